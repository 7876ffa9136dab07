"""Checking programs given as text, for tables of small cases."""

from cdlc.diagnostics import Diagnostic
from cdlc.driver import Compilation, CompileError, compilation
from crow.program import Program

PRELUDE = """\
typedef block
typedef box: block
typedef place
typedef Pose: vector[float32, 2]
typedef Size: vector[float32, 2]
typedef Length: float32
typedef Mass: float32

object_constant table: place

feature clear(x: block)
feature on(x: block, y: block)
feature heavy(x: box)
feature at(x: block) -> place
feature count() -> int64
feature level(x: block) -> int32
feature size(x: block) -> float32
feature width(x: block) -> Length
feature mass(x: block) -> Mass
feature position(x: block) -> Pose
feature extent(x: block) -> Size
feature label(x: block) -> string

def near(p: Pose, q: Pose) -> bool
def middle(p: Pose, q: Pose) -> Pose
def number(x: block) -> float32

controller pick(x: block)
controller go(p: Pose)
"""
"""Declarations that cases of statements and expressions share; they use line 1 to 31."""


def compiled(text: str, prelude: str = "") -> Compilation:
    """The compilation of a domain given as text; read as from standard input."""
    whole = f"{prelude}{text}".encode()
    return compilation(["-"], read_standard_input=lambda: whole)


def diagnose(text: str, prelude: str = "") -> tuple[Diagnostic, ...]:
    """Everything found in a domain given as text, in source order."""
    compiling = compiled(text, prelude)
    try:
        _ = compiling.checked
    except CompileError as error:
        return error.diagnostics
    return compiling.found.sorted()


def codes(text: str, prelude: str = "") -> list[str]:
    """The codes of everything found, in source order."""
    return [diagnostic.code for diagnostic in diagnose(text, prelude)]


def program(text: str, prelude: str = "") -> Program:
    """The typed program of a text without errors."""
    return compiled(text, prelude).program


def effect(lines: str, parameters: str = "x: block, y: block") -> list[str]:
    """The codes found in an effect over the shared declarations."""
    return codes(_behavior(lines, parameters, "eff"), PRELUDE)


def body(lines: str, parameters: str = "x: block, y: block") -> list[str]:
    """The codes found in a body over the shared declarations."""
    return codes(_behavior(lines, parameters, "body"), PRELUDE)


def _behavior(lines: str, parameters: str, section: str) -> str:
    names = [p.split(":")[0].strip() for p in parameters.split(",") if p.strip()]
    indented = "".join(f"    {line}\n" for line in lines.splitlines())
    # A `let` before keeps the lint for unused parameters out of the way.
    mentions = "".join(f"    let _{name} = {name}\n" for name in names)
    other = f"  body:\n{mentions}" if section == "eff" else ""
    inside = mentions if section == "body" else ""
    return f"behavior r({parameters}):\n{other}  {section}:\n{inside}{indented}"


def value(expression: str) -> list[str]:
    """The codes found in an expression with blocks `x`, `y` and a box `b` in scope."""
    return body(f"let _ = {expression}", "x: block, y: block, b: box")


def condition(expression: str) -> list[str]:
    """The codes found in a condition with blocks `x`, `y` and a box `b` in scope."""
    return body(f"assert {expression}", "x: block, y: block, b: box")
