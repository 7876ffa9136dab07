"""One behavior applied as a transition: its preconditions, controller calls and effect (§2.2).

This is what a planner's step does; whether the program would ever choose the step is not asked. An
`achieve` is the condition it names, `achieve_once` is none, as in its Hoare triple, and in a
behavior with an effect of its own every condition must still hold at the next `do` and at the
effect (semantics.md §2).
"""

from collections import ChainMap
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
    Controller,
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
    SetLocal,
    Statement,
)
from crow.program.locals import Locals, set_local
from crow.program.names import fresh_name
from crow.program.walk import free_variables
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

    `problem` says why it stopped before its end, if it did. `variables` are all that the body knows
    at its end.
    """

    trace: Trace
    state: State
    bindings: Mapping[str, Value]
    problem: Unmet | Ambiguous | None = None
    variables: Mapping[str, Value] = field(default_factory=dict)

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

    `arguments` are one value a parameter; `bindings` choose values for `bind`s by name, the second
    variable of a name being `y_2`. A bind that is not chosen takes the one object that satisfies
    its condition, if there is just one.
    """
    names = [p.name for p in behavior.parameters]
    variables = dict(zip(names, arguments, strict=True))
    run = _Application(world, state, behavior, ChainMap(variables), dict(bindings or {}))
    run.taken.update(names)
    problem = run.run()
    return Transition(tuple(run.trace), run.state, run.bound, problem, dict(run.variables))


class _Stop(Exception):  # noqa: N818 - ends the walk over the body
    def __init__(self, problem: Unmet | Ambiguous) -> None:
        super().__init__()
        self.problem = problem


