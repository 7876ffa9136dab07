# ruff: noqa: E501 - tables of cases, one a line
"""Plans of others: valid in three forms, and each way to tamper with one is a diagnostic."""

import copy
import json
import time
from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from small_plan import PDDL_PLAN, SMALL, problem_in, validated

from cdlc.diagnostics import Severity

TEXT = SMALL.text


def test_the_plan_is_as_the_tests_assume() -> None:
    assert TEXT == (
        "1. -          by silent(u)\n"
        "2. put(a, b)  by first(a, y=b)\n"
        "3. mark(b)    by first(a, y=b)\n"
        "4. put(b, u)  by first(b, y=u)\n"
        "5. mark(u)    by first(b, y=u)\n"
    )


@pytest.mark.parametrize(
    ("plan", "steps", "items"),
    [
        (TEXT, 5, 0),
        (TEXT.replace(". ", ".").replace("  ", " "), 5, 0),
        (f"# made by hand\n\n{TEXT}".replace("1. ", ""), 5, 0),
        (TEXT.replace("first(a, y=b)", "first(a)"), 5, 0),
        (PDDL_PLAN, 3, 0),
        (PDDL_PLAN.upper(), 3, 0),
        (json.dumps(SMALL.json), 5, 12),
        (json.dumps({**SMALL.json, "trace": []}), 5, 0),
        (json.dumps({"steps": SMALL.json["steps"]}, indent=2), 5, 0),
    ],
)
def test_valid_plans(plan: str, steps: int, items: int) -> None:
    result, found = validated(plan)
    assert [d.message() for d in found] == []
    assert (result.steps, result.trace_items) == (steps, items)
    assert result.summary().startswith(f"valid: {steps} steps")
    assert ("trace items" in result.summary()) is (items > 0)


LINES = TEXT.splitlines()


def without(*numbers: int) -> str:
    return "\n".join(line for i, line in enumerate(LINES, 1) if i not in numbers)


