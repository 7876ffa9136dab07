"""The checks of one behavior: each a question whose answer `no`, or `yes`, is what is wanted.

A proof is z3's alone. A refutation is never z3's alone: the interpreter has run it.
"""

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import combinations

from cdlc.ir.graph import in_order
from cdlc.ir.hoare import Model
from cdlc.ir.lints.goals import mended, near_miss
from cdlc.ir.updates import NotModelled
from cdlc.verify.errors import DeadWrite, GoalRefuted, NeverApplicable, WritesCollide
from cdlc.verify.explain import Counterexample, false_parts, smaller, write_labels
from cdlc.verify.question import Question
from cdlc.verify.results import Check, Verdict
from cdlc.verify.situation import Situation
from cdlc.verify.smt.ask import Found, can_alias, refute, search
from cdlc.verify.smt.solver import Answer, Solved
from cdlc.verify.ways import Ways
from crow.program import And, Apply, Behavior, Expression, Location, Read
from crow.program.triples import Conflict, Triple, Update
from crow.program.types import is_object
from crow.program.walk import statements_within, subexpressions
from crow.text import expression_text

# Of the time for a check: a first proof, and the end of the search; the rest is a second proof.
_FIRST_PROOF, _SEARCH = 0.2, 0.6
REAL_NUMBERS = "floats are taken as real numbers: rounding is left out"


@dataclass(frozen=True)
class Subject:
    """A behavior, its triples, and the ways through its body that each may be of."""

    model: Model
    behavior: Behavior
    cases: tuple[tuple[Triple, Ways], ...]
    time_limit: float

    @property
    def location(self) -> Location:
        """Where the behavior is defined."""
        return self.behavior.location or Location("", 1, 1, 1, 1)


Confirm = Callable[[Situation], str]


@dataclass(frozen=True, slots=True)
class _Decided:
    """An answer to a question: proved that there is none, one confirmed, or neither."""

    verdict: Verdict
    situation: Situation | None = None
    reason: str = ""
    size: int | None = None
    is_aliased: bool = False


# --------------------------------------------------------------------------------------------- goal


def check_goal(subject: Subject) -> Iterator[Check]:
    """That the goal holds after the behavior, wherever it can be applied."""
    goal = subject.behavior.goal
    if goal is None or goal.location is None:
        return
    yield _worst([_goal_of(subject, goal, triple, ways) for triple, ways in subject.cases])


def _goal_of(subject: Subject, goal: Expression, triple: Triple, ways: Ways) -> Check:
    model = subject.model
    formula = model.formula(goal, triple.parameters)
    _refuse_stale_calls(model, formula, triple)
    after = model.weakest_precondition(formula, triple)
    question = Question(model, triple, (model.pool.negation(after),))

    def confirm(situation: Situation) -> str:
        if problem := _did_not_end(situation):
            return problem
        value = situation.after(goal)
        return "" if value is False else f"the goal is {value} when it is run"

    decided = _decide(question, ways, confirm, subject.time_limit)
    if decided.situation is None:
        return _check("goal", decided, question)
    small = smaller(decided.situation, confirm)
    example = Counterexample(small, false_parts(small, goal))
    return _check(
        "goal", decided, question, _goal_problem(subject, goal, example, decided), example
    )


def _refuse_stale_calls(model: Model, goal: Expression, triple: Triple) -> None:
    """Raise NotModelled for an external function that reads what the triple writes.

    It would be taken for what it was before.
    """
    functions = {f.name: f for f in model.program.functions}
    for node in in_order(goal):
        if not isinstance(node, Apply):
            continue
        for annotation in functions[node.function].annotations:
            named = annotation.value
            read = named if isinstance(named, tuple) else (named,)
            for update in triple.post if annotation.name == "reads" else ():
                if update.feature in read or not {None, "all"}.isdisjoint(read):
                    text = f"`{node.function}`, which reads `{update.feature}`, after a write of it"
                    raise NotModelled(text, node.location)


def _did_not_end(situation: Situation) -> str:
    if not situation.is_possible:
        return "a feature is out of its bounds"
    problem = situation.ran.problem
    if problem is not None:
        return f"the behavior cannot be run there: {getattr(problem, 'reason', 'a choice is open')}"
    return ""


def _goal_problem(
    subject: Subject, goal: Expression, example: Counterexample, decided: _Decided
) -> GoalRefuted:
    triple = example.situation.triple
    assert goal.location is not None
    read = {node.feature for node in subexpressions(goal) if isinstance(node, Read)}
    written = {update.feature for update in triple.post}
    close = near_miss(triple)
    labels = dict.fromkeys(write_labels(example))
    return GoalRefuted(
        location=goal.location,
        behavior=subject.behavior.name,
        goal=expression_text(goal),
        writes=tuple(labels),
        unwritten=() if read & written else tuple(sorted(read)),
        aliased=_equal_arguments(example.situation) if decided.is_aliased else (),
        suggestion=None if close is None else mended(triple),
    )


