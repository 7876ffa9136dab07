"""The rules of lowering.md §1 that are easily got wrong, each compared with the interpreter."""

import random
from collections.abc import Iterator
from itertools import product
from textwrap import dedent, indent

import pytest
from programs import expression_of, program_of

from cdlc.ir.hoare import MAX_TRIPLES, Model
from cdlc.ir.nodes import Level
from cdlc.ir.text import effects, preconditions
from cdlc.ir.updates import NotModelled
from crow.evaluate import EvaluationError, assignments_of, evaluate, execute
from crow.problem import State, World
from crow.program import BOOL, Behavior, Parameter, Program, Type, Variable
from crow.program.triples import Triple
from crow.program.types import ObjectType, VectorType, is_number, underlying

DECLARATIONS = """
typedef T
typedef U: T
typedef V
object_constant home: T
feature p(x: T)
feature q(x: T)
feature r(x: object)
feature on(x: T, y: T)
feature n() -> int64
feature f(x: T) -> int64
feature at(x: T) -> T
feature g(x: T) -> float64
feature h(x: T) -> float32
feature pose(x: T) -> vector[float64, 2]
controller go(x: T)
controller make(x: T):
  eff: p[x] = True
controller flip(x: T):
  eff: p[x] = not p(x)
controller copy(x: T, y: T):
  eff: q[x] = p(y)
controller swap(x: T, y: T):
  eff:
    let k = f(x)
    f[x] = f(y)
    f[y] = k
def near(x: T, y: T): return at(x) == y or on(x, y)
def [[reads=p]] looks(x: T)
def [[reads=all]] feels(x: T)
def sounds(x: T)
"""
OBJECTS = tuple(Parameter(n, ObjectType(t)) for n, t in (("a", "T"), ("b", "U"), ("c", "V")))


def act(eff: str, body: str = "pass", parameters: str = "x: T, y: T") -> tuple[Program, Behavior]:
    text = f"{DECLARATIONS}behavior act({parameters}):\n  body:\n"
    text += indent(dedent(body), "    ") + "\n  eff:\n" + indent(dedent(eff), "    ") + "\n"
    program = program_of(text)
    return program, program.behaviors[0]


def value_of(type_: Type, world: World, chance: random.Random) -> object:
    plain = underlying(type_)
    if plain == BOOL:
        return chance.random() < 0.5
    if isinstance(plain, VectorType):
        return tuple(value_of(plain.element, world, chance) for _ in range(plain.length or 0))
    if is_number(plain):
        number = chance.randint(-2, 4)
        return number if str(plain).startswith("int") else float(number)
    return chance.choice(world.objects_of(plain))


def states(world: World, count: int) -> Iterator[State]:
    chance = random.Random(4)
    for _ in range(count):
        values = {
            (feature.name, cell): value_of(feature.type, world, chance)
            for feature in world.program.features
            for cell in world.cells(feature)
        }
        yield world.updated(State(), values)


def check_running(program: Program, behavior: Behavior, triple: Triple) -> None:
    """Calls and effect one after another, against the triple at once, from random states."""
    world = World.of(program, OBJECTS)
    compared = 0
    for state in states(world, 25):
        for arguments in product(*(world.objects_of(p.type) for p in behavior.parameters)):
            values = dict(zip((p.name for p in behavior.parameters), arguments, strict=True))
            try:
                ran = run(world, state, behavior, triple, values)
            except EvaluationError:
                continue
            changes = {}
            for update in triple.post:
                bound = [Parameter(v.name, v.type) for v in update.variables if is_variable(v)]
                for inner in assignments_of(world, tuple(bound), values):
                    if evaluate(world, state, update.guard, inner):
                        cell = tuple(evaluate(world, state, a, inner) for a in update.arguments)
                        value = evaluate(world, state, update.value, inner)
                        changes[update.feature, cell] = value
            assert world.updated(state, changes) == ran, (arguments, state)
            compared += 1
    assert compared > 20


def is_variable(node: object) -> bool:
    return isinstance(node, Variable)


def run(
    world: World, state: State, behavior: Behavior, triple: Triple, values: dict[str, str]
) -> State:
    before = state
    for call in triple.calls:
        effect = world.controllers[call.controller].effect
        names = [p.name for p in world.controllers[call.controller].parameters]
        given = [evaluate(world, before, a, values) for a in call.arguments]
        state = execute(world, state, effect or (), dict(zip(names, given, strict=True)))
    return execute(world, state, behavior.effect or (), values)


