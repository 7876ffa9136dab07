"""Symbolic execution of effects: statements to a simultaneous assignment (App. D.5)."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal, TypeVar

from cdlc.ir.behaviors import reads_of
from cdlc.ir.cells import Cells
from cdlc.ir.pool import Pool
from cdlc.ir.updates import Layer, NotModelled, merged, written
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
from crow.program.triples import Update
from crow.program.types import INT64
from crow.program.walk import subexpressions

Variables = Mapping[str, Expression]
Kept = TypeVar("Kept")


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


class Executor(Cells):
    """Executes effects of one program symbolically."""

    def __init__(self, program: Program, pool: Pool) -> None:
        super().__init__(program, pool)
        self.functions: dict[str, Function] = {f.name: f for f in program.functions}
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

    def _apply(self, node: Apply, layer: Layer, variables: Variables) -> Expression:
        """A derived function's value; an external one stays, reading the state it is called in."""
        arguments = tuple(self.value(a, layer, variables) for a in node.arguments)
        function = self.functions[node.function]
        if function.body is None:
            self.check_call(node, layer)
            return self.pool.apply(node.function, arguments, node.type, node.location)
        # Functions that call each other twice would else take time exponential in their number.
        key = (node.function, tuple(map(id, arguments)), layer)
        if key not in self._returns:
            names = [p.name for p in function.parameters]
            path = _Path(layer, dict(zip(names, arguments, strict=True)))
            self._returns[key] = self._returned(self._block(function.body, path))
        return self._returns[key]

    def check_call(self, node: Apply, layer: Layer) -> None:
        """Raise NotModelled for an external function called where what it reads is written."""
        reads = reads_of(self.functions[node.function])
        for write in layer.all_writes():
            if not reads.isdisjoint((write.feature, "all")):
                construct = f"`{node.function}`, which reads `{write.feature}`, after a write of it"
                raise NotModelled(construct, node.location)

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
        sources = self._sources(node, arguments, path.layer)
        write = Update(node.feature, arguments, value, self.pool.true, (), node.location, sources)
        return written(path.layer, write)

    def _sources(
        self, node: Assign, arguments: tuple[Expression, ...], layer: Layer
    ) -> tuple[Location, ...]:
        """The statement, and those before it whose writes it changes."""
        own = () if node.location is None else (node.location,)
        reads = (e for e in subexpressions(node.value) if isinstance(e, Read))
        if node.operator == "=" and not any(read.feature == node.feature for read in reads):
            return own
        return merged(own, self.behind(node.feature, arguments, layer))

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
        return _Path(self.join_layers(condition, then.layer, otherwise.layer), variables)

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
        self.find_conflicts(writes, opened)
        layer = path.layer
        for write in writes:
            layer = self.written_by_all(layer, write)
        return layer


def leaving(
    statements: tuple[Statement, ...], outer: Mapping[str, Kept], inner: Mapping[str, Kept]
) -> Mapping[str, Kept]:
    """What is kept of variables after a block: as set in it, but not as hidden by it."""
    hidden = hidden_by(statements)
    return {name: outer[name] if name in hidden else inner[name] for name in outer}


def hidden_by(statements: tuple[Statement, ...]) -> set[str]:
    """The names that a block declares for itself."""
    hidden = {s.variable.name for s in statements if isinstance(s, Let)}
    return hidden | {v.name for s in statements if isinstance(s, Bind) for v in s.variables}
