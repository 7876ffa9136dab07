"""GTPyhop's blocks example, in a process of its own: near-optimal stacking as HTN methods.

Its search is recursive and ends in a RecursionError between 60 and 80 blocks, so the limit is
raised here.
"""

import contextlib
import io
import json
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from time import process_time

Positions = dict[str, str]
"""What each block is on: another one, or `table`."""

_ROOT = Path(__file__).resolve().parent.parent


def stacked(start: Positions, goal: Positions, limit: float) -> tuple[float, int] | str:
    """CPU seconds for the plan, without start-up, and its actions; text where it has none."""
    if find_spec("gtpyhop") is None:
        return "not installed"
    try:
        done = subprocess.run(
            [sys.executable, "-m", "benchmarks.htn"],
            input=json.dumps([start, goal]), capture_output=True, text=True, timeout=limit,
            cwd=_ROOT, check=False,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        return f"none in {limit:.0f} s"
    if done.returncode != 0:
        return f"failed: {done.returncode}"
    seconds, actions = json.loads(done.stdout)
    return seconds, actions


def _planned(start: Positions, goal: Positions) -> tuple[float, int]:
    """The same, in this process. Least of three runs."""
    with contextlib.redirect_stdout(io.StringIO()):
        import gtpyhop
        from gtpyhop.examples.blocks_htn import examples

        gtpyhop.set_current_domain(examples.the_domain)
        gtpyhop.verbose = 0
        sys.setrecursionlimit(1_000_000)
        seconds, actions = [], 0
        for _ in range(3):
            state, wanted = gtpyhop.State("start"), gtpyhop.Multigoal("goal")
            state.pos, wanted.pos = dict(start), dict(goal)
            state.clear = {block: block not in start.values() for block in start}
            state.holding = {"hand": False}
            began = process_time()
            plan = gtpyhop.find_plan(state, [("achieve", wanted)])
            seconds.append(process_time() - began)
            actions = len(plan)
    return min(seconds), actions


if __name__ == "__main__":
    print(json.dumps(_planned(*json.load(sys.stdin))))
