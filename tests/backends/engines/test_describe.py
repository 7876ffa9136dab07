"""What engines take, and whether a task fits them."""

import json

import jsonschema
import pytest
from support import EXAMPLES, ROOT, cdlc

import cdlc as library
from cdlc.backends.engines import EngineFailed, EngineUnsupported, describe, installed
from cdlc.backends.engines.words import in_words, lacks_in_words

if not {"fast-downward", "kairos"} <= set(installed()):
    pytest.skip("needs the extra `planners`", allow_module_level=True)

JUGS = EXAMPLES / "jugs" / "four.cdl"
SCHEMA = json.loads((ROOT / "cdlc" / "schemas" / "engines.json").read_text())


def test_every_installed_engine_is_described() -> None:
    described = {engine.name: engine for engine in describe()}
    assert tuple(described) == installed()
    assert "costs" in in_words(described["fast-downward"].accepts)
    assert "numbers" not in in_words(described["fast-downward"].accepts)
    assert "numbers" in in_words(described["kairos"].accepts)
    assert not any(engine.lacks for engine in described.values())


def test_a_task_that_cannot_be_read_is_an_error() -> None:
    with pytest.raises(EngineFailed, match="cannot read the PDDL"):
        describe("(define (domain", None)


def test_words_are_said_once_and_others_by_their_names() -> None:
    assert in_words(["REAL_FLUENTS", "INCREASE_EFFECTS", "UNHEARD_OF"]) == ("numbers",)
    assert lacks_in_words(["REAL_FLUENTS", "UNHEARD_OF"]) == ("numbers", "UNHEARD_OF")
    said = str(EngineUnsupported("fast-downward", ("REAL_FLUENTS",)))
    assert said == "engine `fast-downward` does not take numbers; see `cdlc engines`"


def test_the_command_lists_engines() -> None:
    listed = cdlc("engines")
    assert listed.status == 0
    assert [line.split()[0] for line in listed.out.splitlines()] == list(installed())
    document = json.loads(cdlc("engines", JUGS, "--format", "json").out)
    jsonschema.validate(document, SCHEMA)
    fits = {engine["name"]: engine["fits"] for engine in document["engines"]}
    assert (fits["kairos"], fits["fast-downward"]) == (True, False)


def test_the_command_says_why_a_domain_does_not_fit() -> None:
    listed = cdlc("engines", EXAMPLES / "jugs" / "jugs.cdl")
    lines = dict(line.split(maxsplit=1) for line in listed.out.splitlines())
    assert (lines["kairos"], lines["fast-downward"]) == ("fits", "does not take numbers")
    assert cdlc("engines", "a", "b", "c").status == 2


@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_a_task_is_a_problem_of_unified_planning() -> None:
    problem = library.compile(JUGS).up()
    assert [action.name for action in problem.actions] == ["fill", "empty", "pour"]
    assert len(problem.all_objects) == 2
    with pytest.raises(ValueError, match="needs a problem"):
        library.compile(EXAMPLES / "jugs" / "jugs.cdl").up()
