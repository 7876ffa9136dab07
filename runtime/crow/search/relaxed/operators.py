"""Behaviors as operators of the relaxation: what their bodies need, and what they write.

A body is walked once for each choice of objects in it. Where M starts in the initial state, the L
of its members is run there; anywhere else it is relaxed as the rest is.
"""

from collections.abc import Iterable, Iterator
from itertools import islice, product
from math import prod
from typing import Final, NamedTuple

from crow.evaluate import EvaluationError
from crow.program import Assign, Bind, Read, Simulate, Statement
from crow.program.walk import statements_within
from crow.search.code import (
    AchieveOp,
    AllOf,
    AlternativeOp,
    AssertOp,
    Atom,
    BindOp,
    Block,
    CallOp,
    Code,
    CommitOp,
    DoOp,
    FixOp,
    IfOp,
    LetOp,
    OneOf,
    Op,
    Opaque,
    SequenceOp,
    UnorderedOp,
    Wanted,
)
from crow.search.compile import Programs
from crow.search.expressions import Environment, names_of
from crow.search.members import with_slots
from crow.search.relaxed.conditions import Conditions, Names
from crow.search.relaxed.facts import Made, Needs, Operator, Task, Write
from crow.search.states import Snapshot
from crow.search.writes import declared
from crow.values import Value

MOST_BRANCHES = 500
"""The ways through one body that are told apart."""

MOST_TRIED = 20
"""The objects that a bind tries; of more, those that it finds in the initial state, if any."""

FIRST: Final = True
"""In an M that starts in the initial state."""
LATER: Final = False

Key = tuple[Code, tuple[Value, ...], bool]
"""A behavior with arguments, and whether the M in which it stands starts in the initial state."""


class Way(NamedTuple):
    """One way through statements: values, facts needed, controller calls and their writes.

    `asked` are those of the facts for which behaviors may be applied.
    """

    values: Environment
    needs: tuple[int, ...] = ()
    calls: int = 0
    writes: tuple[Write, ...] = ()
    asked: tuple[int, ...] = ()

    def needing(self, more: Needs) -> "tuple[Way, ...]":
        """The way with more needed; none if that is impossible."""
        return () if more is None else (self._replace(needs=(*self.needs, *more)),)

    def asking(self, more: Needs) -> "tuple[Way, ...]":
        """The way with more needed that behaviors may be applied for."""
        asked = (*self.asked, *(more or ()))
        return tuple(way._replace(asked=asked) for way in self.needing(more))


