"""The two answers to a problem: a PDDL engine's, replayed, and the runtime's, validated as PDDL."""

from collections.abc import Callable
from typing import Any

from cdlc.backends.engines import (
    EngineFailed,
    EngineMissing,
    EngineResult,
    EngineStatus,
    installed,
    solve,
    validate,
)
from cdlc.backends.pddl import PddlTask
from cdlc.backends.pddl.inverse import NoAction, TooManyWays, to_pddl_plan
from cdlc.backends.pddl.solve import InvalidPlan, replayed
from cdlc.crosscheck.results import Side
from crow.plan import Result
from crow.planning import ENGINES, Planning
from crow.problem import Problem
from crow.results import LimitReached


def engine_for(task: PddlTask) -> str:
    """The engine for a task where none is given: Kairos for numbers, else Fast Downward.

    Raises EngineMissing if neither is installed.
    """
    has_numbers = ":numeric-fluents" in task.domain
    fitting = ("kairos",) if has_numbers else ("fast-downward", "kairos")
    there = [engine for engine in fitting if engine in installed()]
    if not there:
        raise EngineMissing(fitting[0], 'pip install "cdlc[planners]"')
    return there[0]


def ask_planner(task: PddlTask, problem: Problem, engine: str, seconds: float) -> Side:
    """What an engine finds within a time limit; its plan is mapped back and replayed.

    Raises EngineMissing, EngineUnsupported, and EngineFailed for an engine without an answer.
    """
    assert task.problem is not None
    if task.is_hopeless:
        return Side(Result("unsolvable", engine, statistics={"seconds": 0.0}))
    try:
        solved = solve(task.domain, task.problem, engine=engine, time_limit=seconds)
    except EngineFailed as failed:
        if not failed.steps:
            raise
        fault = f"the plan of {engine} is none of the emitted PDDL: {failed.reason}"
        return Side(Result("plan", engine), failed.steps, fault)
    try:
        result = replayed(task, problem, solved)
    except InvalidPlan as invalid:
        fault = f"the plan of {engine} does not replay: {invalid}"
        return Side(_unmapped(solved), solved.steps, fault)
    return Side(result, solved.steps, stop=_stop(result, seconds, None))


def _unmapped(solved: EngineResult) -> Result:
    assert solved.status is EngineStatus.PLAN
    return Result("plan", solved.engine, statistics={"seconds": round(solved.seconds, 3)})


def ask_program(
    task: PddlTask,
    problem: Problem,
    seconds: float,
    nodes: int | None,
    on_progress: Callable[[dict[str, Any]], None],
) -> Side:
    """What the runtime finds within limits; its plan is put into PDDL and validated.

    Raises EngineMissing, EngineUnsupported and EngineFailed as `validate` does.
    """
    planning = Planning(problem, time_limit=seconds, node_limit=nodes, on_progress=on_progress)
    try:
        result = planning.first()
    except AssertionError as broken:  # its own plans are replayed, and this one does not
        fault = f"the runtime fails: {broken}"
        return Side(Result("plan", planning.name, statistics=planning.statistics()), fault=fault)
    if result.status != "plan":
        return Side(result, stop=_stop(result, seconds, nodes))
    return _validated(task, problem, result, seconds)


def _validated(task: PddlTask, problem: Problem, result: Result, seconds: float) -> Side:
    assert task.problem is not None
    try:
        steps = to_pddl_plan(task, problem, result)
    except NoAction as error:
        return Side(result, fault=f"the program's plan is none of the emitted PDDL: {error}")
    except TooManyWays as error:
        return Side(result, unchecked=str(error))
    if task.is_hopeless:
        return Side(result, steps, fault="the program reaches a goal that PDDL says is never true")
    verdict = validate(task.domain, task.problem, steps, time_limit=seconds)
    if verdict is None:
        unchecked = f"the validator stopped at the time limit of {seconds:g} s"
        return Side(result, steps, unchecked=unchecked)
    if verdict.is_valid:
        return Side(result, steps)
    fault = f"the program's plan is none of the emitted PDDL, by {verdict.by}: {verdict.reason}"
    return Side(result, steps, fault)


def second_opinion(
    problem: Problem, seconds: float, nodes: int | None, on_progress: Callable[[Any], None]
) -> Result:
    """What the runtime's reference engine says; it shares nothing with the other's search."""
    return Planning(
        problem, "reference", time_limit=seconds, node_limit=nodes, on_progress=on_progress
    ).first()


def _stop(result: Result, seconds: float, nodes: int | None) -> str:
    """At which limit a search stopped, in words; empty for one that came to an end."""
    who = "the program's search" if result.engine in ENGINES else result.engine
    match result:
        case LimitReached(limits=limits):
            told = {"nodes": f"at the node limit of {nodes}", "commit": "behind a `commit`"}
            named = [told.get(limit, f"at the {limit} limit") for limit in limits]
            return f"{who} stopped {' and '.join(named)}"
        case Result(status="limit"):
            return f"{who} gave up without a proof"
        case Result(status="timeout"):
            return f"{who} stopped at the time limit of {seconds:g} s"
        case Result(status="memory"):
            return f"{who} ran out of memory"
        case _:
            return ""
