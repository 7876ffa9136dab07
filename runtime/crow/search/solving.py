"""Values that have to be found: where the search meets the solver of constraints (§2.4, App. B).

A value that is bound gets its value as soon as a generator can draw it, as a choice of its own.
Until then an unknown stands for it. What has to know it meanwhile is decided both ways, each with
its constraint; what only computes with it makes another unknown, with an equation.
"""

from collections.abc import Hashable, Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final, NamedTuple, cast

from crow.constraints import Conflict, Constraint, Drawing, Draws, Solutions, Solver, Store
from crow.constraints.draws import Stream
from crow.evaluate import EvaluationError, changes
from crow.problem import State
from crow.program import (
    INT64,
    Compare,
    Constant,
    Expression,
    Feature,
    Location,
    ObjectType,
    Statement,
    Type,
    Variable,
)
from crow.search.code import CallOp, DoOp, DrawOp, FixOp, LetOp, Op, Test
from crow.search.direct import Direct, direct
from crow.search.expressions import Compiled, Environment, names_of
from crow.search.frames import Context, Frame, Kind
from crow.search.members import with_slots
from crow.search.points import (
    DRAWS,
    GENERATOR,
    SOLVER,
    Choice,
    Known,
    Point,
    Step,
    Undecided,
    constraint_of,
    holds,
)
from crow.search.states import Snapshot
from crow.search.substitution import Substitution
from crow.text import expression_text
from crow.unknowns import Touched, Unknown, has_unknown
from crow.values import Value

if TYPE_CHECKING:
    from crow.program.expressions import ComparisonOperator
    from crow.search.machine import Machine


_WITHOUT_LIMIT: Final = 1 << 62
"""What a round draws is limited, and a generator may have a limit of its own."""

_FLAGS: Final = {
    "round": DRAWS,
    "limit": GENERATOR,
    "incomplete": GENERATOR,
    "missing": SOLVER,
    "nodes": SOLVER,
}


