"""A layered layout: goals above the behaviors that achieve them, these above what they need.

Layers are distances from a goal on top; within a layer, nodes are where their neighbours are, as
few edges crossing as a few sweeps find (after Sugiyama, Tagawa and Toda).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Final

from cdlc.view.graph import Edge, Graph, Kind, Link

Key = tuple[Kind, str]
Via = tuple[Edge, int]
"""Where an edge passes a row that neither of its ends is in."""
Place = Key | Via

CHARACTER: Final = 6.7
"""The width of a character of a node's text, in points."""
HEIGHT: Final = 24.0
MARGIN: Final = 18.0
GAP: Final = 22.0
THREAD: Final = 7.0
"""What an edge that passes takes, and keeps from others that do."""
RISE: Final = 76.0
"""From one row to the next."""
WIDEST: Final = 1000.0
"""A wider layer is broken into several rows."""
SWEEPS: Final = 24


@dataclass(frozen=True, slots=True)
class Box:
    """Where a node stands: its middle and its size, in points from the bottom left."""

    x: float
    y: float
    width: float
    height: float


@dataclass(frozen=True, slots=True)
class Layout:
    """Boxes by node, what an edge passes on its way, and the size of it all."""

    boxes: Mapping[Key, Box]
    ways: Mapping[Edge, tuple[tuple[float, float], ...]]
    width: float
    height: float


def layout_of(graph: Graph) -> Layout:
    """Where the nodes of a graph stand, and how its edges go."""
    keys = [(n.kind, n.name) for n in graph.nodes]
    widths: dict[Place, float] = {
        key: MARGIN + CHARACTER * len(node.text)
        for key, node in zip(keys, graph.nodes, strict=True)
    }
    rows = _rows(_layers(graph), widths)
    neighbours = _threaded(rows, graph, widths)
    rows = _ordered(rows, neighbours)
    total = max((_width(row, widths) for row in rows), default=0.0)
    height = HEIGHT + RISE * max(0, len(rows) - 1)
    across = _places(rows, widths, neighbours, total)
    down = {place: height - HEIGHT / 2 - RISE * i for i, row in enumerate(rows) for place in row}
    boxes = {key: Box(across[key], down[key], widths[key], HEIGHT) for key in keys}
    row_of = {key: i for i, row in enumerate(rows) for key in row if not _is_via(key)}
    ways = {}
    for edge in graph.edges:
        start, end = row_of[edge.source], row_of[edge.target]
        step = 1 if end >= start else -1
        passed = [(edge, i) for i in range(start + step, end, step)]
        ways[edge] = tuple((across[via], down[via]) for via in passed)
    return Layout(boxes, ways, total, height)


def _is_via(place: Place) -> bool:
    return isinstance(place[0], Edge)


def _gap(one: Place, other: Place) -> float:
    return THREAD if _is_via(one) and _is_via(other) else GAP


def _width(row: Sequence[Place], widths: Mapping[Place, float]) -> float:
    return sum(widths[place] for place in row) + sum(_gap(a, b) for a, b in pairwise(row))


def _threaded(
    rows: list[list[Place]], graph: Graph, widths: dict[Place, float]
) -> dict[Place, list[Place]]:
    """Add to each row what passes it; the neighbours of everything, a row above or below."""
    row_of = {place: i for i, row in enumerate(rows) for place in row}
    found: dict[Place, list[Place]] = {place: [] for row in rows for place in row}
    for edge in graph.edges:
        start, end = row_of[edge.source], row_of[edge.target]
        step = 1 if end >= start else -1
        passed: list[Place] = [(edge, i) for i in range(start + step, end, step)]
        for via in passed:
            assert isinstance(via[1], int)
            rows[via[1]].append(via)
            widths[via] = THREAD
            found[via] = []
        for one, other in pairwise((edge.source, *passed, edge.target)):
            if one != other:
                found[one].append(other)
                found[other].append(one)
    return found


# ------------------------------------------------------------------------------------------ layers


def _downward(graph: Graph) -> Any:
    """What is under what: under a goal what achieves it, under that what it needs."""
    import networkx

    found = networkx.DiGraph()
    found.add_nodes_from((n.kind, n.name) for n in graph.nodes)
    for edge in graph.edges:
        if edge.link is Link.ACHIEVES:
            found.add_edge(edge.target, edge.source, length=1)
        elif edge.link is not Link.WRITES:
            # Between two of one kind there is a layer of the other.
            same = (edge.source[0] is Kind.BEHAVIOR) == (edge.target[0] is Kind.BEHAVIOR)
            found.add_edge(edge.source, edge.target, length=2 if same else 1)
    return found


