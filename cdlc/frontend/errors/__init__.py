"""Every message of the frontend, a module a topic. The docstring of a kind is its page.

The modules are imported with the first problem found: files without any are checked sooner.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from cdlc.frontend.errors.files import (
        EmptyFile,
        IncludeCycle,
        LineTooLong,
        NotText,
        UnreadableFile,
    )
    from cdlc.frontend.errors.layout import (
        ExpectedBlock,
        InconsistentIndentation,
        NestingTooDeep,
        TabInIndentation,
        UnclosedBracket,
        UnexpectedIndentation,
        UnmatchedBracket,
    )
    from cdlc.frontend.errors.loops import (
        MissingReturn,
        OuterLocal,
        OutsideLoop,
        PossibleWriteConflict,
        RangeNotConstant,
        ReturnInForeach,
        UnrollLimit,
        WriteConflict,
    )
    from cdlc.frontend.errors.names import (
        BadAnnotation,
        DuplicateDefinition,
        HidesDefinition,
        Shadowing,
        UnknownAnnotation,
        UnknownCommand,
        UnknownFeature,
        UnknownName,
        UnknownPragma,
        UnknownType,
        WrongKind,
    )
    from cdlc.frontend.errors.pddl import PddlName, PddlSyntax, PddlUnsupported
    from cdlc.frontend.errors.problems import (
        MisplacedPart,
        MissingPart,
        OutOfBounds,
        WrongFileKind,
    )
    from cdlc.frontend.errors.statements import (
        BadDirection,
        CallForIndex,
        DuplicateSection,
        EqualsInGoal,
        MisplacedPromotable,
        MisplacedSection,
        MisplacedStatement,
        MissingSection,
        NotAssignable,
        NotPromotable,
        RecursiveCall,
        UnsupportedGoal,
    )
    from cdlc.frontend.errors.syntax import (
        Elision,
        MissingColon,
        ReservedWord,
        SyntaxError_,
        WhileLoop,
    )
    from cdlc.frontend.errors.types import (
        MissingType,
        NotAnObjectType,
        NotComparable,
        NumberTooLarge,
        TypeCycle,
        UninferableParameter,
        ValueIndex,
        WrongArgumentCount,
        WrongArgumentType,
        WrongType,
    )

_TOPICS = ("files", "layout", "loops", "names", "pddl", "problems", "statements", "syntax", "types")

__all__ = [
    "load",
    # reading files
    "UnreadableFile",
    "NotText",
    "EmptyFile",
    "LineTooLong",
    "IncludeCycle",
    # lines and indentation
    "TabInIndentation",
    "InconsistentIndentation",
    "UnexpectedIndentation",
    "ExpectedBlock",
    "UnclosedBracket",
    "UnmatchedBracket",
    "NestingTooDeep",
    # the grammar
    "SyntaxError_",
    "MissingColon",
    "ReservedWord",
    "WhileLoop",
    "Elision",
    # names and annotations
    "UnknownName",
    "UnknownFeature",
    "UnknownType",
    "UnknownCommand",
    "DuplicateDefinition",
    "HidesDefinition",
    "Shadowing",
    "WrongKind",
    "UnknownAnnotation",
    "BadAnnotation",
    "UnknownPragma",
    # types
    "WrongArgumentCount",
    "WrongArgumentType",
    "WrongType",
    "NotComparable",
    "NotAnObjectType",
    "ValueIndex",
    "TypeCycle",
    "UninferableParameter",
    "MissingType",
    "NumberTooLarge",
    # statements and sections
    "MisplacedStatement",
    "MisplacedPromotable",
    "NotPromotable",
    "DuplicateSection",
    "MisplacedSection",
    "UnsupportedGoal",
    "EqualsInGoal",
    "CallForIndex",
    "NotAssignable",
    "RecursiveCall",
    "MissingSection",
    "BadDirection",
    # problem files
    "MissingPart",
    "MisplacedPart",
    "OutOfBounds",
    "WrongFileKind",
    # PDDL that is imported
    "PddlSyntax",
    "PddlName",
    "PddlUnsupported",
    # loops, and what is left of data-obliviousness
    "RangeNotConstant",
    "UnrollLimit",
    "OuterLocal",
    "OutsideLoop",
    "WriteConflict",
    "PossibleWriteConflict",
    "MissingReturn",
    "ReturnInForeach",
]


def load() -> None:
    """Import every kind, so that `Diagnostic.kinds` lists them."""
    for topic in _TOPICS:
        kinds = vars(import_module(f"{__name__}.{topic}"))
        globals().update({name: kinds[name] for name in __all__ if name in kinds})


# Not for the type checker, which would take any name for one of this module.
if not TYPE_CHECKING:

    def __getattr__(name: str) -> Any:
        if name not in __all__:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        load()
        return globals()[name]
