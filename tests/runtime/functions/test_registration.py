"""What is given as functions, and what of it does not fit the program."""

import pickle
import types
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from programs import program_of
from small_program import DOMAIN, problem

import crow
from crow.functions import NOTHING, collected
from crow.registration import registered

PROGRAM = program_of(DOMAIN)


def mistakes(python: Any) -> list[str]:
    with pytest.raises(crow.FunctionsError) as raised:
        registered(PROGRAM, python)
    assert str(raised.value)
    return [mistake.message for mistake in raised.value.mistakes]


def heavy(b: str) -> bool:
    return b == "a"


def module(source: str) -> types.ModuleType:
    made = types.ModuleType("made")
    exec(source, vars(made))
    return made


def test_a_module_gives_what_is_decorated_and_what_has_a_name_of_the_program() -> None:
    made = module(
        "import crow\n"
        "from os.path import join as weight_of\n"
        "def heavy(b): return True\n"
        "def helper(x, y, z): return 1\n"
        "def _free(state, b): return True\n"
        "@crow.function('middle', vectorized=True)\n"
        "def mid(a, b): return (a + b) / 2\n"
        "@crow.generator(complete=True, limit=3)\n"
        "def reach(state, b, *, rng): yield 1.0, 2.0\n"
        "@crow.effect('carry')\n"
        "@crow.controller('carry')\n"
        "def carry(*given): return {}\n"
    )
    given = registered(PROGRAM, made)
    assert given.functions.keys() == {"heavy", "middle"}
    assert given.functions["middle"].mark.is_vectorized
    reach = given.generators["reach"]
    assert (reach.mark.is_complete, reach.mark.limit, reach.takes_random) == (True, 3, True)
    assert reach.reads == {"at"}
    assert given.effects.keys() == given.controllers.keys() == {"carry"}


def test_a_decorated_function_comes_before_a_plain_one_of_its_name() -> None:
    made = module(
        "import crow\n"
        "def heavy(b): return False\n"
        "@crow.function('heavy')\n"
        "def other(b): return True\n"
    )
    assert registered(PROGRAM, made).functions["heavy"].call("a") is True


def test_what_is_decorated_stays_a_function() -> None:
    marked = crow.function(heavy)
    assert marked is heavy
    assert crow.function("x", vectorized=True)(heavy) is heavy
    del heavy.__crow_marks__  # type: ignore[attr-defined]


def test_a_mapping_names_functions() -> None:
    @crow.function("something else")
    def decorated(b: str) -> bool:
        return False

    given = registered(PROGRAM, {"heavy": decorated, "nearest": lambda b: "table"})
    assert given.functions.keys() == {"heavy", "nearest"}


def test_an_object_gives_its_decorated_methods() -> None:
    class Simulator:
        def __init__(self) -> None:
            self.asked: list[str] = []

        @property
        def broken(self) -> object:
            raise AssertionError("properties are not looked at")

        @crow.function
        def heavy(self, b: str) -> bool:
            self.asked.append(b)
            return True

        @crow.effect
        def carry(self, state: Any, b: str, to: Any) -> dict[Any, Any]:
            return {}

    simulator = Simulator()
    given = registered(PROGRAM, simulator)
    assert given.functions["heavy"].call("a") is True
    assert simulator.asked == ["a"]
    assert given.effects.keys() == {"carry"}


def test_a_file_may_import_its_neighbours_and_leaves_nothing_behind(tmp_path: Path) -> None:
    import sys

    (tmp_path / "weights.py").write_text("HEAVY = 'b'\n")
    file = tmp_path / "functions.py"
    file.write_text(
        "from dataclasses import dataclass\nimport weights\n"
        "@dataclass\nclass Box:\n    name: 'str'\n"
        "def heavy(b): return Box(b) == Box(weights.HEAVY)\n"
    )
    path, modules = list(sys.path), set(sys.modules)
    given = registered(PROGRAM, file)
    assert (given.functions["heavy"].call("a"), given.functions["heavy"].call("b")) == (False, True)
    assert sys.path == path
    assert set(sys.modules) - modules == {"weights"}
    del sys.modules["weights"]


@pytest.mark.parametrize(
    ("source", "said"),
    [
        ("1 / 0", "ZeroDivisionError: division by zero"),
        ("def", "SyntaxError"),
        ("import nothing_of_this_name", "ModuleNotFoundError"),
        ("open('none')", "FileNotFoundError"),
    ],
)
def test_a_file_that_cannot_be_run_is_told_with_its_own_traceback(
    source: str, said: str, tmp_path: Path
) -> None:
    file = tmp_path / "functions.py"
    file.write_text(source + "\n")
    with pytest.raises(crow.FunctionsError) as raised:
        collected(file)
    assert said in str(raised.value)
    assert "python_files" not in str(raised.value)
    assert "importlib" not in str(raised.value)


