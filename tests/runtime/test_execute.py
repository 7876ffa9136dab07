"""Effects, statement by statement: order, aliasing, locals, branches, loops and `foreach` (D.3)."""

import time
from textwrap import dedent, indent

import pytest
from programs import program_of, start

from crow.evaluate import EvaluationError, execute
from crow.problem import State
from crow.values import Value

DECLARATIONS = """
typedef T
typedef U: T
typedef void
feature p(x: T)
feature q(x: T)
feature on(x: T, y: T)
feature f(x: T) -> int32
feature g(x: T) -> int32
feature r(x: T) -> float32
feature v(x: T) -> vector[float32, 2]
feature n() -> int64
feature place(x: T) -> T
def one_more(x: T) -> int64: return f(x) + 1
"""
OBJECTS = "a, b: T; c: U"


def after(effect: str, init: str = "pass", objects: str = OBJECTS, **arguments: Value) -> State:
    """The state after the effect of `act(x: T, y: T)`, x and y being a and b unless told."""
    text = DECLARATIONS + "behavior act(x: T, y: T):\n  eff:\n" + indent(dedent(effect), "    ")
    world, state = start(text, objects, init)
    (behavior,) = world.program.behaviors
    assert behavior.effect is not None
    return execute(world, state, behavior.effect, {"x": "a", "y": "b", **arguments})


def cells(state: State) -> dict[str, Value]:
    """Cells as `f(a, b)`."""
    return {f"{name}({', '.join(where)})": value for (name, where), value in state.cells.items()}


@pytest.mark.parametrize(
    ("effect", "expected"),
    [
        ("f[x] = 1\ng[x] = f(x) + 1", {"f(a)": 1, "g(a)": 2}),
        ("g[x] = f(x) + 1\nf[x] = 1", {"f(a)": 1, "g(a)": 1}),
        ("f[x] = 1\nf[y] = 2\ng[x] = f(x)", {"f(a)": 1, "f(b)": 2, "g(a)": 1}),
        ("f[x] = 1\nf[x] = 2", {"f(a)": 2}),
        ("f[x] = 1\nf[x] = 0", {}),
        ("p[x] = True\np[x] = False", {}),
        ("f[x] += 3\nf[x] *= 4\nf[x] -= 2", {"f(a)": 10}),
        ("n += 1\nn[...] += 1", {"n()": 2}),
        ("r[x] += 1\nr[x] /= 4", {"r(a)": 0.25}),
        ("v[x] = [1, 2]\nv[x] += [1, 1]\nv[x] = v(x) * 2", {"v(a)": (4.0, 6.0)}),
        ("f[x] = 2 if p(y) else 3", {"f(a)": 3}),
        ("f[x] = one_more(x)\nf[x] = one_more(x)", {"f(a)": 2}),
        ("place[x] = y\np[place(x)] = True", {"place(a)": "b", "p(b)": True}),
        ("let k = f(x)\nf[x] = 5\ng[x] = k", {"f(a)": 5}),
        ("let k = 1\nk = k + 1\nk += 1\nf[x] = k", {"f(a)": 3}),
    ],
)
def test_statements_run_in_order(effect: str, expected: dict[str, Value]) -> None:
    assert cells(after(effect)) == expected


def test_parameters_may_be_the_same_object() -> None:
    effect = "f[x] = 1\nf[y] = 2\ng[x] = f(x)"
    assert cells(after(effect, y="a")) == {"f(a)": 2, "g(a)": 2}
    assert cells(after("p[x] = True\np[y] = False", y="a")) == {}
    assert cells(after("p[x] = False\np[y] = True", y="a")) == {"p(a)": True}


@pytest.mark.parametrize(
    ("init", "expected"),
    [
        ("f[a] = 1", {"f(a)": 1, "g(a)": 10}),
        ("f[a] = 2", {"f(a)": 2, "g(a)": 20}),
        ("f[a] = 3", {"f(a)": 3, "g(a)": 30}),
    ],
)
def test_branches(init: str, expected: dict[str, Value]) -> None:
    effect = """
    if f(x) == 1:
      g[x] = 10
    elif f(x) == 2:
      g[x] = 20
    else:
      g[x] = 30
    """
    assert cells(after(effect, init)) == expected


