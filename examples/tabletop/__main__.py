"""`python -m examples.tabletop -o tidy.gif`: plan and carry it out, and film that.

Without a display, set MUJOCO_GL to `egl` or `osmesa`.
"""

import argparse
import sys
from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path

import crow

from . import Robot, tidy
from .render import camera, write


def main(arguments: Sequence[str] | None = None) -> int:
    """Carry the problem out, and tell what was done; returns the exit status, 3 without a plan."""
    parser = argparse.ArgumentParser(prog="python -m examples.tabletop", description=__doc__)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--time-limit", type=float, default=60, metavar="S")
    parser.add_argument(
        "-o", "--output", type=Path, help="film it: .gif; or .png, with a panel after each call"
    )
    parser.add_argument(
        "--disturb", action="store_true", help="somebody nudges the crate out of its place"
    )
    options = parser.parse_args(arguments)
    problem = tidy()
    robot = Robot(problem, {2: ("crate", 0.0, -1.5)} if options.disturb else None)
    films = options.output is not None and options.output.suffix == ".gif"
    with camera(robot, films=films) if options.output else nullcontext() as filming:
        record = crow.execute(problem, robot, seed=options.seed, time_limit=options.time_limit)
    if filming is not None:
        write(filming, options.output)
    print(record.text(), end="")
    return 0 if record.status == "done" else 3


if __name__ == "__main__":
    sys.exit(main())
