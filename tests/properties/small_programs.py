"""Random small programs over objects for comparing the planner's engines: texts, from a seed.

Every construct of bodies occurs: L, M and R, groups, loops, binds, calls, compound conditions,
derived functions, numbers, effects of controllers, methods.
"""

import random
from dataclasses import dataclass, field

FEATURES = {"p": 1, "q": 1, "on": 2, "r": 0, "s": 0}


@dataclass
class Small:
    """A domain and a problem, and what is interesting about them."""

    domain: str
    problem: str
    marks: frozenset[str]


@dataclass
class Maker:
    """Draws one program; `most` is the most members of a section."""

    rng: random.Random
    most: int = 3
    marks: set[str] = field(default_factory=set)
    arities: list[int] = field(default_factory=list)
    goals: list[str] = field(default_factory=list)
    called: set[int] = field(default_factory=set)
    names: int = 0

    def chance(self, share: float) -> bool:
        return self.rng.random() < share

    # ---------------------------------------------------------------------------------- conditions

    def term(self, scope: list[str]) -> str:
        return self.rng.choice(scope) if scope else "home"

    def cell(self, scope: list[str], brackets: str = "()") -> str:
        name = self.rng.choice(list(FEATURES))
        terms = [self.term(scope) for _ in range(FEATURES[name])]
        inner = ", ".join(terms) or ("..." if brackets == "[]" else "")
        return f"{name}{brackets[0]}{inner}{brackets[1]}"

    def literal(self, scope: list[str]) -> str:
        kind = self.rng.randrange(14)
        if kind == 0:
            return f"n() {self.rng.choice(['==', '>=', '<', '!='])} {self.rng.randrange(3)}"
        if kind == 1:
            return f"some({self.term(scope)})"
        if kind == 2:
            return f"at({self.term(scope)}) == {self.term(scope)}"
        return ("not " if self.chance(0.25) else "") + self.cell(scope)

    def condition(self, scope: list[str]) -> str:
        kind = self.rng.randrange(16)
        match kind:
            case 0 | 1:
                return f"({self.literal(scope)} and {self.literal(scope)})"
            case 2:
                return f"({self.literal(scope)} or {self.literal(scope)})"
            case 3:
                return f"(exists v: T: {self.literal(['v', *scope])})"
            case 4:
                return f"(forall v: T: {self.literal(['v'])})"
            case 5:
                return f"(not ({self.literal(scope)} and {self.literal(scope)}))"
            case 6:
                return f"(({self.literal(scope)}) ^ ({self.literal(scope)}))"
            case _:
                return self.literal(scope)

    # ---------------------------------------------------------------------------------- statements

    def achieve(self, scope: list[str]) -> str:
        word = "achieve_once" if self.chance(0.1) else "achieve"
        return f"{word} {self.condition(scope)}"

    def call(self, index: int, scope: list[str]) -> str | None:
        """A later behavior, so that calls make no circle."""
        if index + 1 >= len(self.arities):
            return None
        later = self.rng.randrange(index + 1, len(self.arities))
        self.called.add(later)
        arguments = ", ".join(self.term(scope) for _ in range(self.arities[later]))
        return f"b{later}({arguments})"

    def member(self, index: int, scope: list[str], depth: int) -> list[str]:
        """A member of M."""
        kind = self.rng.randrange(20)
        if depth and kind < 6:
            inner = [self.member(index, scope, depth - 1) for _ in range(2)]
            block = [f"  {line}" for lines in inner for line in lines]
            match kind:
                case 0 | 1:
                    return [self.rng.choice(["sequential:", "unordered:"]), *block]
                case 2:
                    return ["alternative:", *block]
                case 3:
                    self.names += 1
                    name = f"e{self.names}"
                    inside = self.member(index, [name, *scope], 0)
                    return [f"foreach {name}: T:", *(f"  {line}" for line in inside)]
                case _:
                    return [f"if {self.literal(scope)}:", *block]
        if kind < 8:
            return [f"assert {self.condition(scope)}"]
        if kind == 8 and (called := self.call(index, scope)):
            return [called]
        return [self.achieve(scope)]

    def statements(self, index: int, scope: list[str], size: int, depth: int = 1) -> list[str]:
        """Statements of L or R; binds extend the scope of those after them."""
        lines: list[str] = []
        scope = list(scope)
        for _ in range(size):
            lines += self.statement(index, scope, depth)
        return lines

    def statement(self, index: int, scope: list[str], depth: int) -> list[str]:
        kind = self.rng.randrange(20)
        if kind < 3:
            self.names += 1
            name = f"v{self.names}"
            where = f" where: {self.condition([name, *scope])}" if self.chance(0.8) else ""
            scope.append(name)
            return [f"bind {name}: T{where}"]
        if kind == 3:
            self.names += 1
            value = self.term(scope)
            scope.append(f"v{self.names}")
            return [f"let v{self.names} = at({value})"]
        if kind < 7:
            return [f"assert {self.condition(scope)}"]
        if kind < 10:
            return [f"do {self.rng.choice(['c', 'd'])}({self.term(scope)})"]
        if kind == 10 and (called := self.call(index, scope)):
            return [called]
        if depth and kind < 15:
            word = self.rng.choice(
                [
                    "unordered:",
                    "sequential:",
                    "alternative:",
                    "foreach",
                    f"if {self.literal(scope)}:",
                ]
            )
            inner = list(scope)
            if word == "foreach":
                self.names += 1
                inner.append(f"e{self.names}")
                word = f"foreach e{self.names}: T:"
            if word == "alternative:":  # what one choice declares, another cannot see
                return [word, *(f"  {self.achieve(inner)}" for _ in range(2))]
            block = self.statements(index, inner, self.rng.randrange(1, 3), depth - 1)
            return [word, *(f"  {line}" for line in block)]
        return [self.achieve(scope)]

    # --------------------------------------------------------------------------------- definitions

    def effect(self, goal: str | None, scope: list[str]) -> list[str]:
        lines = []
        for _ in range(self.rng.randrange(0, 3)):
            kind = self.rng.randrange(8)
            if kind == 0:
                lines.append(self.rng.choice(["n += 1", "n = 0", "n = 2"]))
            elif kind == 1 and scope:
                lines.append(f"at[{self.term(scope)}] = {self.term(scope)}")
            elif kind == 2:
                lines += ["foreach w: T:", f"  p[w] = {self.rng.choice(['True', 'False'])}"]
            else:
                lines.append(f"{self.cell(scope, '[]')} = {self.rng.choice(['True', 'False'])}")
        if goal is not None and self.chance(0.9):
            lines.append(goal)
        return lines or ["pass"]

    def goal(self, arity: int) -> tuple[str, str]:
        """A goal over the first parameters, and the assignment that establishes it."""
        kind = self.rng.randrange(10)
        if kind == 0:
            return "n() == k", "n = k"
        if kind == 1 and arity >= 2:
            return "at(x0) == x1", "at[x0] = x1"
        names = [n for n, size in FEATURES.items() if size <= arity]
        name = self.rng.choice(names)
        own = ", ".join(f"x{i}" for i in range(FEATURES[name]))
        is_true = self.chance(0.8)
        written = f"{name}[{own or '...'}] = {is_true}"
        return f"{'' if is_true else 'not '}{name}({own})", written

    def behavior(self, index: int) -> list[str]:
        arity = self.arities[index]
        scope = [f"x{i}" for i in range(arity)]
        goal, written = self.goal(arity)
        parameters = [f"{name}: T" for name in scope]
        has_goal = self.chance(0.93)
        if "k" in goal.split():
            if has_goal and index not in self.called:
                parameters.append("k: int64")
            else:
                goal, written = "r()", "r[...] = True"
        annotation = "[[max_nested=1]] " if self.chance(0.1) else ""
        lines = [f"behavior {annotation}b{index}({', '.join(parameters)}):"]
        if has_goal:
            lines.append(f"  goal: {goal}")
            self.goals.append(goal)
        lines.append("  body:")
        lines += [f"    {line}" for line in self.body(index, scope)]
        if self.chance(0.85):
            lines += ["  eff:", *(f"    {line}" for line in self.effect(written, scope))]
        return lines

    def body(self, index: int, scope: list[str]) -> list[str]:
        if self.chance(0.4):
            return self.statements(index, scope, self.rng.randrange(0, self.most + 1)) or ["pass"]
        size = self.rng.randrange(0, 2)
        inner = list(scope)
        left: list[str] = []
        for _ in range(size):
            left += self.statement(index, inner, 0)
        members = [
            line
            for _ in range(self.rng.randrange(1, self.most + 1))
            for line in self.member(index, inner, 1)
        ]
        order = self.rng.choice(["promotable:", "promotable sequential:"])
        right = self.statements(index, inner, self.rng.randrange(0, self.most))
        if any(line.startswith(("achieve", "do ", "b")) and "bind" not in line for line in left):
            self.marks.add("acting L")
        if sum("achieve" in line for line in members) >= 2:
            self.marks.add("interleaving")
        return [*left, order, *(f"  {line}" for line in members), *right]

    def domain(self) -> str:
        self.arities = [self.rng.choice([0, 1, 1, 2]) for _ in range(self.rng.randrange(2, 6))]
        lines = ["typedef T", "object_constant home: T"]
        for name, arity in FEATURES.items():
            inner = ", ".join(f"x{i}: T" for i in range(arity))
            lines.append(f"feature {name}({inner})")
        lines += ["feature [[min=0, max=2]] n() -> int64", "feature at(x: T) -> T"]
        lines += [
            "def some(x: T) -> bool:",
            f"  return {self.condition(['x'])}".replace("some", "q"),
        ]
        lines += ["controller c(x: T)", "controller d(x: T):", "  eff:"]
        lines += [f"    {line}" for line in self.effect(None, ["x"])]
        for index in range(len(self.arities)):
            lines += self.behavior(index)
        return "\n".join(lines) + "\n"

    def wanted(self, everyone: list[str]) -> str:
        """Mostly what some behavior achieves."""
        if not self.goals or self.chance(0.2):
            return self.condition(everyone)
        goal = self.rng.choice(self.goals)
        for name in ("x0", "x1"):
            goal = goal.replace(name, self.term(everyone))
        return goal.replace("k", str(self.rng.randrange(3)))

    def problem(self, objects: int) -> str:
        names = ["a", "b"][: objects - 1]
        everyone = ["home", *names]
        lines = ['problem "small"']
        if names:
            lines += ["objects:", f"  {', '.join(names)}: T"]
        lines += ["init:", "  foreach x: T: at[x] = home"]
        lines += [f"  {self.cell(everyone, '[]')} = True" for _ in range(self.rng.randrange(0, 4))]
        goals = [self.wanted(everyone) for _ in range(self.rng.choice([1, 1, 2]))]
        lines.append(f"goal: {' and '.join(goals)}")
        return "\n".join(lines) + "\n"


def small_program(seed: int, most: int = 3) -> Small:
    """The program of a seed."""
    maker = Maker(random.Random(seed), most)
    domain = maker.domain()
    return Small(domain, maker.problem(maker.rng.randrange(1, 4)), frozenset(maker.marks))
