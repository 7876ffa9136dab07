"""`python -m cdlc` is `cdlc`."""

import sys

from cdlc.cli import main

if __name__ == "__main__":
    sys.exit(main())