def test_a_condition_sees_what_stands_before_it() -> None:
    effect = "p[x] = True\nif p(x):\n  p[x] = False\n  q[x] = True\nif p(x): q[y] = True"
    assert cells(after(effect)) == {"q(a)": True}


@pytest.mark.parametrize(
    ("effect", "expected"),
    [
        ("for i in range(4): f[x] += i", {"f(a)": 6}),
        ("for i in range(1, 4): f[x] += i", {"f(a)": 6}),
        ("for i in range(6, 0, -2): f[x] = f(x) * 10 + i", {"f(a)": 642}),
        ("for i in range(0): f[x] = 9", {}),
        ("for i in range(5):\n  if i == 3: break\n  f[x] += 1", {"f(a)": 3}),
        ("for i in range(5):\n  if i == 3: continue\n  f[x] += 1", {"f(a)": 4}),
        (
            """
            for i in range(3):
              for j in range(3):
                if j == 1: break
                f[x] += 1
              g[x] += 1
            """,
            {"f(a)": 3, "g(a)": 3},
        ),
        ("let k = 0\nfor i in range(3): k = k + i\nf[x] = k", {"f(a)": 3}),
        ("for i in range(3):\n  let k = i\n  k = k + 1\n  f[x] += k", {"f(a)": 6}),
    ],
)
def test_counted_loops(effect: str, expected: dict[str, Value]) -> None:
    assert cells(after(effect)) == expected


@pytest.mark.parametrize(
    ("effect", "expected"),
    [
        ("let k = 1\nif True:\n  let k = 2\n  g[x] = k\nf[x] = k", {"f(a)": 1, "g(a)": 2}),
        ("let k = 1\nif False: pass\nelse:\n  let k = 2\nf[x] = k", {"f(a)": 1}),
        ("let k = 1\nif True:\n  k = 3\n  let k = 2\nf[x] = k", {"f(a)": 3}),
        ("let i = 7\nfor i in range(3): g[x] = i\nf[x] = i", {"f(a)": 7, "g(a)": 2}),
        ("let k = 7\nfor i in range(3):\n  let k = i\nf[x] = k", {"f(a)": 7}),
        ("foreach x: T: g[x] = 1\nf[x] = 2", {"f(a)": 2, "g(a)": 1, "g(b)": 1, "g(c)": 1}),
        ("f[x] = 1\nlet x = y\nf[x] = 2", {"f(a)": 1, "f(b)": 2}),
    ],
)
def test_a_shadowed_name_comes_back_after_its_block(
    effect: str, expected: dict[str, Value]
) -> None:
    assert cells(after(effect)) == expected


@pytest.mark.parametrize(
    ("effect", "init", "expected"),
    [
        ("foreach o: T: p[o] = True", "pass", {"p(a)": True, "p(b)": True, "p(c)": True}),
        ("foreach o: U: p[o] = True", "pass", {"p(c)": True}),
        ("foreach o: void: f[x] = 1", "pass", {}),
        # every iteration reads the state before the loop …
        ("f[x] = 1\nforeach o: T: f[o] = f(x) + 1", "pass", {"f(a)": 2, "f(b)": 2, "f(c)": 2}),
        ("foreach o: T: p[o] = not (exists z: T: p(z))", "p[c] = True", {}),
        # … plus its own writes
        (
            "foreach o: T:\n  f[o] = 1\n  g[o] = f(o) + f(x)",
            "pass",
            {"f(a)": 1, "f(b)": 1, "f(c)": 1, "g(a)": 2, "g(b)": 1, "g(c)": 1},
        ),
        ("foreach o: T: f[o] += 1", "f[a] = 5", {"f(a)": 6, "f(b)": 1, "f(c)": 1}),
        # the same value twice is no conflict
        ("foreach o: T: f[x] = 4", "pass", {"f(a)": 4}),
        ("foreach o: T:\n  if p(o): f[x] = 4", "p[b] = True", {"p(b)": True, "f(a)": 4}),
        (
            "foreach o: T:\n  foreach z: U: on[o, z] = True",
            "pass",
            {"on(a, c)": True, "on(b, c)": True, "on(c, c)": True},
        ),
        (
            "foreach o, z: T:\n  if o != z: on[o, z] = True\n  else: p[o] = True",
            "pass",
            {f"on({s}, {t})": True for s in "abc" for t in "abc" if s != t}
            | {f"p({s})": True for s in "abc"},
        ),
        (
            "foreach o: T:\n  let k = f(o)\n  for i in range(2): k = k + 1\n  f[o] = k",
            "f[b] = 3",
            {"f(a)": 2, "f(b)": 5, "f(c)": 2},
        ),
        # what the loop wrote is there after it
        (
            "foreach o: U: f[o] = 1\ng[x] = f(place(x))",
            "place[a] = c",
            {"f(c)": 1, "g(a)": 1, "place(a)": "c"},
        ),
        # a write of an inner loop back to the first value is a write
        (
            "foreach o: U:\n  p[o] = False\n  foreach z: T: q[z] = p(o)",
            "p[c] = True; q[a] = True",
            {},
        ),
    ],
)  # fmt: skip
def test_foreach_is_parallel(effect: str, init: str, expected: dict[str, Value]) -> None:
    assert cells(after(effect, init)) == expected


