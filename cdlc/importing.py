"""`cdlc import`: PDDL files to CDL files."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from cdlc.diagnostics import Collector, Diagnostic
from cdlc.frontend.formatter import format_module
from cdlc.frontend.loader import Files
from cdlc.frontend.pddl.read import read_domain, read_problem
from cdlc.frontend.pddl.translate import Translation
from cdlc.source import SourceFile

DOMAIN_FILE, PROBLEM_FILE = "domain.cdl", "problem.cdl"


@dataclass(frozen=True, slots=True)
class Imported:
    """CDL texts by file name; none where something is wrong with the PDDL."""

    texts: Mapping[str, str]
    diagnostics: tuple[Diagnostic, ...]
    sources: Mapping[str, SourceFile]


def import_pddl(
    domain: str, problem: str | None, read_standard_input: Callable[[], bytes]
) -> Imported:
    """The CDL of a PDDL domain and, if given, a problem of it (lowering.md §3)."""
    found = Collector()
    files = Files(found, read_standard_input)
    texts = _texts(domain, problem, files, found)
    return Imported({} if found.has_errors else texts, found.sorted(), files.sources)


def _texts(domain: str, problem: str | None, files: Files, found: Collector) -> dict[str, str]:
    source = files.read(domain)
    read = None if source is None else read_domain(source, found)
    if read is None:
        return {}
    stated = None
    if problem is not None:
        problem_source = files.read(problem)
        if problem_source is not None:
            stated = read_problem(problem_source, read[1], found)
        if stated is None:
            return {}
    translation = Translation(read[0], stated, read[1])
    module = translation.domain_module()
    if module is None:
        return {}
    texts = {DOMAIN_FILE: _heading(domain) + format_module(module)}
    if stated is not None and problem is not None:
        text = format_module(translation.problem_module(DOMAIN_FILE))
        texts[PROBLEM_FILE] = _heading(problem) + text
    return texts


def _heading(name: str) -> str:
    return f"# Imported from {Path(name).name!a}.\n\n"
