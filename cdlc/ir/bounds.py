"""What the bounds of features demand of an effect: it must not leave them (language.md §2)."""

from collections.abc import Iterable, Iterator, Mapping

from cdlc.ir.pool import Pool
from cdlc.ir.symbolic import Executor
from cdlc.ir.updates import Layer
from crow.program import Arithmetic, Constant, Expression, Feature, Location, Read
from crow.program.triples import Update
from crow.program.types import INT64


def within_bounds(
    executor: Executor, features: Mapping[str, Feature], layer: Layer
) -> Iterator[tuple[Expression, tuple[Location, ...]]]:
    """The conditions, over the state before, that a bounded cell that was written is in its range.

    With each, the statements that wrote the cell. It is the value after the whole effect that
    counts, not what the cell held in between.
    """
    pool = executor.pool
    writes = tuple(layer.writes.values())
    for position, update in enumerate(writes):
        feature = features[update.feature]
        if feature.bounds == (None, None):
            continue
        later = [w for w in writes[position + 1 :] if w.feature == update.feature]
        if any(w.variables for w in later):
            value, overwritten = executor.read(update.feature, update.arguments, layer), []
        else:
            value, overwritten = update.value, [_meets(pool, w, update) for w in later]
        limits = pool.conjunction(_limits(pool, value, feature, features))
        condition = pool.disjunction((pool.negation(update.guard), *overwritten, limits))
        if update.variables:
            condition = pool.quantified("forall", update.variables, condition)
        yield condition, update.sources


def _meets(pool: Pool, later: Update, update: Update) -> Expression:
    """When a later write hits the same cell: then it is that write's value which counts."""
    pairs = zip(later.arguments, update.arguments, strict=True)
    return pool.conjunction((*(pool.equal(a, b) for a, b in pairs), later.guard))


def _limits(
    pool: Pool, value: Expression, feature: Feature, features: Mapping[str, Feature]
) -> Iterable[Expression]:
    low, high = feature.bounds
    least, greatest = _range_of(value, features)
    if low is not None and (least is None or least < low):
        yield pool.compare(">=", value, pool.constant(low, INT64))
    if high is not None and (greatest is None or greatest > high):
        yield pool.compare("<=", value, pool.constant(high, INT64))


def _range_of(value: Expression, features: Mapping[str, Feature]) -> tuple[int | None, int | None]:
    """What a value is at least and at most, given that every cell is within its bounds."""
    match value:
        case Constant(value=int(number)):
            return number, number
        case Read(feature=name):
            return features[name].bounds
        case Arithmetic(operator="+" | "-" as sign, left=left, right=Constant(value=int(number))):
            least, greatest = _range_of(left, features)
            by = number if sign == "+" else -number
            return (
                None if least is None else least + by,
                None if greatest is None else greatest + by,
            )
        case _:
            return None, None
