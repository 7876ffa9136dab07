"""The Hoare model: `{pre} b(params) {post}` of every behavior with an effect (App. D.5).

`pre` is what the body's asserts, achieves and object binds demand, each regressed to the start;
`post` is one simultaneous assignment, the effects of its controllers and its own one after another.
An `alternative`, or an `unordered` group whose controllers' effects depend on their order, gives
one triple for each choice.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import islice, permutations
from typing import TYPE_CHECKING

from cdlc.ir.behaviors import achieved_in, body_of, disturbed, parts_of, touched
from cdlc.ir.bounds import within_bounds
from cdlc.ir.graph import in_order
from cdlc.ir.nodes import Level
from cdlc.ir.pool import Pool
from cdlc.ir.symbolic import Executor, Variables, hidden_by, leaving
from cdlc.ir.updates import Layer, NotModelled, merged
from crow.program import (
    Achieve,
    And,
    Apply,
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
    Hierarchy,
    If,
    Let,
    Location,
    ObjectType,
    Parameter,
    Program,
    Read,
    SetLocal,
    Statement,
    Variable,
)
from crow.program.names import fresh_name
from crow.program.triples import Triple, Update
from crow.program.types import INT64
from crow.program.walk import free_variables

if TYPE_CHECKING:
    from cdlc.ir.simplify import Work

MAX_TRIPLES = 64
# Marks a read of the state after a transition; no name of CDL starts with it.
_AFTER = "after'"
_STALE = "a `let` used after an `achieve` that may change it"


@dataclass(frozen=True, slots=True, eq=False)
class _Demand:
    """What a statement of a body demands of the state before."""

    formula: Expression
    sources: tuple[Location, ...]


class Model:
    """The formulas of one program, in one pool.

    Every method raises NotModelled for a construct that has no Hoare model.
    """

    def __init__(self, program: Program, level: Level = Level.BASIC) -> None:
        self.program = program
        self.pool = Pool(Hierarchy.of(program.types), level)
        self.behaviors = {b.name: b for b in program.behaviors}

    @cached_property
    def _work(self) -> "Work":
        from cdlc.ir.simplify import Work

        return Work()

    def triples(self, behavior: Behavior) -> tuple[Triple, ...]:
        """The triples of a behavior; none for a method, which has no effect of its own."""
        if behavior.effect is None:
            return ()
        try:
            found = self._triples(behavior)
            if self.pool.level is not Level.FULL:
                return found
            from cdlc.ir.simplify import simplified

            return tuple(simplified(triple, self.pool, self._work) for triple in found)
        except RecursionError:
            construct = "a condition or effect nested this deeply"
            raise NotModelled(construct, behavior.location) from None

    def _triples(self, behavior: Behavior) -> tuple[Triple, ...]:
        runs = [_Run(self, behavior)]
        for statement in body_of(behavior):
            after = (after for run in runs for after in run.statement(statement))
            runs = list(islice(after, MAX_TRIPLES + 1))
            if len(runs) > MAX_TRIPLES:
                construct = f"a body with more than {MAX_TRIPLES} choices"
                raise NotModelled(construct, behavior.location)
        return tuple(run.finished() for run in runs)

    def formula(self, expression: Expression, parameters: Iterable[Parameter] = ()) -> Expression:
        """An expression over the state before, derived functions unfolded; variables stay."""
        executor = Executor(self.program, self.pool)
        names = {p.name: self.pool.variable(p.name, p.type) for p in parameters}
        for part in in_order(expression):
            if isinstance(part, Variable):
                names.setdefault(part.name, self.pool.variable(part.name, part.type))
        try:
            return executor.value(expression, Layer(), names)
        except RecursionError:
            construct = "an expression nested this deeply"
            raise NotModelled(construct, expression.location) from None

    def weakest_precondition(
        self, condition: Expression, triple: Triple, arguments: tuple[Expression, ...] = ()
    ) -> Expression:
        """What must hold before a transition for a pooled condition to hold after it.

        The result is true in a state exactly if the condition is true in the state after. `pre` is
        not part of it: the transition can be applied only where that holds too. Variables of the
        condition that are parameters of the triple mean these, unless `arguments` are given, pooled
        expressions that stand for them in order.
        Raises NotModelled for a condition with an external function that reads what is written, and
        for one that reads what a `foreach` writes to computed cells.
        """
        executor = Executor(self.program, self.pool)
        names = [p.name for p in triple.parameters[: len(arguments)]]
        given = dict(zip(names, arguments, strict=True))
        updates = (self._instance(update, given) for update in triple.post)
        layer = Layer(None, {("", (), i): update for i, update in enumerate(updates)})

        # `not f(x)` after `f[x] = not f(x)` is `f(x)`, which must not be taken for a read after: so
        # what is read after the transition is marked first, and replaced where it is marked.
        def marked(node: Expression) -> Expression:
            if isinstance(node, Apply):
                executor.check_call(node, layer)
            if not isinstance(node, Read):
                return node
            return self.pool.apply(_AFTER + node.feature, node.arguments, node.type, node.location)

        def after(node: Expression) -> Expression:
            if not (isinstance(node, Apply) and node.function.startswith(_AFTER)):
                return node
            feature = node.function.removeprefix(_AFTER)
            return executor.read(feature, node.arguments, layer, node.location)

        return self.pool.rebuild(self.pool.rebuild(condition, {}, marked), {}, after)

    def _instance(self, update: Update, given: Variables) -> Update:
        """An update with some parameters replaced."""
        of = self.pool.substitute
        return replace(
            update,
            arguments=tuple(of(argument, given) for argument in update.arguments),
            value=of(update.value, given),
            guard=of(update.guard, given),
        )


class _Run:
    """One way through a body: what it demands, calls and writes so far."""

    def __init__(self, model: Model, behavior: Behavior) -> None:
        self.model = model
        self.behavior = behavior
        self.executor = Executor(model.program, model.pool)
        self.controllers = {c.name: c for c in model.program.controllers}
        self.parameters: tuple[Parameter, ...] = behavior.parameters
        self.variables: Variables = {
            p.name: model.pool.variable(p.name, p.type) for p in behavior.parameters
        }
        self.layer = Layer()
        self.pre: tuple[_Demand, ...] = ()
        self.calls: tuple[Do, ...] = ()
        # What gave each local its value, and those that would get another one by now.
        self.reading: Mapping[str, Let] = {}
        self.stale: frozenset[str] = frozenset()

    def copy(self) -> "_Run":
        """The same run, to go on in another way."""
        other = _Run(self.model, self.behavior)
        other.__dict__.update(self.__dict__)
        other.executor.conflicts = list(self.executor.conflicts)
        return other

    def finished(self) -> Triple:
        """The triple, after the behavior's own effect."""
        behavior = self.behavior
        assert behavior.effect is not None
        self.own_effect(behavior.effect)
        pool = self.model.pool
        updates = (u for u in self.layer.all_writes() if u.guard is not pool.false)
        pre, reasons = _conjuncts(self.pre, pool)
        return Triple(
            behavior.name,
            self.parameters,
            behavior.goal,
            self.calls,
            pre,
            tuple(updates),
            tuple(self.executor.conflicts),
            behavior.location,
            reasons,
        )

    # ------------------------------------------------------------------------------- statements

    def statement(self, node: Statement) -> Iterator["_Run"]:
        """The runs after a statement: one, or one for each choice it leaves."""
        match node:
            case Group(order="alternative", body=body):
                for chosen in body:
                    yield from self.copy().statement(chosen)
            case Group(order="unordered", body=body) if self._order_matters(body):
                for ordered in permutations(body):
                    yield from self.copy().statement(
                        replace(node, order="sequential", body=ordered)
                    )
            case Group(body=body):
                before = self.copy()
                for run in self.block(body):
                    run.leave(before, body)
                    yield run
            case Call():
                yield from self._call(node)
            case _:
                self._plain(node)
                yield self

    def block(self, statements: tuple[Statement, ...]) -> Iterator["_Run"]:
        """The runs after several statements."""
        if not statements:
            yield self
            return
        for run in self.statement(statements[0]):
            yield from run.block(statements[1:])

    def leave(self, before: "_Run", body: tuple[Statement, ...]) -> None:
        """Go on after a block of its own: what it has declared is gone."""
        hidden = hidden_by(body)
        self.variables = leaving(body, before.variables, self.variables)
        self.reading = leaving(body, before.reading, self.reading)
        self.stale = (self.stale - hidden) | (before.stale & hidden)
        self._age(tuple(achieved_in(self.model.program, body)))

    def _order_matters(self, body: tuple[Statement, ...]) -> bool:
        """Whether the effects of a group's statements may depend on their order."""
        if all(isinstance(s, Achieve | Assert) for s in body):
            return False
        each = [touched(self.model.program, (statement,)) for statement in body]
        if not any(one.disturbs(other) for one, other in permutations(each, 2)):
            return False
        for statement in body:
            if isinstance(statement, Let | SetLocal | Bind):
                # In some orders, others would use its variable before it has a value.
                construct = f"{_construct(statement)} in an `unordered` group that acts"
                raise NotModelled(construct, statement.location)
        return True

    def _plain(self, node: Statement) -> None:
        match node:
            case Assert(condition=condition):
                self._require(condition, node)
            case Achieve():
                self._achieve(node)
            case Bind():
                self._bind(node)
            case Do():
                self._do(node)
            case Let(variable=variable, value=value):
                now = self._now(value, self.variables)
                self.variables = {**self.variables, variable.name: now}
                self.reading = {**self.reading, variable.name: node}
                self.stale -= {variable.name}
            case SetLocal(variable=name, value=value):
                self._plain(Let(Parameter(name, value.type), value, location=node.location))
            case If() | ForEach() | ForRange():
                conditions = list(self._conditions((node,), self.variables))
                self.pre = (*self.pre, *conditions)
            case Commit():
                return
            case _:
                raise AssertionError(f"{type(node).__name__} in a body")

    def _achieve(self, node: Achieve) -> None:
        self._plan_for(node)
        if not node.once:
            self._require(node.condition, node)

    def _plan_for(self, node: Achieve) -> None:
        if self.calls:
            raise NotModelled("an `achieve` after a controller call", node.location)
        self._age((node.condition,))

    def _age(self, conditions: tuple[Expression, ...]) -> None:
        """Plans for conditions may change what a `let` has read; its value would be another."""
        program, stale = self.model.program, self.stale
        for name, let in self.reading.items():
            if not stale.isdisjoint(free_variables(let.value)) or (
                conditions and disturbed(program, (let,), conditions)
            ):
                stale |= {name}
        self.stale = stale

    def _require(self, condition: Expression, node: Statement) -> None:
        self.pre = (*self.pre, _Demand(self._now(condition, self.variables), _place(node)))

    def _now(self, expression: Expression, variables: Variables) -> Expression:
        """The value of an expression where the run stands, over the state before."""
        if not self.stale.isdisjoint(free_variables(expression)):
            raise NotModelled(_STALE, expression.location)
        return self.executor.value(expression, self.layer, variables)

    def _conditions(
        self, statements: tuple[Statement, ...], variables: Variables
    ) -> Iterator[_Demand]:
        """What blocks under `if`, `foreach` and `for` demand; they may do nothing else."""
        pool = self.model.pool
        for node in statements:
            match node:
                case Assert(condition=condition) | Achieve(condition=condition, once=False):
                    if isinstance(node, Achieve):
                        self._plan_for(node)
                    yield _Demand(self._now(condition, variables), _place(node))
                case Achieve():
                    continue
                case Group(order="sequential" | "unordered", body=body):
                    yield from self._conditions(body, variables)
                case If(condition=test, then=then, otherwise=otherwise):
                    now = self._now(test, variables)
                    for part in self._conditions(then, variables):
                        formula = pool.disjunction((pool.negation(now), part.formula))
                        yield replace(part, formula=formula)
                    for part in self._conditions(otherwise, variables):
                        yield replace(part, formula=pool.disjunction((now, part.formula)))
                case ForEach(variables=bound, body=body):
                    opened = tuple(pool.fresh(v) for v in bound)
                    names = {v.name: o for v, o in zip(bound, opened, strict=True)}
                    parts = tuple(self._conditions(body, {**variables, **names}))
                    together = pool.conjunction(part.formula for part in parts)
                    sources = merged((), *(part.sources for part in parts))
                    yield _Demand(pool.quantified("forall", opened, together), sources)
                case ForRange(variable=variable, body=body):
                    for number in range(node.start, node.stop, node.step):
                        counted = pool.constant(number, INT64)
                        yield from self._conditions(body, {**variables, variable.name: counted})
                case _:
                    construct = f"{_construct(node)} under `if`, `foreach` or `for`"
                    raise NotModelled(construct, node.location)

    # ---------------------------------------------------------------------------- binds and calls

    def _bind(self, node: Bind) -> None:
        for variable in node.variables:
            if not isinstance(variable.type, ObjectType):
                raise NotModelled(f"a `bind` of type `{variable.type}`", node.location)
            taken = {p.name for p in self.parameters}
            fresh = replace(variable, name=fresh_name(variable.name, taken))
            self.parameters = (*self.parameters, fresh)
            bound = self.model.pool.variable(fresh.name, fresh.type)
            self.variables = {**self.variables, variable.name: bound}
        if node.condition is not None:
            self._require(node.condition, node)

    def _do(self, node: Do) -> None:
        values = tuple(self._now(a, self.variables) for a in node.arguments)
        self.calls = (*self.calls, replace(node, arguments=values))
        controller = self.controllers[node.controller]
        if controller.effect is not None:
            names = [p.name for p in controller.parameters]
            variables = dict(zip(names, values, strict=True))
            self.execute(controller.effect, variables)

    def own_effect(self, effect: tuple[Statement, ...]) -> None:
        """A behavior's effect, after its body."""
        for part in parts_of(effect):
            if isinstance(part, Variable) and part.name in self.stale:
                raise NotModelled(_STALE, part.location)
        self.execute(effect, self.variables)

    def execute(self, effect: tuple[Statement, ...], variables: Variables) -> None:
        """An effect on top of those before; it can be applied only where it stays in bounds."""
        self.layer = self.executor.execute(effect, self.layer, variables)
        bounds = within_bounds(self.executor, self.executor.features, self.layer)
        demands = (_Demand(condition, sources) for condition, sources in bounds)
        self.pre = (*self.pre, *demands)

    def _call(self, node: Call) -> Iterator["_Run"]:
        """A called behavior is inlined: its conditions, calls and effect become the caller's."""
        called = self.model.behaviors[node.behavior]
        values = tuple(self._now(a, self.variables) for a in node.arguments)
        names = [p.name for p in called.parameters]
        inside = self.copy()
        inside.variables = dict(zip(names, values, strict=True))
        inside.reading, inside.stale = {}, frozenset()
        self._age(tuple(achieved_in(self.model.program, (node,))))
        for run in inside.block(body_of(called)):
            if called.effect is not None:
                run.own_effect(called.effect)
            run.variables, run.reading, run.stale = self.variables, self.reading, self.stale
            yield run


def _conjuncts(
    demands: tuple[_Demand, ...], pool: Pool
) -> tuple[tuple[Expression, ...], tuple[tuple[Location, ...], ...]]:
    """The conjuncts of all demands, each once, with the statements behind each."""
    reasons: dict[int, tuple[Location, ...]] = {}
    for demand in demands:
        for part in _operands(demand.formula, pool):
            reasons[id(part)] = merged(reasons.get(id(part), ()), demand.sources)
    together = _operands(pool.conjunction(d.formula for d in demands), pool)
    every = merged((), *reasons.values())
    return together, tuple(reasons.get(id(part), every) for part in together)


def _operands(condition: Expression, pool: Pool) -> tuple[Expression, ...]:
    if condition is pool.true:
        return ()
    return condition.operands if isinstance(condition, And) else (condition,)


def _place(node: Statement) -> tuple[Location, ...]:
    return () if node.location is None else (node.location,)


def _construct(statement: Statement) -> str:
    """A statement in words."""
    names = {"Do": "a controller call", "Call": "a behavior call", "SetLocal": "an assignment"}
    return names.get(type(statement).__name__, f"`{type(statement).__name__.lower()}`")