class Solving:
    """Draws values for a machine, and keeps account of what was not drawn."""

    def __init__(self, machine: "Machine", seed: int) -> None:
        self.machine = machine
        self.shared = machine.shared
        world = machine.problem.world
        self.draws = Draws(world, seed, limit=_WITHOUT_LIMIT)
        self.solver = Solver(world, self.draws)
        self.nothing = Known(Store.of(world), {})
        self.most = 1
        self._rejected: dict[str, int] = {}
        self._directs: dict[DrawOp, Direct | None] = {}
        self._tests: dict[tuple[Expression, Location | None], Test] = {}

    def statistics(self) -> dict[str, Any]:
        """What was drawn, by generator."""
        return {"generators": self.draws.statistics()}

    # ------------------------------------------------------------------------------- what is bound

    def draw(self, point: Point, op: DrawOp, rest: Frame | None) -> Step:
        """A bind of values: unknowns, with the condition as a constraint of this time step."""
        context = point.context
        assert context is not None
        self.machine.counters.nodes += 1
        if not self._known(point).open and (found := self._direct(op)) is not None:
            inputs = tuple(term(point.state, context.values) for term in found.inputs)
            if not any(map(has_unknown, inputs)):
                stream = self._stream(point, op, found, inputs)
                return Choice(point, self._drawn_directly(point, op, rest, found, stream))
        values, place = context.values, self._place(context, op)
        own = [
            (slot, Unknown(variable.name, variable.type, f"{place}.{variable.name}"))
            for slot, variable in zip(op.slots, op.variables, strict=True)
            if not op.is_parameter or values[slot] is None
        ]
        bind = _Bind(context, op.test, rest, tuple(s for s, _ in own), tuple(u for _, u in own))
        known = self._known(point)
        if op.test is None:
            return self._bound(point, bind, bind.unknowns, known)
        values = with_slots(values, bind.slots, bind.unknowns)
        asking = self.having(point, op.test, values)
        if asking is None or known.open:
            return asking and self._bound(point, bind, bind.unknowns, self._known(asking))
        # Nothing else is open: what is drawn now is never seen as an unknown by anything.
        drawn = self._next_draw(asking)
        if drawn is None:
            return self._bound(point, bind, bind.unknowns, self._known(asking))
        return Choice(point, self._each(point, bind, drawn))

    def _direct(self, op: DrawOp) -> Direct | None:
        """The one generator that a bind needs, if that is all it needs."""
        if op not in self._directs:
            self._directs[op] = direct(op, self.machine.programs)
        return self._directs[op]

    def _stream(self, point: Point, op: DrawOp, found: Direct, inputs: tuple[Value, ...]) -> Stream:
        assert point.context is not None
        place, cells = self._place(point.context, op), point.state.cells
        return self.draws.stream(found.generator, place, cells, inputs)

    def _drawn_directly(
        self, point: Point, op: DrawOp, rest: Frame | None, found: Direct, stream: Stream
    ) -> Iterator[Point]:
        """The points after a bind, one for each value drawn that is what it should be."""
        context = point.context
        assert context is not None
        seen, index = set[tuple[Value, ...]](), 0
        test, machine = op.test, self.machine
        assert test is not None
        while (row := stream.item(index)) is not None:
            if index >= self.most:
                machine.cut_of_values |= DRAWS
                return
            index += 1
            if row in seen:
                continue
            seen.add(row)
            for value in row:
                self.draws.came_from(value, f"{stream.key}#{index}")
            machine.counters.nodes += 1
            own = with_slots(context.values, op.slots, tuple(row[i] for i in found.outputs))
            if holds(test, point.state, own):
                after = self.shared.context(context.application, own, context.held)
                yield point.told(("assert", test, own)).at(rest, after)
            else:
                self._reject(found, stream.key, index)
                machine.dead.note(point, "nothing that was drawn is like this", test, own)
        if not seen:
            machine.dead.note(point, "its generator yields nothing", test, context.values)
        if stream.is_limited or not stream.python.is_complete:
            machine.cut_of_values |= GENERATOR

    def _reject(self, found: Direct, key: str, index: int) -> None:
        """Count a value that is not what it should be, in the first round that draws it."""
        if index > self._rejected.get(key, 0):
            self._rejected[key] = index
            self.draws.rejected(found.generator, found.constraint)

    def _each(self, point: Point, bind: "_Bind", stores: Iterator[Store]) -> Iterator[Point]:
        for store in stores:
            self.machine.counters.nodes += 1
            values = tuple(store.values.get(unknown, unknown) for unknown in bind.unknowns)
            if store.open or any(map(has_unknown, values)):
                yield self._bound(point, bind, values, Known(store, {}))
            else:
                yield self._bound(point, bind, values, point.constraints)

    def _bound(
        self, point: Point, bind: "_Bind", values: tuple[Value, ...], known: Known | None
    ) -> Point:
        """The point after a bind."""
        context = bind.context
        own = with_slots(context.values, bind.slots, values)
        after = self.shared.context(context.application, own, context.held)
        rest = bind.rest
        if known is not point.constraints:
            rest = self.shared.frame(Kind.SETTLE, rest)
        told = point if bind.test is None else point.told(("assert", bind.test, own))
        return told._replace(frame=rest, context=after, constraints=known)

    def _place(self, context: Context, op: DrawOp) -> str:
        """Which refinement binds, in words that are the same in each run."""
        application = context.application
        name = "" if application.code is None else application.code.behavior.name
        objects = [a for a in application.arguments if isinstance(a, str)]
        where = "" if op.location is None else f"{op.location.line}:{op.location.column}"
        return f"{name}({', '.join(objects)})/{application.depth}/{where}"

    def having(self, point: Point, test: Test, values: Environment) -> Point | None:
        """The point where a condition is a constraint too, unless it cannot be true."""
        known = self._known(point)
        found = known.store.having(constraint_of(test, point.state, values))
        if isinstance(found, Conflict):
            self.machine.dead.note(point, found.reason, test, values, "a conflict")
            return None
        return point._replace(constraints=Known(found, known.decided))

    def settle(self, point: Point) -> Step:
        """Put in what values were found, and draw the next one that a generator can yield."""
        point = self.substituted(point)
        assert point.frame is not None
        assert point.constraints is not None
        drawn = self._next_draw(point)
        if drawn is None:
            return point.at(point.frame.next, point.context)
        return Choice(point, self._drawn(point, drawn))

    def substituted(self, point: Point) -> Point:
        """The point with the values that are known in the place of unknowns."""
        known = point.constraints
        assert known is not None
        return Substitution(self.shared, known.store.values).point(point)

    def _drawn(self, point: Point, stores: Iterator[Store]) -> Iterator[Point]:
        """The point with each of some values; solutions and draws alike."""
        assert point.constraints is not None
        decided = point.constraints.decided
        for store in stores:
            self.machine.counters.nodes += 1
            yield point._replace(constraints=Known(store, decided))

    def _known(self, point: Point) -> Known:
        return point.constraints or self.nothing

    # --------------------------------------------------------------------------- what is not known

    def decide(self, point: Point, undecided: Undecided) -> Step:
        """Take a condition for true and for false, each as a constraint, and go on where it is."""
        return Choice(point, self._decided(point, undecided))

    def _decided(self, point: Point, undecided: Undecided) -> Iterator[Point]:
        known = self._known(point)
        for is_wanted in (True, False):
            constraint = replace(undecided.constraint, is_wanted=is_wanted)
            found = known.store.having(constraint)
            if not isinstance(found, Conflict):
                decided = {**known.decided, undecided.key: is_wanted}
                frame = self.shared.frame(Kind.SETTLE, point.frame)
                yield point._replace(frame=frame, constraints=Known(found, decided))

    def compute(self, point: Point) -> Step:
        """The instruction that needs a value, with what it computes as unknowns of their own."""
        frame, context = point.frame, point.context
        if frame is None or frame.kind is not Kind.BLOCK or context is None:
            return self.give_up()
        ops, index = frame.first, frame.second
        found = self._without_values(point, ops[index])
        if found is None:
            return self.give_up()
        op, known = found
        rest = frame.next
        if index + 1 < len(ops):
            rest = self.shared.frame(Kind.BLOCK, rest, ops, index + 1)
        again = self.shared.frame(Kind.BLOCK, rest, (op,), 0)
        settle = self.shared.frame(Kind.SETTLE, again)
        return point._replace(frame=settle, constraints=known)

    def _without_values(self, point: Point, op: Op) -> tuple[Op, Known] | None:
        known = self._known(point)
        match op:
            case LetOp(slot=slot, value=value):
                made, known = self._defined(point, known, value)
                return FixOp(slot, made), known
            case CallOp(arguments=arguments) | DoOp(arguments=arguments):
                terms: list[Compiled] = []
                for argument in arguments:
                    made, known = self._defined(point, known, argument)
                    terms.append(_constant(made))
                return replace(op, arguments=tuple(terms)), known
            case _:
                return None

    def _defined(self, point: Point, known: Known, term: Compiled) -> tuple[Value, Known]:
        """A value; where it depends on what is not known, an unknown with its equation."""
        context = point.context
        assert context is not None
        try:
            return term(point.state, context.values), known
        except Touched:
            expression, slots = self.machine.programs.written[term]
            names = names_of(slots, context.values)
            state = State(point.state.cells)
            return self._equation(known, expression, expression.type, names, state)

    def _equation(
        self, known: Known, value: Expression, type_: Type, names: Mapping[str, Value], state: State
    ) -> tuple[Unknown, Known]:
        """An unknown that is what an expression computes in a state.

        Raises EvaluationError where the constraints leave it none, and for an object: what reads
        features of it would have to know which.
        """
        where = value.location
        if isinstance(type_, ObjectType):
            self.give_up()
            raise EvaluationError(f"`{expression_text(value)}` depends on what is not known", where)
        place = "" if where is None else f"{where.line}:{where.column}"
        unknown = Unknown(expression_text(value), type_, f"computed/{place}")
        constraint = Constraint(value, names, state, defined=unknown)
        found = known.store.having(constraint)
        if isinstance(found, Conflict):
            raise EvaluationError(found.reason, where)
        return unknown, Known(found, known.decided)

    def effect(
        self, point: Point, statements: tuple[Statement, ...], names: Mapping[str, Value]
    ) -> tuple[Snapshot, Known]:
        """The state after an effect that computes with what is not known, and what is known then.

        Raises EvaluationError, and Undecided where it needs to know what is not decided.
        """
        asked = _Asked(self, self._known(point), point.state.store.decided)
        world = self.machine.problem.world
        written = changes(world, point.state.cells, statements, names, asked)
        return point.state.store.after(point.state, written.items()), asked.known

    # ------------------------------------------------------------------------------- what is solved

    def solve(self, point: Point) -> Step:
        """All values that are still to be found, in every way there is: for `commit`, and the end.

        Where the point stands is then run again.
        """
        assert point.constraints is not None
        solutions = self.solver.solutions(point.constraints.store, self.most)
        settled = point._replace(frame=self.shared.frame(Kind.SETTLE, point.frame))
        return Choice(point, self._drawn(settled, self._noted(point, solutions)))

    def _next_draw(self, point: Point) -> Iterator[Store] | None:
        """Values of the first unknown that a generator can yield; None if there is none."""
        store = self._known(point).store
        for requirement in store.ready:
            for unknown in requirement.unknowns:
                if unknown not in store.values:
                    drawing = self.solver.draws(store, unknown, self.most)
                    if drawing is not None:
                        return self._noted(point, drawing)
        return None

    def _noted(self, point: Point, stores: Drawing | Solutions) -> Iterator[Store]:
        """Stores, with a note, at their end, of what was left out, and what failed."""
        yield from stores
        for cut in stores.cuts:
            self.machine.cut_of_values |= _FLAGS[cut.kind]
            if cut.kind == "missing":
                self._note(point, str(cut))

    def _note(self, point: Point, reason: str) -> None:
        """Remember that the constraints of a point cannot be solved, by one of them."""
        constraint = self._known(point).store.open[0]
        key = constraint.condition, constraint.place
        names = {name: slot for slot, name in enumerate(constraint.variables)}
        test = self._tests.setdefault(key, Test(_never, constraint.condition, names, key[1]))
        values = tuple(constraint.variables.values())
        self.machine.dead.note(point, reason, test, values, "without a value")

    def give_up(self) -> Step:
        """A dead end of what is not covered, so that nothing is said to be impossible."""
        self.machine.cut_of_values |= SOLVER
        return None


