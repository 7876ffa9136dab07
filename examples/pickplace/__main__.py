"""`python -m examples.pickplace gate -o gate.gif`: plan, and draw it."""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import crow

from . import blocked, crowded, gate, picture, tight

SIZED = {"tight": tight, "blocked": blocked, "crowded": crowded}


def main(arguments: Sequence[str] | None = None) -> int:
    """Plan, and show it; returns the exit status, 3 without a plan."""
    parser = argparse.ArgumentParser(prog="python -m examples.pickplace", description=__doc__)
    parser.add_argument("problem", choices=[*SIZED, "gate"])
    parser.add_argument("--blocks", type=int, help="how many; not for `gate`")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--time-limit", type=float, default=60, metavar="S")
    parser.add_argument("-o", "--output", type=Path, help="draw it: .png or .gif")
    options = parser.parse_args(arguments)
    if options.blocks is not None and (options.problem == "gate" or not 2 <= options.blocks <= 26):
        parser.error("`--blocks` is from 2 to 26, and `gate` has three")
    sized = {} if options.blocks is None else {"count": options.blocks}
    problem = SIZED[options.problem](**sized) if options.problem in SIZED else gate()
    result = crow.plan(problem, seed=options.seed, time_limit=options.time_limit)
    if not isinstance(result, crow.Plan):
        print(result.summary(), file=sys.stderr)
        return 3
    if options.output is not None:
        picture(problem, result, options.output)
    for number, step in enumerate(result.steps, 1):
        print(f"{number}. {crow.ControllerCall(str(step.controller), step.arguments)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
