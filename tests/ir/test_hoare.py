"""The Hoare model: what behaviors demand and write, in the cases that are easily got wrong."""

import re
from textwrap import dedent, indent

import pytest
from programs import behavior_of, expression_of, program_of

from cdlc.diagnostics import Collector
from cdlc.ir.graph import size
from cdlc.ir.hoare import Model
from cdlc.ir.model import triples as triples_of
from cdlc.ir.text import hoare_text, oversized, sexpr
from cdlc.ir.updates import NotModelled
from crow.program import Expression
from crow.program.triples import Triple

DECLARATIONS = """
typedef T
typedef U: T
typedef V
object_constant home: T
object_constant far: T
feature p(x: T)
feature q(x: T)
feature r(v: V)
feature on(x: T, y: T)
feature n() -> int64
feature f(x: T) -> int64
feature place(x: T) -> T
controller go(x: T)
controller put(x: T, y: T)
controller make(x: T):
  eff:
    p[x] = True
controller swap(x: T, y: T):
  eff:
    let k = p(x)
    p[x] = p(y)
    p[y] = k
controller copy(x: T, flag: bool):
  eff:
    q[x] = flag
def some(x: T): return exists y: T: on(x, y)
def none(y: T): return not some(y)
def both(x: T, y: T):
  let k = p(x)
  let z = y
  k = k and p(z)
  return k
def loops(x: T):
  for i in range(2): pass
  return p(x)
def external(x: T)
"""


def model_of(
    eff: str, body: str = "pass", parameters: str = "x: T, y: T", goal: str = ""
) -> Triple:
    text = f"{DECLARATIONS}behavior act({parameters}):\n"
    if goal:
        text += f"  goal: {goal}\n"
    text += "  body:\n" + indent(dedent(body), "    ") + "\n"
    text += "  eff:\n" + indent(dedent(eff), "    ") + "\n"
    return only_triple(text)


def only_triple(text: str) -> Triple:
    program, behavior = behavior_of(text)
    (found,) = Model(program).triples(behavior)
    return found


def written(node: Expression, found: Triple) -> str:
    return sexpr(node, {p.name: p.name for p in found.parameters})


def pre(found: Triple) -> list[str]:
    return [written(part, found) for part in found.pre]


def post(found: Triple) -> list[str]:
    """Each update, as it stands in the text of the model but without its brackets."""
    text = hoare_text((found,)).partition("  :effect (and\n")[2]
    lines = [line.strip() for line in text.splitlines()]
    if lines:
        lines[-1] = lines[-1].removesuffix("))")
    return [
        re.sub(r"^\(= \(([^()]*(?:\([^()]*\)[^()]*)*)\) (.*)\)$", r"\1 := \2", line)
        for line in lines
    ]


SAME = "(= ?x ?y)"
ALIASED = "(= ?x ?y)"


