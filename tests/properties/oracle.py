"""The CROW engine held against the reference engine, on one problem up to a depth."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

from crow.planning import Planning, _identity
from crow.problem import Problem
from crow.reference import Refinement, refinements
from crow.reference.programs import Application, Apply
from crow.replay import replay_to_goal
from crow.results import LimitReached, Plan, Result, Unsolvable
from crow.search.engine import CrowEngine

MOST_NODES = 50_000
MOST_FORWARD_NODES = 5_000
"""Nodes of the forward engine without pruning; where it needs more, the reference mostly does."""

ENGINES = (
    ("iddfs", "ff"),
    ("iw", "ff"),
    *((engine, h) for engine in ("best", "auto") for h in ("ff", "add")),
)
"""Engines that prune, with the heuristics that they know."""

Plans = set[tuple[object, ...]]


class OverTheCapError(Exception):
    pass


@dataclass(frozen=True)
class Compared:
    """What was found: the plans, whether there are deeper refinements, the behaviors applied."""

    plans: Plans
    is_cut: bool
    applied: set[str]


@dataclass(slots=True)
class Recorded(Refinement):
    """A refinement that notes which behaviors it applies."""

    applied: set[str] = field(default_factory=set)

    def _application(self, applied: Apply) -> Application | None:
        application = Refinement._application(self, applied)
        if application is not None:
            self.applied.add(applied.behavior.name)
        return application


def capped(count: Callable[[], int], most: int) -> Callable[..., None]:
    def check(*_: object) -> None:
        if count() > most:
            raise OverTheCapError

    return check


def replayed(problem: Problem, found: Iterator[tuple[object, object]]) -> Plans:
    """The plans of an engine, each of which must replay."""
    plans: Plans = set()
    for steps, trace in found:
        failure = replay_to_goal(problem, trace).failure  # type: ignore[arg-type]
        assert failure is None, failure
        plans.add(_identity(steps))  # type: ignore[arg-type]
    return plans


def reference(problem: Problem, depth: int, most: int = MOST_NODES) -> Compared:
    """All plans, by the definition."""
    refinement = Recorded(problem.world, depth)
    refinement.check = capped(lambda: refinement.nodes, most)
    plans = replayed(problem, refinements(problem, refinement))
    return Compared(plans, refinement.is_cut, refinement.applied)


def forward(problem: Problem, depth: int, most: int = MOST_FORWARD_NODES) -> Plans:
    """All plans, by the CROW engine without pruning."""
    engine = CrowEngine(problem, lambda _: None, prunes=False)
    counters = engine.machine.counters
    engine.search.check = capped(lambda: counters.nodes, most)
    return replayed(problem, engine.round(depth))  # type: ignore[arg-type]


def answer(problem: Problem, engine: str, heuristic: str, depth: int) -> Result:
    """What an engine says; no limit but the depth may keep it from a plan."""
    result = Planning(problem, engine, h=heuristic, depth_limit=depth).first()
    assert isinstance(result, Plan | Unsolvable | LimitReached), result
    assert not isinstance(result, LimitReached) or result.limits == ("depth",), result
    return result


def hold_against(expected: Compared, result: Result, told: str) -> None:
    """An answer: a plan where there is one, and one of the reference's."""
    assert isinstance(result, Plan) == bool(expected.plans), (told, result)
    if isinstance(result, Plan):
        assert _identity(result.steps) in expected.plans, (told, result)
    else:
        assert result.explanation, (told, result)


def pruned(problem: Problem, depth: int) -> Plans:
    """The plans that deepening enumerates, round by round."""
    planning = Planning(problem, "iddfs", depth_limit=depth)
    return {_identity(plan.steps) for plan in planning.plans()}


def compare(
    problem: Problem,
    depth: int,
    most: int = MOST_NODES,
    most_forward: int = MOST_FORWARD_NODES,
    engines: tuple[tuple[str, str], ...] = ENGINES,
) -> Compared:
    """Equal plans without pruning, equal answers with it, and every plan one of the reference's.

    Raises OverTheCapError where that takes too long.
    """
    found = forward(problem, depth, most_forward)
    expected = reference(problem, depth, most)
    assert found == expected.plans
    enumerated = pruned(problem, depth)
    assert enumerated <= expected.plans
    assert bool(enumerated) == bool(expected.plans)
    for engine, heuristic in engines:
        hold_against(expected, answer(problem, engine, heuristic, depth), f"{engine} {heuristic}")
    return expected
