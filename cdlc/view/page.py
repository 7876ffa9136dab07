"""A search as one page of HTML that needs nothing else: tree, states, steps, and what failed."""

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from html import escape
from importlib.resources import files
from pathlib import PurePath
from textwrap import dedent

from cdlc.source import SourceFile
from cdlc.view.states import States, states_of
from crow.plan import Result, call_text
from crow.problem import Problem
from crow.program import Location
from crow.refinement import Failure, Kind, Node, Refinement

_MOST_LINES = 6
_MOST_CHANGES = 4
# Nothing is to be fetched from anywhere, whatever the names in a program are.
POLICY = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:"
_PREFIXES = {
    Kind.GOAL: "goal",
    Kind.ACHIEVE: "achieve",
    Kind.CALL: "call",
    Kind.STEP: "on the way",
    Kind.BIND: "bind",
    Kind.ASSERT: "assert",
    Kind.HELD: "still",
    Kind.DO: "do",
    Kind.EFFECT: "eff",
    Kind.FAILED: "failed",
}


@dataclass(frozen=True, slots=True)
class Search:
    """One search and all that a page shows of it."""

    problem: Problem
    result: Result
    refinement: Refinement
    sources: Mapping[str, SourceFile]


def page(search: Search) -> str:
    """The page."""
    folder = files("cdlc.view")
    style, script = (folder.joinpath(f"page.{end}").read_text("utf-8") for end in ("css", "js"))
    states = states_of(search.problem, search.refinement.trace)
    data = json.dumps(states.json(), separators=(",", ":")).replace("<", "\\u003c")
    return "".join(
        (
            '<!doctype html>\n<html lang="en">\n<meta charset="utf-8">\n',
            f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">\n',
            '<meta name="viewport" content="width=device-width">\n',
            '<link rel="icon" href="data:,">\n',
            f"<title>{escape(search.problem.name)}: {escape(_headline(search.result))}</title>\n",
            f"<style>\n{style}</style>\n",
            f"<body>\n{_header(search)}{_main(search, states)}",
            f'<script type="application/json" id="states">{data}</script>\n',
            f"<script>\n{script}</script>\n</body>\n</html>\n",
        )
    )


def _headline(result: Result) -> str:
    if result.status == "plan":
        return f"{len(result.steps)} step{'' if len(result.steps) == 1 else 's'}"
    return "no plan"


# ------------------------------------------------------------------------------------------ header


def _header(search: Search) -> str:
    result = search.result
    notes = [result.summary()]
    if result.explanation:
        notes.append(f"The search came as far as {result.explanation}.")
    told = "".join(f"<p>{_with_code(note)}</p>" for note in notes)
    status = escape(result.status)
    return (
        f'<header><h1>{escape(search.problem.name)} <span class="badge {status}">'
        f"{escape(_headline(result))}</span></h1>{told}</header>\n"
    )


def _with_code(text: str) -> str:
    """Text with what stands between backquotes as code."""
    parts = text.split("`")
    return "".join(
        f"<code>{escape(part)}</code>" if index % 2 else escape(part)
        for index, part in enumerate(parts)
    )


def _main(search: Search, states: States) -> str:
    has_plan = search.result.status == "plan"
    sections = [
        _section("steps", "Plan" if has_plan else "Steps so far", _steps(search)),
        _section("tree", "Refinement" if has_plan else "The branch that came farthest",
                 _tree(search, states)),
        _section("state", "State", _STATE),
        _section("failures", "What failed in the search", _failures(search)),
        _section("figures", "Statistics", _figures(search.result)),
    ]  # fmt: skip
    return f"<main{'' if has_plan else ' class=unsolved'}>\n{''.join(sections)}</main>\n"


def _section(name: str, title: str, content: str) -> str:
    return (
        f'<section id="{name}" aria-labelledby="{name}-title">'
        f'<h2 id="{name}-title">{title}</h2>\n{content}</section>\n'
    )


_STATE = """\
<p class="quiet" id="where">Choose a step or a line of the refinement.</p>
<div id="place"></div>
<h3>Changed</h3><ul id="changed" aria-live="polite"></ul>
<h3>All cells <input id="filter" type="search" placeholder="filter" aria-label="filter cells"></h3>
<div id="cells"></div>
"""


