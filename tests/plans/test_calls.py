# ruff: noqa: E501 - tables of cases, one a line
"""Calls as users write them: read, resolved, and refused with a place."""

import pytest
from programs import start

from cdlc.plans.calls import (
    BadStepError,
    BehaviorCall,
    read_call,
    resolve_behavior,
    resolve_controller,
)
from cdlc.source import SourceFile, Span

DOMAIN = """
typedef T
typedef U: T
typedef pose: vector[float32, 2]
feature p(x: T)
controller go(x: T)
controller say(x: T, n: int32, f: float32, s: string, v: pose, flag: bool)
behavior act(x: T, u: U):
  body:
    bind y: T where: p(y)
    bind n: int64 where: n > 0
    called(x)
  eff: p[x] = True
behavior called(x: T):
  body:
    bind z: U where: p(z)
  eff: p[x] = False
behavior none():
  eff: pass
"""
WORLD, _ = start(DOMAIN, "a, b: T; u: U")


def resolved(text: str) -> BehaviorCall:
    source = SourceFile("<step 1>", text)
    return resolve_behavior(read_call(source, Span(0, len(text))), WORLD)


def spoken(*arguments: str) -> tuple[object, ...]:
    text = f"say({', '.join(arguments)})"
    call = read_call(SourceFile("<step 1>", text), Span(0, len(text)))
    return resolve_controller(call, WORLD)[1]


@pytest.mark.parametrize(
    ("text", "arguments", "bindings"),
    [
        ("act(a, u)", ("a", "u"), {}),
        ("  act ( a ,u )  ", ("a", "u"), {}),
        ("act(u, u, y=b)", ("u", "u"), {"y": "b"}),
        ("act(a, u, y = b, n=3)", ("a", "u"), {"y": "b", "n": 3}),
        ("act(a, u, z=u)", ("a", "u"), {"z": "u"}),
        ("act(a, u, y=b, y_2=a)", ("a", "u"), {"y": "b", "y_2": "a"}),
        ("act(a, u,)", ("a", "u"), {}),
        ("none()", (), {}),
        ("none( )", (), {}),
    ],
)
def test_behaviors(text: str, arguments: tuple[str, ...], bindings: dict[str, object]) -> None:
    call = resolved(text)
    assert (call.arguments, call.bindings) == (arguments, bindings)


@pytest.mark.parametrize(
    ("text", "reason", "columns"),
    [
        ("", "a step is `behavior(a, b, name=c)`", (1, 1)),
        ("act", "a step is `behavior(a, b, name=c)`", (1, 4)),
        ("act(a, u", "a step is `behavior(a, b, name=c)`", (1, 9)),
        ("act(a u)", "expected a value, or `name=value`", (5, 8)),
        ("act(a, , u)", "expected a value, or `name=value`", (7, 11)),
        ("act(a, (u))", "expected a value, or `name=value`", (7, 11)),
        ("akt(a, u)", "unknown behavior `akt`", (1, 10)),
        ("go(a)", "unknown behavior `go`", (1, 6)),
        ("act(a)", "`act` takes 2 arguments, not 1", (1, 7)),
        ("called(a, b)", "`called` takes 1 argument, not 2", (1, 13)),
        ("act(c, u)", "no object `c`", (5, 6)),
        ("act(a, b)", "`b` is a `T`, not a `U`", (8, 9)),
        ("act(1, u)", "no object `1`", (5, 6)),
        ('act("a", u)', 'no object `"a"`', (5, 8)),
        ("act(a, u, k=b)", "`act` binds no `k`", (13, 14)),
        ("act(a, u, y_=b)", "`act` binds no `y_`", (14, 15)),
        ("act(a, u, y=c)", "no object `c`", (13, 14)),
        ("act(a, u, n=b)", "`b` is no value of type `int64`", (13, 14)),
        ("act(a, u, n=1.5)", "`1.5` is no value of type `int64`", (13, 16)),
        ("act(a, u, y=b, y=a)", "`y` is given twice", (18, 19)),
        ("act(a, u, n=99999999999999999999)", "99999999999999999999 does not fit into `int64`", (13, 33)),
        ("act(a, u, n=" + "9" * 5000 + ")", "`" + "9" * 40 + "` is no value of type `int64`", (13, 5013)),
    ],
)  # fmt: skip
def test_what_is_no_call_of_a_behavior(text: str, reason: str, columns: tuple[int, int]) -> None:
    with pytest.raises(BadStepError) as raised:
        resolved(text)
    found = raised.value.diagnostic
    assert found.code == "bad-step"
    assert found.message() == reason
    assert (found.location.file, found.location.line) == ("<step 1>", 1)
    assert (found.location.column, found.location.end_column) == columns


def test_near_misses_are_suggested() -> None:
    with pytest.raises(BadStepError) as raised:
        resolved("actt(a, u)")
    assert [h.text for h in raised.value.diagnostic.help()] == ["did you mean `act`?"]
    with pytest.raises(BadStepError) as raised:
        resolved("act(A, u)")
    assert [h.text for h in raised.value.diagnostic.help()] == ["did you mean `a`?"]


def test_values_of_every_type() -> None:
    assert spoken("a", "-3", "1", '"two words"', "[1, -2.5]", "True") == (
        "a", -3, 1.0, "two words", (1.0, -2.5), True,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("position", "value"),
    [(1, "2147483648"), (1, "True"), (2, "a"), (2, "1e999"), (2, "1e99999"), (3, "words"),
     (4, "[1]"), (4, "[1, a]"), (4, "3"), (5, "1"), (5, "true")],
)  # fmt: skip
def test_values_of_no_type(position: int, value: str) -> None:
    arguments = ["a", "1", "1.5", '"s"', "[1, 2]", "True"]
    arguments[position] = value
    with pytest.raises(BadStepError) as raised:
        spoken(*arguments)
    assert raised.value.diagnostic.location.line == 1


def test_controllers() -> None:
    source = SourceFile("plan", "go(a)\ngo(x=a)\nact(a)\n")
    controller, arguments = resolve_controller(read_call(source, Span(0, 5)), WORLD)
    assert (controller.name, arguments) == ("go", ("a",))
    with pytest.raises(BadStepError, match="have no names") as raised:
        resolve_controller(read_call(source, Span(6, 13)), WORLD)
    assert raised.value.diagnostic.location.line == 2
    with pytest.raises(BadStepError, match="unknown controller `act`"):
        resolve_controller(read_call(source, Span(14, 20)), WORLD)
