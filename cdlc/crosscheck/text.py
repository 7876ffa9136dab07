"""A comparison for people: a table with a row a problem, then what is to be said of some rows."""

from collections.abc import Iterator, Sequence

from cdlc.crosscheck.results import Comparison, Outcome, Side
from cdlc.render import paint
from crow.plan import call_text

_WORDS = {
    Outcome.AGREE_PLAN: "agree: plan",
    Outcome.AGREE_NONE: "agree: none",
    Outcome.NOT_COMPARABLE: "not comparable",
}
_STYLES = {
    Outcome.AGREE_PLAN: "help",
    Outcome.AGREE_NONE: "help",
    Outcome.MISMATCH: "error",
    Outcome.ERROR: "error",
}
_HEADINGS = ("problem", "outcome", "planner", "its answer", "time", "program's", "time")
_OUTCOME_COLUMN = 1


def table(compared: Sequence[Comparison], *, color: bool = False) -> str:
    """The table; columns are two spaces apart."""
    rows = [_HEADINGS, *map(_row, compared)]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    styles = [None, *(_STYLES.get(c.outcome, "warning") for c in compared)]
    lines = []
    for row, style in zip(rows, styles, strict=True):
        cells = [f"{cell:<{width}}" for cell, width in zip(row, widths, strict=True)]
        if style is not None:
            cells[_OUTCOME_COLUMN] = paint(cells[_OUTCOME_COLUMN], style, color=color)
        lines.append("  ".join(cells).rstrip() + "\n")
    return "".join(lines)


def _row(comparison: Comparison) -> tuple[str, ...]:
    planner, program = comparison.planner, comparison.program
    engine = "-" if planner is None else planner.result.engine
    return (comparison.file, word(comparison.outcome), engine, *_cells(planner), *_cells(program))


def word(outcome: Outcome) -> str:
    """An outcome as the table has it."""
    return _WORDS.get(outcome, str(outcome))


def _cells(side: Side | None) -> tuple[str, str]:
    if side is None:
        return "-", "-"
    seconds = side.result.statistics.get("seconds")
    return _answer(side), "-" if seconds is None else f"{seconds:.2f} s"


def _answer(side: Side) -> str:
    result = side.result
    if result.status != "plan":
        return {"unsolvable": "none", "timeout": "time limit", "memory": "memory"}.get(
            result.status, "limit"
        )
    count = len(result.steps)
    if not count and side.pddl:
        return f"{len(side.pddl)} actions"
    steps = f"{count} step{'' if count == 1 else 's'}"
    is_told = result.cost is None or result.cost == count
    return steps if is_told else f"{steps}, cost {result.cost:g}"


# ------------------------------------------------------------------------------------------ remarks


def remarks(compared: Sequence[Comparison], *, color: bool = False) -> str:
    """A paragraph for every row that neither agrees nor has diagnostics to say why."""
    return "".join(
        "\n" + "".join(f"{line}\n" for line in _remark(comparison, color))
        for comparison in compared
        if comparison.reason
    )


def _remark(comparison: Comparison, color: bool) -> Iterator[str]:
    style = _STYLES.get(comparison.outcome, "warning")
    outcome = paint(word(comparison.outcome), style, color=color)
    yield f"{comparison.file}: {outcome}: {comparison.reason}"
    yield from _excluded(comparison)
    if comparison.reproducer is not None:
        yield f"  to repeat it: {comparison.reproducer}"


def _excluded(comparison: Comparison) -> Iterator[str]:
    """The planner's plan step by step, with what the rules leave out of it."""
    steps = [excluded.step for excluded in comparison.excluded]
    calls = [call_text(s.controller, s.arguments, {}) if s.controller else "-" for s in steps]
    behaviors = [call_text(s.behavior, s.behavior_arguments, s.bindings) for s in steps]
    widths = [max(map(len, column), default=0) for column in (calls, behaviors)]
    for number, (call, behavior, excluded) in enumerate(
        zip(calls, behaviors, comparison.excluded, strict=True), 1
    ):
        line = (
            f"  {number:>{len(str(len(steps)))}}. {call:<{widths[0]}}  by {behavior:<{widths[1]}}"
        )
        yield f"{line}  {excluded.remark}".rstrip()
    program = comparison.program
    if steps and not any(excluded.remark for excluded in comparison.excluded):
        yield "  each step is wanted somewhere, but not in this order or with these objects"
    if steps and program is not None and program.result.explanation:
        yield f"  the program came as far as {program.result.explanation}"


def summary(compared: Sequence[Comparison]) -> str:
    """How many problems came to which outcome."""
    total = f"{len(compared)} problem{'' if len(compared) == 1 else 's'}"
    found = [c.outcome for c in compared]
    counts = [f"{found.count(o)} {word(o)}" for o in Outcome if o in found]
    return f"{total}: {', '.join(counts)}" if counts else total