SAME = "(= ?x ?y)"


@pytest.mark.parametrize(
    ("rule", "parameters", "body", "eff", "expected"),
    [
        # 1. Reads after writes, and aliasing.
        ("written before", "x: T", "", "f[x] = 1\nn = f(x) + 1", ["f ?x", "2"]),
        ("may be the same", "x: T, y: T", "", "f[x] = 1\nf[y] = 2\nn = f(x)",
         [f"(= (n) (condition {SAME} 2 1))"]),
        ("of a subtype", "x: T, u: U", "", "f[x] = 1\nn = f(u)",
         ["(= (n) (condition (= ?u ?x) 1 (f ?u)))"]),
        ("of a type apart", "x: T, v: V", "", "r[x] = True\np[x] = r(v)", ["(= (p ?x) (r ?v))"]),
        ("of two arguments", "x: T, y: T", "", "on[x, y] = True\np[x] = on(y, x)",
         [f"(= (p ?x) (or {SAME} (on ?y ?x)))"]),
        ("a constant", "x: T", "", "p[home] = True\nq[x] = p(x)",
         ["(= (q ?x) (or (= ?x home) (p ?x)))"]),
        ("an index that is read", "x: T, y: T", "", "at[x] = y\np[at(x)] = True",
         ["(= (p ?y) true)"]),
        # 2. Branches.
        ("a condition where it stands", "x: T", "", ("if p(x):\n  p[x] = False\n  q[x] = p(x)\n"
         "else:\n  p[x] = True"), ["(= (p ?x) (not (p ?x)))"]),
        ("one branch", "x: T", "", "if p(x): f[x] = 1",
         ["(= (f ?x) (condition (p ?x) 1 (f ?x)))"]),
        ("locals", "x: T", "", "let k = 1\nif p(x): k = 2\nelse: k = 3\nf[x] = k",
         ["(= (f ?x) (condition (p ?x) 2 3))"]),
        ("aliased in a branch", "x: T, y: T", "", ("if q(x):\n  p[x] = True\n  p[y] = False\n"
         "else:\n  p[y] = True"), []),
        ("order of two branches", "x: T, y: T", "", ("if q(x):\n  f[x] = 1\n  f[y] = 2\nelse:\n"
         "  f[y] = 3\n  f[x] = 4"), []),
        # 3. Loops that are unrolled.
        ("break", "x: T", "", "for i in range(3):\n  if f(x) > 0: f[x] -= 1\n  else: break",
         ["(condition (> (f ?x) 1) (condition (> (f ?x) 2) (- (f ?x) 3) (- (f ?x) 2))"]),
        ("continue", "x: T", "", "for i in range(3):\n  if f(x) == i: continue\n  n += i",
         ["(= (n)"]),
        ("break after continue", "x: T", "",
         "for i in range(3):\n  if p(x): continue\n  if f(x) > i: break\n  n += 1", []),
        ("nested", "x: T", "", ("for i in range(2):\n  for j in range(2):\n"
         "    if f(x) == j: break\n    n += 1\n  f[x] += 1"), []),
        ("step", "x: T", "", "for i in range(5, 0, -2): n = n(...) * 10 + i", []),
        # 4. `foreach`.
        ("quantified", "x: T", "", "foreach z: T: p[z] = q(z)",
         ["(forall (?z - T) (= (p ?z) (q ?z)))"]),
        ("two objects", "x: T", "", "foreach z: T:\n  foreach w: T: on[z, w] = on(w, z)",
         ["(forall (?z - T ?w - T) (= (on ?z ?w) (on ?w ?z)))"]),
        ("a guard over the object", "x: T", "", "foreach z: T:\n  if near(x, z): f[z] += 1",
         ["(forall (?z - T) (when (or (= ?z (at ?x)) (on ?x ?z)) (= (f ?z) (+ (f ?z) 1))))"]),
        ("a subtype", "x: T", "", "foreach z: U: p[z] = True\nq[x] = p(x)",
         ["(= (q ?x) (or (exists (?u - U) (= ?u ?x)) (p ?x)))"]),
        ("read after it", "x: T", "", "foreach z: T: p[z] = q(z)\nq[x] = not p(x)",
         ["(= (q ?x) (not (q ?x)))"]),
        ("the state before it", "x: T", "", "p[x] = True\nforeach z: T: q[z] = p(z)",
         ["(forall (?z - T) (= (q ?z) (or (= ?x ?z) (p ?z))))"]),
        # 5. Locals, functions, external functions.
        ("a local keeps its value", "x: T", "", "let k = f(x)\nf[x] = 7\nn = k",
         ["(= (n) (f ?x))"]),
        ("inlined", "x: T, y: T", "", "at[x] = y\np[x] = near(x, y)", ["(= (p ?x) true)"]),
        # Vectors and floats keep their order.
        ("a vector", "x: T, y: T", "", "pose[x] = [1.0, 2.0]\npose[y] = pose(x) + pose(x)",
         ["(= (pose ?y) (+ (vector 1.0 2.0) (vector 1.0 2.0)))"]),
        ("elements", "x: T, y: T", "", "pose[x] = pose(y) * 2.0 - pose(x)",
         ["(= (pose ?x) (- (* (pose ?y) 2.0) (pose ?x)))"]),
        ("floats", "x: T", "", "g[x] = g(x) + 1.0 + 2.0", ["(+ (+ (g ?x) 1.0) 2.0)"]),
        ("an exact float32", "x: T", "", "h[x] = 0.5\ng[x] = h(x)", ["(= (g ?x) 0.5)"]),
        # Effects of controllers, one after another, then the behavior's own.
        ("controllers", "x: T, y: T", "do make(x)\ndo flip(y)", "q[x] = p(y)",
         [f"(= (q ?x) (not (or {SAME} (p ?y))))"]),
        ("arguments", "x: T, y: T", "do swap(x, y)\ndo swap(y, x)", "n = f(x)",
         ["(= (n) (f ?x))"]),
    ],
)  # fmt: skip
@pytest.mark.parametrize("level", [Level.NONE, Level.BASIC, Level.FULL])
def test_rules(
    rule: str, parameters: str, body: str, eff: str, expected: list[str], level: Level
) -> None:
    program, behavior = act(eff, body or "pass", parameters)
    (triple,) = Model(program, level).triples(behavior)
    if level is Level.BASIC:
        text = "\n".join(line.text for line in effects(triple))
        assert all(part in text for part in expected), (rule, text)
    check_running(program, behavior, triple)


