"""The Hoare model of straight-line behaviors: the rules of docs' lowering that a toy gets wrong."""

from textwrap import dedent, indent

import pytest
from programs import behavior_of, expression_of, program_of

from cdlc.diagnostics import Collector
from cdlc.ir.hoare import NotModelled, Triple, regress, triple
from cdlc.ir.model import model
from cdlc.ir.text import hoare_text, sexpr
from crow.program import Hierarchy

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
    found = triple(*behavior_of(text))
    assert found is not None
    return found


def pre(found: Triple) -> list[str]:
    return [sexpr(part) for part in found.pre]


def post(found: Triple) -> list[str]:
    calls = [(" ".join((u.feature, *map(sexpr, u.arguments))), sexpr(u.value)) for u in found.post]
    return [f"{cell} := {value}" for cell, value in calls]


SAME = "(= ?y ?x)"
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
        ("p[home] = True\nq[x] = p(x)", ["p home := true", "q ?x := (or (= home ?x) (p ?x))"]),
        # a cell written again moves to its last place, so that the last write wins
        ("p[x] = True\np[y] = False\np[x] = True", ["p ?y := false", "p ?x := true"]),
        # quantified variables range over every object, the written one too
        (
            "p[x] = True\nq[y] = forall z: T: p(z)",
            ["p ?x := true", "q ?y := (forall (?z - T) (or (= ?x ?z) (p ?z)))"],
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
        ("q[y] = some(y)", ["q ?y := (exists (?y_2 - T) (on ?y ?y_2))"]),
        ("q[x] = none(x)", ["q ?x := (not (exists (?y_2 - T) (on ?x ?y_2)))"]),
        (
            "let z = y\nq[x] = exists y: T: on(z, y)",
            ["q ?x := (exists (?y_2 - T) (on ?y ?y_2))"],
        ),
        (
            "p[x] = True\nq[y] = exists x: T: p(x)",
            ["p ?x := true", "q ?y := (exists (?x_2 - T) (or (= ?x ?x_2) (p ?x_2)))"],
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
        ("assert x != y", ["(distinct ?x ?y)"]),
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
        ("bind z: T\nassert exists z: T: q(z)", ["(exists (?z_2 - T) (q ?z_2))"]),
        ("assert none(x)", ["(not (exists (?y_2 - T) (on ?x ?y_2)))"]),
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
    assert [[sexpr(a) for a in call.arguments] for call in found.calls] == [
        ["?y", "?x"],
        ["?x", "(q ?x)"],
        ["?x", "(not (q ?x))"],
    ]
    assert post(found) == ["q ?x := (not (q ?x))"]


def test_types_that_share_no_object_cannot_be_aliased() -> None:
    domain = DECLARATIONS.replace("feature r(v: V)", "feature r(v: object)")
    text = domain + "behavior act(x: T, v: V, u: U):\n  eff:\n    r[x] = True\n    p[x] = r({})\n"
    for name, value in (("v", "(r ?v)"), ("u", "(or (= ?x ?u) (r ?u))"), ("x", "true")):
        found = triple(*behavior_of(text.format(name)))
        assert found is not None
        assert post(found)[-1] == f"p ?x := {value}"


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
    assert triple(*behavior_of(text)) is None


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
        ("exists z: T: p(z)", "p[home] = True", "(exists (?z - T) (or (= home ?z) (p ?z)))"),
        ("place(home) == far", "place[home] = far", "true"),
        ("place(home) != far", "place[home] = far", "false"),
        ("place(home) == far", "place[home] = home", "false"),
        ("f(home) == 3", "f[home] = 3", "true"),
        ("f(home) > n", "n = f(home)", "(> (f home) (f home))"),
        ("p(place(home))", "place[home] = far; p[far] = True", "true"),
        ("n == 1", "pass", "(= (n) 1)"),
    ],
)
def test_regress_is_the_weakest_precondition(condition: str, updates: str, expected: str) -> None:
    found = model_of(updates.replace("; ", "\n"), parameters="")
    program = program_of(DECLARATIONS)
    before = regress(
        expression_of(DECLARATIONS, condition), found.post, Hierarchy.of(program.types)
    )
    assert sexpr(before) == expected


