"""A graph as a picture, SVG with text as text, or PNG. Pictures are made here and in `charts`."""

import io
from collections.abc import Callable
from itertools import pairwise
from typing import Any, Final

from cdlc.view.graph import Edge, Graph, Kind, Link
from cdlc.view.layout import HEIGHT, Box, Layout, layout_of

FORMATS: Final = ("svg", "png")

_PAPER, _INK, _QUIET = "#ffffff", "#1d1f24", "#666b76"
_FACES = {Kind.FEATURE: "#e4ecfd", Kind.FUNCTION: "#efe6fb", Kind.BEHAVIOR: "#fdf0d8"}
_LINES = {Kind.FEATURE: "#2457c5", Kind.FUNCTION: "#6b3fb5", Kind.BEHAVIOR: "#9a5b00"}
_COLORS = {
    Link.ACHIEVES: "#1c7a43",
    Link.NEEDS: "#2457c5",
    Link.TESTS: "#8f949e",
    Link.WRITES: "#c98a2b",
    Link.CALLS: "#9a5b00",
    Link.READS: "#6b3fb5",
}
_STYLES = {Link.TESTS: (0, (4, 2)), Link.WRITES: (0, (1, 2))}
_MARGIN: Final = 26.0
_LEGEND: Final = 34.0
_TITLE: Final = 30.0
_PNG_DOTS: Final = 160


class ViewMissing(Exception):  # noqa: N818 - about an installation
    """matplotlib and networkx, which draw, are not installed."""

    code = "view-missing"

    def __init__(self) -> None:
        super().__init__(
            'pictures need matplotlib and networkx; install them with `pip install "cdlc[view]"`'
        )


def require() -> None:
    """Raises ViewMissing if what draws is not installed."""
    from importlib.util import find_spec

    if find_spec("matplotlib") is None or find_spec("networkx") is None:
        raise ViewMissing


def picture(graph: Graph, title: str, format_: str) -> bytes:
    """The picture of a graph in one of FORMATS. The same graph gives the same bytes."""
    layout = layout_of(graph)
    return encoded(lambda: _figure(graph, layout, title), title, format_, family="DejaVu Sans Mono")


def encoded(
    figure_of: Callable[[], Any], title: str, format_: str, family: str = "DejaVu Sans"
) -> bytes:
    """A figure as a picture in one of FORMATS; it is made by `figure_of`, under our settings."""
    import matplotlib

    # Text stays text; names of parts do not depend on when and where it is drawn.
    settings: Any = {
        "svg.fonttype": "none", "svg.hashsalt": "cdlc", "font.family": family,
        "text.parse_math": False,
    }  # fmt: skip
    with matplotlib.rc_context(settings):
        figure = figure_of()
        stream = io.BytesIO()
        metadata = {"Date": None, "Title": title} if format_ == "svg" else {"Title": title}
        figure.savefig(stream, format=format_, dpi=_PNG_DOTS, facecolor=_PAPER, metadata=metadata)
    return stream.getvalue()


def _figure(graph: Graph, layout: Layout, title: str) -> Any:
    from matplotlib.figure import Figure

    links = [link for link in Link if any(edge.link is link for edge in graph.edges)]
    width = max(layout.width, 7.0 * len(title), 118.0 * len(links)) + 2 * _MARGIN
    height = layout.height + 2 * _MARGIN + _LEGEND + _TITLE
    figure = Figure(figsize=(width / 72, height / 72))
    axes = figure.add_axes((0, 0, 1, 1))
    left = (width - layout.width) / 2
    axes.set_xlim(-left, width - left)
    axes.set_ylim(-_MARGIN - _LEGEND, height - _MARGIN - _LEGEND)
    axes.set_axis_off()
    axes.text(
        -left + _MARGIN, layout.height + _MARGIN, title, fontsize=12, fontweight="bold",
        color=_INK, va="center", family="DejaVu Sans",
    )  # fmt: skip
    for edge in graph.edges:
        _draw_edge(axes, edge, layout)
    for node in graph.nodes:
        _draw_node(axes, node.kind, node.text, layout.boxes[node.kind, node.name])
    _draw_legend(axes, links, -left + _MARGIN)
    return figure


