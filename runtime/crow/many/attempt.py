"""One task, carried out: it ends with a result or a fault, whatever it does."""

import traceback
from collections.abc import Callable
from contextlib import ExitStack
from typing import TYPE_CHECKING

from crow.budget import Stopped
from crow.calls import FunctionError
from crow.limits import limited_memory, timer
from crow.many.records import Fault
from crow.many.tasks import Configuration
from crow.plan import Result
from crow.planning import NotPlannable, Planning
from crow.python_files import user_traceback
from crow.results import OutOfMemory, TimedOut

if TYPE_CHECKING:
    from crow.problem import Problem

Outcome = Result | Fault


def attempt(
    problem: "Problem | Callable[[], Problem]",
    configuration: Configuration,
    *,
    is_alone: bool,
    begun: Callable[[], None] = lambda: None,
) -> Outcome:
    """Plan, and turn what is raised into a fault; only KeyboardInterrupt passes.

    `problem` may be a function that loads it. `is_alone` is for processes that do nothing else:
    their timer and the bound of their memory are used. `begun` is called when the search begins.
    """
    try:
        with ExitStack() as at_end:
            if is_alone and configuration.memory_limit_mb is not None:
                at_end.enter_context(limited_memory(configuration.memory_limit_mb))
            return _searched(problem, configuration, begun, is_alone=is_alone)
    except MemoryError:  # outside of the search, which ends by itself
        return OutOfMemory(configuration.engine, seed=configuration.seed)
    except Stopped as stopped:  # by the timer, when the search had just ended
        kind = OutOfMemory if stopped.reason == "memory" else TimedOut
        return kind(configuration.engine, seed=configuration.seed)
    except Exception as error:  # noqa: BLE001 - every task ends with a record
        return fault_of(error)
    except SystemExit as error:  # by the user's Python
        return Fault("function", f"it ended its process with `sys.exit({error.code!r})`")


def _searched(
    problem: "Problem | Callable[[], Problem]",
    configuration: Configuration,
    begun: Callable[[], None],
    *,
    is_alone: bool,
) -> Outcome:
    try:
        loaded = problem() if callable(problem) else problem
    except MemoryError:
        raise
    except Exception as error:  # noqa: BLE001 - modules of the user's raise anything
        told = f"{type(error).__name__}: {error}"
        return Fault("not-loaded", told, user_traceback(error).rstrip())
    begun()
    planning = Planning(loaded, **configuration.options())
    with ExitStack() as at_end:
        has_limits = configuration.time_limit is not None or (
            configuration.memory_limit_mb is not None
        )
        if is_alone and has_limits:
            at_end.enter_context(timer(planning.budget.look))
        result = planning.first()
        planning.budget.end()
    return result


def fault_of(error: Exception) -> Fault:
    """What was raised, as the fault of a record."""
    match error:
        case FunctionError():
            return Fault("function", _placed(error), error.traceback.rstrip())
        case NotPlannable():
            place = "" if error.location is None else f"{error.location}: "
            return Fault("not-plannable", f"{place}{error}")
        case _:
            told = "".join(traceback.format_exception(error)).rstrip()
            return Fault("error", f"{type(error).__name__}: {error}", told)


def _placed(error: FunctionError) -> str:
    """What happened in a call, without the traceback, which stands beside it."""
    return str(error).removesuffix(error.traceback.rstrip()).rstrip()
