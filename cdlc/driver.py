"""The pipeline on one page: a Compilation computes each stage once, when it is first asked for."""

import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from cdlc.diagnostics import Collector, Diagnostic
from cdlc.frontend import errors
from cdlc.frontend.check import CheckedDomain, CheckedProblem, check_domain, check_problem
from cdlc.frontend.depth import MAX_DEPTH
from cdlc.frontend.loader import EMPTY_DOMAIN, STANDARD_INPUT, Files, beside, title
from cdlc.ir.lints import lint
from cdlc.ir.nodes import Level
from cdlc.source import SourceFile
from crow.program import Location, ProblemStatement, Program

if TYPE_CHECKING:
    from cdlc.backends.hddl import HddlTask
    from cdlc.backends.pddl import PddlTask
    from cdlc.ir.hoare import Model
    from crow.functions import Registered
    from crow.problem import Problem
    from crow.program.triples import Triple


class CompileError(Exception):
    """The input has errors: `diagnostics` are all of them, `sources` the texts they point into."""

    def __init__(
        self, diagnostics: tuple[Diagnostic, ...], sources: Mapping[str, SourceFile]
    ) -> None:
        super().__init__(diagnostics, sources)
        self.diagnostics = diagnostics
        self.sources = sources

    def __str__(self) -> str:
        from cdlc.render import as_text

        return as_text(self.diagnostics, self.sources).rstrip()


def read_standard_input() -> bytes:
    """Standard input as it is."""
    return sys.stdin.buffer.read()


