"""Solves one task with unified-planning; the only module that imports it, in the worker's child."""

import platform
import sys
from collections.abc import Mapping
from importlib import import_module
from importlib.util import find_spec
from typing import Any

import psutil
from unified_planning.engines import PlanGenerationResultStatus, ValidationResultStatus
from unified_planning.engines.plan_validator import SequentialPlanValidator
from unified_planning.environment import get_environment
from unified_planning.io import PDDLReader
from unified_planning.plans import ActionInstance, PlanKind, SequentialPlan

from cdlc.backends.engines.direct import (
    lacks_directly,
    needs_direct,
    solve_directly,
    validated_directly,
)

# An answer is JSON: {"outcome": "plan", "steps": [[action, argument...]...]}, or an outcome that is
# another EngineStatus, or "missing" {"engines"}, "unsupported" {"features"}, "failed" {"reason"},
# with "steps" for a plan that is not valid; of a validator "valid" {"by"}, "invalid" {"by",
# "reason"}.
Answer = dict[str, Any]

_OUTCOMES = {
    PlanGenerationResultStatus.UNSOLVABLE_PROVEN: "unsolvable",
    PlanGenerationResultStatus.UNSOLVABLE_INCOMPLETELY: "limit",
    PlanGenerationResultStatus.TIMEOUT: "timeout",
    PlanGenerationResultStatus.MEMOUT: "memory",
}


class _Refused(Exception):  # noqa: N818 - carries an answer, which need not be an error
    """The run ends here with `answer`."""

    def __init__(self, answer: Answer) -> None:
        super().__init__(answer)
        self.answer = answer


# What engines are told besides the task. Kairos would stop after 30 seconds; that is for `run`.
_PARAMETERS: Mapping[str, dict[str, Any]] = {"kairos": {"anytime": False, "timeout": 1e6}}


def answer(request: dict[str, Any]) -> Answer:
    """Do what a request as `run` writes it asks for; what is not foreseen is raised."""
    try:
        if "engines" in request:
            return _describe(request)
        return _validate(request) if "validate" in request else _solve(request)
    except _Refused as refused:
        return refused.answer


def _solve(request: dict[str, Any]) -> Answer:
    environment = _environment()
    planner_class = _planner_class(environment.factory, request["engine"])
    if needs_direct(request["domain"]):
        _limit_memory(request["memory_limit_mb"])
        return solve_directly(request, planner_class)
    # Only now: the libraries just imported reserve far more address space than they use.
    _limit_memory(request["memory_limit_mb"])
    problem = _read(request["domain"], request["problem"])
    is_exempt = _check_support(planner_class, problem)
    name = request["engine"]
    parameters = _PARAMETERS.get(name, {})
    with environment.factory.OneshotPlanner(name=name, params=parameters) as planner:
        planner.skip_checks = is_exempt
        result = planner.solve(problem)
    _print_messages(result.log_messages)
    if result.plan is None:
        return _without_plan(result.status)
    return _validated(problem, result.plan)


def _environment() -> Any:
    """unified-planning's environment, quiet, with the engines that have to be registered."""
    environment = get_environment()
    environment.credits_stream = None
    if find_spec("up_kairos") is not None:
        import_module("up_kairos").register(environment)
    return environment


def _describe(request: dict[str, Any]) -> Answer:
    """What engines take, and which parts of the task, if there is one, they do not."""
    environment = _environment()
    kind = None
    domain = request["domain"]
    if domain is not None and needs_direct(domain):
        names = request["engines"]
        described = [{"name": n, "accepts": [], "lacks": lacks_directly(n, domain)} for n in names]
        return {"outcome": "described", "engines": described}
    if domain is not None:
        kind = _read(domain, request["problem"]).kind
        if request["problem"] is None:  # numbers have no initial values yet
            kind.unset_initial_state("UNDEFINED_INITIAL_NUMERIC")
    described = []
    for name in request["engines"]:
        engine = environment.factory.engine(name)
        supported = engine.supported_kind().features
        missing = set() if kind is None or engine.supports(kind) else kind.features - supported
        described.append({"name": name, "accepts": sorted(supported), "lacks": sorted(missing)})
    return {"outcome": "described", "engines": described}


def _planner_class(factory: Any, engine: str) -> Any:
    names = [name for name in factory.engines if factory.engine(name).is_oneshot_planner()]
    if engine not in names:
        raise _Refused({"outcome": "missing", "engines": names})
    return factory.engine(engine)


