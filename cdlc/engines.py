"""`cdlc engines`: the installed planners, what they take, and whether a task fits."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from cdlc.backends.engines import describe
from cdlc.backends.engines.words import in_words, lacks_in_words

if TYPE_CHECKING:
    from cdlc.backends.pddl import PddlTask


@dataclass(frozen=True, slots=True)
class Listed:
    """An engine; `lacks` is None where there is no task to fit."""

    name: str
    takes: tuple[str, ...]
    lacks: tuple[str, ...] | None


def listed(task: "PddlTask | None") -> tuple[Listed, ...]:
    """Every installed engine. Raises EngineFailed if the task cannot be read."""
    if task is None:
        return tuple(Listed(d.name, in_words(d.accepts), None) for d in describe())
    described = describe(task.domain, task.problem)
    return tuple(Listed(d.name, in_words(d.accepts), lacks_in_words(d.lacks)) for d in described)


def as_text(found: tuple[Listed, ...]) -> str:
    """A line an engine, for people."""
    if not found:
        return 'no engine is installed: pip install "cdlc[planners]"\n'
    width = max(len(engine.name) for engine in found)
    return "".join(f"{engine.name:<{width}}  {_said(engine)}\n" for engine in found)


def _said(engine: Listed) -> str:
    if engine.lacks is None:
        return "takes " + ", ".join(engine.takes)
    return "does not take " + ", ".join(engine.lacks) if engine.lacks else "fits"


def as_json(found: tuple[Listed, ...]) -> dict[str, Any]:
    """The `engines --format json` document (schemas/engines.json)."""
    engines: list[dict[str, Any]] = []
    for engine in found:
        entry: dict[str, Any] = {"name": engine.name, "takes": list(engine.takes)}
        if engine.lacks is not None:
            entry |= {"fits": not engine.lacks, "lacks": list(engine.lacks)}
        engines.append(entry)
    return {"version": 1, "engines": engines}
