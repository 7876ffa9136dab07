"""Random Boolean programs: text of a domain, and states and arguments for it."""

from dataclasses import dataclass
from itertools import product

from hypothesis import strategies as st

# A hierarchy with a chain, a sibling and a type of its own.
TYPES = {"T": None, "U": "T", "W": "T", "V": None}
OBJECTS = {"t1": "T", "u1": "U", "u2": "U", "w1": "W", "v1": "V"}
FEATURES = {"a": (), "p": ("T",), "q": ("U",), "on": ("T", "T"), "in": ("V", "U")}
PARAMETERS = {"x": "T", "y": "T", "u": "U", "v": "V", "w": "U"}


def is_of(type_: str | None, wanted: str) -> bool:
    while type_ is not None and type_ != wanted:
        type_ = TYPES[type_]
    return type_ == wanted


def objects_of(wanted: str) -> list[str]:
    return [name for name, type_ in OBJECTS.items() if is_of(type_, wanted)]


@dataclass(frozen=True)
class Case:
    """A domain with a behavior `act` of the given parameters, and conditions of its body."""

    text: str
    parameters: tuple[str, ...]

    def arguments(self) -> list[tuple[str, ...]]:
        return list(product(*(objects_of(PARAMETERS[name]) for name in self.parameters)))


HEADER = "\n".join(
    [f"typedef {name}" + (f": {base}" if base else "") for name, base in TYPES.items()]
    + [
        f"feature {name}({', '.join(f'x{i}: {t}' for i, t in enumerate(types))})"
        for name, types in FEATURES.items()
    ]
    + ["object_constant home: U"]
)
OBJECTS["home"] = "U"
CELLS = [
    (name, arguments)
    for name, types in FEATURES.items()
    for arguments in product(*map(objects_of, types))
]


@st.composite
def cells(draw: st.DrawFn, scope: dict[str, str], brackets: str = "()") -> str:
    """A cell over the variables and constants in scope."""
    terms = {**scope, "home": "U"}
    usable = [
        name
        for name, types in FEATURES.items()
        if all(any(is_of(t, wanted) for t in terms.values()) for wanted in types)
    ]
    name = draw(st.sampled_from(usable))
    chosen = [
        draw(st.sampled_from([n for n, t in terms.items() if is_of(t, wanted)]))
        for wanted in FEATURES[name]
    ]
    inside = ", ".join(chosen) or ("..." if brackets == "[]" else "")
    return f"{name}{brackets[0]}{inside}{brackets[1]}"


@st.composite
def conditions(
    draw: st.DrawFn,
    scope: dict[str, str],
    flags: tuple[str, ...] = (),
    functions: tuple[str, ...] = (),
    depth: int = 2,
) -> str:
    """A Boolean expression, in parentheses; `functions` take a `T`."""
    kind = draw(st.integers(0, 9 if depth else 3))
    objects = [name for name, type_ in scope.items() if is_of(type_, "T")]
    if kind == 0 and flags:
        return draw(st.sampled_from(flags))
    if kind == 1 and len(objects) > 1:
        pair = [draw(st.sampled_from(objects)) for _ in range(2)]
        if is_of(scope[pair[0]], scope[pair[1]]) or is_of(scope[pair[1]], scope[pair[0]]):
            return f"({pair[0]} {draw(st.sampled_from(['==', '!=']))} {pair[1]})"
    if kind == 2 and functions and objects:
        return f"{draw(st.sampled_from(functions))}({draw(st.sampled_from(objects))})"
    inner = conditions(scope, flags, functions, depth - 1)
    match kind:
        case 4:
            return f"(not {draw(inner)})"
        case 5 | 6:
            word = draw(st.sampled_from(["and", "or", "^", "=="]))
            return f"({draw(inner)} {word} {draw(inner)})"
        case 7:
            return f"({draw(inner)} if {draw(inner)} else {draw(inner)})"
        case 8 | 9:
            name, type_ = draw(st.sampled_from([("x", "T"), ("z", "U"), ("u", "U"), ("v", "V")]))
            shadowed = {**scope, name: type_}
            body = draw(conditions(shadowed, flags, functions, depth - 1))
            return f"({draw(st.sampled_from(['forall', 'exists']))} {name}: {type_}: {body})"
        case _:
            return draw(cells(scope))


