"""Every message about what a program means. The docstring of a kind is its page."""

from dataclasses import dataclass

from cdlc.diagnostics import Diagnostic, Help, Label, Lint
from crow.program import Location, Type


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class GoalNotEstablished(Lint):
    """A behavior whose effect does not make its goal true.

        behavior r_holding(x: block, y: block):
          goal: holding(x)
          eff:
            holding[y] = True

    A planner would apply the behavior and find its goal still open. Correct the goal or the effect;
    a behavior that reaches its goal through others has no `eff:` of its own.
    """

    behavior: str
    goal: str
    effect: Location | None
    suggestion: str | None

    def message(self) -> str:
        return f"the effects of `{self.behavior}` do not establish its goal `{self.goal}`"

    def label(self) -> str:
        return "not made true"

    def labels(self) -> tuple[Label, ...]:
        return (
            () if self.effect is None else (Label(self.effect, "this effect writes another cell"),)
        )

    def help(self) -> tuple[Help, ...]:
        return () if self.suggestion is None else (Help(f"did you mean `{self.suggestion}`?"),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class NoHoareModel(Diagnostic):
    """A behavior that this version cannot turn into precondition and effect.

        behavior drain(x: tank):
          body:
            do turn(x)
            achieve open(x)
          eff:
            open[x] = True

    A triple is one transition, so what is achieved after a controller call is not part of it, nor
    is a `let` used after an `achieve` that may change what it has read, nor are `bind`s of values.
    `check`, `plan` and `simulate` take such a behavior, and PDDL gets an action a phase of it.
    Achieve first, or split the behavior in two.
    """

    construct: str
    behavior: str

    def message(self) -> str:
        return f"{self.construct} has no Hoare model in this version"

    def label(self) -> str:
        return f"in `{self.behavior}`"


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class FormulaTooLarge(Diagnostic):
    """A formula of the Hoare model that as text would be far larger than as a graph.

        for i in range(100):
          if fuel(x) > i: fuel[x] -= 1

    Text repeats what formulas share: each iteration here doubles it. `compile --emit hoare --format
    json` writes shared parts once and has no limit; `--emit pddl` needs text. Shorten the loop.
    """

    formula: str
    behavior: str
    limit: int

    def message(self) -> str:
        return f"{self.formula} has more than {self.limit:,} parts as text"

    def label(self) -> str:
        return f"in `{self.behavior}`"

    def help(self) -> tuple[Help, ...]:
        return (Help("`--format json` writes the parts that repeat once"),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class UnmatchedAchieve(Lint):
    """Something to achieve that no behavior has as its goal.

        behavior r_on(x: block, y: block):
          goal: on(x, y)
          body:
            achieve held(x)      # no behavior has the goal `held(…)`

    It can only be true already. If that is meant, write `assert`; else write a behavior with this
    goal, or correct the name, the arguments or the negation.
    """

    condition: str
    effect: Location | None

    def message(self) -> str:
        return f"no behavior has the goal `{self.condition}`"

    def label(self) -> str:
        return "cannot be achieved, only be true already"

    def labels(self) -> tuple[Label, ...]:
        text = "this effect writes it, but is not what its behavior is for"
        return () if self.effect is None else (Label(self.effect, text),)

    def help(self) -> tuple[Help, ...]:
        return (Help("write `assert` if it must be true here, or a behavior with this goal"),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class UnreachableBehavior(Lint):
    """A behavior without a goal that no other behavior calls.

        behavior put_back(x: block):
          body:
            do place(x)

    Behaviors are applied to achieve their goal, or by a call from a behavior that is. Give it a
    goal, call it, or remove it.
    """

    behavior: str

    def message(self) -> str:
        return f"nothing can reach `{self.behavior}`"

    def label(self) -> str:
        return "it has no goal, and nothing that is reached calls it"


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class UnmodelledController(Lint):
    """A controller whose effect nothing describes.

        controller attach(o: Object)
        behavior grab(o: Object):        # a method: no `eff:`
          body:
            do attach(o)

    The planner would believe that nothing changes. Give the controller an `eff:` section, or the
    behavior that runs it.
    """

    controller: str
    declared: Location | None

    def message(self) -> str:
        return f"no effect says what `{self.controller}` changes"

    def label(self) -> str:
        return "run by a behavior without `eff:`"

    def labels(self) -> tuple[Label, ...]:
        return () if self.declared is None else (Label(self.declared, "declared without `eff:`"),)

    def help(self) -> tuple[Help, ...]:
        return (Help("give the controller an `eff:` section (`eff: pass` if nothing changes)"),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class UnmatchedGenerator(Lint):
    """A generator whose goal is a constraint that the program never states.

        generator sample(o: Object, g: Grasp):
          goal: is_grasp(o, g)           # nothing else mentions `is_grasp`
          in: o
          out: g

    It is never asked for values. State the constraint in a `bind`, or remove the generator.
    """

    generator: str

    def message(self) -> str:
        return f"no constraint matches the generator `{self.generator}`"

    def label(self) -> str:
        return "stated nowhere in the program"


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class MissingGenerator(Lint):
    """A bound variable of a value type that no generator can give a value.

        bind t: Trajectory where: connect(a, b, t)

    There are endlessly many values, so one has to be generated. Write a `generator` with the
    condition as its goal and the variable among its `out:`, or bind the value of a function.
    """

    variable: str
    type: Type

    def message(self) -> str:
        return f"no generator can give `{self.variable}` a value"

    def label(self) -> str:
        return f"a value of type `{self.type}`"

    def help(self) -> tuple[Help, ...]:
        return (Help(f"write a `generator` for its condition with `out: {self.variable}`"),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class ConstantCondition(Lint):
    """A condition that is the same in every state.

        assert True
        if 1 < 2:

    Remove it, or correct what it compares.
    """

    value: bool

    def message(self) -> str:
        return f"this condition is always {str(self.value).lower()}"


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class UnusedParameter(Lint):
    """A parameter that its behavior or function never mentions.

        behavior r_holding(x: block, y: block):
          goal: holding(x)

    Remove it, or begin its name with `_` if it has to be there.
    """

    name: str
    owner: str

    def message(self) -> str:
        return f"the parameter `{self.name}` of `{self.owner}` is never used"

    def help(self) -> tuple[Help, ...]:
        return (Help(f"remove it, or call it `_{self.name}`"),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class UnusedVariable(Lint):
    """A `let` or `bind` whose variable is never used.

        let p = position(o)

    Remove it, or begin its name with `_`.
    """

    name: str

    def message(self) -> str:
        return f"`{self.name}` is never used"

    def help(self) -> tuple[Help, ...]:
        return (Help(f"remove it, or call it `_{self.name}`"),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class UnusedDefinition(Lint):
    """A feature, derived function, controller or type that nothing uses.

        feature on_tabel(x: block)       # the behaviors mention `on_table`

    Remove it, or correct the name where it is used. Definitions in included files, and in files
    without behaviors, count as libraries and are not reported.
    """

    name: str
    kind: str

    def message(self) -> str:
        return f"the {self.kind} `{self.name}` is never used"
