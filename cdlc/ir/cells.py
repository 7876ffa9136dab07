"""Cells of a state that is known by its writes: what they hold, and how writes join.

A state is the state before plus a list of writes. A write says: where its guard holds, the cell of
these arguments has this value; its quantified variables range over objects, one write for each.
Guards, arguments and values all read the state before, so a list of writes is one simultaneous
assignment, in which a later write wins where two meet in a cell.
"""

from dataclasses import replace

from cdlc.ir.pool import Pool
from cdlc.ir.updates import Layer, NotModelled, cell_of, merged, written
from crow.program import (
    FLOAT32,
    Conditional,
    Constant,
    Expression,
    Feature,
    ListType,
    Location,
    Negative,
    Parameter,
    Program,
    Read,
    Type,
    Variable,
    Vector,
    VectorType,
)
from crow.program.triples import Conflict, Update
from crow.program.types import is_boolean, underlying
from crow.values import ValueRangeError, stored


class Cells:
    """Reads and writes of the cells of one program; `conflicts` gathers what `foreach`s may do."""

    def __init__(self, program: Program, pool: Pool) -> None:
        self.program = program
        self.pool = pool
        self.features: dict[str, Feature] = {f.name: f for f in program.features}
        self.conflicts: list[Conflict] = []
        self._numbers = 0

    # -------------------------------------------------------------------------------------- reads

    def read(
        self,
        feature: str,
        arguments: tuple[Expression, ...],
        layer: Layer,
        location: Location | None = None,
    ) -> Expression:
        """A cell after the writes of a layer: a choice on each write that may meet it."""
        value = self.pool.read(feature, arguments, self.features[feature].type, location)
        for write in layer.all_writes():
            if write.feature == feature:
                value = self._overwritten(value, write, arguments)
        return value

    def _overwritten(
        self, before: Expression, write: Update, arguments: tuple[Expression, ...]
    ) -> Expression:
        """The value of a cell after one more write."""
        pool = self.pool
        if not write.variables:
            pairs = zip(write.arguments, arguments, strict=True)
            met = pool.conjunction((*(pool.equal(a, b) for a, b in pairs), write.guard))
            if met is not pool.false:
                self._check_exact(write)
            return pool.choice(met, write.value, before)
        self._check_exact(write)
        write = self._with_own_variables(write, arguments)
        match_, chosen = self._matching(write, arguments)
        guard = pool.substitute(write.guard, chosen)
        value = pool.substitute(write.value, chosen)
        met = pool.conjunction((match_, guard))
        names = {v.name for v in write.variables if isinstance(v, Variable)} - set(chosen)
        open_ = tuple(v for v in write.variables if isinstance(v, Variable) and v.name in names)
        if not open_:
            return pool.choice(met, value, before)
        if not names & pool.free_variables(value):
            return pool.choice(pool.quantified("exists", open_, met), value, before)
        if is_boolean(value.type):
            # All iterations that write the cell agree, so one that writes true decides it.
            true = pool.quantified("exists", open_, pool.conjunction((met, value)))
            return pool.choice(pool.quantified("exists", open_, met), true, before)
        raise NotModelled("a read of what a `foreach` writes to computed cells", write.location)

    def _with_own_variables(self, write: Update, arguments: tuple[Expression, ...]) -> Update:
        """The same write under other variables where a cell is given in terms of them.

        Two writes of one `foreach` share its variables, and stand for different iterations.
        """
        free = self.pool.free_variables
        variables = [v for v in write.variables if isinstance(v, Variable)]
        if {v.name for v in variables}.isdisjoint(set().union(*map(free, arguments))):
            return write
        fresh = self._other_variables(write)

        def renamed(node: Expression) -> Expression:
            return self.pool.substitute(node, fresh)

        return replace(
            write,
            variables=tuple(fresh[v.name] for v in variables),
            arguments=tuple(map(renamed, write.arguments)),
            guard=renamed(write.guard),
            value=renamed(write.value),
        )

    def _other_variables(self, write: Update) -> dict[str, Expression]:
        """New variables for those of a write, which stand for another iteration."""
        return {
            v.name: self.pool.fresh(Parameter(v.name.split("'")[0], v.type))
            for v in write.variables
            if isinstance(v, Variable)
        }

    def _check_exact(self, write: Update) -> None:
        """Raise NotModelled for a value that its cell does not hold as it is."""
        type_ = self.features[write.feature].type
        if _is_rounding(type_) and not _is_exact(write.value, type_):
            construct = "a read of a `float32` after a write that may round"
            raise NotModelled(construct, write.location)

    def behind(
        self, feature: str, arguments: tuple[Expression, ...], layer: Layer
    ) -> tuple[Location, ...]:
        """The statements whose writes a cell may hold."""
        found: tuple[Location, ...] = ()
        for write in layer.all_writes():
            if write.feature == feature and not self._is_apart(write, arguments):
                found = merged(found, write.sources)
        return found

    def _is_apart(self, write: Update, arguments: tuple[Expression, ...]) -> bool:
        """Whether a write of one cell can never be to the other."""
        pairs = zip(write.arguments, arguments, strict=True)
        return not write.variables and any(
            self.pool.equal(a, b) is self.pool.false for a, b in pairs
        )

    def meets(self, write: Update, arguments: tuple[Expression, ...]) -> Expression:
        """When a write reaches a cell."""
        write = self._with_own_variables(write, arguments)
        match_, chosen = self._matching(write, arguments)
        met = self.pool.conjunction((match_, self.pool.substitute(write.guard, chosen)))
        left = (v for v in write.variables if isinstance(v, Variable) and v.name not in chosen)
        return self.pool.quantified("exists", tuple(left), met)

    def _matching(
        self, write: Update, arguments: tuple[Expression, ...]
    ) -> tuple[Expression, dict[str, Expression]]:
        """When a write meets a cell, and what its quantified variables are then.

        A variable that is itself an argument of the written cell is the cell's argument.
        """
        pool = self.pool
        chosen: dict[str, Expression] = {}
        conditions: list[Expression] = []
        own = {v.name for v in write.variables if isinstance(v, Variable)}
        for index, wanted in zip(write.arguments, arguments, strict=True):
            if isinstance(index, Variable) and index.name in own - set(chosen):
                chosen[index.name] = wanted
                conditions.append(self._is_of_type(wanted, index))
        for index, wanted in zip(write.arguments, arguments, strict=True):
            conditions.append(pool.equal(pool.substitute(index, chosen), wanted))
        return pool.conjunction(conditions), chosen

    def _is_of_type(self, node: Expression, variable: Variable) -> Expression:
        """That an object is one that a variable ranges over."""
        if self.pool.hierarchy.is_subtype(node.type, variable.type):
            return self.pool.true
        opened = self.pool.fresh(Parameter(variable.name, variable.type))
        return self.pool.quantified("exists", (opened,), self.pool.equal(opened, node))

    # ------------------------------------------------------------------------------------ branches

    def join_layers(self, condition: Expression, then: Layer, otherwise: Layer) -> Layer:
        """The writes of two branches as those of one."""
        assert then.under is otherwise.under
        cells = dict.fromkeys((*then.writes, *otherwise.writes))
        pairs = {cell: (then.writes.get(cell), otherwise.writes.get(cell)) for cell in cells}
        same = {cell: one for cell, (one, other) in pairs.items() if one and one is other}
        changed = {cell: pair for cell, pair in pairs.items() if cell not in same}
        for side, guard in ((0, condition), (1, self.pool.negation(condition))):
            if all(pair[1 - side] is None for pair in changed.values()):
                # One branch wrote nothing: the writes of the other keep their order.
                only = {cell: self._guarded(pair[side], guard) for cell, pair in changed.items()}
                return Layer(then.under, {**same, **only})
        joined = {
            cell: self._joined(condition, *pair, then, otherwise) for cell, pair in changed.items()
        }
        return Layer(then.under, {**same, **joined})

    def _guarded(self, write: Update | None, guard: Expression) -> Update:
        assert write is not None
        return replace(write, guard=self.pool.conjunction((guard, write.guard)))

    def _joined(
        self,
        condition: Expression,
        one: Update | None,
        other: Update | None,
        then: Layer,
        otherwise: Layer,
    ) -> Update:
        """A cell that two branches left differently.

        Its value in a branch is read there, since a later write of the branch may have met it.
        """
        pool = self.pool
        write = one or other
        assert write is not None
        if one is None or other is None:
            layer = otherwise if one is None else then
            guards = (pool.false, write.guard) if one is None else (write.guard, pool.false)
            guard = pool.choice(condition, *guards)
            return replace(self._settled(write, layer), guard=guard)
        is_plain = then.under is None and not write.variables
        if is_plain and not one.guard is other.guard is pool.true:
            # A cell written conditionally again and again: its guard would grow with each time.
            values = [self.read(write.feature, write.arguments, end) for end in (then, otherwise)]
            value = pool.choice(condition, *values)
            sources = merged(one.sources, other.sources)
            return replace(write, guard=pool.true, value=value, sources=sources)
        ends = [self._settled(one, then), self._settled(other, otherwise)]
        guard = pool.choice(condition, one.guard, other.guard)
        value = pool.choice(condition, *(end.value for end in ends))
        return replace(
            write, guard=guard, value=value, sources=merged(*(end.sources for end in ends))
        )

    def _settled(self, write: Update, layer: Layer) -> Update:
        """A write with the value of its cell at the end of a branch."""
        value, sources, is_later = write.value, write.sources, False
        for other in layer.writes.values():
            if other is write:
                is_later = True
            elif is_later and other.feature == write.feature:
                after = self._overwritten(value, other, write.arguments)
                if after is not value:
                    value, sources = after, merged(sources, other.sources)
        return replace(write, value=value, sources=sources)

    # -------------------------------------------------------------------------------------- loops

    def written_by_all(self, layer: Layer, write: Update) -> Layer:
        """A quantified write; without its variables where the cell and value have none of them."""
        names = {v.name for v in write.variables if isinstance(v, Variable)}
        free = self.pool.free_variables
        used = free(write.value).union(*map(free, write.arguments))
        if names & used:
            self._numbers += 1
            return written(layer, write, self._numbers)
        guard = self.pool.quantified("exists", write.variables, write.guard)
        return self._written_where(layer, replace(write, guard=guard, variables=()))

    def _written_where(self, layer: Layer, write: Update) -> Layer:
        """A guarded write of one cell, over what an earlier write may have put there."""
        cell = cell_of(write, 0)
        earlier = layer.writes.get(cell)
        if earlier is not None:
            pool = self.pool
            before = self._settled(earlier, layer)
            value = pool.choice(write.guard, write.value, before.value)
            guard = pool.disjunction((write.guard, earlier.guard))
            sources = merged(write.sources, before.sources)
            write = replace(write, guard=guard, value=value, sources=sources)
        return written(layer, write)

    def find_conflicts(self, writes: list[Update], opened: tuple[Expression, ...]) -> None:
        """Pairs of writes by different iterations that may put different values into one cell."""
        for index, first in enumerate(writes):
            for second in writes[index:]:
                if first.feature == second.feature:
                    conflict = self._conflict(first, second, opened)
                    if conflict.condition is not self.pool.false:
                        self.conflicts.append(conflict)

    def _conflict(self, first: Update, second: Update, opened: tuple[Expression, ...]) -> Conflict:
        pool = self.pool
        renaming = self._other_variables(second)

        def renamed(node: Expression) -> Expression:
            return pool.substitute(node, renaming)

        differ = [
            pool.negation(pool.equal(v, renaming[v.name]))
            for v in opened
            if isinstance(v, Variable)
        ]
        pairs = zip(first.arguments, map(renamed, second.arguments), strict=True)
        met = [pool.equal(a, b) for a, b in pairs]
        condition = pool.conjunction(
            (
                pool.disjunction(differ),
                first.guard,
                renamed(second.guard),
                *met,
                pool.negation(pool.equal(first.value, renamed(second.value))),
            )
        )
        if self._contradicts(differ, met):
            condition = pool.false
        variables = (*first.variables, *renaming.values())
        return Conflict(condition, variables, first, second)

    def _contradicts(self, differ: list[Expression], met: list[Expression]) -> bool:
        """Whether meeting in a cell makes all loop variables the same."""
        same = {id(m) for m in met}
        return bool(differ) and all(id(self.pool.negation(d)) in same for d in differ)


def _is_rounding(type_: Type) -> bool:
    match underlying(type_):
        case VectorType(element=element) | ListType(element=element):
            return _is_rounding(element)
        case plain:
            return plain == FLOAT32


def _is_exact(value: Expression, type_: Type) -> bool:
    """Whether a value stays as it is in a cell of a type that rounds."""
    match value:
        case Constant(value=bool() | int() | float() as number):
            return _is_float32(number)
        case Read(type=own) | Variable(type=own):
            # A parameter of that type is what a generator or an earlier cell has given.
            return underlying(own) == underlying(type_)
        case Conditional(then=then, otherwise=otherwise):
            return _is_exact(then, type_) and _is_exact(otherwise, type_)
        case Vector(elements=elements):
            return all(_is_exact(element, FLOAT32) for element in elements)
        case Negative(operand=operand):
            return _is_exact(operand, type_)
        case _:
            return False


def _is_float32(number: float) -> bool:
    try:
        return bool(stored(number, FLOAT32) == number)
    except ValueRangeError:
        return False