@st.composite
def effects(
    draw: st.DrawFn, scope: dict[str, str], functions: tuple[str, ...], size: int
) -> list[str]:
    """Lines of assignments and locals."""
    lines: list[str] = []
    flags: tuple[str, ...] = ()
    for number in range(draw(st.integers(1, size))):
        kind = draw(st.integers(0, 9))
        value = draw(conditions(scope, flags, functions))
        if kind == 0:
            lines.append(f"let k{number} = {value}")
            flags = (*flags, f"k{number}")
        elif kind == 1 and flags:
            lines.append(f"{draw(st.sampled_from(flags))} = {value}")
        elif kind == 2 and "x" in scope:
            lines.append(f"let o{number} = x")
            scope = {**scope, f"o{number}": scope["x"]}
        elif kind == 3:
            lines += draw(branches(scope, flags, functions))
        elif kind == 4:
            lines += draw(loops(scope, flags, functions))
        else:
            lines.append(draw(assignments(scope, value)))
    return lines


@st.composite
def assignments(draw: st.DrawFn, scope: dict[str, str], value: str) -> str:
    """A write of a constant or of the value given."""
    constant = draw(st.sampled_from(["True", "False", value]))
    return f"{draw(cells(scope, '[]'))} = {constant}"


@st.composite
def branches(
    draw: st.DrawFn, scope: dict[str, str], flags: tuple[str, ...], functions: tuple[str, ...]
) -> list[str]:
    """An `if`, perhaps with an `else`."""
    condition, value = (draw(conditions(scope, flags, functions, 1)) for _ in range(2))
    lines = [f"if {condition}:", f"  {draw(assignments(scope, value))}"]
    if draw(st.booleans()):
        lines += ["else:", f"  {draw(assignments(scope, value))}"]
    return lines


@st.composite
def loops(
    draw: st.DrawFn, scope: dict[str, str], flags: tuple[str, ...], functions: tuple[str, ...]
) -> list[str]:
    """A `foreach` whose iterations write cells of their own."""
    name, type_ = draw(st.sampled_from([("z", "U"), ("x", "T")]))
    inner = {**scope, name: type_}
    others = [n for n, t in inner.items() if is_of(t, "T")]
    other = draw(st.sampled_from(others))
    usable = [f"p[{name}]", f"on[{name}, {other}]", f"on[{other}, {name}]"]
    usable += [f"q[{name}]"] if is_of(type_, "U") else []
    value = draw(st.sampled_from(["True", "False", draw(conditions(inner, flags, functions, 1))]))
    write = f"{draw(st.sampled_from(usable))} = {value}"
    lines = [f"foreach {name}: {type_}:"]
    if draw(st.booleans()):
        return [*lines, f"  if {draw(conditions(inner, flags, functions, 1))}: {write}"]
    return [*lines, f"  {write}"]


def _block(head: str, lines: list[str], indent: int) -> list[str]:
    space = " " * indent
    return [space + head, *(f"{space}  {line}" for line in lines or ["pass"])]


@st.composite
def cases(draw: st.DrawFn, *, with_body: bool = False) -> Case:
    """A domain with a derived function, a controller with an effect, and the behavior `act`."""
    names = tuple(sorted(draw(st.sets(st.sampled_from(list(PARAMETERS)), max_size=3))))
    scope = {name: PARAMETERS[name] for name in names}
    lines = [HEADER, "def some(y: T):"]
    lines.append(f"  return {draw(conditions({'y': 'T'}))}")
    lines += ["controller change(x: T, y: T):"]
    lines += _block("eff:", draw(effects({"x": "T", "y": "T"}, ("some",), 2)), 2)
    body = []
    objects = [name for name in names if is_of(scope[name], "T")]
    if with_body:
        body += [
            f"assert {draw(conditions(scope, (), ('some',)))}"
            for _ in range(draw(st.integers(0, 2)))
        ]
    if objects and draw(st.booleans()):
        pair = ", ".join(draw(st.sampled_from(objects)) for _ in range(2))
        body.append(f"do change({pair})")
        if with_body and draw(st.booleans()):
            body.append(f"assert {draw(conditions(scope, (), ('some',)))}")
    lines.append(f"behavior act({', '.join(f'{n}: {t}' for n, t in scope.items())}):")
    lines += _block("body:", body, 2)
    lines += _block("eff:", draw(effects(scope, ("some",), 4)), 2)
    return Case("\n".join(lines) + "\n", names)


STATES = st.sets(st.sampled_from(CELLS)).map(lambda true: frozenset(sorted(true)))