def _equal_arguments(situation: Situation) -> tuple[str, ...]:
    """Two variables that are one object."""
    objects = [p.name for p in situation.triple.parameters if is_object(p.type)]
    pairs = combinations(objects, 2)
    values = situation.values
    return next(((a, b) for a, b in pairs if values[a] == values[b]), ())


# --------------------------------------------------------------------------------------- applicable


def check_applicable(subject: Subject) -> Iterator[Check]:
    """That some state satisfies the conditions, and the effect ends there."""
    checks = []
    for triple, ways in subject.cases:
        checks.append(_applicable(subject, triple, ways))
        if checks[-1].verdict is Verdict.PROVED:
            break
    yield _best(checks)


def _applicable(subject: Subject, triple: Triple, ways: Ways) -> Check:
    question = Question(subject.model, triple)
    start = time.monotonic()
    found = search(question, ways, _did_not_end, start + _SEARCH * subject.time_limit)
    if found.situation is not None:
        return Check("applicable", Verdict.PROVED)
    solved = refute(question, start + subject.time_limit, core=True)
    if solved.answer is not Answer.UNSAT:
        return Check("applicable", Verdict.UNKNOWN, _reason(solved, found), found.size)
    parts = [triple.pre[i] for i in solved.core]
    texts = tuple(_text(subject.model, part) for part in parts)
    problem = NeverApplicable(
        location=subject.location,
        behavior=subject.behavior.name,
        conditions=texts,
        places=tuple(dict.fromkeys(_places(subject, triple, parts))),
    )
    return Check("applicable", Verdict.REFUTED, problem=problem, notes=_notes(question))


def _places(subject: Subject, triple: Triple, parts: list[Expression]) -> Iterator[Location]:
    """Where the body asks for some of the preconditions, as far as that is plain to see."""
    wanted = {id(part) for part in parts}
    for statement in statements_within(subject.behavior.body):
        condition = getattr(statement, "condition", None)
        if condition is None or condition.location is None:
            continue
        try:
            formula = subject.model.formula(condition, triple.parameters)
        except NotModelled:
            continue
        found = formula.operands if isinstance(formula, And) else (formula,)
        if any(id(part) in wanted for part in found):
            yield condition.location


def _text(model: Model, formula: Expression) -> str:
    """A formula in CDL; its bound variables have names that nobody has given."""
    from cdlc.ir.graph import written_size

    if written_size(formula) > 200:
        return "a condition too long to be shown"
    return expression_text(model_names(model, formula))


def model_names(model: Model, formula: Expression) -> Expression:
    """A formula with readable names for its bound variables."""
    from cdlc.ir.names import shown_name
    from crow.program import Parameter, Quantified, Variable
    from crow.program.rewrite import rewrite, substitute

    taken = set(model.pool.free_variables(formula))

    def rule(node: Expression) -> Expression:
        if not isinstance(node, Quantified):
            return node
        names = {}
        for v in node.variables:
            names[v.name] = shown_name(v, taken)
            taken.add(names[v.name])
        variables = tuple(Parameter(names[v.name], v.type) for v in node.variables)
        new: dict[str, Expression] = {
            v.name: Variable(names[v.name], v.type) for v in node.variables
        }
        return replace(node, variables=variables, body=substitute(node.body, new))

    return rewrite(formula, rule)


# ------------------------------------------------------------------------------------------- guards


def check_guards(subject: Subject) -> Iterator[Check]:
    """That every assignment under a condition can be carried out.

    Copies of one statement, of an unrolled loop or of several triples, count as one.
    """
    pool = subject.model.pool
    places: dict[Location, list[tuple[Triple, Ways, Update]]] = {}
    for triple, ways in subject.cases:
        for update in triple.post:
            if update.location is not None:
                places.setdefault(update.location, []).append((triple, ways, update))
    checks = [
        _guard(subject, place, copies)
        for place, copies in places.items()
        if all(update.guard is not pool.true for *_, update in copies)
    ]
    if checks:
        yield _worst(checks)


def _guard(subject: Subject, place: Location, copies: list[tuple[Triple, Ways, Update]]) -> Check:
    checks = []
    limit = subject.time_limit / len(copies)
    for triple, ways, update in copies:
        question = Question(subject.model, triple, (update.guard,))
        start = time.monotonic()

        def confirm(situation: Situation, update: Update = update) -> str:
            ended = _did_not_end(situation)
            return ended or ("" if situation.before(update.guard) else "its guard is false")

        found = search(question, ways, confirm, start + _SEARCH * limit)
        if found.situation is not None:
            return Check("guards", Verdict.PROVED)
        solved = refute(question, start + limit)
        if solved.answer is Answer.UNSAT:
            problem = DeadWrite(location=place, behavior=subject.behavior.name)
            checks.append(Check("guards", Verdict.REFUTED, problem=problem, notes=_notes(question)))
        else:
            checks.append(Check("guards", Verdict.UNKNOWN, _reason(solved, found), found.size))
    return _best(checks)


