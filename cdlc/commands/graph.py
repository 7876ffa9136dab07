"""The command graph: a domain as a picture."""

import argparse
import sys

from cdlc import driver
from cdlc.commands.shared import DONE, INPUT_ERRORS, warn


def graph(options: argparse.Namespace) -> int:
    """`cdlc graph`: which behavior achieves what and needs what, as SVG or PNG."""
    from cdlc.output import write_whole
    from cdlc.view.draw import FORMATS, ViewMissing, picture, require
    from cdlc.view.graph import graph_of

    ending = options.output.suffix.lower().removeprefix(".")
    if ending not in FORMATS:
        known = " or ".join(f".{name}" for name in FORMATS)
        _fail("unknown-picture", f"`{options.output}`: give a file that ends in {known}")
        return INPUT_ERRORS
    try:
        require()
    except ViewMissing as error:
        _fail(error.code, str(error))
        return INPUT_ERRORS
    compilation = driver.compilation([options.domain])
    program = compilation.program
    warn(options, compilation)
    write_whole(options.output, picture(graph_of(program), program.name, ending))
    return DONE


def _fail(code: str, message: str) -> None:
    print(f"error[{code}]: {message}", file=sys.stderr)
