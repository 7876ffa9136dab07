"""What is to be done: a problem, and how to search for its plan."""

from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from crow.problem import Problem


@dataclass(frozen=True, slots=True, kw_only=True)
class Configuration:
    """How to plan: the arguments of `crow.plan`, and a name for tables, which may be empty.

    Raises ValueError for an engine or heuristic that is not one, and a limit that is not positive.
    """

    engine: str = "auto"
    h: str = "ff"
    seed: int = 0
    time_limit: float | None = None
    node_limit: int | None = None
    depth_limit: int | None = None
    draw_limit: int | None = None
    memory_limit_mb: int | None = None
    optimal: bool = False
    name: str = ""

    def __post_init__(self) -> None:
        from crow.planning import ENGINES, HEURISTICS

        if self.engine not in ENGINES:
            raise ValueError(f"no engine `{self.engine}`; there are {', '.join(ENGINES)}")
        if self.h not in HEURISTICS:
            raise ValueError(f"no heuristic `{self.h}`; there are {', '.join(HEURISTICS)}")
        for limit in ("time_limit", "node_limit", "draw_limit", "memory_limit_mb"):
            value = getattr(self, limit)
            if value is not None and not 0 < value < float("inf"):
                raise ValueError(f"`{limit}` has to be positive, not {value!r}")

    def options(self) -> dict[str, Any]:
        """The arguments of `crow.planning.Planning`."""
        return {f.name: getattr(self, f.name) for f in fields(self) if f.name != "name"}

    @property
    def label(self) -> str:
        """The name, or what differs from the defaults, but for the seed: runs of one kind."""
        if self.name:
            return self.name
        told = {f.name: getattr(self, f.name) for f in fields(self) if f.name not in _UNTOLD}
        defaults = {f.name: f.default for f in fields(self)}
        parts = [f"{name}={value}" for name, value in told.items() if value != defaults[name]]
        return " ".join([self.engine, *parts])

    def json(self) -> dict[str, Any]:
        """What differs from the defaults, and the engine."""
        own = {f.name: getattr(self, f.name) for f in fields(self)}
        defaults = {f.name: f.default for f in fields(self)}
        return {k: v for k, v in own.items() if k == "engine" or v != defaults[k]}


_UNTOLD = frozenset(("engine", "seed", "name"))


@dataclass(frozen=True, slots=True)
class Task:
    """One search. `key` tells it from others in what is recorded; the problem's name if empty."""

    problem: "Problem"
    configuration: Configuration = field(default_factory=Configuration)
    key: str = ""
