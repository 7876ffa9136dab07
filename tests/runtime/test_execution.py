"""`crow.execute`: worlds that do as planned, and worlds that do not."""

import json

import jsonschema
import pytest
from programs import problem_of
from small_worlds import SUSSMAN, WANTED, Table, blocks, table
from support import ROOT

import crow
from crow.execution import DONE, FAILED, Acted, Planned
from crow.problem import Cell, Problem

SCHEMA = json.loads((ROOT / "cdlc" / "schemas" / "execution.json").read_text())


def run(problem: Problem, world: object, **options: object) -> crow.Execution:
    """Execute; every record follows the schema, and has a text."""
    record = crow.execute(problem, world, **options)  # type: ignore[arg-type]
    jsonschema.validate(json.loads(json.dumps(record.json())), SCHEMA)
    assert len(record.text().splitlines()) == len(record.events) + 1
    return record


def plans(record: crow.Execution) -> list[Planned]:
    return [event for event in record.events if isinstance(event, Planned)]


def test_a_world_that_does_as_planned_is_planned_for_once() -> None:
    world = table()
    record = run(blocks(), world)
    assert record.status == "done"
    assert world.below == WANTED
    assert len(plans(record)) == 1
    assert len(record.calls) == 6
    assert record.text().splitlines()[1:] == [
        "  1. unstack(C, A)",
        "  2. place_table(C)",
        "  3. pickup_table(B)",
        "  4. stack(B, C)",
        "  5. pickup_table(A)",
        "  6. stack(A, B)",
        "done: the goal holds",
    ]


def test_a_block_that_is_knocked_off_is_put_back() -> None:
    world = table()

    def knock(table: Table) -> None:
        if len(table.acted) == 4:  # B has just been put on C
            table.below["B"] = None

    world.before = knock
    record = run(blocks(), world)
    assert record.status == "done"
    assert world.below == WANTED
    first, second = plans(record)
    assert first.reason is None
    # What A will stand on no longer stands where it has to in the end.
    assert second.reason == "`on(A, B) and on(B, C)` does not hold any more"
    assert record.calls[4:6] == (
        crow.ControllerCall("pickup_table", ("B",)),
        crow.ControllerCall("stack", ("B", "C")),
    )


def test_what_the_rest_of_the_plan_does_not_need_may_change() -> None:
    problem = blocks(SUSSMAN.replace("A, B, C", "A, B, C, D, E"))
    world = Table({"A": None, "B": None, "C": "A", "D": "E", "E": None})

    def knock(table: Table) -> None:
        if len(table.acted) == 2:
            table.below["D"] = None

    world.before = knock
    record = run(problem, world)
    assert record.status == "done"
    assert len(plans(record)) == 1


def test_a_call_that_fails_is_tried_again() -> None:
    world = table()
    world.outcomes = [DONE, FAILED, FAILED]
    record = run(blocks(), world)
    assert record.status == "done"
    assert world.below == WANTED
    failed = [e for e in record.events if isinstance(e, Acted) and e.outcome == "failed"]
    assert [str(e.call) for e in failed] == ["place_table(C)", "place_table(C)"]
    assert plans(record)[1].reason == "`place_table(C)` failed"


@pytest.mark.parametrize("attempts", [1, 4])
def test_a_call_that_always_fails_is_given_up(attempts: int) -> None:
    world = table()
    world.outcomes = [FAILED] * 100
    record = run(blocks(), world, attempts=attempts)
    assert (record.status, record.explanation) == ("failed", "unstack(C, A)")
    assert len(world.acted) == attempts
    assert record.calls == ()


def test_a_goal_that_comes_true_by_itself_ends_it() -> None:
    world = table()

    def help_(table: Table) -> None:
        if len(table.acted) == 2:
            table.below = dict(WANTED)

    world.before = help_
    record = run(blocks(), world)
    assert record.status == "done"
    assert len(record.calls) == 2


def test_a_goal_that_holds_takes_no_call() -> None:
    record = run(blocks(), Table(WANTED))
    assert (record.status, record.events) == ("done", ())