@dataclass(slots=True)
class _Application:
    """One walk over a body; `held` are the conditions to check again at the next step."""

    world: World
    state: State
    behavior: Behavior
    variables: Locals
    chosen: dict[str, Value]
    trace: list[AssertItem | DoItem | EffItem] = field(default_factory=list)
    held: list[tuple[AssertItem, State]] = field(default_factory=list)
    bound: dict[str, Value] = field(default_factory=dict)
    taken: set[str] = field(default_factory=set)
    values: set[str] = field(default_factory=set)

    def run(self) -> Unmet | Ambiguous | None:
        behavior = self.behavior
        try:
            self._statements(behavior.body)
            if behavior.effect is not None:
                self._check_held()
                self._effect(behavior, dict(self.variables), behavior.location)
        except _Stop as stop:
            return stop.problem
        return None

    def _statements(self, statements: tuple[Statement, ...]) -> None:
        for statement in statements:
            self._statement(statement)

    def _statement(self, node: Statement) -> None:
        match node:
            case Assert(condition=condition):
                is_held = self.values.isdisjoint(free_variables(condition))
                self._require(condition, node.location, is_held=is_held)
            case Achieve(once=True):
                return  # what it brings about may be gone again when the transition happens
            case Achieve(condition=condition):
                self._require(condition, node.location)
            case Bind():
                self._bind(node)
            case Do():
                self._do(node)
            case Let(variable=variable, value=value):
                self._set(variable.name, self._value(value))
            case SetLocal(variable=name, value=value):
                set_local(self.variables, name, self._value(value))
            case If(condition=condition, then=then, otherwise=otherwise):
                self._block(then if self._value(condition) else otherwise)
            case ForEach(variables=variables, body=body):
                names = [v.name for v in variables]
                for chosen in assignments_of(self.world, variables, {}):
                    self._block(body, {name: chosen[name] for name in names})
            case ForRange(variable=variable, body=body):
                for number in range(node.start, node.stop, node.step):
                    self._block(body, {variable.name: number})
            case Group(order="alternative"):
                raise _Stop(Unmet("alternative", "its choice is made by search", node.location))
            case Group(body=body):
                self._block(body)
            case Call():
                self._call(node)
            case Commit():
                return
            case _:
                raise AssertionError(f"{type(node).__name__} in a body")

    def _block(
        self, statements: tuple[Statement, ...], variables: dict[str, Value] | None = None
    ) -> None:
        """A block of its own: what it declares hides outer names until its end."""
        outer = self.variables
        self.variables = outer.new_child(variables or {})
        self._statements(statements)
        self.variables = outer

    def _set(self, name: str, value: Value) -> None:
        self.variables[name] = value
        self.values.discard(name)

    def _value(self, expression: Expression) -> Value:
        try:
            return evaluate(self.world, self.state, expression, self.variables)
        except EvaluationError as error:
            text = expression_text(expression)
            raise _Stop(Unmet(text, str(error), error.location)) from None

    def _require(
        self, condition: Expression, location: Location | None, *, is_held: bool = True
    ) -> None:
        item = AssertItem(
            condition, dict(self.variables), expression_text(condition), location=location
        )
        self._check(item, "it is false where it stands")
        if is_held:
            self.held.append((item, self.state))

    def _check(self, item: AssertItem, reason: str) -> None:
        self.trace.append(item)
        try:
            is_true = holds(self.world, self.state, item.condition, item.variables)
        except EvaluationError as error:
            raise _Stop(Unmet(item.text, str(error), error.location)) from None
        if not is_true:
            raise _Stop(Unmet(item.text, reason, item.location))

    def _check_held(self) -> None:
        """Before a `do` and the effect, what was required since the last `do` must still hold."""
        if self.behavior.effect is not None:
            for item, state in self.held:
                if state is not self.state:
                    self._check(item, "it no longer holds at the next step of the behavior")
        self.held.clear()

    def _bind(self, node: Bind) -> None:
        names = self._names(node)
        fixed = self._given(node, names)
        free = tuple(v for v in node.variables if v.name not in fixed)
        for variable in free:
            if not isinstance(variable.type, ObjectType):
                reason = f"a value of type `{variable.type}` has to be given"
                raise _Stop(Unmet(f"bind {variable.name}", reason, node.location))
        candidates = self._candidates(node, free, fixed)
        if len(candidates) > 1:
            raise _Stop(_ambiguous(node, names, candidates))
        if not candidates:
            raise _Stop(_impossible(node, names, is_given=not free))
        (chosen,) = candidates
        for variable, name in zip(node.variables, names, strict=True):
            self._set(variable.name, chosen[variable.name])
            self.bound[name] = chosen[variable.name]
        values = {v.name for v in node.variables if not isinstance(v.type, ObjectType)}
        self.values |= values
        if node.condition is not None:
            self._require(node.condition, node.location, is_held=not values)

    def _names(self, node: Bind) -> tuple[str, ...]:
        """A name of its own for each variable, also where one shadows a parameter or another bind.

        The Hoare model numbers them in the same way.
        """
        names = []
        for variable in node.variables:
            names.append(fresh_name(variable.name, self.taken))
            self.taken.add(names[-1])
        return tuple(names)

    def _given(self, node: Bind, names: tuple[str, ...]) -> dict[str, Value]:
        """The variables of a bind that the caller chose, with their values."""
        pairs = zip(node.variables, names, strict=True)
        return {v.name: self.chosen[name] for v, name in pairs if name in self.chosen}

    def _candidates(
        self, node: Bind, free: tuple[Parameter, ...], fixed: dict[str, Value]
    ) -> list[dict[str, Value]]:
        """The assignments of the free variables that satisfy the condition."""
        assignments = assignments_of(self.world, free, {**self.variables, **fixed})
        condition = node.condition
        if condition is None:
            return list(assignments)
        try:
            return [a for a in assignments if holds(self.world, self.state, condition, a)]
        except EvaluationError as error:
            raise _Stop(Unmet(expression_text(condition), str(error), error.location)) from None

    def _do(self, node: Do) -> None:
        values = tuple(self._value(a) for a in node.arguments)
        self._check_held()
        self.trace.append(DoItem(node.controller, values, location=node.location))
        controller = self.world.controllers[node.controller]
        if controller.effect is not None:
            names = [p.name for p in controller.parameters]
            self._effect(controller, dict(zip(names, values, strict=True)), node.location)

    def _call(self, node: Call) -> None:
        """The called behavior where it stands; its binds are chosen among the caller's."""
        called = self.world.behaviors[node.behavior]
        names = [p.name for p in called.parameters]
        values = dict(zip(names, map(self._value, node.arguments), strict=True))
        inner = _Application(
            self.world,
            self.state,
            called,
            ChainMap(values),
            self.chosen,
            trace=self.trace,
            bound=self.bound,
            taken=self.taken,
        )
        problem = inner.run()
        self.state = inner.state
        if problem is not None:
            raise _Stop(problem)

    def _effect(
        self,
        owner: Behavior | Controller,
        variables: dict[str, Value],
        location: Location | None,
    ) -> None:
        statements = owner.effect or ()
        self.trace.append(EffItem(owner.name, statements, owner.parameters, variables, location))
        try:
            self.state = execute(self.world, self.state, statements, variables)
        except EvaluationError as error:
            reason = str(error)
            raise _Stop(Unmet(f"eff of {owner.name}", reason, error.location)) from None


def _ambiguous(node: Bind, names: tuple[str, ...], candidates: list[dict[str, Value]]) -> Ambiguous:
    """The first variable that several objects can be."""
    for variable, name in zip(node.variables, names, strict=True):
        choices = tuple(dict.fromkeys(str(c[variable.name]) for c in candidates))
        if len(choices) > 1:
            return Ambiguous(name, choices, node.location)
    raise AssertionError("assignments differ in a variable")


def _impossible(node: Bind, names: tuple[str, ...], *, is_given: bool) -> Unmet:
    text = "True" if node.condition is None else expression_text(node.condition)
    if is_given:
        return Unmet(text, "it is false where it stands", node.location)
    wanted = " and ".join(f"`{name}`" for name in names)
    return Unmet(text, f"no object can be {wanted}", node.location)