@pytest.mark.parametrize(
    ("eff", "expected"),
    [
        # rule 1: reads after writes
        ("p[x] = True\nq[x] = p(x)", ["p ?x := true", "q ?x := true"]),
        ("q[x] = p(x)\np[x] = True", ["q ?x := (p ?x)", "p ?x := true"]),
        ("p[x] = q(x)\nq[x] = p(x)", ["p ?x := (q ?x)", "q ?x := (q ?x)"]),
        ("p[x] = not p(x)\np[x] = not p(x)", ["p ?x := (p ?x)"]),
        ("f[x] = 1\nf[x] = 2", ["f ?x := 2"]),
        ("f[x] = f(x) + 1\nf[x] = f(x) * 2", ["f ?x := (* (+ (f ?x) 1) 2)"]),
        # two parameters may be one object
        (
            "f[x] = 1\nf[y] = 2\nn = f(x)",
            ["f ?x := 1", "f ?y := 2", f"n := (condition {SAME} 2 1)"],
        ),
        (
            "p[x] = True\np[y] = False\nq[x] = p(x)",
            ["p ?x := true", "p ?y := false", f"q ?x := (not {SAME})"],
        ),
        (
            "p[x] = True\nq[x] = p(y)",
            ["p ?x := true", f"q ?x := (or {ALIASED} (p ?y))"],
        ),
        ("p[x] = False\nq[x] = p(y)", ["p ?x := false", f"q ?x := (and (not {ALIASED}) (p ?y))"]),
        ("p[home] = True\nq[x] = p(far)", ["p home := true", "q ?x := (p far)"]),
        ("p[home] = True\nq[x] = p(home)", ["p home := true", "q ?x := true"]),
        ("p[home] = True\nq[x] = p(x)", ["p home := true", "q ?x := (or (= ?x home) (p ?x))"]),
        # a cell written again moves to its last place, so that the last write wins
        ("p[x] = True\np[y] = False\np[x] = True", ["p ?y := false", "p ?x := true"]),
        # quantified variables range over every object, the written one too
        (
            "p[x] = True\nq[y] = forall z: T: p(z)",
            ["p ?x := true", "q ?y := (forall (?t - T) (or (= ?t ?x) (p ?t)))"],
        ),
        # rule 5: `let` is substitution of the value of its own place
        ("let k = p(x)\np[x] = False\nq[x] = k", ["p ?x := false", "q ?x := (p ?x)"]),
        ("p[x] = True\nlet k = p(x)\np[x] = False\nq[x] = k", ["p ?x := false", "q ?x := true"]),
        (
            "let k = p(x)\np[x] = q(x)\nq[x] = k",
            ["p ?x := (q ?x)", "q ?x := (p ?x)"],
        ),
        ("let k = p(x)\nk = k and p(y)\np[x] = k", ["p ?x := (and (p ?x) (p ?y))"]),
        ("let z = y\np[z] = True\nq[x] = p(y)", ["p ?y := true", "q ?x := true"]),
        ("let x = y\np[x] = True", ["p ?y := true"]),
        # derived functions are inlined, their quantifiers kept apart from the arguments
        ("q[x] = both(x, y)", ["q ?x := (and (p ?x) (p ?y))"]),
        ("q[y] = some(y)", ["q ?y := (exists (?t - T) (on ?y ?t))"]),
        ("q[x] = none(x)", ["q ?x := (not (exists (?t - T) (on ?x ?t)))"]),
        (
            "let z = y\nq[x] = exists y: T: on(z, y)",
            ["q ?x := (exists (?t - T) (on ?y ?t))"],
        ),
        (
            "p[x] = True\nq[y] = exists x: T: p(x)",
            ["p ?x := true", "q ?y := (exists (?t - T) (or (= ?t ?x) (p ?t)))"],
        ),
        # features whose index reads the state
        ("place[x] = y\np[place(x)] = True", ["place ?x := ?y", "p ?y := true"]),
        ("p[place(x)] = True\nplace[x] = y", ["p (place ?x) := true", "place ?x := ?y"]),
        ("q[x] = external(x)", ["q ?x := (external ?x)"]),
    ],
)  # fmt: skip
def test_post_is_one_simultaneous_assignment(eff: str, expected: list[str]) -> None:
    assert post(model_of(eff)) == expected


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ("assert p(x)\nassert q(y)", ["(p ?x)", "(q ?y)"]),
        ("assert p(x) and q(y)\nassert p(x)", ["(p ?x)", "(q ?y)"]),
        ("achieve p(x)\nachieve_once q(y)", ["(p ?x)"]),
        ("promotable sequential:\n  achieve p(x)\n  assert q(x)\ndo go(x)", ["(p ?x)", "(q ?x)"]),
        ("assert True\nassert not False", []),
        ("assert p(x)\nassert not p(x)", ["false"]),
        ("assert x == x", []),
        ("assert x != y", ["(not (= ?x ?y))"]),
        ("assert home == far", ["false"]),
        ("assert home != far", []),
        ("sequential:\n  assert p(x)\n  unordered:\n    achieve q(x)", ["(p ?x)", "(q ?x)"]),
        ("commit\nassert p(x)", ["(p ?x)"]),
        ("let z = y\nassert p(z)", ["(p ?y)"]),
        ("let z = y\nz = x\nassert p(z)", ["(p ?x)"]),
        ("sequential:\n  let y = x\n  assert p(y)\nassert q(y)", ["(p ?x)", "(q ?y)"]),
        # through the effects of controllers before it
        ("do make(x)\nassert p(x)", []),
        ("do make(x)\nassert not p(x)", ["false"]),
        ("do make(x)\nassert p(y)", ["(or (= ?x ?y) (p ?y))"]),
        ("assert p(y)\ndo make(x)", ["(p ?y)"]),
        ("do swap(x, y)\nassert p(x)", [f"(condition {SAME} (p ?x) (p ?y))"]),
        ("do swap(x, y)\nassert not p(y)", ["(not (p ?x))"]),
        ("do copy(x, p(x))\ndo make(x)\nassert q(x)", ["(p ?x)"]),
        # object binds are preconditions on parameters of their own
        ("bind z: T where: on(x, z)", ["(on ?x ?z)"]),
        ("bind x: T where: p(x)", ["(p ?x_2)"]),
        ("bind z: T\nbind z: T where: p(z)", ["(p ?z_2)"]),
        ("bind z: T\nassert exists z: T: q(z)", ["(exists (?t - T) (q ?t))"]),
        ("assert none(x)", ["(not (exists (?t - T) (on ?x ?t)))"]),
    ],
)  # fmt: skip
def test_pre_is_what_the_body_requires(body: str, expected: list[str]) -> None:
    assert pre(model_of("pass", body)) == expected


