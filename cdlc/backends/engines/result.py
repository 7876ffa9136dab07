"""What a run of an engine gives: a result, or one of three errors."""

from dataclasses import dataclass
from enum import StrEnum
from typing import ClassVar


@dataclass(frozen=True, slots=True)
class PddlStep:
    """One action of a plan; names are spelled as in the task's PDDL text."""

    action: str
    arguments: tuple[str, ...]


class EngineStatus(StrEnum):
    """How a run ended: `LIMIT` is an engine that gave up without a proof."""

    PLAN = "plan"
    UNSOLVABLE = "unsolvable"
    LIMIT = "limit"
    TIMEOUT = "timeout"
    MEMORY = "memory"


@dataclass(frozen=True, slots=True)
class EngineResult:
    """The end of a run.

    `steps` is empty unless the status is `PLAN`, and may be empty then. `seconds` is wall time over
    the whole run, `log` the end of what the engine printed, at most `LOG_LIMIT` bytes of it; an
    engine stopped by the time limit may leave none.
    """

    status: EngineStatus
    steps: tuple[PddlStep, ...]
    seconds: float
    engine: str
    log: str


@dataclass(frozen=True, slots=True)
class Verdict:
    """What the validator called `by` says of a plan; `reason` is why it is none."""

    by: str
    is_valid: bool
    reason: str = ""


LOG_LIMIT = 8192


@dataclass(frozen=True, slots=True)
class Description:
    """An installed engine: what it takes, by unified-planning's names, and lacks for a task."""

    name: str
    accepts: tuple[str, ...]
    lacks: tuple[str, ...]


class EngineError(Exception):
    """An engine could not be run to an answer; `code` names the kind for users."""

    code: ClassVar[str] = "engine-error"


class EngineMissing(EngineError):  # noqa: N818 - the base class says it
    """The engine, or a package it needs, is not installed; the message names the cure."""

    code = "engine-missing"

    def __init__(self, engine: str, cure: str) -> None:
        super().__init__(engine, cure)
        self.engine, self.cure = engine, cure

    def __str__(self) -> str:
        return f"engine `{self.engine}` is not available: {self.cure}"


class EngineUnsupported(EngineError):  # noqa: N818 - the base class says it
    """The engine does not take this kind of task; `features` are unified-planning's names."""

    code = "engine-unsupported"

    def __init__(self, engine: str, features: tuple[str, ...]) -> None:
        super().__init__(engine, features)
        self.engine, self.features = engine, features

    def __str__(self) -> str:
        from cdlc.backends.engines.words import lacks_in_words

        lacks = ", ".join(lacks_in_words(self.features))
        return f"engine `{self.engine}` does not take {lacks}; see `cdlc engines`"


class EngineFailed(EngineError):  # noqa: N818 - the base class says it
    """The engine crashed, could not read the task, or returned a plan that is not valid.

    `log` is the end of what the engine printed, at most `LOG_LIMIT` bytes; `steps` are those of a
    plan that is not valid.
    """

    code = "engine-failed"

    def __init__(
        self, engine: str, reason: str, log: str, steps: tuple[PddlStep, ...] = ()
    ) -> None:
        super().__init__(engine, reason, log, steps)
        self.engine, self.reason, self.log, self.steps = engine, reason, log, steps

    def __str__(self) -> str:
        return f"engine `{self.engine}` failed: {self.reason}"
