"""Domains as users of the library hold them, and compiled programs read from files."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from crow.problem import World
from crow.program import Expression, Program
from crow.program.codec import ProgramFormatError, decode_problem, decode_program
from crow.values import Value

if TYPE_CHECKING:
    from crow.problem import Problem


class Language(Protocol):
    """What a compiler attaches to a domain, so that goals may be text."""

    def expression(
        self, text: str, world: World, values: Mapping[str, Value], *, is_number: bool
    ) -> Expression:
        """A condition, or a number to minimize, about objects and named values.

        Raises crow.ProblemError.
        """

    def prepared(self, problem: "Problem") -> "Problem":
        """The problem with what Python functions say about it. Raises crow.ProblemError."""


@dataclass(frozen=True, slots=True)
class Domain:
    """A program to state problems for; `language` reads goals as text, if a compiler loaded it."""

    program: Program
    language: Language | None = None


def load(path: str | PathLike[str]) -> Domain:
    """The domain of a compiled program, as `cdlc compile --emit ir` writes it (JSON).

    It takes goals as expressions; `cdlc.load` reads CDL, and its domains take goals as text too.
    Raises OSError, and crow.ProgramFormatError for what is no compiled program.
    """
    return Domain(decode_program(_document(path)))


def load_problem(path: str | PathLike[str]) -> "Problem":
    """The problem that was compiled together with its domain (JSON).

    Raises OSError, crow.ProgramFormatError for what is no compiled problem, and
    crow.evaluate.EvaluationError when its initial state cannot be computed.
    """
    from crow.problem import Problem

    document = _document(path)
    program, statement = decode_program(document), decode_problem(document)
    if statement is None:
        raise ProgramFormatError("a program without a problem; `crow.load` reads it")
    return Problem.of(program, statement)


def _document(path: str | PathLike[str]) -> object:
    try:
        return json.loads(Path(path).read_text("utf-8"))
    except (UnicodeDecodeError, RecursionError, ValueError) as error:
        raise ProgramFormatError(f"not a compiled program: {error}") from None
