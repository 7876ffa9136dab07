"""The Hoare model as users get it: text at every level, explanations, JSON."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from jsonschema import Draft202012Validator
from programs import behavior_of

from cdlc.driver import Compilation, CompileError
from cdlc.ir.graph import size, written_size
from cdlc.ir.hoare import Model
from cdlc.ir.nodes import Level
from cdlc.ir.text import hoare_text
from crow.evaluate import evaluate, execute
from crow.problem import State, World
from crow.program import (
    INT64,
    Arithmetic,
    Compare,
    Conditional,
    Constant,
    Expression,
    Parameter,
    Read,
)
from crow.program.codec import decode_problem
from crow.program.model_codec import decode_model
from crow.program.schema import hoare_schema, schema
from crow.program.triples import Update
from crow.program.types import ObjectType

HERE = Path(__file__).parent
CASES = ("do_something", "delivery", "products")
Golden = Callable[[Path, str], None]


def compiled(case: str, level: Level, monkeypatch: pytest.MonkeyPatch) -> Compilation:
    """A case, with places that do not say where the repository is."""
    monkeypatch.chdir(HERE / "golden")
    return Compilation(f"{case}.cdl", level=level)


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("level", Level)
def test_golden(case: str, level: Level, golden: Golden, monkeypatch: pytest.MonkeyPatch) -> None:
    golden(HERE / "golden" / f"{case}.{level}.hoare", compiled(case, level, monkeypatch).hoare_text)


@pytest.mark.parametrize("case", CASES)
def test_golden_explanation(case: str, golden: Golden, monkeypatch: pytest.MonkeyPatch) -> None:
    text = compiled(case, Level.FULL, monkeypatch).hoare_explanation
    golden(HERE / "golden" / f"{case}.explained.txt", text)


# -------------------------------------------------------------------------------------------- D.5

D5 = (HERE / "golden" / "do_something.cdl").read_text()


@pytest.mark.parametrize(
    ("level", "formula"),
    [
        (
            Level.NONE,
            "cond(f>0, cond(f-1>0, cond((f-1)-1>0, ((f-1)-1)-1, (f-1)-1), f-1), f)",
        ),
        (Level.BASIC, "cond(f>0, cond(f>1, cond(f>2, f-3, f-2), f-1), f)"),
    ],
)
def test_the_example_of_the_paper_is_the_formula_of_the_design(level: Level, formula: str) -> None:
    """Written as in lowering.md §1.3, so that the golden files are not their own reference."""
    program, behavior = behavior_of(D5, "do_something")
    (triple,) = Model(program, level).triples(behavior)
    (update,) = triple.post
    assert as_designed(after(update)) == formula.replace(" ", "")
    assert (update.feature, update.variables) == ("f", ())


def after(update: Update) -> Expression:
    """What the cell of an update holds after it."""
    cell = Read(update.feature, update.arguments, INT64)
    return Conditional(update.guard, update.value, cell, INT64)


def as_designed(node: Expression) -> str:
    """A formula over `f` in the notation of the design."""
    match node:
        case Read(feature=name):
            return name
        case Constant(value=value):
            return str(value)
        case Compare(operator=operator, left=left, right=right):
            return f"{as_designed(left)}{operator}{as_designed(right)}"
        case Arithmetic(operator="-", left=left, right=right):
            inner = as_designed(left)
            return (
                f"({inner})-1" if isinstance(left, Arithmetic) else f"{inner}-{as_designed(right)}"
            )
        case Conditional(condition=condition, then=then, otherwise=otherwise):
            return f"cond({','.join(map(as_designed, (condition, then, otherwise)))})"
        case _:
            raise AssertionError(node)


@pytest.mark.parametrize("level", Level)
def test_the_example_of_the_paper_is_what_running_does(level: Level) -> None:
    program, behavior = behavior_of(D5, "do_something")
    (triple,) = Model(program, level).triples(behavior)
    (update,) = triple.post
    world = World.of(program, (Parameter("a", ObjectType("Object")),))
    assert behavior.effect is not None
    for number in range(-50, 51):
        state = world.updated(State(), {("f", ("a",)): number})
        ran = execute(world, state, behavior.effect, {"x": "a"})
        expected = ran.cells.get(("f", ("a",)), 0)
        assert evaluate(world, state, after(update), {"x": "a"}) == expected


# ------------------------------------------------------------------------------------------- JSON


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("level", Level)
def test_json_fits_the_schema_and_is_the_model(
    case: str, level: Level, monkeypatch: pytest.MonkeyPatch
) -> None:
    compilation = compiled(case, level, monkeypatch)
    document = json.loads(compilation.hoare_json)
    Draft202012Validator(hoare_schema()).validate(document)
    model = decode_model(document)
    assert model is not None
    assert model.level == level
    assert hoare_text(model.triples) == compilation.hoare_text
    sources = [[u.sources for u in t.post] for t in model.triples]
    assert sources == [[u.sources for u in t.post] for t in compilation.triples]
    assert [t.reasons for t in model.triples] == [t.reasons for t in compilation.triples]


@pytest.mark.parametrize("case", CASES)
def test_compiled_programs_carry_the_model(case: str, monkeypatch: pytest.MonkeyPatch) -> None:
    compilation = compiled(case, Level.BASIC, monkeypatch)
    document = json.loads(compilation.ir_text)
    Draft202012Validator(schema()).validate(document)
    model = decode_model(document)
    assert model is not None
    assert hoare_text(model.triples) == compilation.hoare_text
    assert decode_problem(document) is None


UNMODELLED = """
typedef T
feature p(x: T)
controller go(x: T)
behavior first(x: T):
  body:
    do go(x)
    achieve p(x)
  eff: p[x] = True
behavior second(x: T):
  eff: p[x] = False
"""


def test_a_behavior_without_model_is_named_in_the_compiled_program() -> None:
    compilation = Compilation("-", read_standard_input=UNMODELLED.encode)
    document = json.loads(compilation.ir_text)
    Draft202012Validator(schema()).validate(document)
    model = decode_model(document)
    assert model is not None
    assert [t.behavior for t in model.triples] == ["second"]
    (missing,) = model.unmodelled
    assert (missing.behavior, missing.construct) == (
        "first",
        "an `achieve` after a controller call",
    )
    assert missing.location is not None
    assert missing.location.line == 8


# ------------------------------------------------------------------------------------- large loops

LOOP = """
typedef T
feature f(x: T) -> int64
behavior act(x: T):
  eff:
    for i in range({count}):
      if f[x] > i: f[x] -= 1
"""


@pytest.mark.parametrize("count", [30, 300])
def test_json_is_linear_in_the_iterations(count: int) -> None:
    compilation = Compilation("-", read_standard_input=LOOP.format(count=count).encode)
    document = json.loads(compilation.hoare_json)
    assert len(document["model"]["nodes"]) <= 4 * count + 10
    model = decode_model(document)
    assert model is not None
    value = model.triples[0].post[0].value
    assert size(value) <= 4 * count + 10
    assert written_size(value) > 2**count


def test_text_beyond_the_limit_is_refused_and_says_what_to_do() -> None:
    compilation = Compilation("-", read_standard_input=LOOP.format(count=30).encode)
    for text in ("hoare_text", "hoare_explanation"):
        with pytest.raises(CompileError) as raised:
            getattr(compilation, text)
        codes = {d.code for d in raised.value.diagnostics}
        assert codes == {"formula-too-large"}