def test_a_world_without_a_plan_ends_with_the_reason() -> None:
    class Empty(Table):
        def observe(self) -> dict[Cell, object]:
            return {}

    record = run(blocks(), Empty({"A": None}), node_limit=300)
    assert record.status == "no-plan"
    assert record.explanation is not None
    assert "the node limit was reached" in record.explanation
    assert "domain.cdl:" in record.explanation


def test_a_limit_of_steps_ends_it() -> None:
    world = table()
    record = run(blocks(), world, step_limit=3)
    assert (record.status, record.explanation) == ("step-limit", "3 calls")
    assert len(world.acted) == 3
    assert run(blocks(), table(), step_limit=6).status == "done"


# ------------------------------------------------------------------------ what environments may do


class Broken(Table):
    def __init__(self, seen: object = None, outcome: object = DONE) -> None:
        super().__init__(table().below)
        self.seen, self.outcome = seen, outcome

    def observe(self) -> dict[Cell, object]:
        if isinstance(self.seen, BaseException):
            raise self.seen
        return super().observe() if self.seen is None else self.seen  # type: ignore[return-value]

    def act(self, controller: str, arguments: tuple[object, ...]) -> str:
        if isinstance(self.outcome, BaseException):
            raise self.outcome
        return self.outcome  # type: ignore[return-value]


@pytest.mark.parametrize(
    ("seen", "told"),
    [
        (ZeroDivisionError("no camera"), "`observe` raised ZeroDivisionError: no camera"),
        (17, "17 is no state"),
        ({("onn", ("A", "B")): True}, "an observation of `onn`, which is no feature"),
        ({("on", ("A",)): True}, "an observation of `on(A)`, which is no cell"),
        ({("on", ("A", "Z")): True}, "an observation of `on(A, Z)`, which is no cell"),
        ({("on", ("A", "B")): 1}, "the observed `on(A, B)` is 1, which is no `bool`"),
        ({"on": True}, "'on' is no cell: a feature's name and a tuple of objects"),
    ],
)
def test_what_is_no_observation_ends_it(seen: object, told: str) -> None:
    record = run(blocks(), Broken(seen))
    assert (record.status, record.explanation) == ("environment", told)


def test_what_is_no_outcome_ends_it() -> None:
    record = run(blocks(), Broken(outcome="perhaps"))
    assert record.status == "environment"
    assert record.explanation == "`unstack(C, A)` ended with 'perhaps', which is no outcome"
    assert run(blocks(), Broken(outcome=None)).status == "environment"


def test_an_exception_of_a_controller_is_a_failure_of_it() -> None:
    record = run(blocks(), Broken(outcome=OSError("no contact")))
    assert record.status == "failed"
    assert record.text().splitlines()[1] == "  1. unstack(C, A): failed (OSError: no contact)"


@pytest.mark.parametrize("broken", [Broken(KeyboardInterrupt()), Broken(None, KeyboardInterrupt())])
def test_an_interrupt_passes_through(broken: Broken) -> None:
    with pytest.raises(KeyboardInterrupt):
        crow.execute(blocks(), broken)


def test_a_controller_may_return_the_state_it_led_to() -> None:
    class Telling(Table):
        def act(self, controller: str, arguments: tuple[object, ...]) -> object:  # type: ignore[override]
            assert super().act(controller, arguments) == DONE
            return super().observe()

        looks = 0

        def observe(self) -> dict[Cell, object]:
            self.looks += 1
            return super().observe()

    world = Telling(table().below)
    assert run(blocks(), world).status == "done"
    assert world.below == WANTED
    assert world.looks == 1


def test_a_program_without_plans_is_refused() -> None:
    domain = """
    feature r()
    def ready() -> bool
    behavior b():
      goal: r()
      body:
        assert ready()
      eff: r[...] = True
    """
    problem = problem_of(domain, 'problem "p"\ngoal: r()\n')
    with pytest.raises(crow.NotPlannable):
        crow.execute(problem, table())
