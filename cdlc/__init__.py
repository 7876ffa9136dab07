"""The CDL compiler as a library: check and compile domains and problems.

    import cdlc

    compiled = cdlc.compile("examples/blocks/blocks.cdl")
    print(compiled.pddl().domain)

Nothing here prints, exits or changes global state. See ARCHITECTURE.md for how it is built.
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from cdlc.driver import CompileError
    from cdlc.library import (
        Compiled,
        check,
        compile,  # noqa: A004 - the natural name
        load,
        load_problem,
    )

__all__ = ["check", "compile", "load", "load_problem", "Compiled", "CompileError"]


def __getattr__(name: str) -> Any:
    """Load the compiler when it is first used, so that `import cdlc` costs nothing."""
    if name not in __all__:
        raise AttributeError(f"module `cdlc` has no attribute `{name}`")
    if name == "CompileError":
        from cdlc.driver import CompileError

        return CompileError
    from cdlc import library

    return getattr(library, name)