# --------------------------------------------------------------------------- what has no model yet


@pytest.mark.parametrize(
    ("body", "eff", "construct", "line"),
    [
        ("pass", "foreach z: T: p[z] = True", "`foreach`", 4),
        ("pass", "for i in range(2): p[x] = True", "`for`", 4),
        ("pass", "if p(x): q[x] = True", "`if`", 4),
        ("pass", "n += 1", "an augmented assignment", 4),
        ("pass", "q[x] = loops(x)", "`for` in `loops`", None),
        ("if p(x): achieve q(x)", "pass", "`if`", 2),
        ("foreach z: T: achieve q(z)", "pass", "`foreach`", 2),
        ("alternative:\n  achieve p(x)\n  achieve q(x)", "pass", "`alternative:`", 2),
        ("other(x)", "pass", "a behavior call", 2),
        ("do go(x)\nachieve p(x)", "pass", "an `achieve` after a controller call", 3),
        ("do go(x)\nachieve_once p(x)", "pass", "an `achieve` after a controller call", 3),
        ("let k = p(x)", "pass", "a local that reads the state", 2),
        ("let k = True\nk = p(x)", "pass", "a local that reads the state", 3),
        ("bind k: int64", "pass", "a `bind` of type `int64`", 2),
        ("unordered:\n  do go(x)\n  do go(y)", "pass", "a controller call in `unordered:`", 3),
    ],
)
def test_what_has_no_model_is_named_with_its_place(
    body: str, eff: str, construct: str, line: int | None
) -> None:
    with pytest.raises(NotModelled) as raised:
        model_of(eff, body)
    assert raised.value.construct == construct
    assert raised.value.location is not None
    if line is not None:
        first = len((DECLARATIONS + "other").splitlines())
        assert raised.value.location.line == first + line


DECLARATIONS += "behavior other(x: T):\n  eff: p[x] = True\n"


def test_a_controllers_effect_without_model_is_placed_there() -> None:
    domain = DECLARATIONS + (
        "controller all(x: T):\n  eff:\n    foreach z: T: p[z] = True\n"
        "behavior act(x: T):\n  body:\n    do all(x)\n  eff: q[x] = True\n"
    )
    with pytest.raises(NotModelled, match="`foreach`") as raised:
        triple(*behavior_of(domain))
    assert raised.value.location is not None
    assert raised.value.location.line == len(DECLARATIONS.splitlines()) + 3


def test_functions_that_double_are_refused_in_time() -> None:
    links = "".join(
        f"def d{i}(x: T): return d{i + 1}(x) ^ (q(x) and d{i + 1}(x))\n" for i in range(60)
    )
    domain = DECLARATIONS + links + "def d60(x: T): return p(x)\n"
    with pytest.raises(NotModelled, match="too large when written out") as raised:
        triple(*behavior_of(domain + "behavior act(x: T):\n  eff: p[x] = d0(x)\n"))
    assert raised.value.location is not None


def test_a_chain_of_functions_longer_than_the_stack_is_refused() -> None:
    links = "".join(f"def d{i}(x: T): return d{i + 1}(x)\n" for i in range(400))
    domain = DECLARATIONS + links + "def d400(x: T): return p(x)\n"
    with pytest.raises(NotModelled, match="nested this deeply") as raised:
        triple(*behavior_of(domain + "behavior act(x: T):\n  eff: p[x] = d0(x)\n"))
    assert raised.value.location is not None


def test_the_model_of_a_program_reports_and_leaves_out() -> None:
    text = DECLARATIONS + (
        "behavior first(x: T):\n  eff: p[x] = True\n"
        "behavior second(x: T):\n  eff:\n    n += 1\n"
        "behavior third(x: T):\n  body: achieve p(x)\n"
        "behavior fourth(x: T):\n  eff: q[x] = True\n"
    )
    found = Collector()
    triples = model(program_of(text), found)
    assert [t.behavior for t in triples] == ["other", "first", "fourth"]
    (missing,) = found
    assert missing.code == "no-hoare-model"
    assert missing.message() == "an augmented assignment has no Hoare model in this version"
    assert missing.location.line == len(DECLARATIONS.splitlines()) + 5


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