def test_effects_of_controllers_are_composed_with_the_behaviors_own() -> None:
    found = model_of("q[x] = p(x)\np[y] = False", "do make(x)\ndo go(y)")
    assert post(found) == ["p ?x := true", "q ?x := true", "p ?y := false"]
    assert [call.controller for call in found.calls] == ["make", "go"]


def test_arguments_of_calls_are_values_of_the_state_before() -> None:
    found = model_of("pass", "let z = y\ndo put(z, x)\ndo copy(x, q(x))\ndo copy(x, not q(x))")
    assert [[written(a, found) for a in call.arguments] for call in found.calls] == [
        ["?y", "?x"],
        ["?x", "(q ?x)"],
        ["?x", "(not (q ?x))"],
    ]
    assert post(found) == ["q ?x := (not (q ?x))"]


def test_types_that_share_no_object_cannot_be_aliased() -> None:
    domain = DECLARATIONS.replace("feature r(v: V)", "feature r(v: object)")
    text = domain + "behavior act(x: T, v: V, u: U):\n  eff:\n    r[x] = True\n    p[x] = r({})\n"
    for name, value in (("v", "(r ?v)"), ("u", "(or (= ?u ?x) (r ?u))"), ("x", "true")):
        assert post(only_triple(text.format(name)))[-1] == f"p ?x := {value}"


def test_parameters_are_the_behaviors_and_then_its_binds() -> None:
    found = model_of("pass", "bind z: U, y: T where: on(z, y)", "y: T")
    assert [(p.name, str(p.type)) for p in found.parameters] == [
        ("y", "T"),
        ("z", "U"),
        ("y_2", "T"),
    ]
    assert pre(found) == ["(on ?z ?y_2)"]


def test_a_method_has_no_triple() -> None:
    text = DECLARATIONS + "behavior act(x: T):\n  body:\n    foreach y: T: achieve p(y)\n"
    program, behavior = behavior_of(text)
    assert Model(program).triples(behavior) == ()


@pytest.mark.parametrize(
    ("condition", "updates", "expected"),
    [
        ("p(home)", "p[home] = True", "true"),
        ("p(home) and q(home)", "p[home] = True", "(q home)"),
        ("p(home) and q(home)", "p[home] = False", "false"),
        ("not p(home)", "p[home] = q(home)", "(not (q home))"),
        ("p(home) ^ q(home)", "p[home] = True", "(not (q home))"),
        ("p(home) == q(home)", "p[home] = q(home)", "true"),
        ("p(far) if q(far) else p(home)", "q[far] = True", "(p far)"),
        ("exists z: T: p(z)", "p[home] = True", "(exists (?t - T) (or (= ?t home) (p ?t)))"),
        ("place(home) == far", "place[home] = far", "true"),
        ("place(home) != far", "place[home] = far", "false"),
        ("place(home) == far", "place[home] = home", "false"),
        ("f(home) == 3", "f[home] = 3", "true"),
        ("f(home) > n", "n = f(home)", "false"),
        ("p(place(home))", "place[home] = far; p[far] = True", "true"),
        ("n == 1", "pass", "(= (n) 1)"),
    ],
)
def test_regress_is_the_weakest_precondition(condition: str, updates: str, expected: str) -> None:
    text = f"{DECLARATIONS}behavior act():\n  eff:\n" + indent(updates.replace("; ", "\n"), "    ")
    program, behavior = behavior_of(text + "\n")
    model = Model(program)
    (found,) = model.triples(behavior)
    goal = model.formula(expression_of(DECLARATIONS, condition))
    assert written(model.weakest_precondition(goal, found), found) == expected


