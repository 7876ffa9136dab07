"""Set `.venv` up and run the tests in it: `python3 tools/test.py [ARGUMENTS OF PYTEST]`."""

import os
import sys

import environment


def main(arguments: list[str]) -> int:
    """Become pytest, so that its exit status and Ctrl-C are the user's.

    Without arguments the whole suite runs, on all cores.
    """
    status = environment.main(
        ["planners", "verify", "view", "examples", "physics", "ray", "bench", "dev"]
    )
    if status == 0:
        python = environment.python_of(environment.ROOT / ".venv")
        os.chdir(environment.ROOT)
        chosen = arguments or ["-n", "auto", "--dist", "worksteal"]
        os.execv(python, [str(python), "-m", "pytest", *chosen])
    return status


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
