"""The engines that unified-planning knows, without importing it."""

from importlib.util import find_spec
from types import MappingProxyType
from typing import Final

from cdlc.backends.engines.result import EngineMissing

# unified-planning's oneshot planners of single-agent tasks and the package each comes in: its
# DEFAULT_ENGINES, repeated here because reading that table imports unified-planning, and one that
# has to be registered.
PACKAGES: Final = MappingProxyType(
    {
        "fast-downward": "up_fast_downward",
        "fast-downward-opt": "up_fast_downward",
        "symk": "up_symk",
        "symk-opt": "up_symk",
        "pyperplan": "up_pyperplan",
        "pyperplan-opt": "up_pyperplan",
        "enhsp": "up_enhsp",
        "enhsp-opt": "up_enhsp",
        "tamer": "up_tamer",
        "lpg": "up_lpg",
        "aries": "up_aries",
        "kairos": "up_kairos",
    }
)
_ALWAYS: Final = ("unified_planning", "psutil")
_IN_EXTRA: Final = (*_ALWAYS, "up_fast_downward", "up_kairos")


def installed() -> tuple[str, ...]:
    """Names for `solve(engine=...)` whose packages can be imported; imports none of them."""
    if any(find_spec(package) is None for package in _ALWAYS):
        return ()
    return tuple(engine for engine, package in PACKAGES.items() if find_spec(package) is not None)


def require(engine: str) -> None:
    """Raise `EngineMissing` if a package that `engine` needs cannot be imported.

    A name that is not in `PACKAGES` passes: a user's `up.ini` may define it, the worker will tell.
    """
    needed = [*_ALWAYS, *filter(None, [PACKAGES.get(engine)])]
    for package in needed:
        if find_spec(package) is None:
            raise EngineMissing(engine, _cure(package))


def _cure(package: str) -> str:
    if package in _IN_EXTRA:
        return 'pip install "cdlc[planners]"'
    return f"pip install {package.replace('_', '-')}"
