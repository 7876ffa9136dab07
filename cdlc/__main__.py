"""`cdlc` and `python -m cdlc`: the command line, from before its imports on."""

import gc
import sys


def main() -> int:
    """Run the command line; returns the exit status."""
    # Modules and trees of large files have no cycles to collect; looking for them costs a lot.
    gc.set_threshold(100_000, 50, 50)
    try:
        from cdlc import cli

        return cli.main()
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return 130


if __name__ == "__main__":
    sys.exit(main())
