"""`python -m examples.namo hard`: plan on a map, and watch it or draw it."""

import argparse
import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import crow

from . import MAPS, STRATEGIES, MapError, PushedBack, Scene, picture, problem, scenes, watch
from .render import animation


def main(arguments: Sequence[str] | None = None) -> int:
    """Plan, and show it; returns the exit status, 3 without a plan."""
    parser = argparse.ArgumentParser(prog="python -m examples.namo", description=__doc__)
    parser.add_argument("map", help=f"{', '.join(MAPS)}, or a file")
    parser.add_argument("--strategy", choices=STRATEGIES, default="interleaved")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--time-limit", type=float, default=60, metavar="S")
    parser.add_argument("-o", "--output", type=Path, help="draw it: .png, .gif or .html")
    parser.add_argument(
        "--disturb", action="store_true", help="carry it out while somebody puts an obstacle back"
    )
    options = parser.parse_args(arguments)
    try:
        text = options.map if options.map in MAPS else Path(options.map).read_text("utf-8")
        task = problem(text, options.strategy)
    except (OSError, UnicodeDecodeError, MapError) as error:
        parser.error(str(error))
    chosen = partial(_carry_out if options.disturb else _plan, task, seed=options.seed)
    return chosen(time_limit=options.time_limit, output=options.output)


def _plan(task: crow.Problem, *, seed: int, time_limit: float, output: Path | None) -> int:
    result = crow.plan(task, seed=seed, time_limit=time_limit)
    if not isinstance(result, crow.Plan):
        print(result.status)
        return 3
    if output is None:
        watch(scenes(Scene.of(task.initial), result.steps))
        print(f"{len(result.steps)} steps")
    else:
        print(picture(task, result, output))
    return 0


def _carry_out(task: crow.Problem, *, seed: int, time_limit: float, output: Path | None) -> int:
    robot = PushedBack(task)
    record = crow.execute(task, robot, seed=seed, time_limit=time_limit)
    if output is None:
        watch(robot.seen)
    else:
        animation(robot.seen, output)
    print(record.text())
    return 0 if record.status == "done" else 3


if __name__ == "__main__":
    sys.exit(main())
