"""Symbolic execution of effects: statements to a simultaneous assignment (App. D.5).

A state is the state before plus a list of writes. A write says: where its guard holds, the cell of
these arguments has this value; its quantified variables range over objects, one write for each.
Guards, arguments and values all read the state before, so a list of writes is one simultaneous
assignment, in which a later write wins where two meet in a cell.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

from cdlc.ir.pool import Pool
from crow.program import (
    And,
    Apply,
    Arithmetic,
    Assign,
    Bind,
    Break,
    Builtin,
    Compare,
    Conditional,
    Constant,
    Continue,
    Expression,
    Feature,
    ForEach,
    ForRange,
    Function,
    If,
    Let,
    Location,
    Negative,
    Not,
    Object,
    Or,
    Parameter,
    Program,
    Quantified,
    Read,
    Return,
    SetLocal,
    Statement,
    Variable,
    Vector,
    Xor,
)
from crow.program.types import INT64, is_boolean

Variables = Mapping[str, Expression]


class NotModelled(Exception):  # noqa: N818 - not an error of the program
    """A construct that has no Hoare model, with its place."""

    def __init__(self, construct: str, location: Location | None) -> None:
        super().__init__(construct)
        self.construct = construct
        self.location = location


@dataclass(frozen=True, slots=True, eq=False)
class Update:
    """`feature[arguments] := value` where `guard` holds, for all `variables`.

    Everything reads the state before. `variables` are fresh ones of the pool.
    """

    feature: str
    arguments: tuple[Expression, ...]
    value: Expression
    guard: Expression
    variables: tuple[Expression, ...] = ()
    location: Location | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Conflict:
    """Two iterations of a `foreach` that may write one cell: when, and where both stand.

    `condition` is over the state before and over the variables of both iterations, `variables`;
    where it holds, the values differ.
    """

    condition: Expression
    variables: tuple[Expression, ...]
    first: Update
    second: Update


Cell = tuple[str, tuple[int, ...], int]
"""A feature with the identities of its arguments; the number tells quantified writes apart."""


@dataclass(frozen=True, slots=True, eq=False)
class Layer:
    """Writes over what is under them: the state before, or the state around a `foreach`."""

    under: "Layer | None" = None
    writes: Mapping[Cell, Update] = field(default_factory=dict)

    def all_writes(self) -> Iterator[Update]:
        """Every write from the state before on, in order."""
        if self.under is not None:
            yield from self.under.all_writes()
        yield from self.writes.values()


@dataclass(frozen=True, slots=True, eq=False)
class _Path:
    """Where execution stands: the writes and the locals so far."""

    layer: Layer
    variables: Variables


@dataclass(frozen=True, slots=True, eq=False)
class _Exit:
    """A way out of a block before its end; taken where `condition` holds and no earlier exit is."""

    signal: Literal["break", "continue", "return"]
    condition: Expression
    path: _Path
    value: Expression | None = None


@dataclass(frozen=True, slots=True, eq=False)
class _Outcome:
    """What a block does: its exits in order, and where it ends normally (None: never)."""

    exits: tuple[_Exit, ...]
    normal: _Path | None


class Executor:
    """Executes effects of one program symbolically; `conflicts` gathers what `foreach`s may do."""

    def __init__(self, program: Program, pool: Pool) -> None:
        self.program = program
        self.pool = pool
        self.features: dict[str, Feature] = {f.name: f for f in program.features}
        self.functions: dict[str, Function] = {f.name: f for f in program.functions}
        self.conflicts: list[Conflict] = []
        self._numbers = 0
        self._returns: dict[tuple[str, tuple[int, ...], Layer], Expression] = {}

    # ------------------------------------------------------------------------------- expressions

    def value(self, node: Expression, layer: Layer, variables: Variables) -> Expression:
        """The value of an expression after the writes of a layer, over the state before."""
        pool = self.pool

        def of(part: Expression) -> Expression:
            return self.value(part, layer, variables)

        match node:
            case Constant(value=value, type=type_):
                return pool.constant(value, type_, node.location)
            case Variable(name=name):
                return variables[name]
            case Object(name=name, type=type_):
                return pool.named_object(name, type_)
            case Read(feature=feature, arguments=arguments):
                return self.read(feature, tuple(map(of, arguments)), layer, node.location)
            case Apply():
                return self._apply(node, layer, variables)
            case Builtin(function=function, arguments=arguments, type=type_):
                return pool.builtin(function, tuple(map(of, arguments)), type_)
            case Vector(elements=elements, type=type_):
                return pool.vector(tuple(map(of, elements)), type_)
            case Not(operand=operand):
                return pool.negation(of(operand))
            case And(operands=operands):
                return pool.conjunction(map(of, operands))
            case Or(operands=operands):
                return pool.disjunction(map(of, operands))
            case Xor(left=left, right=right):
                return pool.exclusive(of(left), of(right))
            case Compare(operator=op, left=left, right=right):
                return pool.compare(op, of(left), of(right))
            case Negative(operand=operand, type=type_):
                return pool.negative(of(operand), type_)
            case Arithmetic(operator=op, left=left, right=right, type=type_):
                return pool.arithmetic(op, of(left), of(right), type_, node.location)
            case Conditional(condition=condition, then=then, otherwise=otherwise):
                return pool.choice(of(condition), of(then), of(otherwise))
            case Quantified(quantifier=quantifier, variables=bound, body=body):
                opened = tuple(pool.fresh(v) for v in bound)
                names = {v.name: o for v, o in zip(bound, opened, strict=True)}
                inner = self.value(body, layer, {**variables, **names})
                return pool.quantified(quantifier, opened, inner)

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
            same = [pool.equal(a, b) for a, b in pairs]
            return pool.choice(pool.conjunction((*same, write.guard)), write.value, before)
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

    def meets(self, write: Update, arguments: tuple[Expression, ...]) -> Expression:
        """When a write reaches a cell."""
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
        for written, wanted in zip(write.arguments, arguments, strict=True):
            if isinstance(written, Variable) and written.name in own - set(chosen):
                chosen[written.name] = wanted
                conditions.append(self._is_of_type(wanted, written))
        for written, wanted in zip(write.arguments, arguments, strict=True):
            conditions.append(pool.equal(pool.substitute(written, chosen), wanted))
        return pool.conjunction(conditions), chosen

    def _is_of_type(self, node: Expression, variable: Variable) -> Expression:
        """That an object is one that a variable ranges over."""
        if self.pool.hierarchy.is_subtype(node.type, variable.type):
            return self.pool.true
        opened = self.pool.fresh(Parameter(variable.name, variable.type))
        return self.pool.quantified("exists", (opened,), self.pool.equal(opened, node))

    def _apply(self, node: Apply, layer: Layer, variables: Variables) -> Expression:
        """A derived function's value; an external one stays, reading the state it is called in."""
        arguments = tuple(self.value(a, layer, variables) for a in node.arguments)
        function = self.functions[node.function]
        if function.body is None:
            if _reads_state(function) and any(layer.all_writes()):
                raise NotModelled(
                    f"`{function.name}`, which reads the state, after a write", node.location
                )
            return self.pool.apply(node.function, arguments, node.type, node.location)
        # Functions that call each other twice would else take time exponential in their number.
        key = (node.function, tuple(map(id, arguments)), layer)
        if key not in self._returns:
            names = [p.name for p in function.parameters]
            path = _Path(layer, dict(zip(names, arguments, strict=True)))
            self._returns[key] = self._returned(self._block(function.body, path))
        return self._returns[key]

    def _returned(self, outcome: _Outcome) -> Expression:
        *earlier, last = outcome.exits
        assert last.value is not None
        value = last.value
        for exit_ in reversed(earlier):
            assert exit_.value is not None
            value = self.pool.choice(exit_.condition, exit_.value, value)
        return value

    # --------------------------------------------------------------------------------- statements

    def execute(
        self, statements: tuple[Statement, ...], layer: Layer, variables: Variables
    ) -> Layer:
        """The layer after an effect."""
        outcome = self._block(statements, _Path(layer, variables))
        assert outcome.normal is not None
        return outcome.normal.layer

    def _block(self, statements: tuple[Statement, ...], path: _Path) -> _Outcome:
        exits: list[_Exit] = []
        for statement in statements:
            outcome = self._statement(statement, path)
            exits += outcome.exits
            if outcome.normal is None:
                return _Outcome(tuple(exits), None)
            path = outcome.normal
        return _Outcome(tuple(exits), path)

    def _nested(self, statements: tuple[Statement, ...], path: _Path) -> _Outcome:
        """A block inside a statement: what it introduces is gone after it."""

        def left(inner: _Path) -> _Path:
            return replace(inner, variables=leaving(statements, path.variables, inner.variables))

        outcome = self._block(statements, path)
        exits = tuple(replace(e, path=left(e.path)) for e in outcome.exits)
        return _Outcome(exits, None if outcome.normal is None else left(outcome.normal))

    def _statement(self, node: Statement, path: _Path) -> _Outcome:
        match node:
            case Assign():
                return _Outcome((), replace(path, layer=self._assign(node, path)))
            case Let(variable=variable, value=value):
                return _Outcome((), self._set(path, variable.name, value))
            case SetLocal(variable=name, value=value):
                return _Outcome((), self._set(path, name, value))
            case If():
                return self._if(node, path)
            case ForRange():
                return self._for(node, path)
            case ForEach():
                return _Outcome((), replace(path, layer=self._foreach(node, path)))
            case Break():
                return _Outcome((_Exit("break", self.pool.true, path),), None)
            case Continue():
                return _Outcome((_Exit("continue", self.pool.true, path),), None)
            case Return(value=value):
                returned = self.value(value, path.layer, path.variables)
                return _Outcome((_Exit("return", self.pool.true, path, returned),), None)
            case _:
                raise AssertionError(f"{type(node).__name__} in an effect")

    def _set(self, path: _Path, name: str, value: Expression) -> _Path:
        now = self.value(value, path.layer, path.variables)
        return replace(path, variables={**path.variables, name: now})

    def _assign(self, node: Assign, path: _Path) -> Layer:
        arguments = tuple(self.value(a, path.layer, path.variables) for a in node.arguments)
        value = self.value(node.value, path.layer, path.variables)
        if node.operator != "=":
            type_ = self.features[node.feature].type
            before = self.read(node.feature, arguments, path.layer, node.location)
            operator = node.operator[0]
            assert operator in ("+", "-", "*", "/")
            value = self.pool.arithmetic(operator, before, value, type_, node.location)  # type: ignore[arg-type]
        write = Update(node.feature, arguments, value, self.pool.true, (), node.location)
        return _written(path.layer, write)

    # ----------------------------------------------------------------------------------- branches

    def _if(self, node: If, path: _Path) -> _Outcome:
        condition = self.value(node.condition, path.layer, path.variables)
        if condition is self.pool.true:
            return self._nested(node.then, path)
        if condition is self.pool.false:
            return self._nested(node.otherwise, path)
        then = self._nested(node.then, path)
        otherwise = self._nested(node.otherwise, path)
        opposite = self.pool.negation(condition)
        exits = [self._under(condition, exit_) for exit_ in then.exits]
        exits += [self._under(opposite, exit_) for exit_ in otherwise.exits]
        if then.normal is None or otherwise.normal is None:
            return _Outcome(tuple(exits), then.normal or otherwise.normal)
        return _Outcome(tuple(exits), self._join(condition, then.normal, otherwise.normal))

    def _under(self, condition: Expression, exit_: _Exit) -> _Exit:
        return replace(exit_, condition=self.pool.conjunction((condition, exit_.condition)))

    def _join(self, condition: Expression, then: _Path, otherwise: _Path) -> _Path:
        """One path for two: what they wrote or set differently depends on the condition."""
        if then is otherwise:
            return then
        choice = self.pool.choice
        variables = {
            name: choice(condition, then.variables[name], otherwise.variables[name])
            for name in then.variables
            if name in otherwise.variables
        }
        return _Path(self._join_layers(condition, then.layer, otherwise.layer), variables)

    def _join_layers(self, condition: Expression, then: Layer, otherwise: Layer) -> Layer:
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
            return replace(write, guard=guard, value=self._settled(write, layer))
        is_plain = then.under is None and not write.variables
        if is_plain and not one.guard is other.guard is pool.true:
            # A cell written conditionally again and again: its guard would grow with each time.
            ends = [self.read(write.feature, write.arguments, end) for end in (then, otherwise)]
            return replace(write, guard=pool.true, value=pool.choice(condition, *ends))
        values = self._settled(one, then), self._settled(other, otherwise)
        guard = pool.choice(condition, one.guard, other.guard)
        return replace(write, guard=guard, value=pool.choice(condition, *values))

    def _settled(self, write: Update, layer: Layer) -> Expression:
        """The value of a written cell at the end of a branch."""
        value, is_later = write.value, False
        for other in layer.writes.values():
            if other is write:
                is_later = True
            elif is_later and other.feature == write.feature:
                value = self._overwritten(value, other, write.arguments)
        return value

    # -------------------------------------------------------------------------------------- loops

    def _for(self, node: ForRange, path: _Path) -> _Outcome:
        breaks: list[_Exit] = []
        returns: list[_Exit] = []
        current: _Path | None = path
        outer = path.variables
        for number in range(node.start, node.stop, node.step):
            if current is None:
                break
            counted = self.pool.constant(number, INT64)
            inside = {**current.variables, node.variable.name: counted}
            outcome = self._nested(node.body, _Path(current.layer, inside))
            current, exits = self._end_iteration(outcome)
            breaks += [e for e in exits if e.signal == "break"]
            returns += [e for e in exits if e.signal == "return"]
        ended = self._after(breaks, returns, current)
        if ended is not None:
            counter = node.variable.name
            kept = {n: outer[n] if n == counter else ended.variables[n] for n in outer}
            ended = replace(ended, variables=kept)
        return _Outcome(tuple(returns), ended)

    def _end_iteration(self, outcome: _Outcome) -> tuple[_Path | None, list[_Exit]]:
        """Where the next iteration starts, and the exits that leave the loop.

        An exit is taken only where no earlier one is; `continue`s are dissolved here, so the exits
        after one of them have to say that it was not taken.
        """
        pool = self.pool
        leaving: list[_Exit] = []
        continued: list[_Exit] = []
        for exit_ in outcome.exits:
            if exit_.signal == "continue":
                continued.append(exit_)
                continue
            not_continued = [pool.negation(c.condition) for c in continued]
            condition = pool.conjunction((*not_continued, exit_.condition))
            leaving.append(replace(exit_, condition=condition))
        end = outcome.normal
        for exit_ in reversed(continued):
            end = exit_.path if end is None else self._join(exit_.condition, exit_.path, end)
        return end, leaving

    def _after(self, breaks: list[_Exit], returns: list[_Exit], end: _Path | None) -> _Path | None:
        """Where a loop ends: at the first `break` taken, else after its last iteration."""
        if returns and breaks:
            raise NotModelled("`break` beside `return` in one loop", None)
        for exit_ in reversed(breaks):
            end = exit_.path if end is None else self._join(exit_.condition, exit_.path, end)
        return end

    def _foreach(self, node: ForEach, path: _Path) -> Layer:
        """A quantified write for each write of the body, which reads the state before the loop."""
        opened = tuple(self.pool.fresh(v) for v in node.variables)
        names = {v.name: o for v, o in zip(node.variables, opened, strict=True)}
        inside = _Path(Layer(path.layer), {**path.variables, **names})
        outcome = self._block(node.body, inside)
        assert outcome.normal is not None
        writes = [
            replace(write, variables=(*opened, *write.variables))
            for write in outcome.normal.layer.writes.values()
            if write.guard is not self.pool.false
        ]
        self._find_conflicts(writes, opened)
        layer = path.layer
        for write in writes:
            layer = self._written_by_all(layer, write)
        return layer

    def _written_by_all(self, layer: Layer, write: Update) -> Layer:
        """A quantified write; without its variables where the cell and value have none of them."""
        names = {v.name for v in write.variables if isinstance(v, Variable)}
        free = self.pool.free_variables
        used = free(write.value).union(*map(free, write.arguments))
        if names & used:
            self._numbers += 1
            return _written(layer, write, self._numbers)
        guard = self.pool.quantified("exists", write.variables, write.guard)
        return self._written_where(layer, replace(write, guard=guard, variables=()))

    def _written_where(self, layer: Layer, write: Update) -> Layer:
        """A guarded write of one cell, over what an earlier write may have put there."""
        cell = _cell(write, 0)
        earlier = layer.writes.get(cell)
        if earlier is not None:
            pool = self.pool
            value = pool.choice(write.guard, write.value, self._settled(earlier, layer))
            guard = pool.disjunction((write.guard, earlier.guard))
            write = replace(write, guard=guard, value=value)
        return _written(layer, write)

    def _find_conflicts(self, writes: list[Update], opened: tuple[Expression, ...]) -> None:
        """Pairs of writes by different iterations that may put different values into one cell."""
        for index, first in enumerate(writes):
            for second in writes[index:]:
                if first.feature == second.feature:
                    conflict = self._conflict(first, second, opened)
                    if conflict.condition is not self.pool.false:
                        self.conflicts.append(conflict)

    def _conflict(self, first: Update, second: Update, opened: tuple[Expression, ...]) -> Conflict:
        pool = self.pool
        renaming = {
            v.name: pool.fresh(Parameter(v.name.split("'")[0], v.type))
            for v in second.variables
            if isinstance(v, Variable)
        }

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


def leaving(statements: tuple[Statement, ...], outer: Variables, inner: Variables) -> Variables:
    """The variables after a block: those from before it, as set in it but not as hidden by it."""
    hidden = {s.variable.name for s in statements if isinstance(s, Let)}
    hidden |= {v.name for s in statements if isinstance(s, Bind) for v in s.variables}
    return {name: outer[name] if name in hidden else inner[name] for name in outer}


def _reads_state(function: Function) -> bool:
    return any(a.name == "reads" for a in function.annotations)


def _cell(write: Update, number: int) -> Cell:
    return (write.feature, tuple(map(id, write.arguments)), number)


def _written(layer: Layer, write: Update, number: int = 0) -> Layer:
    """The layer with a write after all others; one of the same cell is gone."""
    cell = _cell(write, number)
    others = {c: w for c, w in layer.writes.items() if c != cell}
    return Layer(layer.under, {**others, cell: write})
