"""Random programs with truth values, objects and numbers: text of a domain, and states for it."""

from dataclasses import dataclass
from itertools import product

from hypothesis import strategies as st

TYPES = {"T": None, "U": "T", "P": None}
OBJECTS = {"t1": "T", "u1": "U", "u2": "U", "home": "P", "p1": "P"}
CONSTANT = "home"
# Name: types of the parameters, and of the value.
FEATURES = {
    "on": (("T",), "bool"),
    "clear": (("P",), "bool"),
    "flag": ((), "bool"),
    "loc": (("T",), "P"),
    "next": (("P",), "P"),
    "owner": (("P",), "U"),
    "best": ((), "T"),
    "n": (("T",), "int64"),
    "m": (("P",), "int64"),
    "total": ((), "int64"),
    "w": (("U",), "float64"),
}
PARAMETERS = {"x": "T", "y": "T", "u": "U", "p": "P", "q": "P"}
NUMBERS = ("int64", "float64")
Scope = dict[str, str]


def is_of(type_: str | None, wanted: str) -> bool:
    while type_ is not None and type_ != wanted:
        type_ = TYPES.get(type_)
    return type_ == wanted


def objects_of(wanted: str) -> list[str]:
    return [name for name, type_ in OBJECTS.items() if is_of(type_, wanted)]


def cells() -> list[tuple[str, tuple[str, ...]]]:
    return [
        (name, arguments)
        for name, (types, _) in FEATURES.items()
        for arguments in product(*map(objects_of, types))
    ]


@dataclass(frozen=True)
class Case:
    """A domain with a behavior `act` of the given parameters."""

    text: str
    parameters: tuple[str, ...]

    def arguments(self) -> list[tuple[str, ...]]:
        return list(product(*(objects_of(PARAMETERS[name]) for name in self.parameters)))


HEADER = "\n".join(
    [f"typedef {name}" + (f": {base}" if base else "") for name, base in TYPES.items()]
    + [
        f"feature {name}({', '.join(f'x{i}: {t}' for i, t in enumerate(types))}) -> {value}"
        for name, (types, value) in FEATURES.items()
    ]
    + [f"object_constant {CONSTANT}: P", "controller change(x: T, p: P)"]
)


@st.composite
def objects(draw: st.DrawFn, scope: Scope, wanted: str, depth: int = 2) -> str:
    """An expression for an object of a type."""
    names = [n for n, t in {**scope, CONSTANT: "P"}.items() if is_of(t, wanted)]
    reads = [n for n, (_, value) in FEATURES.items() if is_of(value, wanted)]
    usable = [n for n in reads if depth or not FEATURES[n][0]] or reads
    if names and (not usable or not draw(st.integers(0, 2)) or not depth):
        return draw(st.sampled_from(names))
    if depth and names and not draw(st.integers(0, 4)):
        then, otherwise = (draw(objects(scope, wanted, depth - 1)) for _ in range(2))
        return f"({then} if {draw(conditions(scope, depth - 1))} else {otherwise})"
    return draw(cell(scope, draw(st.sampled_from(usable)), depth=depth - 1))


@st.composite
def cell(draw: st.DrawFn, scope: Scope, name: str, brackets: str = "()", depth: int = 1) -> str:
    """A cell of a feature."""
    chosen = [draw(objects(scope, wanted, max(depth, 0))) for wanted in FEATURES[name][0]]
    inside = ", ".join(chosen) or ("..." if brackets == "[]" else "")
    return f"{name}{brackets[0]}{inside}{brackets[1]}"


@st.composite
def numbers(draw: st.DrawFn, scope: Scope, depth: int = 2, *, real: bool = False) -> str:
    """A numeric expression; of whole numbers unless it is for a `real`."""
    kind = draw(st.integers(0, 8 if depth else 2))
    inner = numbers(scope, depth - 1, real=real)
    match kind:
        case 0:
            return str(draw(st.integers(-2, 3)))
        case 3 | 4:
            return (
                f"({draw(inner)} {draw(st.sampled_from(['+', '-', '+', '-', '*']))} {draw(inner)})"
            )
        case 5:
            return f"{draw(st.sampled_from(['min', 'max']))}({draw(inner)}, {draw(inner)})"
        case 6:
            return draw(st.sampled_from([f"abs({draw(inner)})", f"(-{draw(inner)})"]))
        case 7:
            test = draw(conditions(scope, depth - 1))
            return f"({draw(inner)} if {test} else {draw(inner)})"
        case _:
            usable = ["n", "m", "total"] + ["w"] * real
            return draw(cell(scope, draw(st.sampled_from(usable)), depth=min(depth, 1)))


