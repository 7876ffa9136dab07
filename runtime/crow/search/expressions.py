"""Expressions as Python functions of a state and the values of slots, compiled once.

Connectives, reads and comparisons become Python; arithmetic is left to the interpreter, which
knows about widths and divisions by zero.
"""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from functools import lru_cache
from itertools import product
from math import prod
from types import CodeType
from typing import Any, Final

from crow.budget import looking
from crow.evaluate import EvaluationError, evaluate, shown_cell
from crow.externals import ExternalFunction
from crow.problem import Cell, State, World
from crow.program import (
    And,
    Apply,
    Compare,
    Conditional,
    Constant,
    Expression,
    Function,
    Location,
    Not,
    Object,
    ObjectType,
    Or,
    Parameter,
    Quantified,
    Read,
    Return,
    Type,
    Variable,
    Xor,
)
from crow.program.types import BOOL, underlying
from crow.program.walk import free_variables
from crow.search.states import Snapshot
from crow.values import Value

Slots = Mapping[str, int]
"""Where the values of the variables in scope are."""
Environment = Sequence[Value]
"""Never changed while it is shared."""
Compiled = Callable[[Snapshot, Environment], Value]

_MANY: Final = 100_000
"""A quantifier over so many tuples of objects takes a noticeable time."""


class Compiler:
    """Compiles the expressions of one world."""

    def __init__(self, world: World) -> None:
        self.world = world
        self.constants: dict[str, Any] = {
            "evaluated": self._evaluated,
            "unset": _unset,
            "bound": _bound,
            "product": product,
        }
        self._functions: dict[str, str | None] = {}

    def expression(self, node: Expression, slots: Slots, unsure: Collection[int] = ()) -> Compiled:
        """A function for the value of an expression; it may raise EvaluationError.

        The slots that are `unsure` may have no value yet.
        """
        names = {name: f"E[{slot}]" for name, slot in slots.items()}
        for name, slot in slots.items():
            if slot in unsure:
                names[name] = f"bound(E[{slot}], {name!r})"
        try:
            compiled: Compiled = self._compiled("S, E", self._source(node, names))
        except (SyntaxError, RecursionError, MemoryError):
            compiled = self._compiled("S, E", self._interpreted(node, names))
        return compiled

    def _compiled(self, parameters: str, source: str) -> Any:
        scope: dict[str, Any] = {}
        # The source is made here, from names that the program's checker has let through.
        exec(_python(f"def compiled({parameters}):", source), self.constants, scope)  # noqa: S102
        return scope["compiled"]

    def _constant(self, value: object) -> str:
        name = f"k{len(self.constants)}"
        self.constants[name] = value
        return name

    def _source(self, node: Expression, names: Mapping[str, str]) -> str:
        match node:
            case Constant(value=bool(value)):
                return str(value)
            case Variable(name=name):
                return names[name]
            case Object(name=name):
                return repr(name)
            case Read():
                return self._read(node, names)
            case Not(operand=operand):
                return f"(not {self._source(operand, names)})"
            case And(operands=operands):
                return f"({' and '.join(self._source(o, names) for o in operands)})"
            case Or(operands=operands):
                return f"({' or '.join(self._source(o, names) for o in operands)})"
            case Xor(left=left, right=right):
                return f"({self._source(left, names)} != {self._source(right, names)})"
            case Compare(operator=op, left=left, right=right):
                return f"({self._source(left, names)} {op} {self._source(right, names)})"
            case Conditional(condition=condition, then=then, otherwise=otherwise, type=type_):
                if not is_plain(type_):
                    return self._interpreted(node, names)
                parts = [self._source(e, names) for e in (then, condition, otherwise)]
                return f"({parts[0]} if {parts[1]} else {parts[2]})"
            case Quantified():
                return self._quantified(node, names)
            case Apply():
                return self._applied(node, names)
            case _:
                return self._interpreted(node, names)

    def _interpreted(self, node: Expression, names: Mapping[str, str]) -> str:
        free = sorted(free_variables(node))
        values = ", ".join(f"{name!r}: {names[name]}" for name in free)
        return f"evaluated(S, {self._constant(node)}, {{{values}}})"

    def _evaluated(self, state: Snapshot, node: Expression, variables: dict[str, Value]) -> Value:
        return evaluate(self.world, State(state.cells), node, variables)

    def _read(self, node: Read, names: Mapping[str, str]) -> str:
        arguments = "".join(f"{self._source(a, names)}, " for a in node.arguments)
        cell = f"({node.feature!r}, ({arguments}))"
        default = self.world.defaults[node.feature]
        if default is None:
            place = self._constant(node.location)
            base = f"(B[c] if c in B else unset(c, {place}))"
        else:
            base = f"B.get(c, {default!r})"
        return f"(D[c] if (c := {cell}) in D else {base})"

    def _quantified(self, node: Quantified, names: Mapping[str, str]) -> str:
        own = [f"q{len(names) + i}" for i in range(len(node.variables))]
        inner = {**names, **{v.name: q for v, q in zip(node.variables, own, strict=True)}}
        domains = [self._constant(d) for d in watched(self.world, node)]
        test = "all" if node.quantifier == "forall" else "any"
        loops = " ".join(f"for {q} in {d}" for q, d in zip(own, domains, strict=True))
        return f"{test}({self._source(node.body, inner)} {loops})"

    def _applied(self, node: Apply, names: Mapping[str, str]) -> str:
        function = self.world.functions[node.function]
        external = self.world.externals.functions.get(node.function)
        name = self._function(function) if external is None else self._external(node, external)
        if name is None:
            return self._interpreted(node, names)
        arguments = "".join(f", {self._source(a, names)}" for a in node.arguments)
        return f"{name}(S{arguments})"

    def _external(self, node: Apply, external: ExternalFunction) -> str:
        """The name of a call of the user's Python, at the place of the node."""
        location, reads_state = node.location, external.reads is not None

        def call(state: Snapshot, *arguments: Value) -> Value:
            try:
                return external.value(state.cells if reads_state else {}, arguments, location)
            except ArithmeticError as error:
                raise EvaluationError(str(error), location) from None

        return self._constant(call)

    def _function(self, function: Function) -> str | None:
        """The name of a compiled derived function; None for one that the interpreter must run."""
        if function.name not in self._functions:
            self._functions[function.name] = None
            types = [function.type, *(p.type for p in function.parameters)]
            match function.body:
                case (Return(value=value),) if all(map(is_plain, types)):
                    own = {p.name: f"a{i}" for i, p in enumerate(function.parameters)}
                    parameters = ", ".join(["S", *own.values()])
                    compiled = self._compiled(parameters, self._source(value, own))
                    self._functions[function.name] = self._constant(compiled)
                case _:
                    pass
        return self._functions[function.name]