def _draw_node(axes: Any, kind: Kind, text: str, box: Box) -> None:
    from matplotlib.patches import FancyBboxPatch

    rounding = 2.0 if kind is Kind.BEHAVIOR else box.height / 2
    axes.add_patch(
        FancyBboxPatch(
            (box.x - box.width / 2, box.y - box.height / 2), box.width, box.height,
            boxstyle=f"round,pad=0,rounding_size={rounding}", facecolor=_FACES[kind],
            edgecolor=_LINES[kind], linewidth=1.1, zorder=3,
        )
    )  # fmt: skip
    axes.text(box.x, box.y - 0.5, text, fontsize=9.5, color=_INK, ha="center", va="center",
              zorder=4)  # fmt: skip


def _draw_edge(axes: Any, edge: Edge, layout: Layout) -> None:
    from matplotlib.patches import FancyArrowPatch

    axes.add_patch(
        FancyArrowPatch(
            path=_path(edge, layout), arrowstyle="-|>,head_length=4,head_width=2.2",
            color=_COLORS[edge.link], linestyle=_STYLES.get(edge.link, "solid"),
            linewidth=1.5 if edge.link in (Link.ACHIEVES, Link.NEEDS) else 1.1,
            zorder=1 if edge.link in (Link.TESTS, Link.WRITES) else 2, alpha=0.9,
        )
    )  # fmt: skip


_SHIFTS = {Link.ACHIEVES: -0.16, Link.WRITES: -0.3, Link.TESTS: 0.3, Link.NEEDS: 0.16}
"""Where on its node an edge ends, as a share of the width: each kind has a place of its own."""


def _path(edge: Edge, layout: Layout) -> Any:
    """A curve from the side of one node that faces the other; a loop aside for one row."""
    from matplotlib.path import Path

    start, end = layout.boxes[edge.source], layout.boxes[edge.target]
    shift = _SHIFTS.get(edge.link, 0.0)
    x, to = start.x + shift * start.width, end.x + shift * end.width
    if abs(start.y - end.y) < 1:
        side = -1 if edge.link in (Link.ACHIEVES, Link.WRITES) else 1
        y = start.y + side * start.height / 2
        bend = y + side * (20 + 0.06 * abs(to - x))
        to = to if start is not end else to + 0.3 * end.width
        return Path([(x, y), (x, bend), (to, bend), (to, y)], _curve(1))
    side = 1 if end.y > start.y else -1
    first, last = (x, start.y + side * start.height / 2), (to, end.y - side * end.height / 2)
    passed = []  # past a row straight, between two rows across
    for across, down in layout.ways[edge]:
        passed += [(across, down - side * HEIGHT / 2), (across, down + side * HEIGHT / 2)]
    points = [first]
    for one, other in pairwise((first, *passed, last)):
        bend = 0.45 * (other[1] - one[1])
        points += [(one[0], one[1] + bend), (other[0], other[1] - bend), other]
    return Path(points, _curve(len(passed) + 1))


def _curve(pieces: int) -> list[Any]:
    from matplotlib.path import Path

    return [Path.MOVETO, *([Path.CURVE4] * 3 * pieces)]


def _draw_legend(axes: Any, links: list[Link], left: float) -> None:
    y = -_LEGEND
    for index, link in enumerate(links):
        x = left + 118 * index
        axes.plot(
            (x, x + 22), (y, y), color=_COLORS[link], linestyle=_STYLES.get(link, "solid"),
            linewidth=1.6,
        )  # fmt: skip
        axes.text(x + 27, y, str(link), fontsize=8.5, color=_QUIET, va="center",
                  family="DejaVu Sans")  # fmt: skip