@st.composite
def conditions(draw: st.DrawFn, scope: Scope, depth: int = 2) -> str:
    """A Boolean expression, in parentheses."""
    kind = draw(st.integers(0, 9 if depth else 3))
    inner = conditions(scope, depth - 1)
    match kind:
        case 1:
            wanted = draw(st.sampled_from(["T", "P"]))
            sides = [draw(objects(scope, wanted, min(depth, 1))) for _ in range(2)]
            return f"({sides[0]} {draw(st.sampled_from(['==', '!=']))} {sides[1]})"
        case 2 | 3:
            sides = [draw(numbers(scope, min(depth, 1))) for _ in range(2)]
            operator = draw(st.sampled_from(["==", "!=", "<", "<=", ">", ">="]))
            return f"({sides[0]} {operator} {sides[1]})"
        case 4:
            return f"(not {draw(inner)})"
        case 5 | 6:
            return f"({draw(inner)} {draw(st.sampled_from(['and', 'or', '^']))} {draw(inner)})"
        case 7:
            return f"({draw(inner)} if {draw(inner)} else {draw(inner)})"
        case 8:
            name, type_ = draw(st.sampled_from([("z", "U"), ("x", "T"), ("r", "P")]))
            body = draw(conditions({**scope, name: type_}, depth - 1))
            return f"({draw(st.sampled_from(['forall', 'exists']))} {name}: {type_}: {body})"
        case _:
            name = draw(st.sampled_from(["on", "clear", "flag"]))
            return draw(cell(scope, name, depth=min(depth, 1)))


@st.composite
def values(draw: st.DrawFn, scope: Scope, type_: str) -> str:
    """A value of a feature's type."""
    if type_ == "bool":
        return draw(st.sampled_from(["True", "False", draw(conditions(scope))]))
    if type_ in NUMBERS:
        return draw(numbers(scope, real=type_ == "float64"))
    return draw(objects(scope, type_))


@st.composite
def assignments(draw: st.DrawFn, scope: Scope) -> str:
    """A write of any feature."""
    name = draw(st.sampled_from(list(FEATURES)))
    type_ = FEATURES[name][1]
    operator = draw(st.sampled_from(["+=", "-=", "="])) if type_ in NUMBERS else "="
    where = draw(cell(scope, name, "[]"))
    return f"{where} {operator} {draw(values(scope, type_))}"


@st.composite
def effects(draw: st.DrawFn, scope: Scope, size: int) -> list[str]:
    """Lines of assignments, locals, branches and loops."""
    lines: list[str] = []
    for number in range(draw(st.integers(1, size))):
        match draw(st.integers(0, 6)):
            case 0:
                lines.append(f"let k{number} = {draw(objects(scope, 'P'))}")
                scope = {**scope, f"k{number}": "P"}
            case 1 | 2:
                lines += [f"if {draw(conditions(scope))}:", f"  {draw(assignments(scope))}"]
                if draw(st.booleans()):
                    lines += ["else:", f"  {draw(assignments(scope))}"]
            case 3:
                lines += draw(loops(scope))
            case _:
                lines.append(draw(assignments(scope)))
    return lines


@st.composite
def loops(draw: st.DrawFn, scope: Scope) -> list[str]:
    """A `foreach` that mostly writes cells of its own."""
    name, type_ = draw(st.sampled_from([("z", "U"), ("x", "T"), ("r", "P")]))
    inner = {**scope, name: type_}
    own = [f for f, (types, _) in FEATURES.items() if types and is_of(type_, types[0])]
    feature = draw(st.sampled_from(own))
    value = FEATURES[feature][1]
    write = f"{feature}[{name}] = {draw(values(inner, value))}"
    if value in NUMBERS and draw(st.booleans()):
        write = f"{feature}[{name}] += {draw(values(inner, value))}"
    if not draw(st.integers(0, 4)):
        flag = draw(st.sampled_from(["True", "False"]))
        write = (
            draw(st.sampled_from([f"clear[next(loc({name}))] = {flag}"]))
            if is_of(type_, "T")
            else f"on[owner({name})] = {flag}"
        )
    lines = [f"foreach {name}: {type_}:"]
    if draw(st.booleans()):
        return [*lines, f"  if {draw(conditions(inner, 1))}: {write}"]
    return [*lines, f"  {write}"]


def _block(head: str, lines: list[str], indent: int) -> list[str]:
    space = " " * indent
    return [space + head, *(f"{space}  {line}" for line in lines or ["pass"])]


@st.composite
def cases(draw: st.DrawFn) -> Case:
    """A domain with the behavior `act`."""
    names = tuple(sorted(draw(st.sets(st.sampled_from(list(PARAMETERS)), max_size=3))))
    scope = {name: PARAMETERS[name] for name in names}
    body = [f"assert {draw(conditions(scope))}" for _ in range(draw(st.integers(0, 2)))]
    if draw(st.booleans()):
        wanted = f"do change({draw(objects(scope, 'T'))}, {draw(objects(scope, 'P'))})"
        body.append(wanted)
    lines = [HEADER, f"behavior act({', '.join(f'{n}: {t}' for n, t in scope.items())}):"]
    lines += _block("body:", body, 2)
    lines += _block("eff:", draw(effects(scope, 4)), 2)
    return Case("\n".join(lines) + "\n", names)


def _values_of(type_: str) -> st.SearchStrategy[object]:
    if type_ == "bool":
        return st.booleans()
    if type_ in NUMBERS:
        whole = st.integers(-2, 3)
        return whole if type_ == "int64" else whole.map(lambda n: n / 2)
    return st.sampled_from(objects_of(type_))


STATES: st.SearchStrategy[dict[tuple[str, tuple[str, ...]], object]] = st.fixed_dictionaries(
    {cell_: _values_of(FEATURES[cell_[0]][1]) for cell_ in cells()}
)