class _Bind(NamedTuple):
    """A bind of values that is under way: its unknowns, and the slots they are for."""

    context: Context
    test: Test | None
    rest: Frame | None
    slots: tuple[int, ...]
    unknowns: tuple[Unknown, ...]


class _Asked:
    """Answers where an effect computes with what is not known."""

    def __init__(self, solving: Solving, known: Known, decided: Mapping[Hashable, bool]) -> None:
        self.solving = solving
        self.known = known
        self.decided = decided

    def define(
        self, value: Expression, type_: Type, variables: Mapping[str, Value], state: State
    ) -> Unknown:
        """An unknown that has a value."""
        unknown, self.known = self.solving._equation(self.known, value, type_, variables, state)  # noqa: SLF001
        return unknown

    def decide(self, condition: Expression, variables: Mapping[str, Value], state: State) -> bool:
        """Whether a condition is true, if that was decided."""
        key = (condition, tuple(variables.items()), frozenset(state.cells.items()))
        if key not in self.decided:
            raise Undecided(Constraint(condition, variables, state), key)
        return self.decided[key]

    def bound(self, feature: Feature, value: Unknown) -> None:
        """See to it that a value is within the bounds of a feature."""
        low, high = feature.bounds
        variable = Variable("value", feature.type, location=feature.location)
        for operator, limit in ((">=", low), ("<=", high)):
            if limit is not None:
                bound = Constant(limit, INT64)
                condition = Compare(cast("ComparisonOperator", operator), variable, bound)
                self.require(Constraint(condition, {"value": value}, State()))

    def require(self, constraint: Constraint) -> None:
        """Add a constraint. Raises EvaluationError where it cannot be true."""
        found = self.known.store.having(constraint)
        if isinstance(found, Conflict):
            raise EvaluationError(found.reason, constraint.place)
        self.known = Known(found, self.known.decided)


def _never(_state: Snapshot, _values: Environment) -> bool:
    return False


def _constant(value: Value) -> Compiled:
    return lambda _state, _values: value