# ------------------------------------------------------------------------------------------- steps


def _steps(search: Search) -> str:
    """The steps, each with the stretch of the trace up to the next one."""
    nodes = [node for node in search.refinement.nodes if node.step is not None]
    nodes.sort(key=lambda node: node.step or 0)
    if not nodes:
        return '<p class="quiet">None.</p>\n'
    all_nodes = search.refinement.nodes
    index = {id(node): number for number, node in enumerate(all_nodes)}
    ends = [(node.item or 0) - 1 for node in nodes[1:]] + [len(search.refinement.trace) - 1]
    rows = []
    for node, end in zip(nodes, ends, strict=True):
        by = all_nodes[node.above].by if node.above >= 0 else ""
        text = node.text if node.kind is Kind.DO else "-"
        rows.append(
            f'<li role="option" tabindex="-1" aria-selected="false" data-from="{node.item}"'
            f' data-to="{end}" data-node="{index[id(node)]}"><code>{escape(text)}</code>'
            f'<span class="quiet">by {escape(by)}</span></li>\n'
        )
    listed = "".join(rows)
    return f'<ol role="listbox" aria-labelledby="steps-title" class="rows">\n{listed}</ol>\n'


# -------------------------------------------------------------------------------------------- tree


def _tree(search: Search, states: States) -> str:
    nodes = search.refinement.nodes
    if not nodes:
        return '<p class="quiet">Nothing was refined.</p>\n'
    controls = (
        '<p class="controls"><label><input type="checkbox" id="held"> conditions asserted again'
        '</label> <button type="button" id="fold">Fold</button>'
        ' <button type="button" id="unfold">Unfold</button>'
        ' <span class="quiet">arrow keys move, open and close</span></p>\n'
    )
    spans = _spans(nodes, len(search.refinement.trace))
    parents = {node.above for node in nodes}
    rows = []
    for index, node in enumerate(nodes):
        text = _effect(states, node) if node.kind is Kind.EFFECT else node.text
        expanded = ' aria-expanded="true"' if index in parents else ""
        rows.append(_row(index, node, text, f"{expanded}{spans[index]}", search.sources))
    listed = "".join(rows)
    return f'{controls}<ul role="tree" aria-labelledby="tree-title" class="rows">\n{listed}</ul>\n'


def _effect(states: States, node: Node) -> str:
    """What an effect changes, as long as it is short."""
    changes = () if node.item is None else states.changes[node.item]
    texts = [_written(states.cells[cell], after) for cell, _, after in changes]
    more = len(texts) - _MOST_CHANGES
    return ", ".join(texts[:_MOST_CHANGES]) + (f" and {more} more" if more > 0 else "") or "nothing"


def _written(cell: str, value: str) -> str:
    return {"True": cell, "False": f"not {cell}"}.get(value, f"{cell} = {value}")


def _spans(nodes: tuple[Node, ...], count: int) -> list[str]:
    """From which item of the trace to which a node and what is below it goes, as attributes."""
    spans = [None if node.item is None else (node.item, node.item) for node in nodes]
    for index in range(len(nodes) - 1, 0, -1):
        own, above = spans[index], nodes[index].above
        before = spans[above]
        if own is not None:
            spans[above] = (
                own if before is None else (min(own[0], before[0]), max(own[1], before[1]))
            )
    found = [(count, count - 1) if n.kind is Kind.FAILED else s
             for n, s in zip(nodes, spans, strict=True)]  # fmt: skip
    return ["" if s is None else f' data-from="{s[0]}" data-to="{s[1]}"' for s in found]


def _row(
    index: int, node: Node, text: str, attributes: str, sources: Mapping[str, SourceFile]
) -> str:
    classes = f"{node.kind}{'' if node.is_done else ' open'}"
    is_true = node.kind is Kind.ACHIEVE and not node.by
    step = "" if node.step is None else f'<span class="number">{node.step + 1}</span>'
    return (
        f'<li role="treeitem" id="n{index}" class="{classes}" aria-level="{node.level + 1}"'
        f' aria-selected="false" tabindex="-1" style="--level:{min(node.level, 24)}"'
        f'{attributes}{_source(node, sources)}><span class="mark" aria-hidden="true"></span>'
        f'{step}<span class="kind">{_PREFIXES[node.kind]}</span> <code>{escape(text)}</code>'
        f"{_by(node)}{_PLAIN if is_true else ''}{_place(node.location)}</li>\n"
    )