@dataclass
class Compilation:
    """A domain, a problem, or a problem with another domain than it names, through all stages.

    Each stage raises CompileError if it or an earlier one finds errors. Warnings are in `found`.
    """

    domain_file: str | None = None
    problem_file: str | None = None
    found: Collector = field(default_factory=Collector)
    read_standard_input: Callable[[], bytes] = read_standard_input
    level: Level = Level.BASIC
    axioms: bool = False
    enumerates: bool = False
    functions: object = None
    """Python for external functions: a module, a file, a mapping or an object."""

    @cached_property
    def files(self) -> Files:
        """The files read so far."""
        return Files(self.found, self.read_standard_input)

    @cached_property
    def checked(self) -> CheckedProblem | CheckedDomain:
        """The typed program, with the problem if there is one. Reports every mistake."""
        checked = None
        try:
            checked = self._check_problem() if self.problem_file else self._check_domain()
            if checked is not None and not self.found.has_errors:
                problem = checked.problem if isinstance(checked, CheckedProblem) else None
                included = frozenset(self.files.included)
                lint(_domain_of(checked).program, self.found, problem, included)
        except RecursionError:  # the caller's stack was nearly full, since depth is bounded
            start = Location(self.problem_file or self.domain_file or "", 1, 1, 1, 1)
            self.found.add(errors.NestingTooDeep(location=start, limit=MAX_DEPTH))
        self._stop_at_errors()
        assert checked is not None
        return checked

    @property
    def domain(self) -> CheckedDomain:
        """The checked domain, with its names."""
        return _domain_of(self.checked)

    @property
    def program(self) -> Program:
        """The typed program of the domain."""
        return self.domain.program

    @property
    def statement(self) -> ProblemStatement | None:
        """The typed problem, where there is one."""
        checked = self.checked
        return checked.problem if isinstance(checked, CheckedProblem) else None

    @cached_property
    def registered(self) -> "Registered":
        """The Python of the program. Raises crow.FunctionsError for what cannot be run."""
        from cdlc.backends.functions import checked

        registered = checked(self.program, self.functions, self.found)
        self._stop_at_errors()
        assert registered is not None
        return registered

    @cached_property
    def problem(self) -> "Problem":
        """The problem with its initial state computed, ready to plan or to replay in."""
        from cdlc.backends.crow import to_runtime
        from cdlc.backends.functions import tabulated_problem

        assert self.statement is not None
        with self.reporting():
            problem = to_runtime(self.program, self.statement, self.found, self.registered)
            if problem is not None and self.tabulated is not self.program:
                problem = tabulated_problem(problem)
        self._stop_at_errors()
        assert problem is not None
        return problem

    @contextmanager
    def reporting(self) -> "Iterator[None]":
        """Raise CompileError where Python of the user fails in what is done within."""
        from crow.calls import FunctionError

        try:
            yield
        except FunctionError as error:
            from cdlc.backends.functions import failed

            raise CompileError((*self.found.sorted(), failed(error)), self.sources) from None

    @cached_property
    def tabulated(self) -> Program:
        """The program, external functions of objects that are given in Python as features."""
        if self.functions is None:
            return self.program
        from cdlc.backends.functions import tabulated

        return tabulated(self.program, self.registered)

    @cached_property
    def plannable(self) -> "Problem":
        """The problem, with a program that the runtime's planner covers."""
        return self.plannable_by("auto")

    def plannable_by(self, engine: str) -> "Problem":
        """The problem, with a program that an engine of the runtime covers."""
        from cdlc.backends.crow import check_plannable

        problem = self.problem
        check_plannable(problem, self.found, engine)
        self._stop_at_errors()
        return problem

    @cached_property
    def model(self) -> "Model":
        """The formulas of the program."""
        from cdlc.ir.hoare import Model

        return Model(self.tabulated, self.level)

    @cached_property
    def triples(self) -> "tuple[Triple, ...]":
        """The Hoare model of every behavior that has an effect."""
        from cdlc.ir.model import triples as model_triples

        triples = model_triples(self.model, self.found)
        self._stop_at_errors()
        return triples

    @cached_property
    def pddl(self) -> "PddlTask":
        """The PDDL of the domain and, if there is one, of the problem."""
        from cdlc.backends.pddl import Emission, to_pddl

        self._refuse_simulated()
        problem = self.problem if self.statement is not None else None
        emission = Emission(self.axioms, self.enumerates)
        task = to_pddl(self.model, problem, self.found, emission)
        self._stop_at_errors()
        assert task is not None
        return task

    def _refuse_simulated(self) -> None:
        from cdlc.backends.functions import report_simulated

        if self.functions is not None:
            report_simulated(self.program, self.registered, self.found)
        self._stop_at_errors()

    @cached_property
    def hddl(self) -> "HddlTask":
        """The HDDL of the domain and, if there is one, of the problem."""
        from cdlc.backends.hddl import to_hddl

        pddl = self.pddl
        task = to_hddl(pddl, None if self.statement is None else self.problem, self.found)
        self._stop_at_errors()
        assert task is not None
        return task

    @cached_property
    def up_text(self) -> str:
        """The task as unified-planning, which has to be installed, writes its problems."""
        from cdlc.backends.up import report_unfit, up_text

        self._require_problem("up")
        task = self.pddl
        report_unfit(task, self.found)
        self._stop_at_errors()
        return up_text(task)

    def _require_problem(self, format_: str) -> None:
        from cdlc.backends.errors import NeedsProblem

        if self.statement is None:
            start = Location(self.domain_file or "", 1, 1, 1, 1)
            self.found.add(NeedsProblem(location=start, format=format_))
        self._stop_at_errors()

    @cached_property
    def planning_task(self) -> "PddlTask":
        """The PDDL, for a planner: refused where its plans would leave out what methods run."""
        from cdlc.backends.pddl.fit import report_unplannable

        task = self.pddl
        report_unplannable(self.tabulated, self.found)
        self._stop_at_errors()
        return task

    @cached_property
    def ir_text(self) -> str:
        """The typed program, the problem if there is one, and the Hoare model, as JSON."""
        import json

        from cdlc.ir.model import carried
        from crow.program.codec import encode
        from crow.program.model_codec import encode_model

        document = encode(self.program, self.statement)
        document["model"] = encode_model(carried(self.model))
        return json.dumps(document, indent=1) + "\n"

    @cached_property
    def hoare_text(self) -> str:
        """The Hoare model in the style of Appendix D.5."""
        from cdlc.ir.text import hoare_text

        return hoare_text(self._writable_triples)

    @cached_property
    def hoare_explanation(self) -> str:
        """The Hoare model as text, with the statements that each part of it comes from."""
        from cdlc.ir.explanation import explanation

        return explanation(self._writable_triples, self.sources)

    @cached_property
    def hoare_json(self) -> str:
        """The Hoare model as JSON (schemas/hoare.json); its size is linear in the graph."""
        import json

        from crow.program.codec import VERSION
        from crow.program.model_codec import encode_model
        from crow.program.triples import HoareModel

        model = HoareModel(str(self.level), self.triples)
        return json.dumps({"version": VERSION, "model": encode_model(model)}, indent=1) + "\n"

    @property
    def _writable_triples(self) -> "tuple[Triple, ...]":
        from cdlc.ir.model import writable

        writable(self.triples, self.found)
        self._stop_at_errors()
        return self.triples

    @property
    def sources(self) -> Mapping[str, SourceFile]:
        """The texts that diagnostics point into."""
        return self.files.sources

    def _stop_at_errors(self) -> None:
        if self.found.has_errors:
            raise CompileError(self.found.sorted(), self.sources)

    def _check_domain(self) -> CheckedDomain | None:
        assert self.domain_file is not None
        module = self.files.load(self.domain_file)
        if module is None:
            return None
        if (problem := title(module, "problem")) is not None:
            location = self.sources[self.domain_file].location(problem.span)
            self.found.add(errors.WrongFileKind(location=location, is_a="problem", wanted="domain"))
            return None
        definitions = list(self.files.definitions(self.domain_file))
        return check_domain(_stem(self.domain_file), definitions, self.found)

    def _check_problem(self) -> CheckedProblem | None:
        assert self.problem_file is not None
        module = self.files.load(self.problem_file)
        if module is None:
            return None
        source = self.sources[self.problem_file]
        start = Location(source.name, 1, 1, 1, 1)
        if title(module, "problem") is None:
            if module.definitions:
                wrong = errors.WrongFileKind(location=start, is_a="domain", wanted="problem")
                self.found.add(wrong)
            return None
        domain_file = self._domain_of_problem(start)
        if domain_file is None:
            return None
        domain = [] if domain_file == EMPTY_DOMAIN else list(self.files.definitions(domain_file))
        name = _stem(domain_file)
        own = list(self.files.definitions(self.problem_file))
        checked = check_problem(own, name, domain, self.found)
        if checked is None and not self.found.has_errors:
            missing = errors.MissingPart(location=start, part="goal", example="goal: …")
            self.found.add(missing)
        return checked

    def _domain_of_problem(self, start: Location) -> str | None:
        """The domain's file, loaded: the one given, else the one the problem names."""
        assert self.problem_file is not None
        module = self.files.modules[self.problem_file]
        named = title(module, "domain")
        wanted_by = None
        domain_file = self.domain_file
        if domain_file is None and named is not None:
            wanted_by = self.sources[self.problem_file].location(named.span)
            is_empty = named.text == EMPTY_DOMAIN
            domain_file = EMPTY_DOMAIN if is_empty else beside(self.problem_file, named.text)
        if named is not None and not named.text and self.found.has_errors:
            return None  # its name could not be read
        if domain_file is None:
            example = 'domain "file.cdl"'
            self.found.add(errors.MissingPart(location=start, part="domain", example=example))
            return None
        if domain_file == EMPTY_DOMAIN:
            return domain_file
        loaded = self.files.load(domain_file, wanted_by)
        if loaded is None:
            return None
        if (problem := title(loaded, "problem")) is not None:
            location = self.sources[domain_file].location(problem.span)
            self.found.add(errors.WrongFileKind(location=location, is_a="problem", wanted="domain"))
            return None
        return domain_file


def compilation(
    files: list[str],
    found: Collector | None = None,
    read_standard_input: Callable[[], bytes] = read_standard_input,
) -> Compilation:
    """The compilation of `DOMAIN`, `PROBLEM` or `DOMAIN PROBLEM`.

    One file alone is a problem if it says so in its text, else a domain.
    """
    collector = Collector() if found is None else found
    if len(files) == 2:
        return Compilation(files[0], files[1], collector, read_standard_input)
    single = Compilation(files[0], None, collector, read_standard_input)
    module = single.files.load(files[0])
    if module is not None and title(module, "problem") is not None:
        single.domain_file, single.problem_file = None, files[0]
    return single


def problem_compilation(files: list[str]) -> Compilation:
    """The compilation of `PROBLEM` or `DOMAIN PROBLEM`; a domain in its place is reported."""
    return Compilation(files[0] if len(files) == 2 else None, files[-1])


def _domain_of(checked: CheckedProblem | CheckedDomain) -> CheckedDomain:
    return checked.domain if isinstance(checked, CheckedProblem) else checked


def _stem(name: str) -> str:
    return "domain" if name == STANDARD_INPUT else Path(name).stem
