"""What a transition needs beyond its conditions: no division by zero.

The interpreter does not apply a transition whose effect has no value; PDDL has to be told by
preconditions.
"""

from collections.abc import Iterator

from cdlc.backends.pddl.cases import cases, grouped
from cdlc.backends.pddl.effects import effective_guard
from cdlc.backends.pddl.sexpr import NotPddl
from cdlc.ir.graph import in_order
from cdlc.ir.pool import Pool
from cdlc.ir.symbolic import Executor
from crow.program import And, Arithmetic, Compare, Constant, Expression
from crow.program.triples import Update
from crow.program.types import is_number


def is_defined(
    pre: tuple[Expression, ...], post: tuple[Update, ...], executor: Executor
) -> Iterator[Expression]:
    """Conditions under which an effect has values. Raises NotPddl."""
    for part in pre:
        yield from _divisors_of_condition(part, executor.pool)
    for update in post:
        refuse_division(update.guard)
        if is_number(update.value.type):
            yield from _is_update_defined(update, post, executor)


def _is_update_defined(
    update: Update, post: tuple[Update, ...], executor: Executor
) -> Iterator[Expression]:
    pool = executor.pool
    guard = effective_guard(update, post, executor)
    known = guard.operands if isinstance(guard, And) else (guard,)
    for when, (value,) in grouped(pool, cases(pool, (update.value,), known, update.location)):
        refuse_division(when)
        needed = list(_divisors(value, pool))
        if needed:
            fires = pool.negation(pool.conjunction((guard, when)))
            condition = pool.disjunction((fires, pool.conjunction(needed)))
            yield pool.quantified("forall", update.variables, condition)


def _divisors(value: Expression, pool: Pool) -> Iterator[Expression]:
    """That nothing is divided by zero in a number."""
    for part in in_order(value):
        if isinstance(part, Arithmetic) and part.operator == "/":
            if not isinstance(part.right, Constant):
                yield pool.compare("!=", part.right, pool.constant(0, part.right.type))
            elif part.right.value == 0:
                raise NotPddl("a division by zero", part.location)


def _divisors_of_condition(condition: Expression, pool: Pool) -> Iterator[Expression]:
    """The same for one conjunct; deeper in a condition, whether it is evaluated depends."""
    if isinstance(condition, Compare):
        yield from _divisors(condition, pool)
    else:
        refuse_division(condition)


def refuse_division(condition: Expression) -> None:
    """Raise NotPddl for a condition that may divide by zero."""
    for part in in_order(condition):
        match part:
            case Arithmetic(operator="/", right=Constant(value=value)) if value:
                pass
            case Arithmetic(operator="/"):
                construct = "a division by what may be zero, in a condition,"
                raise NotPddl(construct, part.location)
            case _:
                pass