@pytest.mark.parametrize(
    ("plan", "code", "message", "place"),
    [
        # wrong order, missing and repeated steps
        ("\n".join([*LINES[3:], *LINES[:3]]), "step-failed", "step 3 cannot be applied: `not p(u)`: it is false where it stands", (3, 18)),
        (without(2, 3), "goal-not-reached", "the goal is not reached: `q(a) and q(b) and p(u)`: it is false here", (3, 1)),
        ("", "goal-not-reached", "the goal is not reached: `q(a) and q(b) and p(u)`: it is false here", (1, 1)),
        (without(3), "other-calls", "`first(a, y=b)` runs `put(a, b)`, `mark(b)`, the plan has `put(a, b)`", (2, 18)),
        (without(4, 5) + "\n" + LINES[1] + "\n" + LINES[2], "step-failed", "step 4 cannot be applied: `on(x, y)`: it is false where it stands", (4, 18)),
        # wrong controllers
        (TEXT.replace("mark(b)", "go(b)"), "other-calls", "`first(a, y=b)` runs `put(a, b)`, `mark(b)`, the plan has `put(a, b)`, `go(b)`", (2, 18)),
        (TEXT.replace("put(a, b)", "put(b, a)"), "other-calls", "`first(a, y=b)` runs `put(a, b)`, `mark(b)`, the plan has `put(b, a)`, `mark(b)`", (2, 18)),
        (TEXT.replace("1. -  ", "1. go(u)"), "other-calls", "`silent(u)` runs no controller, the plan has `go(u)`", (1, 20)),
        (TEXT.replace("put(a, b)", "-"), "other-calls", "`first(a, y=b)` runs `put(a, b)`, `mark(b)`, the plan has `mark(b)`", (2, 10)),
        # the second call of a behavior, claimed for another one
        (TEXT.replace("3. mark(b)    by first(a, y=b)", "3. mark(b)    by silent(u)"), "other-calls", "`first(a, y=b)` runs `put(a, b)`, `mark(b)`, the plan has `put(a, b)`", (2, 18)),
        # missing and wrong binds
        (TEXT.replace("first(b, y=u)", "first(b)"), "bad-step", "`y` can be `a` or `u`, and the plan does not say which", (4, 18)),
        (TEXT.replace("first(b, y=u)", "first(b, y=b)"), "step-failed", "step 4 cannot be applied: `on(x, y)`: it is false where it stands", (4, 18)),
        (TEXT.replace("first(b, y=u)", "first(b, z=u)"), "bad-step", "`first` binds no `z`", (4, 29)),
        (TEXT.replace("first(b, y=u)", "first(b, y=v)"), "bad-step", "no object `v`", (4, 29)),
        (TEXT.replace("silent(u)", "silent(a)"), "bad-step", "`a` is a `T`, not a `U`", (1, 25)),
        # garbage
        ("garbage\n", "bad-step", "a step is `controller(a) by behavior(a, bind=b)`", (1, 1)),
        (LINES[0] + "\n\x00\x01by\n", "bad-step", "a step is `controller(a) by behavior(a, bind=b)`", (2, 1)),
        ("by first(a)\n", "bad-step", "a step is `controller(a) by behavior(a, bind=b)`", (1, 1)),
        ("put(a, b) by first(a", "bad-step", "a step is `controller(a) by behavior(a, bind=b)`", (1, 1)),
        ("f() by g()", "bad-step", "unknown controller `f`", (1, 1)),
        ("- by g()", "bad-step", "unknown behavior `g`", (1, 6)),
        # PDDL
        ("(jump a)", "bad-step", "no action `jump` in the emitted domain", (1, 1)),
        (PDDL_PLAN + "\n(first a", "bad-step", "not a step of a PDDL plan: `(first a`", (5, 1)),
        (PDDL_PLAN.replace("u-2", "b", 1), "bad-step", "`b` is a `T`, not a `U`", (1, 1)),
        (PDDL_PLAN.replace("u-2", "u", 1), "bad-step", "no object `u` in the problem", (1, 1)),
        ("(first a b)\n(first a b)", "step-failed", "step 2 cannot be applied: `on(x, y)`: it is false where it stands", (2, 1)),
        ("(silent u-2)", "goal-not-reached", "the goal is not reached: `q(a) and q(b) and p(u)`: it is false here", (1, 1)),
    ],
)  # fmt: skip
def test_tampered_plans(plan: str, code: str, message: str, place: tuple[int, int]) -> None:
    found = problem_in(plan)
    assert (found.code, found.message()) == (code, message)
    assert (found.location.file, found.location.line, found.location.column) == ("plan", *place)
    assert found.severity is Severity.ERROR


# ------------------------------------------------------------------------------------------- JSON


def changed(change: Callable[[dict[str, Any]], object]) -> str:
    document = SMALL.json
    change(document)
    return json.dumps(document)


