"""The report for people: what is wrong and where it can be seen, then a line for each behavior."""

from collections.abc import Iterator, Mapping

from cdlc.render import as_text, paint
from cdlc.source import SourceFile
from cdlc.verify.explain import Counterexample
from cdlc.verify.results import Check, Report, Verdict, Verified

_STYLES = {Verdict.PROVED: "help", Verdict.REFUTED: "error", Verdict.UNKNOWN: "warning"}
# Longer states are cut; JSON has all of them.
_MOST_LINES = 40


def report_text(report: Report, sources: Mapping[str, SourceFile], *, color: bool = False) -> str:
    """A report, ending with a line feed."""
    parts = [
        _refutation(check, sources, color)
        for verified in report.behaviors
        for check in verified.checks
        if check.problem is not None
    ]
    return "\n".join([*parts, "\n".join(_table(report, color)) + "\n"])


def summary(reports: tuple[Report, ...]) -> str:
    """How many behaviors came to which verdict."""
    verdicts = [verified.verdict for report in reports for verified in report.behaviors]
    if not verdicts:
        return "no behavior has an effect to verify"
    counts = [(sum(v is verdict for v in verdicts), str(verdict)) for verdict in Verdict]
    total = f"{len(verdicts)} behavior{'' if len(verdicts) == 1 else 's'}"
    return f"{total}: {', '.join(f'{n} {word}' for n, word in counts if n)}"


# ------------------------------------------------------------------------------------------- tables


def _table(report: Report, color: bool) -> Iterator[str]:
    yield report.file
    width = max((len(v.behavior) for v in report.behaviors), default=0)
    for verified in report.behaviors:
        verdict = paint(f"{verified.verdict:<8}", _STYLES[verified.verdict], color=color)
        yield f"  {verdict} {verified.behavior:<{width}}  {_detail(verified)}"
        yield from (f"{'':11}{line}" for line in _remarks(verified))
    if not report.behaviors:
        yield "  no behavior has an effect to verify"
    for names in report.same:
        *others, last = names
        yield f"  note: {', '.join(others)} and {last} are one and the same transition"


def _detail(verified: Verified) -> str:
    """Which checks came to the verdict."""
    names = [c.name for c in verified.checks if c.verdict is verified.verdict]
    return ", ".join(names)


def _remarks(verified: Verified) -> Iterator[str]:
    for check in verified.checks:
        if check.verdict is Verdict.UNKNOWN:
            yield f"{check.name}: {check.reason}{_checked(check.size)}"
    notes = dict.fromkeys(note for check in verified.checks for note in check.notes)
    yield from notes


def _checked(size: int | None) -> str:
    """How far an unknown check has been searched."""
    if size is None:
        return ""
    objects = "1 object" if size == 1 else f"{size} objects"
    return f"; nothing wrong with up to {objects}"


# ---------------------------------------------------------------------------------- counterexamples


def _refutation(check: Check, sources: Mapping[str, SourceFile], color: bool) -> str:
    assert check.problem is not None
    text = as_text([check.problem], sources, color=color)
    if check.example is None:
        return text
    lines = _example(check.example, color)
    return text + "\n" + "".join(f"    {line}".rstrip() + "\n" for line in lines)


def _example(example: Counterexample, color: bool) -> Iterator[str]:
    """The situation as a problem file has it, the call, and what it leads to."""

    def strong(text: str) -> str:
        return paint(text, "bold", color=color)

    yield strong("Here is a state where it goes wrong; the behavior has been run in it:")
    yield ""
    if example.objects():
        yield "objects:"
        yield from (f"  {line}" for line in example.objects())
    yield "init:"
    yield from _cut([f"  {line}" for line in example.state()] or ["  pass"])
    if example.functions():
        yield "where:"
        yield from _cut([f"  {line}" for line in example.functions()])
    yield ""
    runs = f" runs {', '.join(example.controllers)} and" if example.controllers else ""
    problem = example.situation.ran.problem
    if problem is not None:
        yield f"{strong(example.call)} fails there: {problem.reason}"  # type: ignore[union-attr]
        return
    changes = example.changes()
    yield f"{strong(example.call)}{runs} {'changes' if changes else 'changes nothing.'}"
    widths = [max((len(change[i]) for change in changes), default=0) for i in (0, 2)]
    yield from _cut(
        [f"  {cell:<{widths[0]}}  {old:<{widths[1]}} -> {new}" for cell, new, old in changes]
    )
    yield ""
    yield "The goal needs, and does not get:"
    parts = example.false_parts
    width = max(len(part.text) for part in parts)
    for part in parts:
        it = "it " if part.finding.startswith("is ") else ""
        yield f"  {strong(f'{part.text:<{width}}')}  but {it}{part.finding}"


def _cut(lines: list[str]) -> list[str]:
    if len(lines) <= _MOST_LINES:
        return lines
    return [*lines[:_MOST_LINES], f"  … and {len(lines) - _MOST_LINES} more"]