# --------------------------------------------------------------------------- what has no model yet


@pytest.mark.parametrize(
    ("body", "eff", "construct", "line"),
    [
        ("do go(x)\nachieve p(x)", "pass", "an `achieve` after a controller call", 3),
        ("do go(x)\nachieve_once p(x)", "pass", "an `achieve` after a controller call", 3),
        ("bind k: int64", "pass", "a `bind` of type `int64`", 2),
        ("if p(x): do go(x)", "pass", "a controller call under `if`, `foreach` or `for`", 2),
        (
            "pass",
            "foreach z: T: f[place(z)] = f(z)\nn = f(x)",
            "a read of what a `foreach` writes to computed cells",
            4,
        ),
    ],
)
def test_what_has_no_model_is_named_with_its_place(
    body: str, eff: str, construct: str, line: int
) -> None:
    with pytest.raises(NotModelled) as raised:
        model_of(eff, body)
    assert raised.value.construct == construct
    assert raised.value.location is not None
    assert raised.value.location.line == len(DECLARATIONS.splitlines()) + 1 + line


@pytest.mark.parametrize(
    ("eff", "expected"),
    [
        ("if p(x): q[x] = True", ["q ?x := (condition (p ?x) true (q ?x))"]),
        ("if p(x): q[x] = True\nelse: q[x] = p(y)", ["q ?x := (or (p ?x) (p ?y))"]),
        ("n += 1\nn += 1", ["n := (+ (n) 2)"]),
        ("for i in range(3): n += i", ["n := (+ (n) 3)"]),
        ("foreach z: T: p[z] = q(z)", ["(forall (?z - T) (= (p ?z) (q ?z)))"]),
        (
            "foreach z: T:\n  if q(z): p[z] = True",
            ["(forall (?z - T) (when (q ?z) (= (p ?z) true)))"],
        ),
        (
            "foreach z: T:\n  p[z] = True\nq[x] = p(y)",
            ["(forall (?z - T) (= (p ?z) true))", "q ?x := true"],
        ),
        ("foreach z: T: p[x] = True", ["p ?x := (condition (exists (?t - T) true) true (p ?x))"]),
    ],
)
def test_branches_and_loops(eff: str, expected: list[str]) -> None:
    assert post(model_of(eff)) == expected


def test_conditions_under_branches_and_loops() -> None:
    body = "if p(x): assert q(x)\nforeach z: T: achieve q(z)\nfor i in range(2): assert f(x) > i"
    assert pre(model_of("pass", body)) == [
        "(or (not (p ?x)) (q ?x))",
        "(forall (?t - T) (q ?t))",
        "(> (f ?x) 0)",
        "(> (f ?x) 1)",
    ]


def test_alternatives_and_orders_are_triples_of_their_own() -> None:
    text = DECLARATIONS + "behavior act(x: T, y: T):\n  body:\n    {}\n  eff: pass\n"
    for body, expected in (
        ("alternative:\n      assert p(x)\n      assert q(x)", [["(p ?x)"], ["(q ?x)"]]),
        ("unordered:\n      do make(x)\n      do swap(x, y)", [[], []]),
    ):
        program, behavior = behavior_of(text.format(body))
        found = Model(program).triples(behavior)
        assert [pre(triple) for triple in found] == expected


def test_a_called_behavior_is_inlined() -> None:
    text = DECLARATIONS + (
        "behavior inner(z: T):\n  body:\n    assert q(z)\n    do go(z)\n  eff: p[z] = True\n"
        "behavior act(x: T, y: T):\n  body:\n    inner(y)\n    assert p(x)\n  eff: q[x] = p(y)\n"
    )
    found = only_triple(text)
    assert pre(found) == ["(q ?y)", "(or (= ?x ?y) (p ?x))"]
    assert post(found) == ["p ?y := true", "q ?x := true"]
    assert [call.controller for call in found.calls] == ["go"]


