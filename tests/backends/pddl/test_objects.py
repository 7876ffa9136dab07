"""Object-valued features: predicates with one value, and reads that bind parameters."""

import re

import pytest
from programs import emitted, task_of

HEAD = """
typedef T
typedef P
typedef Q: P
object_constant home: Q
feature loc(x: T) -> P
feature room(x: T) -> Q
feature next(p: P) -> P
feature clear(p: P)
controller go(x: T, p: P)
"""


def action(body: str, eff: str, parameters: str = "x: T, y: T, p: P") -> str:
    def block(name: str, lines: str) -> str:
        return f"  {name}:\n" + "".join(f"    {line}\n" for line in lines.splitlines() or ["pass"])

    text = f"{HEAD}behavior act({parameters}):\n{block('body', body)}{block('eff', eff)}"
    return re.sub(r"\s+", " ", task_of(text).domain.split("(:action ")[1])


def parameters(text: str) -> str:
    return text.split(":parameters ")[1].split(" :precondition")[0]


@pytest.mark.parametrize(
    ("body", "eff", "expected"),
    [
        # The old value is a parameter, unless a precondition says what it is.
        ("", "loc[x] = p", "(?x - T ?p ?old - P)"),
        ("assert loc(x) == p", "loc[x] = home", "(?x - T ?p - P)"),
        ("assert loc(x) == home", "loc[x] = p", "(?x - T ?p - P)"),
        ("bind q: P where: loc(x) == q", "loc[x] = p", "(?x - T ?p ?q - P)"),
        # One for all reads of a term.
        ("assert clear(loc(x))", "clear[loc(x)] = False\nclear[next(loc(x))] = True",
         "(?x - T ?loc ?next - P)"),
        # What an equality fixes is none.
        ("assert p == home", "clear[p] = True", "()"),
        ("assert x == y", "loc[x] = loc(y)", "(?x - T ?old - P)"),
        ("assert loc(x) == next(p) and loc(y) == next(p)", "clear[loc(y)] = True",
         "(?x ?y - T ?p ?loc - P)"),
        # Nor is what a branch writes.
        ("", "if clear(p): loc[x] = home", "(?x - T ?p - P)"),
    ],
)  # fmt: skip
def test_parameters(body: str, eff: str, expected: str) -> None:
    assert parameters(action(body, eff)) == expected


def test_a_parameter_that_is_fixed_leads_back() -> None:
    body = "    assert p == home and q == p\n    do go(x, q)\n"
    task = task_of(f"{HEAD}behavior act(x: T, p: P, q: P):\n  body:\n{body}  eff: loc[x] = q\n")
    (act,) = task.actions
    assert [p.name for p in act.parameters] == ["x", "old"]
    (source,) = act.sources
    chosen = [(c.variable.name, c.parameter, c.object) for c in source.variables]
    assert chosen == [("x", "x", None), ("p", None, "home"), ("q", None, "home")]


def test_reads_merge_with_binds_of_the_same() -> None:
    text = (
        HEAD
        + "behavior one(x: T, p: P):\n  body: do go(x, p)\n  eff: loc[x] = p\n"
        + "behavior two(y: T, q: P):\n  body:\n    bind r: P where: loc(y) == r\n    do go(y, q)\n"
        + "  eff: loc[y] = q\n"
    )
    (act,) = task_of(text).actions
    assert [source.behavior for source in act.sources] == ["one", "two"]


def test_a_value_of_a_wider_type_is_compared_with_what_is_read() -> None:
    text = action("assert room(x) == p", "clear[p] = True")
    assert "(room ?x ?p)" not in text
    assert parameters(text) == "(?x - T ?room - Q)"


def test_what_a_precondition_excludes_needs_no_guard() -> None:
    text = action("assert loc(x) != p", "clear[loc(x)] = True\nclear[p] = False")
    assert "when" not in text


def test_every_cell_needs_an_initial_value() -> None:
    init = "  next[home] = home\n  loc[a] = home\n"
    problem = f'problem "p"\nobjects:\n  a, b: T\ninit:\n{init}goal: True\n'
    task, found, _ = emitted(HEAD, problem)
    assert task is None
    messages = sorted(d.message() for d in found)
    assert messages == [
        "`loc(b)` has no initial value, which PDDL needs",
        "`room(a)` has no initial value nor have 1 more cells, which PDDL needs",
    ]
