"""Runs to tasks: a problem file compiled, with a fault if it cannot be."""

from typing import TYPE_CHECKING, Final

from cdlc.bench.suite import Run
from cdlc.driver import Compilation, CompileError
from cdlc.render import as_text
from crow.budget import Budget, Stopped
from crow.functions import FunctionsError, collected
from crow.limits import timer
from crow.many.records import Fault
from crow.many.tasks import Task

if TYPE_CHECKING:
    from cdlc.frontend.syntax import Module
    from cdlc.source import SourceFile
    from crow.functions import Collected
    from crow.problem import Problem

_GRACE: Final = 2.0
"""Seconds beyond a time limit that the user's Python may take while a problem is loaded."""

_MOST_SHARED: Final = 64
"""So many files are kept parsed; a suite in which each problem has its own domain has no end."""


class Loader:
    """Compiles problems one after another; domains they share are parsed once."""

    def __init__(self) -> None:
        self._parsed: dict[str, tuple[Module, SourceFile]] = {}
        self._functions: dict[str, Collected] = {}
        self._last: tuple[tuple[str, str | None, str | None], Problem] | None = None

    def task(self, run: Run) -> Task | Fault:
        """The task of a run, or why there is none."""
        limit = run.configuration.time_limit
        budget = Budget(None if limit is None else limit + _GRACE)
        try:
            with timer(budget.look):
                problem = self._problem(run)
        except CompileError as error:
            return Fault("not-loaded", as_text(error.diagnostics, error.sources).rstrip())
        except FunctionsError as error:
            return Fault("not-loaded", str(error))
        except Stopped:
            return Fault("hung", f"it was not loaded within {limit:g} s and {_GRACE:g} more")
        return Task(problem, run.configuration, run.key)

    def _problem(self, run: Run) -> "Problem":
        """The problem of a run; that of the run before, if it is the same."""
        about = (run.file, run.domain, run.functions)
        if self._last is None or self._last[0] != about:
            self._last = (about, self._compiled(run))
        return self._last[1]

    def _compiled(self, run: Run) -> "Problem":
        compilation = Compilation(run.domain, run.file)
        compilation.functions = self._collected(run.functions)
        own = compilation.files
        for name, (module, source) in self._parsed.items():
            own.modules[name], own.sources[name] = module, source
        with compilation.reporting():
            problem = compilation.plannable
        if len(self._parsed) >= _MOST_SHARED:
            self._parsed = {}
        # What the next problem may name, too; this problem itself it will not.
        self._parsed |= {
            name: (module, own.sources[name])
            for name, module in own.modules.items()
            if name != run.file
        }
        return problem

    def _collected(self, file: str | None) -> "Collected | None":
        """The functions of a file, which is run once."""
        if file is None:
            return None
        if file not in self._functions:
            self._functions[file] = collected(file)
        return self._functions[file]
