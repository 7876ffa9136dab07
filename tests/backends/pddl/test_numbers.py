"""Numeric effects and conditions: how they are written, and what is refused."""

import re
from textwrap import dedent

import pytest
from programs import emitted, task_of

HEAD = """
typedef T
feature n(x: T) -> int64
feature m(x: T) -> int64
feature r(x: T) -> float64
feature total() -> int64
feature p(x: T)
feature loc(x: T) -> T
"""


def effects(eff: str, parameters: str = "x: T, y: T") -> list[str]:
    lines = "".join(f"    {line}\n" for line in dedent(eff).splitlines())
    domain = task_of(f"{HEAD}behavior act({parameters}):\n  eff:\n{lines}").domain
    found = domain.split(":effect", 1)[1].rstrip().removesuffix(")))").splitlines()[1:]
    return [line.strip() for line in found]


def condition(text: str) -> str:
    behavior = f"behavior act(x: T, y: T):\n  body: assert {text}\n  eff: p[x] = True\n"
    domain = task_of(HEAD + behavior).domain
    found = domain.split(":precondition ")[1].split(":effect")[0].strip()
    return re.sub(r"\s+", " ", found.removeprefix("(and").removesuffix(")").strip())


@pytest.mark.parametrize(
    ("eff", "expected"),
    [
        ("n[x] += 2", ["(increase (n ?x) 2)"]),
        ("n[x] -= m(x)", ["(decrease (n ?x) (m ?x))"]),
        ("n[x] = 3 + n(x)", ["(increase (n ?x) 3)"]),
        ("n[x] = m(y) + n(x)", ["(increase (n ?x) (m ?y))"]),
        ("n[x] = 7 // 2", ["(assign (n ?x) 3)"]),
        ("n[x] *= 2", ["(assign (n ?x) (* (n ?x) 2))"]),
        ("r[x] = 1e-7", ["(assign (r ?x) 0.0000001)"]),
        ("r[x] = n(x) / 4", ["(assign (r ?x) (/ (n ?x) 4))"]),
        ("n[x] = -m(x)", ["(assign (n ?x) (* -1 (m ?x)))"]),
        ("n[x] = n(x)", [")"]),
        # One effect a path; equal values are joined, and a kept value is no effect.
        (
            "n[x] = 1 if p(x) else (1 if p(y) else n(x))",
            ["(when (or (p ?y) (and (not (p ?y)) (p ?x))) (assign (n ?x) 1))"],
        ),
        (
            "n[x] = max(m(x), 2)",
            [
                "(when (not (>= (m ?x) 2)) (assign (n ?x) 2))",
                "(when (>= (m ?x) 2) (assign (n ?x) (m ?x)))",
            ],
        ),
        (
            "n[x] = abs(m(y))",
            [
                "(when (not (>= (m ?y) 0)) (assign (n ?x) (* -1 (m ?y))))",
                "(when (>= (m ?y) 0) (assign (n ?x) (m ?y)))",
            ],
        ),
        # Two cells that may be one.
        ("n[x] = 1\nn[y] = 2", ["(when (not (= ?x ?y)) (assign (n ?x) 1))", "(assign (n ?y) 2)"]),
        (
            "foreach z: T: n[z] = 0\nn[x] = 1",
            ["(forall (?z - T) (when (not (= ?x ?z)) (assign (n ?z) 0)))", "(assign (n ?x) 1)"],
        ),
        # A cell that several objects lead to is written once.
        (
            "foreach z: T: n[loc(z)] = 0",
            ["(forall (?loc - T) (when (exists (?t - T) (loc ?t ?loc)) (assign (n ?loc) 0)))"],
        ),
    ],
)
def test_effects(eff: str, expected: list[str]) -> None:
    assert [line for line in effects(eff) if line != ")"] == [e for e in expected if e != ")"]


