"""`python -m benchmarks [name ...] [--quick]`: print every table, and write it as CSV."""

import argparse
import importlib
import sys
from pathlib import Path

# In the order of the table in docs/benchmarks.md; each module has `run(quick) -> Table`.
NAMES = ("start", "parse", "size", "imports", "unroll", "sussman", "random", "reverse", "serial")
RESULTS = Path(__file__).parent / "results"


def main() -> int:
    """Run the benchmarks named, or all of them; returns the exit status."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(NAMES)}")
    parser.add_argument("--quick", action="store_true", help="fewer runs and smaller sizes")
    options = parser.parse_args()
    unknown = set(options.names) - set(NAMES)
    if unknown:
        parser.error(f"no benchmark {', '.join(sorted(unknown))}; there are {', '.join(NAMES)}")
    for name in options.names or NAMES:
        table = importlib.import_module(f"benchmarks.{name}").run(options.quick)
        print(table.text(), flush=True)
        table.write(RESULTS)
    return 0


if __name__ == "__main__":
    sys.exit(main())
