"""Domains as users of the library hold them, and compiled programs read from files."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from crow.functions import NOTHING, Registered
from crow.problem import World
from crow.program import Expression, Program
from crow.program.codec import ProgramFormatError, decode_problem, decode_program
from crow.registration import registered
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
        """The problem with what Python functions say about it. Raises crow.FunctionError."""


@dataclass(frozen=True, slots=True)
class Domain:
    """A program to state problems for; `language` reads goals as text, if a compiler loaded it.

    `functions` is the Python that was given for it.
    """

    program: Program
    language: Language | None = None
    functions: Registered = NOTHING


def load(path: str | PathLike[str], functions: object = None) -> Domain:
    """The domain of a compiled program, as `cdlc compile --emit ir` writes it (JSON).

    It takes goals as expressions; `cdlc.load` reads CDL, and its domains take goals as text too.
    `functions` is the Python of the program: a module, a file, a mapping or an object
    (`crow.functions`). Raises OSError, crow.ProgramFormatError for what is no compiled program, and
    crow.FunctionsError for Python that does not fit it.
    """
    program = decode_program(_document(path))
    return Domain(program, functions=registered(program, functions))


def load_problem(path: str | PathLike[str], functions: object = None) -> "Problem":
    """The problem that was compiled together with its domain (JSON).

    `functions` is as for `load`. Raises OSError, crow.ProgramFormatError for what is no compiled
    problem, crow.FunctionsError for Python that does not fit, and crow.evaluate.EvaluationError or
    crow.FunctionError when its initial state cannot be computed.
    """
    from crow.problem import Problem

    document = _document(path)
    program, statement = decode_program(document), decode_problem(document)
    if statement is None:
        raise ProgramFormatError("a program without a problem; `crow.load` reads it")
    return Problem.of(program, statement, registered(program, functions))


def _document(path: str | PathLike[str]) -> object:
    try:
        return json.loads(Path(path).read_text("utf-8"))
    except (UnicodeDecodeError, RecursionError, ValueError) as error:
        raise ProgramFormatError(f"not a compiled program: {error}") from None