@pytest.mark.parametrize(
    ("plan", "code", "part"),
    [
        ("{", "bad-step", "no JSON"),
        ("{}", "bad-step", "no `steps`"),
        ('{"steps": 5}', "bad-step", "no `steps`"),
        ('{"steps": [5]}', "bad-step", "step 1: not as"),
        ('{"steps": [{}]}', "bad-step", "step 1: not as"),
        ("{" * 100_000, "bad-step", "no JSON"),
        ('{"steps": ' + "[" * 100_000, "bad-step", "no JSON"),
        ('{"steps": [' + "9" * 10_000 + "]}", "bad-step", "no JSON"),
        (changed(lambda d: d["steps"].pop(1)), "other-calls", "runs `put(a, b)`"),
        (changed(lambda d: d["steps"].reverse()), "other-calls", "runs"),
        (changed(lambda d: d["steps"][1].update(controller="go")), "bad-step", "step 2: `go` takes"),
        (changed(lambda d: d["steps"][1].update(controller=5)), "bad-step", "step 2: not as"),
        (changed(lambda d: d["steps"][1].update(controller="put(x")), "bad-step", "step 2: unknown"),
        (changed(lambda d: d["steps"][1].update(behavior="none")), "bad-step", "step 2: unknown"),
        (changed(lambda d: d["steps"][3]["bindings"].clear()), "bad-step", "`y` can be"),
        (changed(lambda d: d["steps"][3]["bindings"].update(y=[1])), "bad-step", "step 4: "),
        (changed(lambda d: d["steps"][3]["bindings"].update(y={"a": 1})), "bad-step", "step 4: "),
        (changed(lambda d: d["steps"][3]["behavior_arguments"].append(None)), "bad-step", "step 4: "),
        (changed(lambda d: d["steps"][0].pop("arguments")), "bad-step", "step 1: not as"),
        # the trace
        (changed(lambda d: d.update(trace=5)), "bad-plan", "the trace is no list"),
        (changed(lambda d: d.update(trace={"do": 1})), "bad-plan", "the trace is no list"),
        (changed(lambda d: d.update(trace=[5])), "bad-plan", "item 1 of the trace: no `do`"),
        (changed(lambda d: d["trace"].pop(0)), "", ""),
        (changed(lambda d: d["trace"].pop(6)), "bad-plan", "ends in another state"),
        (changed(lambda d: d["trace"].pop(3)), "bad-plan", "other controller calls"),
        (changed(lambda d: d["trace"].pop(5)), "bad-plan", "`do mark(b)`: its effect does not follow"),
        (changed(lambda d: d["trace"].reverse()), "bad-plan", "of the trace"),
        (changed(lambda d: d["trace"].insert(0, {"do": "go", "arguments": ["a"]})), "bad-plan", "other controller calls"),
        (changed(lambda d: d["trace"].insert(0, {"do": "fly", "arguments": []})), "bad-plan", "no controller `fly`"),
        (changed(lambda d: d["trace"].insert(0, {"do": "go", "arguments": []})), "bad-plan", "`go` takes 1 arguments"),
        (changed(lambda d: d["trace"].insert(0, {"do": "go", "arguments": ["z"]})), "bad-plan", "no object `z`"),
        (changed(lambda d: d["trace"].append({"eff": "silent", "variables": {"u": "u"}})), "", ""),
        (changed(lambda d: d["trace"].append({"eff": "make", "variables": {"x": "a"}})), "bad-plan", "`make` has no effect"),
        (changed(lambda d: d["trace"].append({"eff": "mark", "variables": {"x": "a"}})), "bad-plan", "ends in another state"),
        (changed(lambda d: d["trace"].append({"eff": "first", "variables": {"x": "a"}})), "bad-plan", "no value for `y` of `first`"),
        (changed(lambda d: d["trace"].append({"eff": "first", "variables": {"y": "a"}})), "bad-plan", "no value for `x` of `first`"),
        (changed(lambda d: d["trace"].append({"eff": "mark", "variables": {"x": {}}})), "bad-plan", "no value of type `T`"),
        (changed(lambda d: d["trace"].append({"assert": "p(x)", "variables": {"x": {}}})), "bad-plan", "`x` has no value"),
        (changed(lambda d: d["trace"].append({"assert": "p(x)", "variables": {"x": None}})), "bad-plan", "`x` has no value"),
        (changed(lambda d: d["trace"].append({"assert": "p(x)", "variables": {"x": 1}})), "bad-plan", "is indexed by objects"),
        (changed(lambda d: d["trace"].append({"assert": "p(x)", "variables": {"x": "ghost"}})), "bad-plan", "is indexed by objects"),
        (changed(lambda d: d["trace"].append({"assert": "p(x)", "variables": {}})), "bad-plan", "unknown name `x`"),
        (changed(lambda d: d["trace"].append({"assert": "p(", "variables": {}})), "bad-plan", "is no condition"),
        (changed(lambda d: d["trace"].append({"assert": "p(u)\nfeature r()", "variables": {}})), "bad-plan", "is no condition"),
        (changed(lambda d: d["trace"].append({"assert": "p(u) = q(u)", "variables": {}})), "bad-plan", "is no condition"),
        (changed(lambda d: d["trace"].append({"assert": "not p(u)", "variables": {}})), "bad-plan", "item 13 of the trace, `not p(u)`: it is false here"),
        (changed(lambda d: d["trace"].append({"assert": "(" * 5000 + "p(u)" + ")" * 5000, "variables": {}})), "bad-plan", "item 13"),
        (changed(lambda d: d["trace"].append({"assert": "1 // n == 1", "variables": {"n": 0}})), "bad-plan", "division by zero"),
    ],
)  # fmt: skip
def test_tampered_json(plan: str, code: str, part: str) -> None:
    if not code:
        assert validated(plan)[1] == []
        return
    found = problem_in(plan)
    assert found.code == code
    assert part in found.message()
    assert found.location.file == "plan"