MAX = "(or (and (not (>= (n ?x) 2)) (<= (m ?x) 2)) (and (>= (n ?x) 2) (>= (n ?x) (m ?x))))"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("n(x) > 2", "(not (<= (n ?x) 2))"),
        ("n(x) < 2", "(not (>= (n ?x) 2))"),
        ("n(x) >= m(y)", "(>= (n ?x) (m ?y))"),
        ("n(x) == 2", "(= (n ?x) 2)"),
        ("n(x) != 2", "(not (= (n ?x) 2))"),
        ("n(x) - 1 <= 2", "(<= (n ?x) 3)"),
        ("1.5 <= r(x)", "(>= (r ?x) 1.5)"),
        ("max(n(x), 2) >= m(x)", MAX),
        ("n(loc(x)) >= 1", "(>= (n ?loc) 1) (loc ?x ?loc)"),
        ("r(x) / r(y) <= 1", "(<= (/ (r ?x) (r ?y)) 1) (not (= (r ?y) 0))"),
        ("forall z: T: n(loc(z)) <= 1",
         "(forall (?t - T) (exists (?t-2 - T) (and (loc ?t ?t-2) (<= (n ?t-2) 1))))"),
    ],
)  # fmt: skip
def test_conditions(text: str, expected: str) -> None:
    assert condition(text) == expected


def refusal(eff: str) -> str:
    lines = "".join(f"    {line}\n" for line in dedent(eff).splitlines())
    task, found, _ = emitted(f"{HEAD}behavior act(x: T, y: T):\n  eff:\n{lines}")
    assert task is None
    (diagnostic,) = found
    assert diagnostic.code == "not-in-pddl"
    assert diagnostic.location.line > len(HEAD.splitlines())
    return diagnostic.message()


@pytest.mark.parametrize(
    ("eff", "message"),
    [
        ("n[x] = n(y) % 2", "`%` of numbers that change"),
        ("n[x] = n(y) // m(y)", "`//` of numbers that change"),
        ("r[x] = r(x) ** 2", "`**` of numbers that change"),
        ("r[x] = r(x) / 0", "a division by zero"),
        ("if r(x) / r(y) > 1: p[x] = True", "a division by what may be zero, in a condition,"),
        ("foreach z: T: n[x] = m(z)", "`n`, which iterations of a `foreach` may write twice,"),
    ],
)
def test_what_is_refused(eff: str, message: str) -> None:
    assert refusal(eff) == f"{message} has no PDDL"


def test_effects_of_too_many_cases_are_refused_where_they_stand() -> None:
    flags = "".join(f"feature f{i}()\n" for i in range(9))
    total = " + ".join(f"({2**i} if f{i}() else 0)" for i in range(9))
    act = f"behavior act(x: T):\n  eff:\n    p[x] = True\n    n[x] = {total}\n"
    task, found, _ = emitted(HEAD + flags + act)
    assert task is None
    (diagnostic,) = found
    assert diagnostic.message() == "an effect of more than 256 cases has no PDDL"
    assert diagnostic.location.line == len((HEAD + flags).splitlines()) + 4
    assert emitted(HEAD + flags + act.replace(" + (256 if f8() else 0)", ""))[0] is not None


def test_a_loop_has_as_many_cases_as_outcomes() -> None:
    act = "behavior act(x: T):\n  eff:\n    for i in range(100):\n      if n[x] > 0: n[x] -= 1\n"
    domain = task_of(HEAD + act).domain
    assert len(re.findall(r"\(decrease \(n \?x\) \d+\)", domain)) == 100


def test_bounds_are_preconditions() -> None:
    head = HEAD.replace("feature n", "feature [[min=0, max=5]] n")
    domain = task_of(f"{head}behavior act(x: T):\n  eff: n[x] += 1\n").domain
    assert "(<= (n ?x) 4)" in domain.split(":precondition")[1].split(":effect")[0]


def test_numbers_start_at_zero_and_have_no_exponents() -> None:
    init = "  foreach x: T: loc[x] = a\n  r[a] = 1e-7\n  n[a] = -3\n"
    problem = f'problem "p"\nobjects:\n  a, b: T\ninit:\n{init}goal: n(b) == 0\n'
    text = task_of(HEAD, problem).problem or ""
    assert "(= (n b) 0)" in text
    assert "(= (n a) -3)" in text
    assert "(= (r a) 0.0000001)" in text
    assert "(= (total) 0)" in text
