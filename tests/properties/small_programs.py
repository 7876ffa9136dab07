"""Random small programs over objects for comparing the planner's engines: texts, from a seed.

Every construct of bodies but `commit` occurs: L, M and R, groups, loops, binds, calls, compound
conditions, derived functions, numbers, subtypes, effects of controllers, methods.
"""

import random
import re
from dataclasses import dataclass, field

FEATURES = {"p": 1, "q": 1, "on": 2, "r": 0, "s": 0}
LITERAL = re.compile(rf"(not )?\b({'|'.join(FEATURES)})\(")
WRITE = re.compile(rf"({'|'.join(FEATURES)})\[.*\] = (True|False)")

CONSTRUCTS = {
    name: re.compile(words)
    for name, words in {
        "bind": r"bind v\d+: T where",
        "bind of a subtype": r"bind v\d+: U",
        "unordered": "unordered:",
        "alternative": "alternative:",
        "foreach": r"foreach e\d+",
        "for": "for k in",
        "if": r"if .*:",
        "let": "let ",
        "call": r"\n +b\d\(",
        "max_nested": "max_nested",
        "number": r"achieve.* n\(\) [=><!]",
        "numeric goal": r"goal: n\(\)",
        "derived function": r"achieve.*some\(",
        "derived goal": r"goal: some\(",
        "negative": "achieve not",
        "negative goal": "goal: not",
        "value": r"achieve.* at\(.*\) ==",
        "value goal": r"goal: at\(",
        "achieve_once": "achieve_once",
        "assert": "assert",
        "opaque": r"achieve.* \^ ",
        "subtype": r"behavior .*: U",
        "promotable": "promotable:",
        "promotable sequential": "promotable sequential:",
    }.items()
}
"""What occurs in programs, and how to see it in their text."""


@dataclass
class Small:
    """A domain and a problem, and what is interesting about behaviors, by their names."""

    domain: str
    problem: str
    marks: dict[str, set[str]]


@dataclass
class Written:
    """A behavior: what it is for, what it achieves and what it writes, as feature and value."""

    name: str
    marks: set[str]
    goal: tuple[str, bool] | None
    achieves: set[tuple[str, bool]]
    writes: set[tuple[str, bool]]


@dataclass
class Maker:
    """Draws one program; `most` is the most members of a section."""

    rng: random.Random
    most: int = 3
    behaviors: list["Written"] = field(default_factory=list)
    arities: list[int] = field(default_factory=list)
    goals: list[str] = field(default_factory=list)
    called: set[int] = field(default_factory=set)
    names: int = 0

    def chance(self, share: float) -> bool:
        return self.rng.random() < share

    def type_(self) -> str:
        return "U" if self.chance(0.15) else "T"

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
                    return [f"foreach {name}: {self.type_()}:", *(f"  {line}" for line in inside)]
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
            return [f"bind {name}: {self.type_()}{where}"]
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
                    "for k in range(2):",
                    f"if {self.literal(scope)}:",
                ]
            )
            inner = list(scope)
            if word == "foreach":
                self.names += 1
                inner.append(f"e{self.names}")
                word = f"foreach e{self.names}: {self.type_()}:"
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
        kind = self.rng.randrange(12)
        if kind == 0:
            return f"n() {self.rng.choice(['==', '>='])} k", "n = k"
        if kind == 1 and arity >= 2:
            return "at(x0) == x1", "at[x0] = x1"
        if kind == 2 and arity:
            return "some(x0)", self.rng.choice(["p[x0] = True", "q[x0] = True"])
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
        types = [self.type_() if index not in self.called else "T" for _ in scope]
        parameters = [f"{name}: {type_}" for name, type_ in zip(scope, types, strict=True)]
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
        body, marks = self.body(index, scope)
        lines += [f"    {line}" for line in body]
        effect = self.effect(written, scope) if self.chance(0.85) else []
        if effect:
            lines += ["  eff:", *(f"    {line}" for line in effect)]
        own = Written(
            f"b{index}",
            marks,
            goal=next(iter(_writes([written])), None) if has_goal else None,
            achieves=_literals(body),
            writes=_writes(effect),
        )
        self.behaviors.append(own)
        return lines

    def body(self, index: int, scope: list[str]) -> tuple[list[str], set[str]]:
        """The lines of a body, and what is interesting about them."""
        if self.chance(0.25):
            lines = self.statements(index, scope, self.rng.randrange(0, self.most + 1))
            return lines or ["pass"], set()
        marks = set()
        size = self.rng.choice([0, 0, 0, 1, 1, 1, 2])
        inner = list(scope)
        left: list[str] = []
        for _ in range(size):
            left += self.statement(index, inner, 0)
        members = [
            line
            for _ in range(min(self.rng.choice([1, 1, 2, 2, 3]), self.most))
            for line in self.member(index, inner, 1)
        ]
        order = self.rng.choice(["promotable:", "promotable sequential:"])
        right = self.statements(index, inner, self.rng.randrange(0, self.most))
        if any(line.startswith(("achieve", "do ", "b")) and "bind" not in line for line in left):
            marks.add("acting L")
        if sum("achieve" in line for line in members) >= 2:
            marks.add("interleaving")
        return [*left, order, *(f"  {line}" for line in members), *right], marks

    def domain(self) -> str:
        self.arities = [self.rng.choice([0, 1, 1, 2]) for _ in range(self.rng.randrange(2, 6))]
        lines = ["typedef T", "typedef U: T", "object_constant home: T"]
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

    def marked(self) -> list[Written]:
        """The behaviors, marked also where what they achieve may establish their own goals."""
        for parent in self.behaviors:
            for child in self.behaviors:
                is_child = child.goal is not None and child.goal in parent.achieves
                if is_child and parent.goal in child.writes:
                    parent.marks.add("established by a child")
        return self.behaviors

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
            types = ["T", "U"]
            lines += ["objects:", *(f"  {n}: {t}" for n, t in zip(names, types, strict=False))]
        lines += ["init:", "  foreach x: T: at[x] = home"]
        lines += [f"  {self.cell(everyone, '[]')} = True" for _ in range(self.rng.randrange(0, 4))]
        goals = [self.wanted(everyone) for _ in range(self.rng.choice([1, 1, 2]))]
        lines.append(f"goal: {' and '.join(goals)}")
        return "\n".join(lines) + "\n"


def small_program(seed: int, most: int = 3) -> Small:
    """The program of a seed."""
    maker = Maker(random.Random(seed), most)
    domain = maker.domain()
    problem = maker.problem(maker.rng.randrange(1, 4))
    return Small(domain, problem, {b.name: b.marks for b in maker.marked()})


def _literals(lines: list[str]) -> set[tuple[str, bool]]:
    """What the achieves of a body want, whichever its arguments."""
    achieves = (line for line in lines if "achieve" in line)
    return {(m[2], m[1] is None) for line in achieves for m in LITERAL.finditer(line)}


def _writes(lines: list[str]) -> set[tuple[str, bool]]:
    """What an effect writes, whichever its arguments."""
    return {(m[1], m[2] == "True") for line in lines for m in WRITE.finditer(line)}