@lru_cache(4096)
def _python(head: str, source: str) -> CodeType:
    """A function for Python to run. The same texts come again with each search of a domain."""
    lines = f"{head}\n D = S.delta\n B = S.base\n return {source}\n"
    return compile(lines, "<compiled>", "exec")


class Watched:
    """Objects to loop over, with a look at the limits of the search before each of some."""

    def __init__(self, objects: tuple[str, ...], every: int) -> None:
        self.objects = objects
        self.every = every

    def __iter__(self) -> Iterator[str]:
        return looking(self.objects, self.every)


def watched(world: World, node: Quantified) -> list[Iterable[str]]:
    """The objects that the variables of a quantifier range over; watched where they are many."""
    domains = [world.objects_of(v.type) for v in node.variables]
    inner = prod(map(len, domains[1:]))
    if inner * len(domains[0]) < _MANY:
        return [*domains]
    return [Watched(domains[0], max(1, _MANY // (10 * max(1, inner)))), *domains[1:]]


def is_plain(type_: Type) -> bool:
    """Whether values of a type are passed on as they are."""
    return isinstance(type_, ObjectType) or underlying(type_) == BOOL


def _bound(value: Value, name: str) -> Value:
    if value is None:
        raise EvaluationError(f"`{name}` has no value yet", None)
    return value


def _unset(cell: Cell, location: Location | None) -> Value:
    raise EvaluationError(f"`{shown_cell(cell)}` has no value", location)


def slots_of(parameters: tuple[Parameter, ...]) -> dict[str, int]:
    """The slots of a behavior's or controller's parameters."""
    return {p.name: i for i, p in enumerate(parameters)}


def names_of(slots: Slots, values: Sequence[Value]) -> dict[str, Value]:
    """The variables in scope that have a value, by name."""
    return {name: values[slot] for name, slot in slots.items() if values[slot] is not None}