def _layers(graph: Graph) -> list[list[Key]]:
    """The nodes by their distance from the top."""
    import networkx

    downward = _downward(graph)
    distances = networkx.multi_source_dijkstra_path_length(
        downward, set(_tops(graph, downward)), weight="length"
    )
    for key in downward:  # only written, or by itself
        distances.setdefault(key, 1 if key[0] is Kind.BEHAVIOR else 2)
    layers: dict[int, list[Key]] = {}
    for key in downward:
        layers.setdefault(distances[key], []).append(key)
    return [layers[depth] for depth in sorted(layers)]


def _tops(graph: Graph, downward: Any) -> list[Key]:
    """Of each part that nothing is above, the goal that least needs and that says most."""
    import networkx

    order = {(n.kind, n.name): index for index, n in enumerate(graph.nodes)}
    arity = {(n.kind, n.name): n.text.count(",") for n in graph.nodes}
    needed: dict[Key, int] = {}
    for edge in graph.edges:
        if edge.link in (Link.NEEDS, Link.TESTS):
            needed[edge.target] = needed.get(edge.target, 0) + 1
    parts = networkx.condensation(downward)
    tops = []
    for part, above in parts.in_degree():
        if not above:
            members = parts.nodes[part]["members"]
            goals = [key for key in members if key[0] is not Kind.BEHAVIOR] or list(members)
            tops.append(min(goals, key=lambda k: (-arity[k], needed.get(k, 0), order[k])))
    return sorted(tops, key=lambda key: order[key])


# ----------------------------------------------------------------------------------------- sweeping


def _ordered(
    rows: list[list[Place]], neighbours: Mapping[Place, Sequence[Place]]
) -> list[list[Place]]:
    """Each row in the order of the middles of its neighbours, swept down and up."""
    best, fewest = rows, _crossings(rows, neighbours)
    for sweep in range(SWEEPS):
        places = {
            place: (index + 0.5) / len(row) for row in rows for index, place in enumerate(row)
        }
        order = range(len(rows)) if sweep % 2 == 0 else reversed(range(len(rows)))
        rows = list(rows)
        for number in order:
            middles = {p: _middle([places[n] for n in neighbours[p]], places[p])
                       for p in rows[number]}  # fmt: skip
            row = sorted(rows[number], key=middles.__getitem__)
            rows[number] = row
            places |= {place: (index + 0.5) / len(row) for index, place in enumerate(row)}
        crossings = _crossings(rows, neighbours)
        if crossings < fewest:
            best, fewest = rows, crossings
    return best


def _middle(places: list[float], own: float) -> float:
    return sum(places) / len(places) if places else own


def _crossings(rows: list[list[Place]], neighbours: Mapping[Place, Sequence[Place]]) -> int:
    """How often edges between rows that follow one another cross."""
    count = 0
    for upper, lower in pairwise(rows):
        place = {below: index for index, below in enumerate(lower)}
        ends = [sorted(place[n] for n in neighbours[p] if n in place) for p in upper]
        flat = [end for group in ends for end in group]
        count += sum(other > end for i, end in enumerate(flat) for other in flat[:i])
    return count


# ------------------------------------------------------------------------------------------ places


def _rows(layers: list[list[Key]], widths: Mapping[Place, float]) -> list[list[Place]]:
    """Layers that are too wide, in several rows."""
    rows: list[list[Place]] = []
    for layer in layers:
        rows.append([])
        for key in layer:
            if rows[-1] and _width([*rows[-1], key], widths) > WIDEST:
                rows.append([])
            rows[-1].append(key)
    return rows


def _places(
    rows: list[list[Place]],
    widths: Mapping[Place, float],
    neighbours: Mapping[Place, Sequence[Place]],
    total: float,
) -> dict[Place, float]:
    """The middles from left to right: near the neighbours, with a gap between any two."""
    found: dict[Place, float] = {}
    for row in rows:
        start = (total - _width(row, widths)) / 2
        found |= dict(zip(row, _apart(row, [start] * len(row), widths, total), strict=True))
    for sweep in range(SWEEPS):
        for row in rows if sweep % 2 == 0 else reversed(rows):
            wanted = [_middle([found[n] for n in neighbours[p]], found[p]) for p in row]
            found |= dict(zip(row, _apart(row, wanted, widths, total), strict=True))
    return found


def _apart(
    row: list[Place], wanted: list[float], widths: Mapping[Place, float], total: float
) -> list[float]:
    """The wanted places, moved apart as far as need be and kept within the whole."""
    found: list[float] = []
    for index, (place, middle) in enumerate(zip(row, wanted, strict=True)):
        least = widths[place] / 2
        if index:
            before = row[index - 1]
            least += found[-1] + widths[before] / 2 + _gap(before, place)
        found.append(max(middle, least))
    most = total
    for index in range(len(row) - 1, -1, -1):
        half = widths[row[index]] / 2
        found[index] = min(found[index], most - half)
        most = found[index] - half - (_gap(row[index - 1], row[index]) if index else 0)
    return found