@pytest.mark.parametrize(
    "effect",
    [
        "foreach o: T: f[x] = f(o)",
        "foreach o: T:\n  if o == a: p[x] = True\n  else: p[x] = False",
    ],
)
def test_iterations_that_write_different_values_are_an_error_with_a_place(effect: str) -> None:
    effect = effect.replace("o == a", "o == x")
    with pytest.raises(EvaluationError, match="iterations write different values to `") as raised:
        after(effect, "f[a] = 1")
    assert raised.value.location is not None


@pytest.mark.parametrize(
    ("effect", "init", "message"),
    [
        ("f[x] = 2147483647\nf[x] += 1", "pass", "2147483648 does not fit into `int32`"),
        ("n = 9223372036854775807\nn += 1", "pass", "does not fit into `int64`"),
        ("r[x] = 1e39", "pass", "does not fit into `float32`"),
        ("r[x] /= 0", "pass", "division by zero"),
        ("p[place(x)] = True", "pass", "`place(a)` has no value"),
        ("v[x] += [1, 1]", "pass", "`v(a)` has no value"),
        ("if place(x) == y: p[x] = True", "pass", "`place(a)` has no value"),
    ],
)
def test_errors_have_a_place(effect: str, init: str, message: str) -> None:
    with pytest.raises(EvaluationError) as raised:
        after(effect, init)
    assert message in str(raised.value)
    assert raised.value.location is not None


def test_the_first_of_two_cells_in_error_is_named() -> None:
    with pytest.raises(EvaluationError) as raised:
        after("f[x] = 1\nf[y] = 1 // f(c0)".replace("c0", "y"))
    assert raised.value.location is not None
    lines = len(DECLARATIONS.splitlines())
    assert raised.value.location.line == lines + 4


def test_the_state_before_is_left_alone() -> None:
    world, state = start(DECLARATIONS, OBJECTS, "p[a] = True")
    before = dict(state.cells)
    program = program_of(DECLARATIONS + "behavior act():\n  eff:\n    foreach x: T: p[x] = False\n")
    effect = program.behaviors[0].effect
    assert effect is not None
    changed = execute(world, state, effect, {})
    assert state.cells == before
    assert changed == State()


def test_float32_cells_hold_rounded_values() -> None:
    state = after("r[x] = 0.1\nv[x] = [0.1, 16777217]")
    assert state.cells["r", ("a",)] == pytest.approx(0.1, abs=1e-7)
    assert state.cells["r", ("a",)] != 0.1
    assert state.cells["v", ("a",)] == (state.cells["r", ("a",)], 16777216.0)


def test_an_effect_over_many_objects_takes_time_linear_in_their_number() -> None:
    objects = ", ".join(f"o{i}" for i in range(4000)) + ": T"
    began = time.monotonic()
    _, state = start(DECLARATIONS, objects, "foreach x: T: p[x] = True; f[x] = 1")
    assert len(state.cells) == 8000
    assert time.monotonic() - began < 5
