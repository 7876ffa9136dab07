"""What an unrolled loop costs: as text its formula doubles with an iteration, as a graph not."""

import json
import subprocess
import sys
from pathlib import Path

from benchmarks.plot import Plot
from benchmarks.table import Table

_ROOT = Path(__file__).resolve().parent.parent
_COUNTS = (30, 300, 3_000)
_HEAD = """typedef tank
feature fuel(x: tank) -> int64
behavior burn(x: tank):
  eff:
    for i in range({count}):
"""
# The loop of lowering.md §1, that of Appendix D.5, and one without end in its values.
_LOOPS = {
    "if f[x] > i: f[x] -= 1": "      if fuel[x] > i: fuel[x] -= 1\n",
    "if … -= 1 else: break": (
        "      if fuel[x] > 0:\n        fuel[x] -= 1\n      else:\n        break\n"
    ),
    "f[x] //= 2 or 3 * f[x] + 1": (
        "      if fuel[x] % 2 == 0:\n        fuel[x] = fuel(x) // 2\n"
        "      else:\n        fuel[x] = 3 * fuel(x) + 1\n"
    ),
}


def run(quick: bool) -> Table:
    """Nodes of the graph, CPU of the model and of its JSON, and how they grow."""
    rows: list[tuple[str | int | float, ...]] = []
    for name, loop in _LOOPS.items():
        before: tuple[float, ...] | None = None
        for count in _COUNTS[: 2 if quick else None]:
            figures = _measure(_HEAD.format(count=count) + loop, 1 if quick else 3)
            ratios = (
                ("", "") if before is None else (figures[0] / before[0], figures[2] / before[2])
            )
            rows.append((name, count, *figures, *ratios))
            before = figures
    columns = (
        "loop", "iterations", "DAG nodes", "digits of tree size", "model CPU s", "JSON CPU s",
        "nodes ratio", "CPU ratio",
    )  # fmt: skip
    note = "target: linear, a ratio of 10 a row. CPU without start-up, least of three."
    ys = ("DAG nodes", "model CPU s", "JSON CPU s")
    plots = tuple(
        Plot("iterations", (y,), y, by="loop", name=f"-{y.split()[0].lower()}") for y in ys
    )
    return Table("unroll", columns, tuple(rows), note, plots)


def _measure(text: str, times: int) -> tuple[int, int, float, float]:
    command = [sys.executable, "-m", "benchmarks.unroll"]
    runs = [
        json.loads(
            subprocess.run(
                command, input=text, text=True, check=True, capture_output=True, cwd=_ROOT
            ).stdout
        )
        for _ in range(times)
    ]
    nodes, digits = runs[0][:2]
    return nodes, digits, min(run[2] for run in runs), min(run[3] for run in runs)


def _measured(text: str) -> tuple[int, int, float, float]:
    """Nodes of the one formula, the length of its tree's size, and CPU seconds, in this process."""
    import time

    from cdlc.driver import Compilation
    from cdlc.ir.graph import size, written_size

    compilation = Compilation("-", read_standard_input=text.encode)
    _ = compilation.checked
    started = time.process_time()
    (triple,) = compilation.triples
    modelled = time.process_time()
    _ = compilation.hoare_json
    (update,) = triple.post
    formulas = (update.guard, update.value)
    digits = len(str(max(map(written_size, formulas))))
    return size(*formulas), digits, modelled - started, time.process_time() - modelled


if __name__ == "__main__":
    print(json.dumps(_measured(sys.stdin.read())))
