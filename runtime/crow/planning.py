"""Behind `crow.plan` and `crow.plans`: a problem to its plans, or to why there are none.

Deepening goes in rounds: round k refines up to depth k, until a plan is found, nothing deeper is
left, or a limit is reached. Each plan is replayed by `crow.replay` before it is handed over.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Protocol

from crow.budget import Budget, Progress, Stopped
from crow.evaluate import evaluate
from crow.explanation import at_the_start
from crow.plan import Result, Step
from crow.problem import Problem
from crow.program import Commit, Location
from crow.program.walk import statements_within
from crow.refinement import Refinement
from crow.replay import Replay, replay_to_goal
from crow.results import LimitReached, OutOfMemory, Plan, TimedOut, Unsolvable
from crow.support import OF_OBJECTS
from crow.trace import Trace

if TYPE_CHECKING:
    from crow.search.optimal import Cheapest

ENGINES = ("auto", "best", "iddfs", "iw", "reference")
"""The engines of the runtime; `auto` is `iddfs` and `best` by turns."""

HEURISTICS = ("ff", "add")
"""What `h` may name for best-first search: the size of a relaxed plan, or costs added up."""

_RESERVE = 1 << 20
"""Bytes kept back for what is to be told when there is no memory left."""

Found = tuple[tuple[Step, ...], Trace]


class NotPlannable(ValueError):  # noqa: N818 - about the program, not about a failure
    """The program needs what the engine does not have; `location` is where it says so.

    `engine` is None where no other has it either.
    """

    def __init__(self, construct: str, location: Location | None, engine: str | None) -> None:
        super().__init__(
            f"planning does not cover {construct}"
            if engine is None
            else f"the engine `{engine}` does not cover {construct};"
            " `auto`, `iddfs` and `iw` draw values"
        )
        self.construct = construct
        self.location = location


class Engine(Protocol):
    """An engine with one problem to search."""

    def plans(self) -> Iterator[Found | None]:
        """The plans, some more than once, with None in between. Raises Stopped."""

    def left_out(self) -> tuple[str, ...]:
        """The limits that kept the search from trying everything, once it has ended."""

    def statistics(self) -> dict[str, Any]:
        """Figures so far."""

    def explanation(self) -> str | None:
        """What failed, farthest on the way to the goal."""

    def refinement(self) -> Refinement:
        """How the plan that was found last refines the goal; without one, how far it came."""


class Planning:
    """One search for the plans of a problem.

    Limits are None for none; `depth_limit` is the deepest round. The result is the same for the
    same engine and node limit; `seed` is kept for engines that draw values. With `optimal`, `first`
    goes on for the cheapest plan until none can be cheaper or a limit is reached.
    """

    def __init__(
        self,
        problem: Problem,
        engine: str = "auto",
        *,
        h: str = "ff",
        seed: int = 0,
        time_limit: float | None = None,
        node_limit: int | None = None,
        depth_limit: int | None = None,
        draw_limit: int | None = None,
        memory_limit_mb: int | None = None,
        on_progress: Progress | None = None,
        optimal: bool = False,
    ) -> None:
        if engine not in ENGINES:
            raise ValueError(f"no engine `{engine}`; there are {', '.join(ENGINES)}")
        if h not in HEURISTICS:
            raise ValueError(f"no heuristic `{h}`; there are {', '.join(HEURISTICS)}")
        if (missing := problem.world.unsupported) is not None:
            raise NotPlannable(missing.construct, missing.location, None)
        if engine in OF_OBJECTS and (missing := problem.world.chosen_value) is not None:
            raise NotPlannable(missing.construct, missing.location, engine)
        self.problem = problem
        self.name = engine
        self.seed = seed
        self.budget = Budget(time_limit, node_limit, memory_limit_mb, on_progress)
        self.depth_limit = depth_limit
        self.optimal = optimal
        self.cheapest: Cheapest | None = None
        self.end: Result | None = None
        self._make: Callable[[], Engine] = lambda: _engine(
            problem, engine, self._check, depth_limit, h, seed, draw_limit
        )
        self._engine: Engine | None = None
        self._tree: Refinement | None = None

    def plans(self) -> Iterator[Plan]:
        """Each plan, once; after the last, `end` says why there are no more."""
        found = self._plans()
        while True:
            with self.budget.running():
                plan = next(found, None)
            if plan is None:
                return
            yield plan

    def _plans(self) -> Iterator[Plan]:
        reserve = [bytearray(_RESERVE)]
        try:
            yield from self._each()
        except Stopped as stopped:
            self.budget.end()
            self.end = self._stopped(stopped.reason)
        except MemoryError:
            reserve.clear()  # what is told of the search takes some
            self.budget.end()
            self.end = self._stopped("memory")

    def _each(self) -> Iterator[Plan]:
        """The plans; making the engine compiles the program, which may take its time too."""
        seen = set()
        self._engine = engine = self._make()
        for found in engine.plans():
            if found is None:
                continue
            key = _identity(found[0])
            if key not in seen:
                seen.add(key)
                yield self._plan(*found)
        left_out = engine.left_out()
        self.end = self._limit(*left_out) if left_out else self._unsolvable()

    def first(self) -> Result:
        """The first plan, or the cheapest; or the typed result that says why there is none."""
        plans = self.plans()
        found = next(plans, None)
        if found is None:
            assert self.end is not None
            return self.end
        if not self.optimal:
            return found
        self._tree = self._last()
        world = self.problem.world
        if self.name == "reference" or world.chosen_value or _commits(self.problem):
            return self._cheapest_of(found, plans)
        return self._improved(found)

    def statistics(self) -> dict[str, Any]:
        """Figures so far."""
        figures = {"nodes": 0} if self._engine is None else self._engine.statistics()
        if self.cheapest is not None:
            figures["nodes"] += self.cheapest.machine.counters.nodes
        return {"seconds": round(self.budget.seconds, 3), **figures}

    def explanation(self) -> str:
        """What failed so far, farthest on the way to the goal."""
        told = None if self._engine is None else self._engine.explanation()
        return told or at_the_start(self.problem).text(self.problem)

    def refinement(self) -> Refinement:
        """How the plan that came last refines the goal; without one, how far the search came.

        Of the cheapest plan, if that was asked for.
        """
        return self._last() if self._tree is None else self._tree

    def _last(self) -> Refinement:
        return Refinement() if self._engine is None else self._engine.refinement()

    def _check(self, nodes: int) -> None:
        self.budget.check(nodes, self.statistics)

    # -------------------------------------------------------------------------------- cheapest plan

    def _cheapest_of(self, best: Plan, plans: Iterator[Plan]) -> Plan:
        """The cheapest plan that an engine enumerates."""
        for plan in plans:
            if _cost_of(plan) < _cost_of(best):
                best, self._tree = plan, self._last()
        match self.end:
            case LimitReached(limits=limits):
                unproved = limits
            case TimedOut():
                unproved = ("time",)
            case OutOfMemory():
                unproved = ("memory",)
            case _:
                unproved = ()
        return replace(best, statistics=self.statistics(), unproved=unproved)

    def _improved(self, best: Plan) -> Plan:
        """The cheapest plan, by branch and bound from one plan on."""
        from crow.search.optimal import Cheapest
        from crow.search.tree import refinement as tree_of

        before = self.statistics()["nodes"]
        search = Cheapest(self.problem, lambda nodes: self._check(before + nodes), self.depth_limit)
        self.cheapest, search.bound = search, _cost_of(best)
        try:
            with self.budget.running():
                for found in search.plans():
                    best = self._plan(*found)
                    search.bound = _cost_of(best)
                    self._tree = tree_of((search.machine,), search.machine)
            unproved = search.left_out()
        except Stopped as stopped:
            unproved = (stopped.reason,)
        except MemoryError:
            unproved = ("memory",)
        return replace(best, statistics=self.statistics(), unproved=unproved)

    def _plan(self, steps: tuple[Step, ...], trace: Trace) -> Plan:
        replayed = replay_to_goal(self.problem, trace, keeps_states=False)
        if replayed.failure is not None:
            failure = replayed.failure
            raise AssertionError(f"no plan: `{failure.condition}`: {failure.reason}")
        cost = self._cost(steps, replayed)
        given = tuple(step.given_out() for step in steps)
        return Plan(self.name, given, trace, cost, self.seed, self.statistics())

    def _cost(self, steps: tuple[Step, ...], replayed: Replay) -> float:
        if self.problem.minimize is not None:
            world = self.problem.world
            return float(evaluate(world, replayed.final, self.problem.minimize, {}))
        return float(sum(step.controller is not None for step in steps))

    # --------------------------------------------------------------------------------- no plan

    def _told(self) -> dict[str, Any]:
        return {
            "seed": self.seed,
            "statistics": self.statistics(),
            "explanation": self.explanation(),
        }

    def _unsolvable(self) -> Result:
        return Unsolvable(self.name, **self._told())

    def _limit(self, *limits: str) -> Result:
        told = self._told()
        told["statistics"]["limits"] = list(limits)
        return LimitReached(self.name, limits=limits, **told)

    def _stopped(self, reason: str) -> Result:
        match reason:
            case "time":
                return TimedOut(self.name, **self._told())
            case "memory":
                return OutOfMemory(self.name, **self._told())
            case _:
                return self._limit(reason)


def _cost_of(plan: Plan) -> float:
    assert plan.cost is not None
    return plan.cost


def _commits(problem: Problem) -> bool:
    """Whether a program keeps some of its plans from being tried."""
    bodies = (s for b in problem.world.program.behaviors for s in statements_within(b.body))
    return any(isinstance(s, Commit) for s in bodies)


def _identity(steps: tuple[Step, ...]) -> tuple[object, ...]:
    return tuple(
        (s.behavior, s.behavior_arguments, frozenset(s.bindings.items()), s.controller, s.arguments)
        for s in steps
    )


def _engine(
    problem: Problem, name: str, check: Any, depth_limit: int | None, heuristic: str,
    seed: int, draw_limit: int | None,
) -> Engine:  # fmt: skip
    from crow.search.strategies import Best, Deepening

    if name == "auto" and problem.world.chosen_value is not None:
        name = "iddfs"

    match name:
        case "reference":
            from crow.reference import ReferenceEngine

            return Deepening(ReferenceEngine(problem, check), depth_limit)
        case "iddfs":
            from crow.search.engine import CrowEngine

            return Deepening(CrowEngine(problem, check, seed=seed), depth_limit, draw_limit)
        case "iw":
            from crow.search.widening import Widening

            return Widening(problem, check, depth_limit, seed=seed, draw_limit=draw_limit)
        case "best":
            return Best(problem, check, depth_limit, heuristic)
        case _:
            return _auto(problem, check, depth_limit, heuristic)


def _auto(problem: Problem, check: Any, depth_limit: int | None, heuristic: str) -> Engine:
    from crow.search.straight import Straight, StraightFirst
    from crow.search.strategies import Auto

    straight = Straight.of(problem, depth_limit)
    if straight is None:
        return Auto(problem, check, depth_limit, heuristic)
    return StraightFirst(
        straight, check, lambda counted: Auto(problem, counted, depth_limit, heuristic)
    )
