"""Random small behaviors, and every small state to try them in."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain, combinations, product

from hypothesis import strategies as st

from crow.evaluate import EvaluationError, holds
from crow.problem import State, World
from crow.program import Behavior, ObjectType, Parameter, Program
from crow.transition import Unmet, apply

HEADER = """
typedef T
typedef U: T
feature p(x: T)
feature on(x: T, y: T)
feature [[min=0, max=3]] n() -> int32
"""
# Universes of objects by their types.
UNIVERSES = [(), ("T",), ("U",), ("T", "T"), ("T", "U"), ("U", "U")]
VARIABLES = {"x": "T", "y": "T", "u": "U"}


@st.composite
def terms(draw: st.DrawFn, scope: tuple[str, ...]) -> str:
    return draw(st.sampled_from(scope))


@st.composite
def numbers(draw: st.DrawFn, depth: int = 1) -> str:
    kind = draw(st.integers(0, 6 if depth else 2))
    if kind > 2:
        left, right = draw(numbers(depth - 1)), draw(numbers(depth - 1))
        return f"({left} {draw(st.sampled_from(['+', '-', '*', '//', '%']))} {right})"
    return "n()" if kind else str(draw(st.integers(-2, 3)))


@st.composite
def conditions(draw: st.DrawFn, scope: tuple[str, ...], depth: int = 2) -> str:
    kind = draw(st.integers(0, 9 if depth else 4))
    inner = conditions(scope, depth - 1)
    match kind:
        case 0 | 1 if scope:
            return f"p({draw(terms(scope))})"
        case 2 if scope:
            return f"on({draw(terms(scope))}, {draw(terms(scope))})"
        case 3 if scope:
            return (
                f"({draw(terms(scope))} {draw(st.sampled_from(['==', '!=']))} {draw(terms(scope))})"
            )
        case 5:
            return f"(not {draw(inner)})"
        case 6 | 7:
            return f"({draw(inner)} {draw(st.sampled_from(['and', 'or']))} {draw(inner)})"
        case 8 | 9:
            name = f"z{depth}"
            body = draw(conditions((*scope, name), depth - 1))
            type_ = draw(st.sampled_from(["T", "U"]))
            return f"({draw(st.sampled_from(['forall', 'exists']))} {name}: {type_}: {body})"
        case _:
            operator = draw(st.sampled_from(["==", "<", "<="]))
            return f"({draw(numbers())} {operator} {draw(numbers())})"


@st.composite
def writes(draw: st.DrawFn, scope: tuple[str, ...]) -> str:
    kind = draw(st.integers(0, 3))
    if kind == 0 or not scope:
        return f"n[...] = {draw(numbers(2))}"
    cell = f"p[{draw(terms(scope))}]"
    if kind == 1:
        cell = f"on[{draw(terms(scope))}, {draw(terms(scope))}]"
    value = draw(st.sampled_from(["True", "False", draw(conditions(scope, 1))]))
    return f"{cell} = {value}"


@st.composite
def parallel_writes(draw: st.DrawFn, scope: tuple[str, ...]) -> str:
    """A write in a loop; two iterations may meet in its cell, and perhaps differ."""
    arguments = [draw(terms(scope)) for _ in range(draw(st.integers(1, 2)))]
    cell = f"{'p' if len(arguments) == 1 else 'on'}[{', '.join(arguments)}]"
    return f"{cell} = {draw(st.one_of(st.just('True'), conditions(scope, 1)))}"


@st.composite
def effects(draw: st.DrawFn, scope: tuple[str, ...]) -> list[str]:
    lines: list[str] = []
    for index in range(draw(st.integers(1, 3))):
        match draw(st.integers(0, 4)):
            case 0:
                lines.append(f"if {draw(conditions(scope, 1))}: {draw(writes(scope))}")
            case 1:
                inner = (*scope, f"w{index}")
                write = draw(parallel_writes(inner))
                guard = draw(conditions(inner, 1))
                lines.append(f"foreach w{index}: {draw(st.sampled_from(['T', 'U']))}:")
                lines.append(f"  if {guard}: {write}")
            case _:
                lines.append(draw(writes(scope)))
    return lines


@st.composite
def claims(draw: st.DrawFn) -> str:
    """A domain with a behavior `act`."""
    scope = tuple(sorted(draw(st.sets(st.sampled_from(list(VARIABLES)), max_size=2))))
    parameters = ", ".join(f"{name}: {VARIABLES[name]}" for name in scope)
    body = [f"assert {draw(conditions(scope))}" for _ in range(draw(st.integers(0, 2)))]
    if draw(st.booleans()):
        body.append(f"bind b: T where: {draw(conditions((*scope, 'b'), 1))}")
    lines = [HEADER, f"def wanted({parameters}) -> bool:", f"  return {draw(conditions(scope))}"]
    lines += [f"behavior act({parameters}):", f"  goal: wanted({', '.join(scope)})", "  body:"]
    lines += [f"    {line}" for line in body or ["pass"]]
    lines += ["  eff:", *(f"    {line}" for line in draw(effects(scope)))]
    return "\n".join(lines) + "\n"


@dataclass(frozen=True)
class Outcomes:
    """What happens to a behavior in all small states."""

    is_applicable: bool
    fails_its_goal: bool
    has_conflict: bool


def outcomes(program: Program) -> Outcomes:
    """Run `act` in every state over at most two objects, with all arguments and binds."""
    behavior = next(b for b in program.behaviors if b.name == "act")
    found = list(_endings(program, behavior))
    return Outcomes(
        any(e in ("reached", "failed") for e in found), "failed" in found, "conflict" in found
    )


def _endings(program: Program, behavior: Behavior) -> Iterator[str]:
    binds = any(type(s).__name__ == "Bind" for s in behavior.body)
    for universe in UNIVERSES:
        objects = tuple(Parameter(f"o{i}", ObjectType(t)) for i, t in enumerate(universe))
        world = World.of(program, objects)
        domains = [world.objects_of(p.type) for p in behavior.parameters]
        choices = [{"b": o} for o in world.objects] if binds else [{}]
        for state in _states(world):
            for arguments in product(*domains):
                for binding in choices:
                    yield _ending(world, state, behavior, arguments, binding)


def _states(world: World) -> Iterator[State]:
    names = list(world.objects)
    cells = [("p", (a,)) for a in names] + [("on", (a, b)) for a in names for b in names]
    subsets = chain.from_iterable(combinations(cells, k) for k in range(len(cells) + 1))
    for true in subsets:
        for number in range(4):
            cell = {("n", ()): number} if number else {}
            yield State({**dict.fromkeys(true, True), **cell})


def _ending(
    world: World,
    state: State,
    behavior: Behavior,
    arguments: tuple[str, ...],
    binding: dict[str, str],
) -> str:
    ran = apply(world, state, behavior, arguments, binding)
    if isinstance(ran.problem, Unmet):
        return (
            "conflict" if "iterations write different" in ran.problem.reason else "not applicable"
        )
    if not 0 <= ran.state.cells.get(("n", ()), 0) <= 3:  # type: ignore[operator]
        return "not applicable"
    assert behavior.goal is not None
    names = [p.name for p in behavior.parameters]
    try:
        is_reached = holds(
            world, ran.state, behavior.goal, dict(zip(names, arguments, strict=True))
        )
    except EvaluationError:
        return "reached"  # a goal without a value is not one that is false
    return "reached" if is_reached else "failed"