class Operators:
    """Makes the operators of one world as they come to be asked for."""

    def __init__(self, programs: Programs, task: Task, initial: Snapshot) -> None:
        self.programs = programs
        self.world = programs.world
        self.task = task
        self.initial = initial
        self.conditions = Conditions(programs, task, initial)
        self._applied: dict[Key, list[int]] = {}
        self._claims: dict[Key, list[int]] = {}
        self._pending: list[Key] = []

    def close(self) -> None:
        """Make the operators that were asked for, and those that these ask for."""
        while self._pending:
            self._make(*self._pending.pop())

    # ------------------------------------------------------------------------------- what is wanted

    def wanted(self, wanted: Wanted, values: Environment, is_first: bool, *, again: bool = False
    ) -> Needs:  # fmt: skip
        """The facts that stand for a condition; `again` if it has to be achieved though true.

        `is_first` says that the M in which it stands starts in the initial state.
        """
        from crow.search.machine import choices

        match wanted:
            case AllOf():
                return self.conditions.all_of([
                    self.wanted(part, own, is_first) for part, own in choices(wanted, values)
                ])  # fmt: skip
            case OneOf():
                return self.conditions.one_of([
                    self.wanted(part, own, is_first) for part, own in choices(wanted, values)
                ])  # fmt: skip
            case Opaque(test=test):
                return self.conditions.needs(test.condition, names_of(test.slots, values))
            case Atom():
                return self._atom(wanted, values, is_first, again)

    def _atom(self, atom: Atom, values: Environment, is_first: bool, again: bool) -> Needs:
        names = names_of(atom.test.slots, values)
        needs = self.conditions.needs(atom.test.condition, names)
        try:
            found, is_step = atom.alternatives(self.initial, values)
        except (EvaluationError, TypeError):
            return needs
        if needs is None or not needs or len(needs) > 1:
            return needs
        (fact,) = needs
        number = self.task.fact(Made(("again", fact))) if again else fact
        for code, arguments in found:
            made = self._asked((code, arguments, is_first))
            if not is_step:
                self._claim((code, arguments, is_first), {number, fact}, made)
        return (number, fact) if again else (number,)

    def _claim(self, key: Key, facts: set[int], made: list[int]) -> None:
        """A behavior makes true what it is applied for."""
        claims = self._claims[key]
        for fact in facts.difference(claims):
            claims.append(fact)
            for index in made:
                self.task.operators[index].claims.append(fact)

    # ------------------------------------------------------------------------------------ operators

    def _asked(self, key: Key) -> list[int]:
        """The operators of a behavior with arguments; there may be none before `close`."""
        found = self._applied.get(key)
        if found is None:
            found = self._applied[key] = []
            self._claims[key] = [self.task.fact(Made(key))]
            self._pending.append(key)
        return found

    def applied(self, code: Code, arguments: tuple[Value, ...], is_first: bool) -> list[int]:
        """The operators of a behavior with arguments."""
        found = self._asked((code, arguments, is_first))
        self.close()
        return found

    def _make(self, code: Code, arguments: tuple[Value, ...], is_first: bool) -> None:
        key = (code, arguments, is_first)
        values = arguments + (None,) * (code.size - len(arguments))
        middle = () if code.middle is None else (code.middle,)
        ways = self._ways(code.left, [Way(values)], self.initial if is_first else None, LATER)
        ways = self._ways(middle, ways, None, is_first)
        for way in self._ways(code.right, ways, None, LATER):
            self._applied[key].append(self._operator(code, arguments, way, self._claims[key]))

    def _operator(
        self, code: Code, arguments: tuple[Value, ...], way: Way, claims: list[int]
    ) -> int:
        writes = way.writes
        if code.behavior.effect is not None:
            writes += self._writes(code.behavior.effect, names_of(code.effect_slots, way.values))
        cost = max(way.calls, int(code.has_effect))
        needs = tuple(dict.fromkeys(way.needs))
        return self.task.operator(
            Operator(cost, needs, list(claims), [], writes, code, arguments, way.values, way.asked)
        )

    def running(self, code: Code, arguments: tuple[Value, ...], is_first: bool) -> int:
        """The fact that a behavior runs."""
        self._asked((code, arguments, is_first))
        return self.task.fact(Made((code, arguments, is_first)))

    # ------------------------------------------------------------------------------- ways through

    def ways(self, block: Block, values: Environment) -> list[Way]:
        """The ways through the rest of a body."""
        return self._ways(block, [Way(values)], None, LATER)

    def _ways(
        self, block: Block, ways: list[Way], state: Snapshot | None, is_first: bool
    ) -> list[Way]:
        """The ways on through a block; `state` is where it runs, if that is known."""
        for op in block:
            ways = [after for way in ways for after in self._through(op, way, state, is_first)]
            del ways[MOST_BRANCHES:]
        return ways

    def _through(self, op: Op, way: Way, state: Snapshot | None, is_first: bool) -> Iterable[Way]:
        values = way.values
        match op:
            case AssertOp(test=test):
                if state is not None:
                    return (way,) if _holds(test.holds, state, values) else ()
                names = names_of(test.slots, values)
                return way.needing(self.conditions.needs(test.condition, names))
            case AchieveOp(wanted=wanted):
                return way.asking(self.wanted(wanted, values, is_first))
            case CallOp(behavior=name, arguments=compiled):
                code = self.programs.code(self.world.behaviors[name])
                arguments = tuple(self._argument(part, values) for part in compiled)
                is_known = None not in arguments
                return way.asking((self.running(code, arguments, is_first),) if is_known else ())
            case DoOp():
                writes = way.writes + self._called(op, values)
                return (way._replace(calls=way.calls + 1, writes=writes),)
            case BindOp():
                return self._bind(op, way, state)
            case LetOp():
                return self._let(op, way, state)
            case FixOp(slot=slot, value=value):
                return (way._replace(values=with_slots(values, (slot,), (value,))),)
            case IfOp():
                return self._if(op, way, state, is_first)
            case AlternativeOp(body=body):
                return [
                    after for part in body for after in self._through(part, way, state, is_first)
                ]
            case SequenceOp(body=body) | UnorderedOp(body=body, variables=None):
                return self._ways(body, [way], state, is_first)
            case UnorderedOp(body=body, variables=(slots, tuples)):
                ways = [way]
                for chosen in tuples:
                    ways = [w._replace(values=with_slots(w.values, slots, chosen)) for w in ways]
                    ways = self._ways(body, ways, state, is_first)
                return ways
            case CommitOp():
                return (way,)
            case _:
                raise AssertionError(op)

    def _argument(self, compiled: object, values: Environment) -> Value:
        try:
            return compiled(self.initial, values)  # type: ignore[operator]
        except (EvaluationError, TypeError):
            return None

    def _called(self, op: DoOp, values: Environment) -> tuple[Write, ...]:
        controller = self.world.controllers[op.controller]
        if controller.effect is None:
            return ()
        own = (self._argument(part, values) for part in op.arguments)
        names = dict(zip((p.name for p in controller.parameters), own, strict=True))
        known = {name: value for name, value in names.items() if value is not None}
        return self._writes(controller.effect, known)

    def _bind(self, op: BindOp, way: Way, state: Snapshot | None) -> Iterator[Way]:
        if state is not None:
            for chosen in op.choices(state, way.values):
                yield way._replace(values=with_slots(way.values, op.slots, chosen))
            return
        statement = op.statement
        assert isinstance(statement, Bind)
        domains = [self.world.objects_of(v.type) for v in statement.variables]
        found: Iterable[tuple[Value, ...]] = product(*domains)
        if prod(map(len, domains)) > MOST_TRIED and op.test is not None:
            # All of them would make operators that grow with the square of the objects.
            found = op.choices(self.initial, way.values) or found
        for chosen in islice(found, MOST_BRANCHES):
            values = with_slots(way.values, op.slots, chosen)
            after = way._replace(values=values)
            if op.test is None:
                yield after
            else:
                names = names_of(op.test.slots, values)
                yield from after.needing(self.conditions.needs(op.test.condition, names))

    def _let(self, op: LetOp, way: Way, state: Snapshot | None) -> Iterator[Way]:
        if state is not None:
            value = self._argument(op.value, way.values)
            yield way._replace(values=with_slots(way.values, (op.slot,), (value,)))
            return
        names = names_of(op.slots, way.values)
        value = self.conditions.value(op.expression, names)
        if value is None and isinstance(op.expression, Read):
            for possible, needs in self.conditions.readings(op.expression, names):
                after = way._replace(values=with_slots(way.values, (op.slot,), (possible,)))
                yield from after.needing(needs)
            return
        yield way._replace(values=with_slots(way.values, (op.slot,), (value,)))

    def _if(self, op: IfOp, way: Way, state: Snapshot | None, is_first: bool) -> list[Way]:
        if state is not None:
            block = op.then if _holds(op.test.holds, state, way.values) else op.otherwise
            return self._ways(block, [way], state, is_first)
        needs = self.conditions.needs(op.test.condition, names_of(op.test.slots, way.values))
        found = self._ways(op.then, list(way.needing(needs)), state, is_first)
        return found if needs == () else found + self._ways(op.otherwise, [way], state, is_first)

    # --------------------------------------------------------------------------------------- writes

    def _writes(self, statements: tuple[Statement, ...], names: Names) -> tuple[Write, ...]:
        """What an effect may write."""
        hidden = declared(statements)
        known = {name: value for name, value in names.items() if name not in hidden}
        top = {id(s) for s in statements}
        found = []
        for statement in statements_within(statements):
            if isinstance(statement, Assign):
                arguments = tuple(self.conditions.value(a, known) for a in statement.arguments)
                plain = statement.operator == "="
                value = self.conditions.value(statement.value, known) if plain else None
                certain = id(statement) in top
                found.append(Write(statement.feature, arguments, value, certain))
            elif isinstance(statement, Simulate):
                for feature in self.world.program.features:
                    unknown = tuple(None for _ in feature.parameters)
                    found.append(Write(feature.name, unknown, None, is_certain=False))
        return tuple(found)


def _holds(holds: object, state: Snapshot, values: Environment) -> bool:
    try:
        return bool(holds(state, values))  # type: ignore[operator]
    except EvaluationError:
        return False
