"""A question over a few objects or over any number of them, as z3 gets it."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Any

import z3

from cdlc.verify.question import Question
from cdlc.verify.situation import Situation
from cdlc.verify.smt.encode import Encoder, TimedOut
from cdlc.verify.smt.model import Reader, blocked
from cdlc.verify.smt.solver import TIMED_OUT, Answer, Solved, solve
from cdlc.verify.smt.universe import Few, TooLarge, Unbounded
from cdlc.verify.ways import Ways
from crow.program import Parameter, Variable
from crow.program.types import is_object

# How many answers of one size are tried out before a larger one is.
_TRIES = 4


@dataclass(frozen=True, slots=True)
class Found:
    """What a search came to: a situation that the interpreter confirms, or how far it went.

    Up to `size` objects there is none. `doubt` says why an answer of z3 was not confirmed, `reason`
    why the search stopped.
    """

    situation: Situation | None
    size: int | None
    doubt: str = ""
    reason: str = ""


def facts(question: Question, encoder: Encoder) -> list[Any]:
    """The preconditions, each with that it has a value."""
    return [
        z3.And(encoder.condition(part), encoder.is_defined(part)) for part in question.triple.pre
    ]


def assertions(question: Question, encoder: Encoder, *, hints: bool) -> list[Any]:
    """Everything else that holds where the answer is yes. Raises NotModelled, TooLarge."""
    claims = (*question.claims, *(question.hints if hints else ()))
    found = [encoder.variable_is_valid(v) for v in question.variables]
    found += [z3.And(encoder.condition(c), encoder.is_defined(c)) for c in claims]
    if question.ends:
        found += _written(question, encoder)
    return [*found, *encoder.axioms()]


def _written(question: Question, encoder: Encoder) -> Iterator[Any]:
    """That every value that is written exists and fits."""
    features = encoder.declared_features
    for update in question.triple.post:
        fits = encoder.fits(update.value, features[update.feature].type)
        exists = z3.And(encoder.is_defined(update.value), fits)
        guarded = z3.Implies(encoder.condition(update.guard), exists)
        whole = z3.And(encoder.is_defined(update.guard), guarded)
        yield _for_all(update.variables, whole, encoder)


def _for_all(variables: tuple[Any, ...], body: Any, encoder: Encoder) -> Any:
    bound = [v for v in variables if isinstance(v, Variable)]
    if not bound or z3.is_true(z3.simplify(body)):
        return body
    terms = [encoder.variable(v.name, v.type)[0] for v in bound]
    return encoder.universe.for_all(terms, [v.type for v in bound], body, None)


# ----------------------------------------------------------------------------------------- proving


def refute(question: Question, deadline: float, *, core: bool = False) -> Solved:
    """Whether z3 shows that no state, of any size, is an answer. Raises NotModelled."""
    universe = Unbounded(_hierarchy(question), question.kinds, question.constants)
    encoder = Encoder(question.model.program, universe, deadline)
    try:
        pre = facts(question, encoder)
        rest = assertions(question, encoder, hints=False)
    except TimedOut:
        return Solved(Answer.UNKNOWN, reason=TIMED_OUT)
    if core:
        return solve(universe.ctx, rest, deadline, pre)
    return solve(universe.ctx, [*pre, *rest], deadline)


# --------------------------------------------------------------------------------------- searching


def search(
    question: Question,
    ways: Ways,
    confirm: Callable[[Situation], str],
    deadline: float,
    *,
    apart: bool = False,
) -> Found:
    """A smallest situation that answers the question.

    `confirm` tries one out, in each of the ways, and says what is wrong with it, or nothing. With
    `apart`, arguments are different objects. Raises NotModelled.
    """
    size: int | None = None
    doubt = ""
    for count in range(question.enough_objects + 1):
        universe = Few(_hierarchy(question), question.kinds, question.constants, count)
        encoder = Encoder(question.model.program, universe, deadline)
        try:
            asked = [*facts(question, encoder), *assertions(question, encoder, hints=True)]
        except TooLarge:
            return Found(None, size, doubt, "more objects make too large a formula")
        except TimedOut:
            return Found(None, size, doubt, TIMED_OUT)
        asked += _apart(question, encoder) if apart else []
        for _ in range(_TRIES):
            solved = solve(universe.ctx, asked, deadline)
            if solved.answer is Answer.UNKNOWN:
                return Found(None, size, doubt, solved.reason)
            if solved.answer is Answer.UNSAT:
                break
            reader = Reader(question.model.program, encoder, universe, solved.model)
            first = reader.situation(question.triple, ways[0], question.variables)
            situations = [replace(first, way=way) for way in ways]
            problems = list(map(confirm, situations))
            if "" in problems:
                return Found(situations[problems.index("")], size, doubt)
            doubt = problems[0]
            asked.append(blocked(reader, {v.name: v.type for v in question.variables}))
        size = count if not doubt else size
    return Found(None, size, doubt)


def _hierarchy(question: Question) -> Any:
    return question.model.pool.hierarchy


def _apart(question: Question, encoder: Encoder) -> list[Any]:
    """That arguments are different objects."""
    objects = [v for v in question.triple.parameters if is_object(v.type)]
    return [
        encoder.variable(a.name, a.type)[0] != encoder.variable(b.name, b.type)[0]
        for a, b in combinations(objects, 2)
    ]


def can_alias(question: Question) -> bool:
    """Whether two arguments can be one object."""
    objects: list[Parameter] = [v for v in question.triple.parameters if is_object(v.type)]
    share = question.model.pool.hierarchy.may_share_objects
    return any(share(a.type, b.type) for a, b in combinations(objects, 2))
