"""Outlines, what their steps are for, and the way through the program along one."""

import pytest
from support import EXAMPLES

import crow
from benchmarks.towers import instance, names, random_towers
from cdlc.driver import problem_compilation
from crow.replay import replay_to_goal
from crow.search.follow import Follower
from crow.search.machine import Machine
from crow.search.relaxed.guide import Guiding
from crow.search.relaxed.links import Outline
from crow.search.relaxed.outlines import Outlines

FOLLOWED = ["blocks/sussman", "blocks/towers12", "briefcase/payday", "gripper/four", "jugs/four",
            "kitchen/tidy", "tutorial/swap"]  # fmt: skip
OUTLINED = [*FOLLOWED, "logistics/parcel"]


def outlines(task: crow.Problem) -> Outlines:
    machine = Machine(task, counts_depth=False)
    machine.protects = False
    machine.depth_limit = 1
    return Outlines(machine, Guiding(machine, "ff"), lambda: None)


def example(name: str) -> crow.Problem:
    return problem_compilation([str(EXAMPLES / f"{name}.cdl")]).problem


def found(search: Outlines) -> Outline:
    (outline,) = [one for one in search.search(2_000) if one is not None]
    return outline


@pytest.mark.parametrize("name", OUTLINED)
def test_each_operator_of_a_step_makes_it_and_the_last_one_what_is_wanted(name: str) -> None:
    search = outlines(example(name))
    outline = found(search)
    assert outline.states[0] is search.initial
    for number, operators in enumerate(outline.operators):
        assert operators
        for index in operators:
            states = search.run(outline.states[number], index)
            assert states is not None
            assert states[-1] is outline.states[number + 1]
    assert all(search.task.is_true(fact, outline.states[-1]) for fact in search.wanted)
    assert [outline.steps[state] for state in outline.states] == list(range(len(outline.states)))


@pytest.mark.parametrize("name", OUTLINED)
def test_no_step_can_be_left_out_that_is_for_nothing(name: str) -> None:
    search = outlines(example(name))
    outline = found(search)
    assert search.outline(list(outline.states)) == outline


def test_steps_that_are_for_nothing_are_left_out() -> None:
    search = outlines(example("logistics/parcel"))
    outline = found(search)
    path = search._path(outline.states[-1])
    whole = search._through(path)
    assert search.links(whole).useless()
    assert len(outline.states) < len(path)
    assert search.links(outline).useless() == []


def test_what_lasts_is_what_a_step_is_for() -> None:
    search = outlines(example("blocks/sussman"))
    outline = found(search)
    known = search.links(outline)
    last = len(outline.operators)
    # A is stacked for the goal alone, and held only to be stacked.
    assert known.purposes(last - 1) == {(None, last)}
    ends = {(key[0].behavior.name, step) for key, step in known.purposes(last - 2) if key}
    assert ends == {("r_on", last - 1)}
    beginning = known.beginning(last - 2)
    assert {code.behavior.name for code, _ in beginning} >= {"r_on", "r_holding_from_table"}
    assert set(beginning.values()) == {last - 2, last - 1}


@pytest.mark.parametrize("name", FOLLOWED)
def test_the_program_goes_along_an_outline(name: str) -> None:
    task = example(name)
    search = outlines(task)
    outline = found(search)
    follower = Follower(search.machine, search.guiding, search.links(outline), lambda: None)
    points = [point for point in follower.search(20_000) if point is not None]
    assert [point.state for point in points] == [outline.states[-1]]


def test_where_the_program_has_no_such_plan_the_search_goes_on() -> None:
    # A truck drives to where a parcel will be before it is there; the program has it wait.
    task = example("logistics/parcel")
    search = outlines(task)
    follower = Follower(search.machine, search.guiding, search.links(found(search)), lambda: None)
    assert not any(follower.search(20_000))
    result = crow.plan(task, "best")
    assert isinstance(result, crow.Plan)
    assert replay_to_goal(task, result.trace).is_sound


@pytest.mark.parametrize("count", [6, 9, 12, 16])
@pytest.mark.parametrize("seed", range(3))
def test_towers_take_few_nodes(count: int, seed: int) -> None:
    task = instance(*random_towers(count, seed)).problem
    result = crow.plan(task, "best", node_limit=4_000)
    assert isinstance(result, crow.Plan)
    assert replay_to_goal(task, result.trace).is_sound


def test_the_order_of_goals_makes_no_difference_to_a_tower_turned_over() -> None:
    tower = names(15)
    goal = [(tower[i], tower[i + 1]) for i in range(len(tower) - 1)]
    results = [crow.plan(instance([tower], order).problem) for order in (goal, goal[::-1])]
    assert [len(result.steps) for result in results] == [30, 30]
    few, many = sorted(result.statistics["nodes"] for result in results)
    assert many <= 1.5 * few


def test_a_choice_of_a_called_behavior_is_not_that_of_the_operator() -> None:
    """`stack_blocks` calls `arrange`, which chooses in its turn, with other variables."""
    problem = example("blocks/stacking_sussman")
    result = crow.plan(problem, "best", time_limit=60)
    assert isinstance(result, crow.Plan)
    assert replay_to_goal(problem, result.trace).is_sound