# ------------------------------------------------------------------------------------------- writes


def check_writes(subject: Subject) -> Iterator[Check]:
    """That iterations of a `foreach` agree where they write one cell."""
    checks = [
        _conflict(subject, triple, ways, conflict)
        for triple, ways in subject.cases
        for conflict in triple.conflicts
    ]
    if checks:
        yield _worst(checks)


def _conflict(subject: Subject, triple: Triple, ways: Ways, conflict: Conflict) -> Check:
    pool = subject.model.pool
    # The condition says nothing of an `if` around the loop; where one write is done, it is entered.
    done = [
        pool.quantified("exists", u.variables, u.guard)
        for u in triple.post
        if u.location is not None and u.location == conflict.first.location
    ]
    hints = (pool.disjunction(done),) if done else ()
    question = Question(subject.model, triple, (conflict.condition,), ends=False, hints=hints)

    def confirm(situation: Situation) -> str:
        is_found = situation.is_possible and situation.has_conflict
        return "" if is_found else "the iterations agree when it is run"

    decided = _decide(question, ways, confirm, subject.time_limit)
    if decided.situation is None:
        return _check("writes", decided, question)
    first, second = conflict.first.location, conflict.second.location
    problem = WritesCollide(
        location=first or subject.location,
        behavior=subject.behavior.name,
        feature=conflict.first.feature,
        other=None if first == second else second,
    )
    small = smaller(decided.situation, confirm)
    return _check("writes", decided, question, problem, Counterexample(small))


# ------------------------------------------------------------------------------------------- shared


def _decide(question: Question, ways: Ways, confirm: Confirm, limit: float) -> _Decided:
    """Whether a question has an answer: a quick proof, a search, and a proof that takes longer."""
    start = time.monotonic()
    first = refute(question, start + _FIRST_PROOF * limit)
    if first.answer is Answer.UNSAT:
        return _Decided(Verdict.PROVED)
    until = start + _SEARCH * limit
    aliases = can_alias(question)
    found = search(question, ways, confirm, until, apart=aliases)
    if aliases and found.situation is None:
        found = search(question, ways, confirm, until)
        if found.situation is not None:
            return _Decided(Verdict.REFUTED, found.situation, is_aliased=True)
    if found.situation is not None:
        return _Decided(Verdict.REFUTED, found.situation)
    last = first if first.answer is Answer.SAT else refute(question, start + limit)
    if last.answer is Answer.UNSAT:
        return _Decided(Verdict.PROVED)
    return _Decided(Verdict.UNKNOWN, reason=_reason(last, found), size=found.size)


def _reason(solved: Solved, found: Found) -> str:
    """Why a question stays open."""
    if found.doubt:
        return f"z3's counterexample is not confirmed: {found.doubt}"
    if solved.answer is Answer.SAT:
        return found.reason or "z3 finds a counterexample only with more objects than were tried"
    return solved.reason or found.reason


def _check(
    name: str,
    decided: _Decided,
    question: Question,
    problem: GoalRefuted | WritesCollide | None = None,
    example: Counterexample | None = None,
) -> Check:
    notes = _notes(question) if decided.verdict is Verdict.PROVED else ()
    return Check(name, decided.verdict, decided.reason, decided.size, notes, problem, example)


def _notes(question: Question) -> tuple[str, ...]:
    """What a proof takes for granted."""
    return (REAL_NUMBERS,) if question.has_floats else ()


_ORDER = (Verdict.REFUTED, Verdict.UNKNOWN, Verdict.PROVED)


def _worst(checks: list[Check]) -> Check:
    """The first refuted, else the first unknown, else proved, with the notes of all."""
    chosen = min(checks, key=lambda check: _ORDER.index(check.verdict))
    notes = dict.fromkeys(note for check in checks for note in check.notes)
    return replace(chosen, notes=tuple(notes)) if chosen.verdict is Verdict.PROVED else chosen


def _best(checks: list[Check]) -> Check:
    """The first proved, else the first unknown, else refuted."""
    return max(checks, key=lambda check: _ORDER.index(check.verdict))


def unmodelled(name: str, missing: NotModelled) -> Check:
    """A check that the formulas do not reach to."""
    where = "" if missing.location is None else f" ({missing.location})"
    return Check(name, Verdict.UNKNOWN, f"{missing.construct} has no formula{where}")
