"""Charts of measurements, as pictures; matplotlib is imported where one is drawn."""

from dataclasses import dataclass
from typing import Any, Final, Literal

from cdlc.view.draw import encoded

_COLORS: Final = (
    "#2457c5",
    "#c2410c",
    "#1c7a43",
    "#6b3fb5",
    "#9a5b00",
    "#be185d",
    "#0e7490",
    "#555",
)
_MARKERS: Final = "osD^vP*X"
_MOST_MARKED: Final = 60
_MANY: Final = 300
"""From this on, powers of ten are labels enough."""


@dataclass(frozen=True, slots=True)
class Curve:
    """Points of one label."""

    label: str
    xs: tuple[float, ...]
    ys: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Chart:
    """Curves over two axes; with a `rim`, points, and on it those that lie beyond."""

    name: str
    title: str
    x: str
    y: str
    curves: tuple[Curve, ...]
    scale: Literal["semilogx", "semilogy", "loglog"]
    is_stepped: bool = False
    rim: float | None = None


def drawn(chart: Chart, format_: str) -> bytes:
    """The picture of a chart, as SVG or PNG. The same chart gives the same bytes."""
    return encoded(lambda: _figure(chart), chart.title, format_)


def _figure(chart: Chart) -> Any:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.4, 4.2 if chart.rim is None else 5.2), layout="constrained")
    axes = figure.subplots()
    axes.set_title(chart.title, fontsize=11, loc="left")
    axes.set(xlabel=chart.x, ylabel=chart.y)
    if chart.scale != "semilogy":
        axes.set_xscale("log")
    if chart.scale != "semilogx":
        axes.set_yscale("log")
    for number, curve in enumerate(chart.curves):
        _draw(axes, chart, curve, number)
    if chart.rim is not None:
        _draw_rim(axes, chart)
    elif chart.scale == "semilogy":
        _count_by_whole_numbers(axes)
    else:
        axes.set_ylim(0, 102)
    for axis in (axes.xaxis, axes.yaxis):
        if axis.get_scale() == "log":
            _label_plainly(axis)
    axes.grid(visible=True, alpha=0.25)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    if any(curve.xs for curve in chart.curves):
        axes.legend(fontsize=9, frameon=False)
    return figure


def _draw(axes: Any, chart: Chart, curve: Curve, number: int) -> None:
    style: dict[str, Any] = {"color": _COLORS[number % len(_COLORS)], "label": curve.label}
    marker = _MARKERS[number % len(_MARKERS)]
    if chart.rim is not None:
        axes.scatter(curve.xs, curve.ys, marker=marker, s=22, alpha=0.75, linewidths=0, **style)
        return
    marked = marker if len(curve.xs) <= _MOST_MARKED else None
    axes.plot(
        curve.xs, curve.ys, marker=marked, markersize=3.5, linewidth=1.4,
        drawstyle="steps-post" if chart.is_stepped else "default", **style,
    )  # fmt: skip


def _draw_rim(axes: Any, chart: Chart) -> None:
    """The diagonal, and where what was not solved stands."""
    assert chart.rim is not None
    least = min((v for c in chart.curves for v in (*c.xs, *c.ys)), default=chart.rim / 10) / 1.5
    axes.plot((least, chart.rim), (least, chart.rim), color="#999", linewidth=0.8, zorder=0)
    for draw in (axes.axhline, axes.axvline):
        draw(chart.rim, color="#999", linewidth=0.8, linestyle=(0, (4, 3)), zorder=0)
    axes.text(least, chart.rim * 1.06, "not solved", fontsize=8, color="#666")
    axes.set_xlim(least, chart.rim * 1.4)
    axes.set_ylim(least, chart.rim * 1.4)
    axes.set_aspect("equal")


def _label_plainly(axis: Any) -> None:
    """0.1, 1 and 10; on a short axis 2 and 5 of each as well."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    low, high = axis.get_view_interval()
    subs = (1.0,) if high / low > _MANY else (1.0, 2.0, 5.0)
    axis.set_major_locator(LogLocator(subs=subs))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())


def _count_by_whole_numbers(axes: Any) -> None:
    from matplotlib.ticker import MaxNLocator

    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set_xlim(left=0)
