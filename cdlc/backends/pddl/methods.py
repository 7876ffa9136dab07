"""Methods, behaviors without an effect of their own, as single steps: one a `do` (lowering.md §1).

A controller with an effect changes the state when a method runs it. As a transition of its own it
demands the asserts that stand since the last thing that may have changed the state.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

from cdlc.backends.pddl.sexpr import NotPddl
from cdlc.ir.behaviors import called_by_transitions
from crow.program import (
    Achieve,
    And,
    Assert,
    Behavior,
    Bind,
    Call,
    Constant,
    Do,
    Expression,
    ForEach,
    ForRange,
    Group,
    If,
    Let,
    Not,
    Or,
    Parameter,
    Program,
    Quantified,
    Read,
    SetLocal,
    Statement,
    Variable,
)
from crow.program.names import fresh_name
from crow.program.rewrite import substitute
from crow.program.types import INT64, is_object
from crow.program.walk import free_variables, statements_within, subexpressions


def method_steps(program: Program, method: Behavior) -> tuple[Behavior, ...]:
    """The steps of a method that have effects, in source order: one `do` each, as a behavior of its
    own whose parameters are what it depends on.

    Raises NotPddl for a step that depends on a value which is no object, or was read before
    something that may have changed it.
    """
    walk = _Walk(program, method)
    start = {p.name: Variable(p.name, p.type) for p in method.parameters}
    walk.block(method.body, _Place(start))
    return tuple(walk.steps)


def unmodelled_calls(program: Program) -> Iterator[tuple[Behavior, Do]]:
    """The calls, in methods, of controllers whose effect nothing describes."""
    silent = {c.name for c in program.controllers if c.effect is None}
    called = called_by_transitions(program)
    for behavior in program.behaviors:
        # A method that is only called has its calls in the transitions of its callers.
        is_part = behavior.goal is None and behavior.name in called
        if behavior.effect is None and not is_part:
            for statement in statements_within(behavior.body):
                if isinstance(statement, Do) and statement.controller in silent:
                    yield behavior, statement


@dataclass(frozen=True, slots=True)
class _Place:
    """Where the walk stands: locals over parameters (None: of no use any more), and conditions."""

    values: Mapping[str, Expression | None]
    pre: tuple[Expression, ...] = ()

    def requiring(self, condition: Expression) -> "_Place":
        return replace(self, pre=(*self.pre, condition))

    def changed(self) -> "_Place":
        """After something that may change the state: nothing read before counts any more."""
        values = {
            name: None if value is None or _reads(value) else value
            for name, value in self.values.items()
        }
        return _Place(values)


def _reads(value: Expression) -> bool:
    return any(isinstance(part, Read) for part in subexpressions(value))


@dataclass
class _Walk:
    program: Program
    method: Behavior
    steps: list[Behavior] = field(default_factory=list)
    _bound: list[Parameter] = field(default_factory=list)

    def block(self, statements: tuple[Statement, ...], place: _Place) -> _Place:
        """The place after some statements."""
        for statement in statements:
            place = self._statement(statement, place)
        return place

    def _nested(self, statements: tuple[Statement, ...], place: _Place) -> _Place:
        """After a block of its own, whose locals end with it."""
        after = self.block(statements, place)
        return replace(after, values={name: after.values.get(name) for name in place.values})

    def _statement(self, node: Statement, place: _Place) -> _Place:
        match node:
            case Assert(condition=condition):
                return place.requiring(self._value(condition, place))
            case Achieve() | Call():
                return place.changed()
            case Do():
                self._do(node, place)
                return place.changed()
            case Bind():
                return self._bind(node, place)
            case (
                Let(variable=Parameter(name=name), value=value)
                | SetLocal(variable=str(name), value=value)
            ):
                now = self._value(value, place) if self._is_known(value, place) else None
                return replace(place, values={**place.values, name: now})
            case If():
                return self._if(node, place)
            case Group(order="sequential", body=body):
                return self._nested(body, place)
            case Group(order=order, body=body):
                start = place.changed() if order == "unordered" and _changes(body) else place
                places = [self._nested((part,), start) for part in body]
                return place.changed() if _changes(body) else self._all(place, places)
            case ForEach():
                return self._foreach(node, place)
            case ForRange(variable=variable, body=body):
                for number in range(node.start, node.stop, node.step):
                    counted = {**place.values, variable.name: Constant(number, INT64)}
                    place = self._nested(body, replace(place, values=counted))
                return place
            case _:
                return place

    def _all(self, place: _Place, places: list[_Place]) -> _Place:
        extra = tuple(c for after in places for c in after.pre[len(place.pre) :])
        return replace(place, pre=(*place.pre, *extra))

    def _if(self, node: If, place: _Place) -> _Place:
        test = self._value(node.condition, place)
        ways = ((test, node.then), (Not(test), node.otherwise))
        places = [self._nested(body, place.requiring(c)) for c, body in ways]
        if _changes((*node.then, *node.otherwise)):
            return place.changed()
        for (condition, _), after in zip(ways, places, strict=True):
            for demanded in after.pre[len(place.pre) + 1 :]:
                place = place.requiring(Or((Not(condition), demanded)))
        return place

    def _foreach(self, node: ForEach, place: _Place) -> _Place:
        variables, inner = self._opened(node.variables, place)
        start = inner.changed() if _changes(node.body) else inner
        after = self._nested(node.body, start)
        if _changes(node.body):
            return place.changed()
        demanded = after.pre[len(place.pre) :]
        if not demanded:
            return place
        body = demanded[0] if len(demanded) == 1 else And(demanded)
        return place.requiring(Quantified("forall", variables, body))

    def _bind(self, node: Bind, place: _Place) -> _Place:
        _, inner = self._opened(node.variables, place)
        if node.condition is None or not self._is_known(node.condition, inner):
            return inner
        return inner.requiring(self._value(node.condition, inner))

    def _opened(
        self, variables: tuple[Parameter, ...], place: _Place
    ) -> tuple[tuple[Parameter, ...], _Place]:
        """New variables under names of their own; a value that is no object is not known."""
        opened: list[Parameter] = []
        values = dict(place.values)
        for variable in variables:
            taken = {p.name for p in (*self.method.parameters, *self._bound, *opened)}
            named = replace(variable, name=fresh_name(variable.name, taken))
            opened.append(named)
            is_known = is_object(variable.type)
            values[variable.name] = Variable(named.name, named.type) if is_known else None
        self._bound += opened
        return tuple(opened), replace(place, values=values)

    def _is_known(self, node: Expression, place: _Place) -> bool:
        return all(place.values.get(name) is not None for name in free_variables(node))

    def _value(self, node: Expression, place: _Place) -> Expression:
        """An expression over parameters and the state of its place. Raises NotPddl."""
        for name in sorted(free_variables(node)):
            if place.values.get(name) is None:
                construct = (
                    f"`{name}`, whose value is not known at this step of `{self.method.name}`,"
                )
                raise NotPddl(construct, node.location)
        given = {n: v for n, v in place.values.items() if v is not None}
        return substitute(node, given)

    def _do(self, node: Do, place: _Place) -> None:
        controller = next(c for c in self.program.controllers if c.name == node.controller)
        if controller.effect is None:
            return
        arguments = tuple(self._value(a, place) for a in node.arguments)
        body: tuple[Statement, ...] = tuple(Assert(c, location=c.location) for c in place.pre)
        called = replace(node, arguments=arguments)
        number = len(self.steps) + 1
        behavior = Behavior(
            f"{self.method.name}'{number}",
            (*self.method.parameters, *self._bound),
            None,
            (*body, called),
            None,
            (),
            (),
            location=node.location,
        )
        self.steps.append(_only_used(behavior))


def _only_used(step: Behavior) -> Behavior:
    """A step with the parameters it depends on."""
    used: set[str] = set()
    for statement in step.left:
        match statement:
            case Assert(condition=condition):
                used |= free_variables(condition)
            case Do(arguments=arguments):
                used |= frozenset[str]().union(*map(free_variables, arguments))
            case _:
                pass
    return replace(step, parameters=tuple(p for p in step.parameters if p.name in used))


def _changes(statements: tuple[Statement, ...]) -> bool:
    """Whether any statement may change the state."""
    return any(isinstance(s, Achieve | Call | Do) for s in statements_within(statements))