def test_functions_that_double_stay_small_as_graphs() -> None:
    links = "".join(
        f"def d{i}(x: T): return d{i + 1}(x) ^ (q(x) and d{i + 1}(x))\n" for i in range(20)
    )
    domain = DECLARATIONS + links + "def d20(x: T): return p(x)\n"
    found = only_triple(domain + "behavior act(x: T):\n  eff: p[x] = d0(x)\n")
    assert size(found.post[0].value) < 100
    assert [formula for formula, _ in oversized(found)] == ["the new value of `p`"]


MAKE_P = "behavior other(x: T):\n  goal: p(x)\n  body:\n    achieve q(x)\n  eff: p[x] = True\n"
MAKE_Q = "behavior more(x: T):\n  goal: q(x)\n  eff:\n    q[x] = True\n    n[] = 3\n"


@pytest.mark.parametrize(
    ("let", "use", "is_stale"),
    [
        ("let k = p(x)", "on[x, y] = k", True),
        ("let k = p(x)", "pass", False),
        ("let k = on(x, y)", "on[x, y] = k", False),
        ("let k = n() == 3", "on[x, y] = k", True),  # written for q, which p is achieved with
        ("let j = p(x)\nlet k = not j", "on[x, y] = k", True),
        ("let j = p(x)\nlet k = on(x, x)", "on[x, y] = k", False),
        ("let k = p(x)\nsequential:\n  let k = on(y, x)\n  assert k", "on[x, y] = k", True),
        ("let k = True\nk = p(x)", "on[x, y] = k", True),
        ("let k = some(x)", "on[x, y] = k", False),
        ("let k = both(x, y)", "on[x, y] = k", True),
    ],
)
def test_a_let_that_a_plan_may_change_is_used_no_more(let: str, use: str, is_stale: bool) -> None:
    body = indent(f"{let}\nachieve p(y)", "    ")
    act = f"behavior act(x: T, y: T):\n  body:\n{body}\n  eff: {use}\n"
    program = program_of(DECLARATIONS + MAKE_P + MAKE_Q + act)
    model, act_ = Model(program), program.behaviors[-1]
    if not is_stale:
        assert len(model.triples(act_)) == 1
        return
    with pytest.raises(NotModelled) as raised:
        model.triples(act_)
    assert raised.value.construct == "a `let` used after an `achieve` that may change it"


def test_the_model_of_a_program_reports_and_leaves_out() -> None:
    text = DECLARATIONS + (
        "behavior first(x: T):\n  eff: p[x] = True\n"
        "behavior second(x: T):\n  body:\n    do go(x)\n    achieve p(x)\n  eff: q[x] = True\n"
        "behavior third(x: T):\n  body: achieve p(x)\n"
        "behavior fourth(x: T):\n  eff: q[x] = True\n"
    )
    found = Collector()
    triples = triples_of(Model(program_of(text)), found)
    assert [t.behavior for t in triples] == ["first", "fourth"]
    (missing,) = found
    assert missing.code == "no-hoare-model"
    assert missing.message() == (
        "an `achieve` after a controller call has no Hoare model in this version"
    )
    assert missing.location.line == len(DECLARATIONS.splitlines()) + 6


def test_text() -> None:
    found = model_of("p[x] = False\non[x, y] = p(y)", "assert q(x)\ndo go(x)", "x: T, y: U")
    assert hoare_text((found, model_of("pass", parameters=""))) == dedent("""\
        (:action act
          :parameters (?x - T ?y - U)
          :precondition (and
            (q ?x))
          :effect (and
            (= (p ?x) false)
            (= (on ?x ?y) (and (not (= ?x ?y)) (p ?y)))))

        (:action act
          :parameters ()
          :precondition (and)
          :effect (and))
        """)


def test_a_value_after_is_not_taken_for_one_before() -> None:
    """`not p(x)` after `p[x] = not p(x)` is `p(x)`, before; reading that again would be wrong."""
    text = (
        DECLARATIONS
        + """
behavior act(x: T):
  goal: not p(x)
  eff:
    p[x] = not p(x)
"""
    )
    program, behavior = behavior_of(text)
    model = Model(program)
    (triple,) = model.triples(behavior)
    assert triple.goal is not None
    goal = model.formula(triple.goal, triple.parameters)
    assert sexpr(model.weakest_precondition(goal, triple), {"x": "x"}) == "(p ?x)"
