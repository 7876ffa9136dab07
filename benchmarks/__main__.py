"""`python -m benchmarks [name ...] [--quick] [-o DIR]`: print every table, write CSV and plots."""

import argparse
import importlib
import sys
from collections.abc import Sequence
from pathlib import Path

# In the order of the table in docs/reference/benchmarks.md; each module has `run(quick) -> Table`.
NAMES = (
    "start", "parse", "size", "imports", "unroll", "sussman", "random", "reverse", "serial",
    "objects", "thm1", "thm2", "commit", "namo", "rooms", "csp", "sat", "tamp", "many", "race",
)  # fmt: skip
RESULTS = Path(__file__).parent / "results"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the benchmarks named, or all of them; returns the exit status."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(NAMES)}")
    parser.add_argument("--quick", action="store_true", help="fewer runs and smaller sizes")
    parser.add_argument(
        "-o", "--output", type=Path, default=RESULTS, metavar="DIR",
        help="folder for CSV and plots; default: %(default)s",
    )  # fmt: skip
    options = parser.parse_args(arguments)
    unknown = set(options.names) - set(NAMES)
    if unknown:
        parser.error(f"no benchmark {', '.join(sorted(unknown))}; there are {', '.join(NAMES)}")
    for name in options.names or NAMES:
        table = importlib.import_module(f"benchmarks.{name}").run(options.quick)
        print(table.text(), flush=True)
        table.write(options.output)
    return 0


if __name__ == "__main__":
    sys.exit(main())
