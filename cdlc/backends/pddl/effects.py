"""Updates to PDDL effects: simultaneous, with PDDL's add after delete (lowering.md §2)."""

from collections.abc import Iterator
from dataclasses import dataclass

from cdlc.backends.pddl.cases import Known, cases, grouped
from cdlc.backends.pddl.conditions import Lowering, atom, condition, term, typed
from cdlc.backends.pddl.numbers import assignment
from cdlc.backends.pddl.sexpr import ALWAYS, NEVER, SExpr
from cdlc.ir.pool import Pool
from cdlc.ir.symbolic import Executor
from crow.program import (
    And,
    Arithmetic,
    Compare,
    Constant,
    Expression,
    Or,
    Parameter,
    Quantified,
    Read,
    Variable,
)
from crow.program.triples import Update
from crow.program.types import is_boolean, is_number, is_object


def effects(
    post: tuple[Update, ...],
    pre: tuple[Expression, ...],
    lowering: Lowering,
    executor: Executor,
) -> Iterator[SExpr]:
    """The clauses of an effect.

    An earlier update is guarded against a later one in the same cell, except where the later one
    adds the same fact: then both fire, and the add wins.
    """
    writer = _Writer(executor, executor.pool, pre, Known(executor.pool, pre))
    for update in post:
        yield from writer.clauses(update, post, lowering)


def overruling(update: Update, post: tuple[Update, ...], executor: Executor) -> tuple[Update, ...]:
    """The later updates that may put another value into the same cell."""
    later = post[post.index(update) + 1 :]
    return tuple(
        other
        for other in later
        if other.feature == update.feature
        and other.value is not update.value
        and executor.meets(other, update.arguments) is not executor.pool.false
    )


def effective_guard(update: Update, post: tuple[Update, ...], executor: Executor) -> Expression:
    """When an update decides what its cell becomes: its guard, and no later update's there."""
    pool = executor.pool
    later = [u for u in post[post.index(update) + 1 :] if u.feature == update.feature]
    overruled = [pool.negation(executor.meets(other, update.arguments)) for other in later]
    return pool.conjunction((update.guard, *overruled))


@dataclass(frozen=True, slots=True)
class _Writer:
    executor: Executor
    pool: Pool
    pre: tuple[Expression, ...]
    known: Known

    def clauses(
        self, update: Update, post: tuple[Update, ...], lowering: Lowering
    ) -> Iterator[SExpr]:
        """The clauses of one update."""
        bound = tuple(
            Parameter(v.name, v.type) for v in update.variables if isinstance(v, Variable)
        )
        inner = lowering.with_variables(bound)
        type_ = self.executor.features[update.feature].type
        cell = self.pool.read(update.feature, update.arguments, type_)
        assert isinstance(cell, Read)
        if is_boolean(type_):
            written = self._boolean(update, self._guard(update, post), cell, inner)
        elif is_object(type_):
            written = self._object(update, self._guard(update, post), cell, inner)
        else:
            guard = self.known.simplified(effective_guard(update, post, self.executor))
            written = self._number(update, guard, cell, inner)
        for clause in written:
            # Numbers change once, however many objects there are to say so.
            when, effect, more = clause if is_number(type_) or not bound else _opened(clause)
            scope = inner.with_variables(more)
            lowered = condition(when, scope)
            if lowered != NEVER:
                made: SExpr = effect if lowered == ALWAYS else ("when", lowered, effect)
                named = [(scope.variables[v.name], v.type) for v in (*bound, *more)]
                yield ("forall", typed(named, scope.names), made) if named else made

    def _guard(self, update: Update, post: tuple[Update, ...]) -> Expression:
        """The guard of an add: later updates that may add something else must not fire."""
        pool = self.pool
        overruled = [
            pool.negation(self.executor.meets(other, update.arguments))
            for other in overruling(update, post, self.executor)
            if other.value is not pool.true
        ]
        return self.known.simplified(pool.conjunction((update.guard, *overruled)))

    def _boolean(
        self, update: Update, guard: Expression, cell: Read, lowering: Lowering
    ) -> "Iterator[_Clause]":
        written = atom(cell, lowering)
        adds, deletes = _when_written(update, guard, cell, self.pool)
        yield deletes, ("not", written), ()
        yield adds, written, ()

    # --------------------------------------------------------------------------------- objects

    def _object(
        self, update: Update, guard: Expression, cell: Read, lowering: Lowering
    ) -> "Iterator[_Clause]":
        """The old value goes, the new one comes.

        A later update of the same cell deletes the same old value, so only adds are guarded.
        """
        pool = self.pool
        written = atom(cell, lowering)
        assert isinstance(written, tuple)
        found = grouped(pool, cases(pool, (update.value,), _parts(guard), update.location))
        old = self._known_value(cell)
        kept = [when for when, (value,) in found if value is cell or value is old]
        changes = pool.conjunction((update.guard, *map(pool.negation, kept)))
        if old is not None:
            yield changes, ("not", (*written, term(old, lowering))), ()
        else:
            value = pool.fresh(Parameter(cell.feature, cell.type))
            assert isinstance(value, Variable)
            any_ = (Parameter(value.name, value.type),)
            named = lowering.with_variables(any_).variables[value.name]
            when = pool.conjunction((changes, pool.equal(cell, value)))
            yield when, ("not", (*written, named)), any_
        for when, (value,) in found:
            if value is not cell and value is not old:
                yield pool.conjunction((guard, when)), (*written, term(value, lowering)), ()

    def _known_value(self, cell: Read) -> Expression | None:
        """What a precondition says the cell holds before."""
        for part in self.pre:
            match part:
                case Compare(operator="==", left=left, right=right) if (
                    left is cell or right is cell
                ):
                    other = right if left is cell else left
                    if not isinstance(other, Read):
                        return other
                case _:
                    pass
        return None

    # --------------------------------------------------------------------------------- numbers

    def _number(
        self, update: Update, guard: Expression, cell: Read, lowering: Lowering
    ) -> "Iterator[_Clause]":
        """One effect a path, and nothing on a path that keeps the value."""
        pool = self.pool
        for when, (value,) in grouped(
            pool, cases(pool, (update.value,), _parts(guard), update.location)
        ):
            leaf = self._in_terms_of(cell, value, when)
            effect = assignment(cell, leaf, lambda read: atom(read, lowering))
            if effect is not None:
                yield pool.conjunction((guard, when)), effect, ()

    def _in_terms_of(self, cell: Read, value: Expression, when: Expression) -> Expression:
        """A value with the cell's own name for it, where a test says that two objects are one.

        So that `f[x] += 1; f[y] += 1` increases by 2 where x is y.
        """
        pool = self.pool
        for part in _parts(when):
            match part:
                case Compare(operator="==", left=Variable() as left, right=Variable() as right):
                    for one, other in ((left, right), (right, left)):
                        changed = pool.substitute(value, {one.name: other})
                        if changed is cell or _is_change_of(cell, changed):
                            return changed
                case _:
                    pass
        return value