def _limit_memory(megabytes: int | None) -> None:
    # Elsewhere the limit is missing, or not enforced and the address space of no account.
    if megabytes is None or platform.system() != "Linux":
        return
    import resource

    limit = megabytes * 2**20
    in_use = psutil.Process().memory_info().vms
    if limit < in_use:
        sys.stdout.write(f"unified-planning alone takes {in_use // 2**20} MiB of address space")
        raise _Refused({"outcome": "memory"})
    _, hard = resource.getrlimit(resource.RLIMIT_AS)
    if hard != resource.RLIM_INFINITY:
        limit = min(limit, hard)
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))


def _read(domain: str, problem: str | None) -> Any:
    try:
        return PDDLReader().parse_problem_string(domain, problem)
    except (MemoryError, SystemError):  # SystemError is what pyparsing makes of it
        raise
    except Exception as error:
        reason = f"cannot read the PDDL: {error or type(error).__name__}"
        raise _Refused({"outcome": "failed", "reason": reason}) from error


def _check_support(planner_class: Any, problem: Any) -> bool:
    """Refuse what the engine does not take; true if its own check would be wrong.

    The reader takes every function for a real one, and some engines want whole costs.
    """
    kind = problem.kind
    has_whole_numbers = all(
        value.constant_value() == int(value.constant_value())
        for value in problem.initial_values.values()
        if value.is_real_constant() or value.is_int_constant()
    )
    harmless = {"REAL_NUMBERS_IN_ACTIONS_COST"} if has_whole_numbers else set[str]()
    is_exempt = False
    for engine in (planner_class, SequentialPlanValidator):
        if not engine.supports(kind):
            features = kind.features - engine.supported_kind().features or kind.features
            if features - harmless:
                raise _Refused({"outcome": "unsupported", "features": sorted(features)})
            is_exempt = True
    return is_exempt


def _print_messages(messages: Any) -> None:
    for message in messages or ():
        sys.stdout.write(message.message)


def _without_plan(status: Any) -> Answer:
    if status in _OUTCOMES:
        return {"outcome": _OUTCOMES[status]}
    if status is PlanGenerationResultStatus.UNSUPPORTED_PROBLEM:
        return {"outcome": "unsupported", "features": ["this task, by its own account"]}
    return {"outcome": "failed", "reason": f"it reports {status.name}"}


def _validated(problem: Any, plan: Any) -> Answer:
    if plan.kind is not PlanKind.SEQUENTIAL_PLAN:
        plan = plan.convert_to(PlanKind.SEQUENTIAL_PLAN, problem)
    steps = [[step.action.name, *map(str, step.actual_parameters)] for step in plan.actions]
    objection = _objection(problem, plan)
    if objection is not None:
        reason = f"it returned an invalid plan: {objection}"
        return {"outcome": "failed", "reason": reason, "steps": steps}
    return {"outcome": "plan", "steps": steps}


def _objection(problem: Any, plan: Any) -> str | None:
    """Why unified-planning's validator does not take a plan; None if it does."""
    verdict = SequentialPlanValidator().validate(problem, plan)
    if verdict.status is ValidationResultStatus.VALID:
        return None
    return " ".join(message.message for message in verdict.log_messages or ())


def _validate(request: dict[str, Any]) -> Answer:
    """What a validator says of somebody else's plan."""
    domain, steps = request["domain"], request["validate"]
    if needs_direct(domain):
        return validated_directly(domain, request["problem"], steps)
    problem = _read(domain, request["problem"])
    if not SequentialPlanValidator.supports(problem.kind):
        return validated_directly(domain, request["problem"], steps)
    by = "unified-planning"
    actions = {action.name.lower(): action for action in problem.actions}
    objects = {object_.name.lower(): object_ for object_ in problem.all_objects}
    try:
        plan = SequentialPlan(
            [
                ActionInstance(actions[name.lower()], [objects[a.lower()] for a in given])
                for name, *given in steps
            ]
        )
    except KeyError as error:
        return {"outcome": "invalid", "by": by, "reason": f"the task has no {error}"}
    objection = _objection(problem, plan)
    if objection is None:
        return {"outcome": "valid", "by": by}
    return {"outcome": "invalid", "by": by, "reason": objection}