@pytest.mark.parametrize(
    ("eff", "expected"),
    [
        ("q[x] = sounds(x)", "(= (q ?x) (sounds ?x))"),
        ("p[x] = True\nq[x] = sounds(x)", "(= (q ?x) (sounds ?x))"),
        ("f[x] = 1\nq[x] = looks(x)", "(= (q ?x) (looks ?x))"),
        ("q[x] = looks(x)\np[x] = True", "(= (q ?x) (looks ?x))"),
        ("let k = feels(x)\nf[x] = 1\nq[x] = k", "(= (q ?x) (feels ?x))"),
        ("if looks(x): p[x] = False", "(= (p ?x) (condition (looks ?x) false (p ?x)))"),
    ],
)
def test_external_functions_stay_and_read_the_state_of_their_call(eff: str, expected: str) -> None:
    program, behavior = act(eff)
    (triple,) = Model(program).triples(behavior)
    assert expected in [line.text for line in effects(triple)]


@pytest.mark.parametrize(
    ("eff", "construct"),
    [
        ("p[x] = True\nq[x] = looks(x)", "`looks`, which reads `p`, after a write of it"),
        ("f[x] = 1\nq[x] = feels(x)", "`feels`, which reads `f`, after a write of it"),
        ("h[x] = 0.1\ng[x] = h(x)", "a read of a `float32` after a write that may round"),
        ("h[x] += 1.0\ng[y] = h(y)", "a read of a `float32` after a write that may round"),
    ],
)
def test_what_would_be_of_another_state_or_value_is_refused(eff: str, construct: str) -> None:
    program, behavior = act(eff)
    with pytest.raises(NotModelled) as raised:
        Model(program).triples(behavior)
    assert raised.value.construct == construct


