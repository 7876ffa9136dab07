"""`cdlc graph`: what is in the graph, where it is drawn, and the picture itself."""

import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from itertools import combinations
from pathlib import Path

import pytest
from programs import program_of
from support import BLOCKS, EXAMPLES, cdlc

from cdlc.driver import compilation
from cdlc.view.draw import picture
from cdlc.view.graph import Graph, Link, graph_of
from cdlc.view.layout import layout_of

DOMAINS = sorted(
    path for path in EXAMPLES.glob("*/*.cdl") if not path.read_text().startswith("problem")
)


def example(path: Path) -> Graph:
    return graph_of(compilation([str(path)]).program)


def told(graph: Graph) -> set[tuple[str, Link, str]]:
    return {(edge.source[1], edge.link, edge.target[1]) for edge in graph.edges}


def test_what_behaviors_of_blocks_achieve_and_need() -> None:
    found = told(example(BLOCKS / "blocks.cdl"))
    of_clear = {(link, target) for source, link, target in found if source == "r_clear"}
    assert of_clear == {
        (Link.ACHIEVES, "clear"),
        (Link.NEEDS, "on"),
        (Link.NEEDS, "clear"),
        (Link.NEEDS, "handempty"),
        (Link.WRITES, "on"),
        (Link.WRITES, "handempty"),
        (Link.WRITES, "holding"),
    }
    assert ("r_clear_from_holding", Link.TESTS, "holding") in found


EVERYTHING = """
typedef T
feature p(x: T)
feature q(x: T)
feature apart(x: T)
feature unused(x: T)
def both(x: T) -> bool:
  return p(x) and q(x)
controller c(x: T):
  eff:
    q[x] = True

behavior helper(x: T):
  body:
    do c(x)

behavior main(x: T):
  goal: p(x)
  body:
    if apart(x):
      helper(x)
    assert both(x)
  eff:
    p[x] = True
"""


def test_calls_functions_tests_and_effects_of_controllers() -> None:
    graph = graph_of(program_of(EVERYTHING))
    assert told(graph) == {
        ("helper", Link.WRITES, "q"),
        ("main", Link.ACHIEVES, "p"),
        ("main", Link.CALLS, "helper"),
        ("main", Link.TESTS, "apart"),
        ("main", Link.TESTS, "both"),
        ("both", Link.READS, "p"),
        ("both", Link.READS, "q"),
    }
    assert "unused" not in {node.name for node in graph.nodes}


@pytest.mark.parametrize("path", DOMAINS, ids=lambda path: path.stem)
def test_nothing_is_drawn_over_a_node(path: Path) -> None:
    """Nodes are apart, and edges pass beside the nodes of the rows between their ends."""
    graph = example(path)
    layout = layout_of(graph)
    assert set(layout.boxes) == {(n.kind, n.name) for n in graph.nodes}
    for one, other in combinations(layout.boxes.values(), 2):
        if one.y == other.y:
            assert abs(one.x - other.x) > (one.width + other.width) / 2
    for box in layout.boxes.values():
        assert box.width / 2 <= box.x + 0.01 <= layout.width - box.width / 2 + 0.02
    for way in layout.ways.values():
        for x, y in way:
            row = [box for box in layout.boxes.values() if box.y == y]
            assert all(abs(x - box.x) > box.width / 2 for box in row)


def test_what_is_needed_is_under_what_needs_it() -> None:
    layout = layout_of(example(EXAMPLES / "logistics" / "logistics.cdl"))
    rows = {name: box.y for (_, name), box in layout.boxes.items()}
    assert rows["in"] > rows["r_load"] == rows["r_unload"] > rows["at"] > rows["r_fly"]


def test_svg_has_its_text_as_text_and_does_not_change() -> None:
    graph = example(BLOCKS / "blocks.cdl")
    svg = picture(graph, "blocks", "svg")
    root = ElementTree.fromstring(svg)
    texts = {t.text for t in root.iter("{http://www.w3.org/2000/svg}text")}
    assert {node.text for node in graph.nodes} <= texts
    assert {"blocks", "achieves", "achieves first", "tests", "writes besides"} <= texts
    assert picture(graph, "blocks", "svg") == svg


def test_names_are_no_formulas() -> None:
    text = EVERYTHING.replace("helper", "x_1_y")
    root = ElementTree.fromstring(picture(graph_of(program_of(text)), "a $b$ <c> & d", "svg"))
    texts = {t.text for t in root.iter("{http://www.w3.org/2000/svg}text")}
    assert {"a $b$ <c> & d", "x_1_y(T)"} <= texts


def test_the_command_writes_pictures(tmp_path: Path) -> None:
    for ending, start in (("svg", b"<?xml"), ("PNG", b"\x89PNG")):
        target = tmp_path / f"new/blocks.{ending}"
        ran = cdlc("graph", BLOCKS / "blocks.cdl", "-o", target)
        assert (ran.status, ran.out, ran.err) == (0, "", "")
        assert target.read_bytes().startswith(start)


def test_another_ending_is_refused(tmp_path: Path) -> None:
    target = tmp_path / "blocks.pdf"
    ran = cdlc("graph", BLOCKS / "blocks.cdl", "-o", target)
    assert ran.status == 1
    assert ran.err == f"error[unknown-picture]: `{target}`: give a file that ends in .svg or .png\n"
    assert not target.exists()


def test_a_domain_in_error_is_not_drawn(tmp_path: Path) -> None:
    ran = cdlc("graph", "-", "-o", tmp_path / "x.svg", stdin="feature p(x: thing)\n")
    assert ran.status == 1
    assert "error[unknown-type]" in ran.err
    assert list(tmp_path.iterdir()) == []


def test_without_what_draws_the_cure_is_named(tmp_path: Path) -> None:
    script = (
        "import sys\n"
        "from importlib.machinery import PathFinder\n"
        "find = PathFinder.find_spec\n"
        "PathFinder.find_spec = lambda name, *a: None if name == 'matplotlib' else find(name, *a)\n"
        "from cdlc.cli import main\n"
        "sys.exit(main(sys.argv[1:]))\n"
    )
    command = [sys.executable, "-c", script, "graph", str(BLOCKS / "blocks.cdl"), "-o",
               str(tmp_path / "x.svg")]  # fmt: skip
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert done.stderr == (
        "error[view-missing]: pictures need matplotlib and networkx; install them with "
        '`pip install "cdlc[view]"`\n'
    )