_Clause = tuple[Expression, SExpr, tuple[Parameter, ...]]
"""When an effect fires, the effect, and further objects it is for."""


def _opened(clause: _Clause) -> _Clause:
    """An effect that fires where something exists, as one for all of them."""
    match clause:
        case Quantified(quantifier="exists", variables=variables, body=body), effect, more:
            return _opened((body, effect, (*more, *variables)))
        case _:
            return clause


def _is_change_of(cell: Read, value: Expression) -> bool:
    match value:
        case Arithmetic(operator="+" | "-", left=left, right=Constant()):
            return left is cell
        case _:
            return False


def _parts(condition: Expression) -> tuple[Expression, ...]:
    return condition.operands if isinstance(condition, And) else (condition,)


def _when_written(
    update: Update, guard: Expression, cell: Expression, pool: Pool
) -> tuple[Expression, Expression]:
    """When an update adds and when it deletes.

    An add is needed only where the cell is false before, a delete only where it is true.
    """
    known = _parts(guard)
    from_false = pool.given(update.value, (*known, pool.negation(cell)))
    from_true = pool.given(update.value, (*known, cell))
    deletes = pool.conjunction((guard, pool.negation(from_true)))
    if from_false is from_true:
        if (apart := _told_apart(known, from_true, pool)) is not None:
            return apart
        return pool.conjunction((guard, from_true)), deletes
    # Where the cell is true and becomes false, the add must not fire: it would win.
    stays = pool.disjunction((pool.negation(cell), from_true))
    return pool.conjunction((guard, from_false, stays)), deletes


def _told_apart(
    known: tuple[Expression, ...], value: Expression, pool: Pool
) -> tuple[Expression, Expression] | None:
    """Add and delete of `value` where one of several writes fires, one of them if it is true.

    Then the delete needs no negated test: where the value is true, the add wins. None elsewhere.
    """
    for part in known:
        if isinstance(part, Or) and value in part.operands:
            rest = [other for other in known if other is not part]
            others = pool.disjunction(o for o in part.operands if o is not value)
            return pool.conjunction((*rest, value)), pool.conjunction((*rest, others))
    return None