_PLAIN = ' <span class="quiet">already true</span>'


def _by(node: Node) -> str:
    if not node.by or node.by == node.text:
        return "" if node.is_done or node.kind is Kind.FAILED else _UNDONE
    where = "" if node.by_location is None else f' title="{escape(str(node.by_location))}"'
    by = f' <span class="by">by <code{where}>{escape(node.by)}</code></span>'
    return by if node.is_done else by + _UNDONE


_UNDONE = ' <span class="quiet">not finished</span>'


def _place(location: Location | None) -> str:
    """A place by the name of its file; the whole path shows when it is pointed at."""
    if location is None:
        return ""
    name = f"{PurePath(location.file).name}:{location.line}:{location.column}"
    return f' <span class="place" title="{escape(str(location))}">{escape(name)}</span>'


def _source(node: Node, sources: Mapping[str, SourceFile]) -> str:
    lines = "\n".join(excerpt(node.location, sources))
    return f' data-source="{escape(lines)}"' if lines else ""


def excerpt(location: Location | None, sources: Mapping[str, SourceFile]) -> Iterator[str]:
    """The first lines of a place, with their numbers."""
    source = None if location is None else sources.get(location.file)
    if location is None or source is None:
        return
    last = min(location.end_line, location.line + _MOST_LINES - 1)
    numbers = range(location.line, last + 1)
    lines = dedent("\n".join(source.line(number) for number in numbers)).split("\n")
    for number, line in zip(numbers, lines, strict=True):
        yield f"{number} | {line[:200]}"


# ---------------------------------------------------------------------------- failures and figures


def _failures(search: Search) -> str:
    failures = search.refinement.failures
    if not failures:
        return '<p class="quiet">Nothing is known to have failed.</p>\n'
    most = max(failure.count for failure in failures)
    rows = "".join(_failure(failure, most, search.sources) for failure in failures)
    return (
        '<p class="quiet">Conditions that ended branches; what came farthest comes first.</p>\n'
        '<div class="wide"><table><thead><tr><th scope="col">condition<th scope="col">why'
        '<th scope="col">branches<th scope="col">farthest: after'
        '<th scope="col">with<th scope="col">there</thead>\n'
        f"<tbody>\n{rows}</tbody></table></div>\n"
    )


def _failure(failure: Failure, most: int, sources: Mapping[str, SourceFile]) -> str:
    source = "\n".join(excerpt(failure.location, sources))
    owner = f"in {failure.behavior}" if failure.behavior else "in the goal"
    steps = f"{failure.steps} step{'' if failure.steps == 1 else 's'}"
    given = ", ".join(f"{name} = {_value(value)}" for name, value in failure.variables.items())
    share = 100 * failure.count / most
    return (
        f'<tr title="{escape(source)}"><td><code>{escape(failure.text)}</code>'
        f"{_place(failure.location)}<br><span class=quiet>{escape(owner)}</span>"
        f'<td>{escape(failure.reason)}<td class="count">{failure.count:,}'
        f'<span class="bar" style="width:{share:.1f}%"></span><td>{steps}'
        f"<td><code>{escape(given)}</code><td><code>{escape(', '.join(failure.facts))}</code>\n"
    )


def _value(value: object) -> str:
    return call_text("", (value,), {})[1:-1]


def _figures(result: Result) -> str:
    """The statistics, a row a figure."""
    rows = [("engine", result.engine), ("seed", str(result.seed))]
    if result.cost is not None:
        rows.append(("cost", f"{result.cost:g}"))
    for name, value in result.statistics.items():
        if isinstance(value, dict):
            rows += [(f"{name}: {kind}", _figure(number)) for kind, number in value.items()]
        elif isinstance(value, list):
            rows.append((name, ", ".join(map(str, value))))
        else:
            rows.append((name, _figure(value)))
    cells = "".join(
        f'<tr><th scope="row">{escape(name)}<td>{escape(value)}\n' for name, value in rows
    )
    return f"<table><tbody>\n{cells}</tbody></table>\n"


def _figure(value: object) -> str:
    return f"{value:,}" if isinstance(value, int | float) else str(value)