def test_a_condition_after_a_behavior_is_refused_likewise() -> None:
    program, behavior = act("p[x] = True")
    model = Model(program)
    (triple,) = model.triples(behavior)
    condition = model.formula(expression_of(DECLARATIONS, "looks(home)"))
    with pytest.raises(NotModelled, match="reads `p`"):
        model.weakest_precondition(condition, triple)
    unread = model.formula(expression_of(DECLARATIONS, "sounds(home)"))
    assert model.weakest_precondition(unread, triple) is unread


@pytest.mark.parametrize(
    ("eff", "conflicts"),
    [
        ("foreach z: T: f[z] = f(z) + 1", 0),
        ("foreach z: T: f[x] = f(z)", 1),
        ("foreach z: T: p[x] = True", 0),
        ("foreach z: T: p[at(z)] = q(z)", 1),
        ("foreach z: T:\n  foreach w: T: on[z, w] = p(z)", 0),
        ("foreach z: T:\n  foreach w: T: on[z, z] = p(w)", 1),
    ],
)
def test_iterations_that_may_write_one_cell_are_known(eff: str, conflicts: int) -> None:
    program, behavior = act(eff)
    (triple,) = Model(program).triples(behavior)
    assert len(triple.conflicts) == conflicts


# ------------------------------------------------------------------------------ choices of a body


def needs(body: str, eff: str = "pass") -> list[list[str]]:
    program, behavior = act(eff, body)
    return [
        [line.text for line in (*preconditions(triple), *effects(triple))]
        for triple in Model(program).triples(behavior)
    ]


def test_each_order_of_an_unordered_group_is_a_triple() -> None:
    body = "unordered:\n  do make(x)\n  do flip(y)"
    assert needs(body) == [
        ["(= (p ?x) true)", f"(= (p ?y) (not (or {SAME} (p ?y))))"],
        ["(= (p ?y) (not (p ?y)))", "(= (p ?x) true)"],
    ]


def test_an_unordered_group_of_conditions_is_one_triple() -> None:
    assert needs("unordered:\n  achieve p(x)\n  achieve q(y)") == [["(p ?x)", "(q ?y)"]]


def test_orders_that_make_no_difference_are_one_triple() -> None:
    body = "unordered:\n" + "\n".join(["  do make(x)", *["  do go(x)"] * 5, "  do swap(x, y)"])
    assert len(needs(body)) == 1
    assert len(needs("unordered:\n  do make(x)\n  do go(y)\n  do copy(x, y)")) == 6


@pytest.mark.parametrize(
    ("statement", "construct"),
    [("let k = p(y)", "`let`"), ("bind k: T where: p(k)", "`bind`")],
)
def test_variables_in_a_group_whose_order_matters_are_refused(
    statement: str, construct: str
) -> None:
    """In some orders they would be used before they have a value."""
    use = "do make(k)" if "bind" in statement else "do go(x)"
    with pytest.raises(NotModelled, match=f"{construct} in an `unordered` group that acts"):
        needs(f"unordered:\n  do make(x)\n  {statement}\n  {use}")


@pytest.mark.parametrize(("count", "is_modelled"), [(6, True), (7, False)])
def test_more_choices_than_the_limit_are_refused(count: int, is_modelled: bool) -> None:
    body = "\n".join(["alternative:\n  assert p(x)\n  assert q(y)"] * count)
    if is_modelled:
        assert len(needs(body)) == 2**count == MAX_TRIPLES
        return
    with pytest.raises(NotModelled, match="more than 64 choices"):
        needs(body)


def test_orders_beyond_the_limit_are_refused_before_they_are_tried() -> None:
    """Twelve calls have 479,001,600 orders."""
    body = "unordered:\n" + "\n".join(f"  do flip({'xy'[i % 2]})" for i in range(12))
    with pytest.raises(NotModelled, match="more than 64 choices"):
        needs(body)


@pytest.mark.parametrize("level", Level)
def test_writes_of_one_loop_may_meet_in_other_iterations(level: Level) -> None:
    eff = """
    if p(x):
      foreach z: T:
        at[at(z)] = at(x)
        at[at(z)] = y
    else:
      q[x] = True
    """
    program, behavior = act(eff)
    (triple,) = Model(program, level).triples(behavior)
    check_running(program, behavior, triple)
