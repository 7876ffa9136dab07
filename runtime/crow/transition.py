"""One behavior applied as a transition: its preconditions, controller calls and effect (§2.2).

This is what a planner's step does; whether the program would ever choose the step is not asked. An
`achieve` is the condition it names, and in a behavior with an effect of its own every condition
must still hold at the next `do` and at the effect (semantics.md §2).
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

from crow.evaluate import EvaluationError, assignments_of, evaluate, execute, holds
from crow.problem import State, World
from crow.program import (
    Achieve,
    Assert,
    Behavior,
    Bind,
    Call,
    Commit,
    Do,
    Expression,
    ForEach,
    ForRange,
    Group,
    If,
    Let,
    Location,
    ObjectType,
    Parameter,
    Statement,
)
from crow.text import expression_text
from crow.trace import AssertItem, DoItem, EffItem, Trace
from crow.values import Value


@dataclass(frozen=True, slots=True)
class Unmet:
    """Why a behavior cannot be applied: a condition that is false where it stands."""

    condition: str
    reason: str
    location: Location | None


@dataclass(frozen=True, slots=True)
class Ambiguous:
    """A `bind` that the state leaves open: the objects to choose from."""

    variable: str
    choices: tuple[str, ...]
    location: Location | None


@dataclass(frozen=True, slots=True)
class Transition:
    """What applying a behavior did: the trace, the state after it, and the bound variables.

    `problem` says why it stopped before its end, if it did.
    """

    trace: Trace
    state: State
    bindings: Mapping[str, Value]
    problem: Unmet | Ambiguous | None = None

    @property
    def calls(self) -> tuple[DoItem, ...]:
        """The controller calls, in order."""
        return tuple(item for item in self.trace if isinstance(item, DoItem))


def apply(
    world: World,
    state: State,
    behavior: Behavior,
    arguments: tuple[Value, ...],
    bindings: Mapping[str, Value] | None = None,
) -> Transition:
    """Apply a behavior in a state.

    `arguments` are one value a parameter; `bindings` choose values for `bind`s by name. A bind that
    is not chosen takes the one object that satisfies its condition, if there is just one.
    """
    names = [p.name for p in behavior.parameters]
    variables = dict(zip(names, arguments, strict=True))
    run = _Application(world, state, behavior, variables, dict(bindings or {}))
    problem = run.run()
    return Transition(tuple(run.trace), run.state, run.bound, problem)


class _Stop(Exception):  # noqa: N818 - ends the walk over the body
    def __init__(self, problem: Unmet | Ambiguous) -> None:
        super().__init__()
        self.problem = problem


@dataclass(slots=True)
class _Application:
    world: World
    state: State
    behavior: Behavior
    variables: dict[str, Value]
    chosen: dict[str, Value]
    trace: list[AssertItem | DoItem | EffItem] = field(default_factory=list)
    held: list[AssertItem] = field(default_factory=list)
    bound: dict[str, Value] = field(default_factory=dict)

    def run(self) -> Unmet | Ambiguous | None:
        behavior = self.behavior
        members = () if behavior.promotable is None else behavior.promotable.members
        try:
            self._statements((*behavior.left, *members, *behavior.right))
            if behavior.effect is not None:
                self._check_held()
                parameters = behavior.parameters
                self._effect(behavior.name, behavior.effect, parameters, self.variables)
        except _Stop as stop:
            return stop.problem
        except EvaluationError as error:
            return Unmet("a computation", str(error), error.location)
        return None

    def _statements(self, statements: tuple[Statement, ...]) -> None:
        for statement in statements:
            self._statement(statement)

    def _statement(self, node: Statement) -> None:
        match node:
            case Assert(condition=condition):
                self._require(condition, node.location)
            case Achieve(condition=condition, once=once):
                self._require(condition, node.location, is_held=not once)
            case Bind():
                self._bind(node)
            case Do():
                self._do(node)
            case Let(variable=variable, value=value):
                self.variables[variable.name] = self._value(value)
            case If(condition=condition, then=then, otherwise=otherwise):
                self._statements(then if self._value(condition) else otherwise)
            case ForEach(variables=variables, body=body):
                self._loop(assignments_of(self.world, variables, self.variables), body)
            case ForRange(variable=variable, body=body):
                numbers = range(node.start, node.stop, node.step)
                self._loop([{**self.variables, variable.name: n} for n in numbers], body)
            case Group(order="alternative"):
                raise _Stop(Unmet("alternative", "its choice is made by search", node.location))
            case Group(body=body):
                self._statements(body)
            case Call():
                self._call(node)
            case Commit():
                return
            case _:
                raise AssertionError(f"{type(node).__name__} in a body")

    def _loop(self, rounds: list[dict[str, Value]], body: tuple[Statement, ...]) -> None:
        outer = self.variables
        for inner in rounds:
            self.variables = inner
            self._statements(body)
        self.variables = outer

    def _value(self, expression: Expression) -> Value:
        return evaluate(self.world, self.state, expression, self.variables)

    def _require(
        self, condition: Expression, location: Location | None, *, is_held: bool = True
    ) -> None:
        item = AssertItem(
            condition, dict(self.variables), expression_text(condition), location=location
        )
        self._check(item, "it is false where it stands")
        if is_held:
            self.held.append(item)

    def _check(self, item: AssertItem, reason: str) -> None:
        self.trace.append(item)
        if not holds(self.world, self.state, item.condition, item.variables):
            raise _Stop(Unmet(item.text, reason, item.location))

    def _check_held(self) -> None:
        """Before a `do` and the effect, what was required must still hold."""
        if self.behavior.effect is None:
            return
        if any(isinstance(item, EffItem) for item in self.trace):
            for item in self.held:
                self._check(item, "it no longer holds at the next step of the behavior")

    def _bind(self, node: Bind) -> None:
        for variable in node.variables:
            self.variables.pop(variable.name, None)
        candidates = [
            assignment
            for assignment in assignments_of(self.world, self._open(node), self._fixed(node))
            if node.condition is None or holds(self.world, self.state, node.condition, assignment)
        ]
        names = [v.name for v in node.variables]
        if len(candidates) > 1:
            name = next(n for n in names if len({c[n] for c in candidates}) > 1)
            choices = tuple(dict.fromkeys(str(c[name]) for c in candidates))
            raise _Stop(Ambiguous(name, choices, node.location))
        if not candidates:
            text = "True" if node.condition is None else expression_text(node.condition)
            wanted = " and ".join(f"`{name}`" for name in names)
            given = all(name in self.chosen for name in names)
            reason = "it is false where it stands" if given else f"no object can be {wanted}"
            raise _Stop(Unmet(text, reason, node.location))
        self.variables = candidates[0]
        self.bound |= {name: candidates[0][name] for name in names}
        if node.condition is not None:
            self._require(node.condition, node.location)

    def _open(self, node: Bind) -> tuple[Parameter, ...]:
        """The variables of a bind that the caller did not choose."""
        free = tuple(v for v in node.variables if v.name not in self.chosen)
        for variable in free:
            if not isinstance(variable.type, ObjectType):
                reason = f"a value of type `{variable.type}` has to be given"
                raise _Stop(Unmet(f"bind {variable.name}", reason, node.location))
        return free

    def _fixed(self, node: Bind) -> dict[str, Value]:
        chosen = {v.name: self.chosen[v.name] for v in node.variables if v.name in self.chosen}
        return {**self.variables, **chosen}

    def _do(self, node: Do) -> None:
        self._check_held()
        values = tuple(self._value(a) for a in node.arguments)
        self.trace.append(DoItem(node.controller, values, location=node.location))
        controller = self.world.controllers[node.controller]
        if controller.effect is not None:
            names = [p.name for p in controller.parameters]
            variables = dict(zip(names, values, strict=True))
            self._effect(controller.name, controller.effect, controller.parameters, variables)

    def _call(self, node: Call) -> None:
        called = self.world.behaviors[node.behavior]
        arguments = tuple(self._value(a) for a in node.arguments)
        inner = apply(self.world, self.state, called, arguments, self.chosen)
        self.trace += inner.trace
        self.state = inner.state
        if inner.problem is not None:
            raise _Stop(inner.problem)

    def _effect(
        self,
        owner: str,
        statements: tuple[Statement, ...],
        parameters: tuple[Parameter, ...],
        variables: dict[str, Value],
    ) -> None:
        location = self.behavior.location
        item = EffItem(owner, statements, parameters, dict(variables), location=location)
        self.trace.append(item)
        self.state = execute(self.world, self.state, statements, variables)