def test_a_forged_trace_does_not_pass_for_the_plan() -> None:
    forged = {**SMALL.json, "trace": [i for i in SMALL.json["trace"] if "do" in i]}
    assert problem_in(json.dumps(forged)).code == "bad-plan"


# ---------------------------------------------------------------------------------------- mutation

JSON = st.recursive(
    st.one_of(st.none(), st.booleans(), st.integers(), st.floats(), st.sampled_from(["a", "u", "x", "put", "first", ""])),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.sampled_from("xyz"), inner, max_size=2),
    max_leaves=4,
)  # fmt: skip


def paths(value: Any, here: tuple[str | int, ...] = ()) -> list[tuple[str | int, ...]]:
    found = [here]
    if isinstance(value, dict):
        found += [p for key, item in value.items() for p in paths(item, (*here, key))]
    elif isinstance(value, list):
        found += [p for i, item in enumerate(value) for p in paths(item, (*here, i))]
    return found


DOCUMENT = SMALL.json
PATHS = [path for path in paths(DOCUMENT) if path and path[0] in ("steps", "trace")]


@given(st.sampled_from(PATHS), st.sampled_from(["replace", "delete", "copy"]), JSON, st.data())
@settings(deadline=None, max_examples=150)
def test_no_change_of_json_raises(
    path: tuple[str | int, ...], how: str, value: Any, data: st.DataObject
) -> None:
    document = copy.deepcopy(DOCUMENT)
    holder: Any = document
    for step in path[:-1]:
        holder = holder[step]
    if how == "delete":
        del holder[path[-1]]
    elif how == "copy":
        other: Any = DOCUMENT
        for step in data.draw(st.sampled_from(PATHS)):
            other = other[step]
        holder[path[-1]] = copy.deepcopy(other)
    else:
        holder[path[-1]] = value
    for found in validated(json.dumps(document))[1]:
        assert found.code
        assert found.location.file == "plan"


@given(
    st.sampled_from([TEXT, PDDL_PLAN]),
    st.integers(0, 200),
    st.integers(0, 10),
    st.text(st.sampled_from('abuy(),=-. \n#;"[]{}1\x00é'), max_size=6),
)
@settings(deadline=None, max_examples=150)
def test_no_change_of_text_raises(plan: str, start: int, length: int, new: str) -> None:
    for found in validated(plan[:start] + new + plan[start + length :])[1]:
        assert found.code
        assert found.location.file == "plan"


@pytest.mark.parametrize(
    "line",
    [" " * 200_000 + "x", ") by " * 40_000 + "x", ") " * 100_000 + "by", "(" * 100_000, "a" * 200_000,
     "- by first(" + "a," * 50_000 + ")", "1." * 100_000 + ")"],
)  # fmt: skip
def test_long_lines_take_no_time(line: str) -> None:
    began = time.monotonic()
    assert validated(line)[1]
    assert time.monotonic() - began < 5
