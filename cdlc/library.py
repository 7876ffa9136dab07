"""The functions that `import cdlc` offers."""

from dataclasses import dataclass
from os import PathLike, fspath
from typing import TYPE_CHECKING

from cdlc import driver
from cdlc.diagnostics import Diagnostic
from crow.program import Expression, ProblemStatement, Program

if TYPE_CHECKING:
    from unified_planning.model import Problem as UpProblem

    from cdlc.backends.hddl import HddlTask
    from cdlc.backends.pddl import PddlTask
    from crow.domain import Domain
    from crow.problem import Problem
    from crow.program.triples import Triple

Path = str | PathLike[str]


@dataclass(frozen=True)
class Compiled:
    """A domain, and a problem if one was given, without errors."""

    _compilation: driver.Compilation

    @property
    def program(self) -> Program:
        """The typed program."""
        return self._compilation.program

    @property
    def problem(self) -> ProblemStatement | None:
        """The typed problem, if one was given."""
        return self._compilation.statement

    @property
    def warnings(self) -> tuple[Diagnostic, ...]:
        """What was found and does not stop the compiler, in source order."""
        return self._compilation.found.sorted()

    def hoare(self, behavior: str) -> "Triple":
        """Precondition and effect of a behavior (App. D.5).

        Raises KeyError for a name that is no behavior with an effect, CompileError for a program
        that has no Hoare model in this version.
        """
        return {triple.behavior: triple for triple in self._compilation.triples}[behavior]

    def weakest_precondition(self, behavior: str, condition: str) -> Expression:
        """What must hold before a behavior for a condition over its parameters to hold after it.

        `condition` is CDL text. The behavior's own precondition is not part of the result; where
        its body leaves a choice, the result is enough whichever way is taken. Raises KeyError for a
        name that is no behavior with an effect, ValueError for text that is no condition, and
        CompileError for a program that has no Hoare model in this version.
        """
        from cdlc.plans.traces import read_condition

        compilation = self._compilation
        triples = [t for t in compilation.triples if t.behavior == behavior]
        if not triples:
            raise KeyError(behavior)
        model, found = compilation.model, []
        for triple in triples:
            types = {p.name: p.type for p in triple.parameters}
            checked = read_condition(condition, types, compilation.domain)
            formula = model.formula(checked, triple.parameters)
            found.append(model.weakest_precondition(formula, triple))
        return model.pool.conjunction(found)

    def task(self) -> "Problem":
        """The problem as `crow.plan` takes it, its initial state computed.

        Raises CompileError when the initial state has no value or the program needs values chosen.
        """
        return self._compilation.plannable

    def pddl(self) -> "PddlTask":
        """The PDDL: `.domain` and, where there is a problem, `.problem` are texts.

        Raises CompileError for a program that is not discrete.
        """
        return self._compilation.pddl

    def hddl(self) -> "HddlTask":
        """The HDDL, tasks and methods beside the actions: `.domain` and `.problem` are texts.

        Raises CompileError for a program that is not discrete, or has numbers.
        """
        return self._compilation.hddl

    def up(self) -> "UpProblem":
        """The task as a `unified_planning.model.Problem`; needs a problem and that library.

        Raises CompileError for a program that is not discrete, ValueError as `to_up` does.
        """
        from cdlc.backends.up import to_up

        return to_up(self._compilation.pddl)


def load(path: Path, functions: object = None) -> "Domain":
    """A domain to state problems for in Python, as `crow.Problem` takes it.

    `functions` is the Python of external functions: a module, a file, a mapping from names, or an
    object with decorated methods. Raises CompileError, which holds every diagnostic, if there are
    errors, and crow.FunctionsError for Python that cannot be run.
    """
    from cdlc.plans.stated import Text
    from crow.domain import Domain

    compilation = driver.compilation([fspath(path)])
    compilation.functions = functions
    return Domain(compilation.program, Text(compilation.domain), compilation.registered)


def load_problem(path: Path, functions: object = None) -> "Problem":
    """The problem of a CDL file, with the domain that it names.

    `functions` is as for `load`. Raises CompileError, which holds every diagnostic, if there are
    errors or the file states no problem, and crow.FunctionsError for Python that cannot be run.
    """
    compilation = driver.problem_compilation([fspath(path)])
    compilation.functions = functions
    return compilation.plannable


def check(path: Path) -> tuple[Diagnostic, ...]:
    """Everything that is wrong with a domain or problem file, warnings too, in source order."""
    compilation = driver.compilation([fspath(path)])
    try:
        _ = compilation.checked
    except driver.CompileError as error:
        return error.diagnostics
    return compilation.found.sorted()


def compile(  # noqa: A001 - the natural name
    domain: Path, problem: Path | None = None, functions: object = None
) -> Compiled:
    """Compile a domain or problem file, or a problem with another domain than it names.

    `functions` is the Python of external functions: a module, a file, a mapping from names, or an
    object with decorated methods. Raises CompileError, which holds every diagnostic, if there are
    errors, and crow.FunctionsError for Python that cannot be run.
    """
    files = [fspath(domain)] + ([] if problem is None else [fspath(problem)])
    compilation = driver.compilation(files)
    _ = compilation.checked
    compilation.functions = functions
    return Compiled(compilation)