@pytest.mark.parametrize("wrong", [3, object(), {"heavy": 3}, {3: len}])
def test_what_gives_no_functions_is_refused(wrong: object) -> None:
    with pytest.raises(crow.FunctionsError):
        registered(PROGRAM, wrong)


def test_nothing_is_nothing() -> None:
    assert registered(PROGRAM, None) is NOTHING


def gen(b: str) -> Iterator[int]:
    yield 1


async def later(b: str) -> bool:
    return True


@pytest.mark.parametrize(
    ("name", "python", "said"),
    [
        ("heavy", lambda: True, "`heavy` is called with 1 value, which `<lambda>()`"),
        ("free", lambda b: True, "`free` is called with the state and 1 value"),
        ("close", lambda b, s: True, "`close` is called with the state and 2 values"),
        ("heavy", lambda b, *, rng: True, "`heavy` is called with 1 value"),
        ("heavy", gen, "`heavy` yields, which only generators do"),
        ("heavy", later, "`heavy` is `async`"),
        ("hevy", heavy, "no external function `hevy`"),
        ("twice", lambda n: n, "`twice` is a derived function, not an external function"),
        ("held", lambda b: True, "`held` is a feature"),
        ("r_on", lambda b: True, "`r_on` is a behavior"),
        ("table", lambda b: True, "`table` is an object"),
        ("carry", lambda b, to: None, "`carry` is a controller"),
        ("carry", crow.effect(lambda b, to: {}), "`carry` is called with the state and 2 values"),
        ("carry", crow.controller(lambda b: {}), "`carry` is called with 2 values"),
        ("wait", crow.effect(lambda state: {}), "`wait` has an `eff:` of its own"),
        ("reach", lambda b: [], "`reach` is called with the state and 1 value"),
        ("pairs", lambda b: [], "`pairs` is called with the state and 1 value"),
        ("reach", crow.function(lambda b: True), "`reach` is a generator, not an external"),
        ("heavy", crow.generator(lambda b: []), "`heavy` is an external function, not a generator"),
    ],
)
def test_what_does_not_fit_is_told(name: str, python: Any, said: str) -> None:
    (told,) = mistakes({name: python})
    assert said in told


def test_all_mistakes_are_told_at_once_with_their_places() -> None:
    with pytest.raises(crow.FunctionsError) as raised:
        registered(PROGRAM, {"heavy": lambda: True, "hevy": heavy, "free": heavy})
    first, second, third = raised.value.mistakes
    assert first.location is not None
    assert first.location.line == 12
    assert (second.location, second.help) == (None, "did you mean `heavy`?")
    assert third.location is not None
    assert str(raised.value).count("\n") == 2


def test_what_is_given_twice_is_a_mistake() -> None:
    made = module(
        "import crow\n"
        "@crow.function('heavy')\ndef one(b): return True\n"
        "@crow.function('heavy')\ndef two(b): return True\n"
        "alias = one\n"
    )
    assert mistakes(made) == ["the function `heavy` is given twice"]


@pytest.mark.parametrize("limit", [0, -1, True, 1.5])
def test_a_limit_is_a_positive_number(limit: Any) -> None:
    with pytest.raises(ValueError, match="from 1 on"):
        crow.generator("reach", limit=limit)


def test_what_cannot_be_marked_says_so() -> None:
    with pytest.raises(TypeError, match="give it in a mapping"):
        crow.function(len)


def test_built_in_functions_may_be_given() -> None:
    given = registered(PROGRAM, {"name_of": str.upper, "heavy": "ab".__contains__})
    assert given.functions["name_of"].call("a") == "A"


def test_a_problem_pickles_where_its_functions_can_be_imported() -> None:
    made = problem({"heavy": heavy, "free": _free, "path": _path, "middle": _path}, "held(b)")
    back = pickle.loads(pickle.dumps(made))
    assert back.world == made.world
    assert back.world.externals.functions["heavy"].value({}, ("a",)) is True
    assert isinstance(crow.plan(back), crow.Plan)


def _path(a: Any, b: Any) -> Any:
    return a


def _free(state: Any, b: str) -> bool:
    return True


def test_else_the_function_that_does_not_is_named() -> None:
    made = problem({"heavy": heavy, "nearest": lambda b: "table"})
    with pytest.raises(pickle.PicklingError, match="the Python of `nearest` cannot be pickled"):
        pickle.dumps(made)
