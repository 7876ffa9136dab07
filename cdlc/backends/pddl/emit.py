"""PDDL of a program and a problem, or diagnostics for what is not discrete."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from cdlc.backends.errors import NotInPddl
from cdlc.backends.pddl.actions import Action, actions
from cdlc.backends.pddl.conditions import Lowering, condition
from cdlc.backends.pddl.domain import Domain, domain_text
from cdlc.backends.pddl.fit import report_unfit, report_unset
from cdlc.backends.pddl.names import Names
from cdlc.backends.pddl.normal import plain
from cdlc.backends.pddl.problems import problem_text
from cdlc.backends.pddl.sexpr import NEVER, NotPddl, SExpr
from cdlc.diagnostics import Collector
from cdlc.ir.hoare import Model, Triple
from cdlc.ir.symbolic import NotModelled
from crow.problem import Problem
from crow.program import Location, Program


@dataclass(frozen=True)
class PddlTask:
    """The PDDL of a program, and of a problem if there is one; `actions` lead back to behaviors.

    A hopeless task has a goal that is false in every state, which some readers do not take.
    """

    program: Program
    actions: tuple[Action, ...]
    names: Names
    domain: str
    problem: str | None
    is_hopeless: bool = False

    @cached_property
    def actions_by_name(self) -> dict[str, Action]:
        """Actions by lower-cased PDDL name."""
        return {action.name.lower(): action for action in self.actions}


def to_pddl(
    model: Model, triples: Sequence[Triple], problem: Problem | None, found: Collector
) -> PddlTask | None:
    """Emit a program and, if given, a problem. None, with diagnostics, for what is not discrete."""
    before = len(found.found)
    report_unfit(model.program, found)
    if problem is not None:
        report_unset(problem, found)
    if len(found.found) > before:
        return None
    try:
        return _task(model, triples, problem)
    except NotPddl as refused:
        location = refused.location or Location("", 1, 1, 1, 1)
        found.add(NotInPddl(location=location, construct=refused.construct, cure=refused.cure))
        return None


def _task(model: Model, triples: Sequence[Triple], problem: Problem | None) -> PddlTask:
    program = model.program
    names = _names(program)
    made = actions(model, triples, names)
    renamed = names.changed()
    goal = None if problem is None else _goal(model, problem, names)
    domain = Domain(program, names, made, () if goal is None else (goal,))
    text = _heading("domain", program.name) + _renamings(renamed) + domain_text(domain)
    if problem is None or goal is None:
        return PddlTask(program, made, names, text, None)
    own = _renamings(names.changed()[len(renamed) :])
    stated = _heading("problem", problem.name) + own + problem_text(problem, goal, names)
    return PddlTask(program, made, names, text, stated, is_hopeless=goal == NEVER)


def _names(program: Program) -> Names:
    names = Names()
    for type_ in program.types:
        if type_.is_object:
            names.add("type", type_.name)
    for feature in program.features:
        names.add("feature", feature.name)
    for constant in program.constants:
        names.add("object", constant.name)
    return names


def _heading(kind: str, name: str) -> str:
    shown = "".join(c if c.isprintable() else " " for c in name)
    return f'; Emitted by cdlc from the CDL {kind} "{shown}".\n'


def _renamings(renamed: list[tuple[str, str]]) -> str:
    lines = [f";   {name} is {pddl}\n" for name, pddl in renamed]
    return "; Names that PDDL does not take or tell apart:\n" + "".join(lines) if lines else ""


def _goal(model: Model, problem: Problem, names: Names) -> SExpr:
    if problem.minimize is not None:
        raise NotPddl("`minimize`", problem.minimize.location)
    for name in problem.world.objects:
        names.add("object", name)
    try:
        goal = model.formula(problem.goal)
    except NotModelled as refused:
        raise NotPddl(refused.construct, refused.location) from None
    return condition(plain(goal, model.pool), Lowering(names, model.pool, {}))
