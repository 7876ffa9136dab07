"""Triples in the form PDDL needs: no `min`, no choice inside a term, every term a variable (§2).

A read of an object-valued feature becomes a parameter that its value binds, shared by all reads of
one term; inside a `foreach`, one more quantified variable. What an equality fixes is no parameter.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

from cdlc.backends.pddl.cases import Known, cases, grouped
from cdlc.backends.pddl.conditions import as_value
from cdlc.backends.pddl.defined import is_defined
from cdlc.backends.pddl.sexpr import NotPddl, TooLarge
from cdlc.ir.graph import in_order, parts
from cdlc.ir.hoare import Model
from cdlc.ir.pool import Pool
from cdlc.ir.symbolic import Executor
from crow.arithmetic import arithmetic
from crow.program import (
    And,
    Apply,
    Arithmetic,
    Builtin,
    Compare,
    Conditional,
    Constant,
    Expression,
    Object,
    Parameter,
    Quantified,
    Read,
    Variable,
)
from crow.program.names import fresh_name
from crow.program.triples import Triple, Update
from crow.program.types import is_boolean, is_number, is_object


@dataclass(frozen=True, slots=True, eq=False)
class NormalTriple:
    """A triple whose terms are variables and objects.

    `variables` are those of the behavior, its parameters and binds. Some of them are `fixed`: they
    are another variable, or an object. The triple has further parameters for what it reads.
    """

    triple: Triple
    variables: tuple[Parameter, ...]
    fixed: Mapping[str, Expression]


def normal(triple: Triple, model: Model) -> NormalTriple:
    """A triple in normal form. Raises NotPddl."""
    state = _Normal(model, plain_triple(triple, model.pool))
    state.fix_equalities()
    state.bind_reads()
    state.add_demands()
    state.use_precondition()
    remaining = tuple(p for p in state.triple.parameters if p.name not in state.fixed)
    made = replace(state.triple, parameters=remaining)
    return NormalTriple(made, triple.parameters, state.fixed)


# -------------------------------------------------------------------------------- plain expressions


def plain(node: Expression, pool: Pool) -> Expression:
    """An expression without `min`, `max` and `abs`, and without choices of objects inside terms.

    Raises NotPddl for arithmetic on constants that has no value, and for a formula whose
    quantifiers, written out, have no end.
    """
    if _quantifiers(node, {}) > _MOST_QUANTIFIERS:
        location = next((part.location for part in in_order(node) if part.location), None)
        raise TooLarge("a condition that is too large when written out", location)
    return pool.rebuild(node, {}, lambda part: _plain(part, pool))


# Each is opened where it stands, also one that a formula holds many times.
_MOST_QUANTIFIERS = 5_000


def _quantifiers(node: Expression, known: dict[int, int]) -> int:
    """How many quantifiers have to be opened to get into all of them."""
    if id(node) not in known:
        body = node.body if isinstance(node, Quantified) else node
        inside = [p for p in in_order(body, into_quantifiers=False) if isinstance(p, Quantified)]
        known[id(node)] = sum(1 + _quantifiers(part, known) for part in inside)
    return known[id(node)]


def _plain(node: Expression, pool: Pool) -> Expression:
    match node:
        case Builtin():
            return _builtin(node, pool)
        case Arithmetic(left=Constant(value=a), right=Constant(value=b)):
            try:
                return pool.constant(arithmetic(node.operator, a, b, node.type), node.type)
            except ArithmeticError as error:
                raise NotPddl(f"an expression without a value ({error})", node.location) from None
        case Arithmetic(operator="-", left=left, right=right) if left is right:
            return pool.constant(0, node.type)
        case Read() | Apply() if any(isinstance(a, Conditional) for a in node.arguments):
            return _distributed(node, node.arguments, pool)
        case Compare(left=left, right=right) if is_object(left.type):
            if isinstance(left, Conditional) or isinstance(right, Conditional):
                return _distributed(node, (left, right), pool)
            return node
        case _:
            return node


def _builtin(node: Builtin, pool: Pool) -> Expression:
    first, *others = node.arguments
    if node.function == "abs":
        is_low = pool.compare("<", first, pool.constant(0, first.type))
        return pool.choice(is_low, pool.negative(first, node.type), first)
    for other in others:
        is_better = pool.compare("<" if node.function == "min" else ">", other, first)
        first = pool.choice(is_better, other, first)
    return first


def _distributed(
    node: Read | Apply | Compare, arguments: tuple[Expression, ...], pool: Pool
) -> Expression:
    """`f(a if c else b)` as `f(a) if c else f(b)`."""
    for index, argument in enumerate(arguments):
        if isinstance(argument, Conditional):
            then, otherwise = (
                _distributed(node, (*arguments[:index], way, *arguments[index + 1 :]), pool)
                for way in (argument.then, argument.otherwise)
            )
            return pool.choice(argument.condition, then, otherwise)
    match node:
        case Read(feature=name):
            return pool.read(name, arguments, node.type, node.location)
        case Apply(function=name):
            return pool.apply(name, arguments, node.type, node.location)
        case Compare(operator=operator):
            return pool.compare(operator, *arguments)


def plain_triple(triple: Triple, pool: Pool) -> Triple:
    """A triple of plain expressions, the arguments of its updates without choices."""
    made = mapped(triple, pool, lambda node: plain(node, pool))
    return replace(made, post=tuple(u for update in made.post for u in _with_terms(update, pool)))


def _with_terms(update: Update, pool: Pool) -> Iterator[Update]:
    """An update for each case of its arguments: `f[a if c else b] = v` is two."""
    found = cases(pool, update.arguments, location=update.location)
    for when, arguments in grouped(pool, found):
        guard = pool.conjunction((update.guard, when))
        if guard is not pool.false:
            yield replace(update, arguments=arguments, guard=guard)


def mapped(triple: Triple, pool: Pool, change: Callable[[Expression], Expression]) -> Triple:
    """A triple with a function applied to its formulas."""

    def changed(update: Update) -> Update:
        return replace(
            update,
            arguments=tuple(map(change, update.arguments)),
            value=change(update.value),
            guard=change(update.guard),
        )

    calls = tuple(replace(c, arguments=tuple(change(a) for a in c.arguments)) for c in triple.calls)
    return replace(
        triple,
        calls=calls,
        pre=conjuncts(pool.conjunction(map(change, triple.pre)), pool),
        post=tuple(map(changed, triple.post)),
    )


def conjuncts(condition: Expression, pool: Pool) -> tuple[Expression, ...]:
    """The parts of a condition, none for one that always holds."""
    if condition is pool.true:
        return ()
    return condition.operands if isinstance(condition, And) else (condition,)


# ---------------------------------------------------------------------------- equalities and reads


class _Normal:
    """A triple on its way to normal form."""

    def __init__(self, model: Model, triple: Triple) -> None:
        self.pool = model.pool
        self.program = model.program
        self.types = {f.name: f.type for f in model.program.features}
        self.triple = triple
        self.fixed: dict[str, Expression] = {}

    def _change(self, change: Callable[[Expression], Expression]) -> None:
        self.triple = mapped(self.triple, self.pool, change)

    # ------------------------------------------------------------------------------- equalities

    def fix_equalities(self) -> None:
        """Take out every parameter that a precondition says is another one, or an object.

        What a precondition says a read to be stands for the read everywhere else; that may show
        more equalities.
        """
        while True:
            fixing = next(filter(None, map(self._fixed_by, self.triple.pre)), None)
            if fixing is None:
                before = self.triple.pre
                self._use_known_values()
                if [id(p) for p in before] == [id(p) for p in self.triple.pre]:
                    return
            else:
                self._fix(*fixing)

    def _fix(self, name: str, value: Expression) -> None:
        def change(node: Expression) -> Expression:
            return self.pool.substitute(node, {name: value})

        self.fixed = {n: change(v) for n, v in self.fixed.items()} | {name: value}
        self._change(change)

    def _fixed_by(self, condition: Expression) -> tuple[str, Expression] | None:
        """The parameter that an equality fixes, the later of two, and what it is."""
        if not isinstance(condition, Compare) or condition.operator != "==":
            return None
        names = [p.name for p in self.triple.parameters if p.name not in self.fixed]
        left, right = condition.left, condition.right
        candidates = [
            (names.index(v.name), v.name, other)
            for v, other in ((left, right), (right, left))
            if isinstance(v, Variable)
            and v.name in names
            and isinstance(other, Variable | Object)
            and self.pool.hierarchy.is_subtype(other.type, v.type)
        ]
        if not candidates:
            return None
        _, name, value = max(candidates, key=lambda c: c[0])
        return name, value

    def _known_values(self) -> dict[int, tuple[Expression, Expression]]:
        """By the identity of a read its value, and the precondition that says so."""
        known: dict[int, tuple[Expression, Expression]] = {}
        for part in self.triple.pre:
            found = as_value(part, self.pool)
            if found is not None and isinstance(part, Compare) and part.operator == "==":
                known.setdefault(id(found[0]), (found[1], part))
        return known

    def _use_known_values(self) -> None:
        known = self._known_values()
        if not known:
            return
        values = {read: value for read, (value, _) in known.items()}
        definitions = [id(part) for _, part in known.values()]

        def change(node: Expression) -> Expression:
            return self.pool.rebuild(node, {}, lambda part: values.get(id(part), part))

        pre = tuple(p if id(p) in definitions else change(p) for p in self.triple.pre)
        self._change(change)
        self.triple = replace(self.triple, pre=conjuncts(self.pool.conjunction(pre), self.pool))

    def add_demands(self) -> None:
        """Add to the precondition what the effect needs to have values."""
        executor = Executor(self.program, self.pool)
        needed = is_defined(self.triple.pre, self.triple.post, executor)
        pre = self.pool.conjunction((*self.triple.pre, *needed))
        self.triple = replace(self.triple, pre=conjuncts(pre, self.pool))

    def use_precondition(self) -> None:
        """Leave out of the effects what the precondition decides."""
        known = Known(self.pool, self.triple.pre)
        post = tuple(
            replace(u, value=known.simplified(u.value), guard=known.simplified(u.guard))
            for u in self.triple.post
        )
        post = tuple(u for u in post if u.guard is not self.pool.false)
        self.triple = replace(self.triple, post=post)

    # ------------------------------------------------------------------------------------ reads

    def bind_reads(self) -> None:
        """Bind every read that stands where a variable has to."""
        while self._is_possible() and (read := self._first_read()) is not None:
            self._bind(read)
            self.fix_equalities()
        post = tuple(_quantified_reads(update, self.pool) for update in self.triple.post)
        self.triple = replace(self.triple, post=post)

    def _is_possible(self) -> bool:
        return not any(part is self.pool.false for part in self.triple.pre)

    def _first_read(self) -> Read | None:
        """A read to bind, of parameters and objects only."""
        known = self._known_values()
        names = {p.name for p in self.triple.parameters}
        for node in self._to_bind():
            is_closed = self.pool.free_variables(node) <= names
            if is_closed and _has_plain_arguments(node) and id(node) not in known:
                return node
        return None

    def _to_bind(self) -> Iterator[Read]:
        for call in self.triple.calls:
            yield from object_reads(call.arguments)
        for update in self.triple.post:
            yield from object_reads((*update.arguments, *_terms(update.value, self.pool)))
            if is_object(update.value.type):
                yield from value_reads((update.value,))
                if update.guard is self.pool.true and not update.variables:
                    yield self._cell(update)
            yield from object_reads(_terms(update.guard, self.pool))
        for part in self.triple.pre:
            yield from object_reads(_terms(part, self.pool))

    def _cell(self, update: Update) -> Read:
        cell = self.pool.read(update.feature, update.arguments, self.types[update.feature])
        assert isinstance(cell, Read)
        return cell

    def _bind(self, read: Read) -> None:
        """A parameter for the value of a read, which then stands for it everywhere."""
        is_written = any(self._cell(u) is read for u in self.triple.post)
        taken = {p.name for p in self.triple.parameters}
        name = fresh_name("old" if is_written else read.feature, taken)
        parameter = Parameter(name, read.type)
        value = self.pool.variable(name, read.type)
        self._change(replacing(read, value, self.pool))
        self.triple = replace(
            self.triple,
            parameters=(*self.triple.parameters, parameter),
            pre=(*self.triple.pre, self.pool.equal(read, value)),
        )


def _terms(node: Expression, pool: Pool) -> list[Expression]:
    """Where terms of a formula have to be variables: all of it but atoms `loc(x) == p`."""
    found: list[Expression] = []
    for part in in_order(node):
        match part:
            case Compare(left=left, right=right) if as_value(part, pool) is None:
                found += (left, right)
            case Read(arguments=arguments) | Apply(arguments=arguments):
                found += arguments
            case _:
                pass
    return found


def object_reads(nodes: Iterable[Expression]) -> Iterator[Read]:
    """The reads of objects in expressions, inner ones first."""
    for part in in_order(*nodes):
        if isinstance(part, Read) and is_object(part.type):
            yield part


def value_reads(values: Iterable[Expression]) -> Iterator[Read]:
    """The reads of objects that values are made of, inner ones first; not those of their tests."""
    seen: set[int] = set()
    stack = [(value, False) for value in reversed(tuple(values))]
    while stack:
        node, is_done = stack.pop()
        if is_done:
            if isinstance(node, Read) and is_object(node.type):
                yield node
        elif id(node) not in seen and not is_boolean(node.type):
            seen.add(id(node))
            stack.append((node, True))
            stack += [(part, False) for part in reversed(parts(node))]


def _has_plain_arguments(node: Read) -> bool:
    return all(isinstance(a, Variable | Object) for a in node.arguments)


def _quantified_reads(update: Update, pool: Pool) -> Update:
    """An update of a `foreach` with a further variable for each read in its index or value."""
    while True:
        inside = value_reads((*update.arguments, update.value))
        read = next((r for r in inside if _has_plain_arguments(r)), None)
        if read is None:
            return _one_per_cell(update, pool)
        value = pool.fresh(Parameter(read.feature, read.type))
        change = replacing(read, value, pool)
        update = replace(
            update,
            arguments=tuple(map(change, update.arguments)),
            value=change(update.value),
            guard=pool.conjunction((pool.equal(read, value), change(update.guard))),
            variables=(*update.variables, value),
        )


def replacing(
    read: Expression, value: Expression, pool: Pool
) -> Callable[[Expression], Expression]:
    """A function that puts a value in the place of a read."""
    return lambda node: pool.rebuild(node, {}, lambda part: value if part is read else part)


def _one_per_cell(update: Update, pool: Pool) -> Update:
    """An update that reaches a cell only once: numbers must not be assigned twice.

    Objects that only decide whether a cell is written go into the guard.
    """
    used = pool.free_variables(update.value).union(*map(pool.free_variables, update.arguments))
    others = tuple(v for v in update.variables if isinstance(v, Variable) and v.name not in used)
    if not others or not is_number(update.value.type):
        return update
    return replace(
        update,
        guard=pool.quantified("exists", others, update.guard),
        variables=tuple(v for v in update.variables if v not in others),
    )
