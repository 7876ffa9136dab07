"""Every listing of the paper (docs: language.md §6) with exactly what is to be said about it."""

import json
from dataclasses import replace
from pathlib import Path

import pytest
from jsonschema import Draft202012Validator
from support import BLOCKS

import cdlc
from cdlc.ir.passes.expand_foreach import expand_foreach
from crow.program import Behavior, Program
from crow.program.codec import decode_problem, decode_program, encode
from crow.program.schema import schema

FOLDER = Path(__file__).parent

CLEAN = [
    "s2_types",
    "s2_1_move_away",
    "s2_2_assert",
    "s2_2_effect",
    "s2_3_unordered",
    "s2_4_bind",
    "s2_5_commit",
    "a_foreach",
    "a_unordered",
    "b_assignment",
    "b1_generator",
    "d1_move_to",
    "d1_move_five_steps",
    "d2_base",
    "d2_objects",
    "d2_objects_explicit",
    "d2_values",
    "d2_feature",
    "d3_functions",
    "d4_invert_f",
    "d5_do_something",
    "d6_cupboard",
    "d6_blocks_world_mended",
]
# Listing: code, line and column of everything to be said.
SAID = {
    "s2_1_let": [("shadowing", 10, 9)],
    "s2_1_move_away_as_printed": [("missing-colon", 7, 45)],
    "s2_2_effect_as_printed": [("elision", 11, 28)],
    "s2_2_elided_value": [("elision", 7, 14)],
    "s2_3_unordered_as_printed": [("elision", 13, 37), ("elision", 15, 41)],
    "c_namo": [("shadowing", 45, 10)],
    "c_namo_as_printed": [("missing-colon", 33, 45), ("shadowing", 45, 10)],
    "d1_move_until_less_than_0": [("while-loop", 10, 5)],
    "d3_recursion": [("recursive-call", 3, 5)],
    "d6_blocks_world": [("goal-not-established", 34, 9)],
}
WITH_ERRORS = {
    "s2_1_move_away_as_printed",
    "s2_2_effect_as_printed",
    "s2_2_elided_value",
    "s2_3_unordered_as_printed",
    "c_namo_as_printed",
    "d1_move_until_less_than_0",
    "d3_recursion",
}
EXAMPLES = sorted(BLOCKS.parent.rglob("*.cdl"))


def file(name: str) -> Path:
    return FOLDER / f"{name}.cdl"


def program(name: str) -> Program:
    return cdlc.compile(file(name)).program


def behavior(name: str, behavior: str) -> Behavior:
    return next(b for b in program(name).behaviors if b.name == behavior)


def test_every_listing_is_tested() -> None:
    assert sorted(p.stem for p in FOLDER.glob("*.cdl")) == sorted([*CLEAN, *SAID])


@pytest.mark.parametrize("name", CLEAN)
def test_the_listing_checks(name: str) -> None:
    assert [d.message() for d in cdlc.check(file(name))] == []


@pytest.mark.parametrize("name", SAID)
def test_exactly_this_is_said_of_the_listing(name: str) -> None:
    found = cdlc.check(file(name))
    assert [(d.code, d.location.line, d.location.column) for d in found] == SAID[name]


def test_the_missing_colon_comes_with_its_cure() -> None:
    (missing,) = cdlc.check(file("s2_1_move_away_as_printed"))
    (cure,) = missing.help()
    assert cure.replacement is not None
    assert cure.replacement.text == ":"


def test_the_recursion_names_its_cycle() -> None:
    (recursive,) = cdlc.check(file("d3_recursion"))
    assert "f → g → f" in recursive.message()
    assert [label.location.line for label in recursive.labels()] == [4, 7]


def test_while_says_what_to_write_instead() -> None:
    (loop,) = cdlc.check(file("d1_move_until_less_than_0"))
    assert "foreach" in loop.help()[0].text


def test_the_misprint_of_the_blocks_world_is_named() -> None:
    (warning,) = cdlc.check(file("d6_blocks_world"))
    assert "r_holding_from_stack" in warning.message()
    assert "holding[x] = True" in warning.help()[0].text


# --------------------------------------------------------------------------------- equivalences


def test_foreach_is_an_unordered_group_of_sequential_ones() -> None:
    unordered = replace(program("a_unordered"), name="a_foreach")
    assert expand_foreach(program("a_foreach")) == unordered


def test_bind_with_equality_is_bind_with_a_condition() -> None:
    bound = behavior("s2_4_bind", "bound")
    assert bound.right[0].condition is not None  # type: ignore[union-attr]
    assert [type(s).__name__ for s in bound.right] == ["Bind", "Do"]
    reduced = behavior("s2_4_bind", "reduced")
    assert [type(s).__name__ for s in reduced.right] == ["Bind", "Assert", "Do"]
    assert bound.right[0].condition == reduced.right[1].condition  # type: ignore[union-attr]


def test_explicit_and_implicit_object_are_the_same() -> None:
    assert program("d2_objects").types == program("d2_objects_explicit").types


def test_calls_inside_and_after_the_promotable_section_are_the_same() -> None:
    printed, moved = program("d6_blocks_world"), cdlc.compile(BLOCKS / "blocks_as_printed.cdl")
    assert printed.behaviors == moved.program.behaviors


def test_the_equality_of_a_generator_may_be_written_with_one_sign(tmp_path: Path) -> None:
    text = file("b1_generator").read_text()
    twin = tmp_path / "twin.cdl"
    twin.write_text(text.replace(" = y", " == y"))
    assert cdlc.compile(twin).program.generators == program("b1_generator").generators


def test_untyped_parameters_are_inferred() -> None:
    (generator,) = program("d4_invert_f").generators
    assert [str(p.type) for p in generator.parameters] == ["float32"] * 3
    (do_something,) = program("d5_do_something").behaviors
    assert [str(p.type) for p in do_something.parameters] == ["Object"]


# ------------------------------------------------------------------------------------------- IR

PROGRAMS = [*(file(n) for n in [*CLEAN, *SAID] if n not in WITH_ERRORS), *EXAMPLES]


@pytest.mark.parametrize("path", PROGRAMS, ids=lambda p: p.stem)
def test_programs_survive_json_and_fit_the_schema(path: Path) -> None:
    compiled = cdlc.compile(path)
    document = json.loads(json.dumps(encode(compiled.program, compiled.problem)))
    Draft202012Validator(schema()).validate(document)
    assert decode_program(document) == compiled.program
    assert decode_problem(document) == compiled.problem
    # Equality ignores places; the text does not.
    assert encode(decode_program(document), decode_problem(document)) == document


def test_the_published_schema_is_current() -> None:
    published = Path(cdlc.__file__).parent / "schemas" / "ir.json"
    assert json.loads(published.read_text()) == schema()


def test_the_schema_refuses_damaged_programs() -> None:
    document = json.loads(json.dumps(encode(program("d6_blocks_world"))))
    document["program"]["features"][0]["parameters"][0]["type"] = {"node": "Read"}
    assert not Draft202012Validator(schema()).is_valid(document)
