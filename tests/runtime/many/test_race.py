"""`crow.race`: who wins, what becomes of the others, and the same winner again."""

import multiprocessing
import time
from collections.abc import Iterator

import pytest
from hard_problems import towers
from many_tasks import sussman
from troubles import troubled

import cdlc
import crow
from crow.many.processes import Processes
from crow.many.tasks import Configuration
from crow.problem import Problem
from crow.replay import replay_to_goal

ENDLESS = [Configuration(engine=engine) for engine in ("iddfs", "iw")]
"""With these the towers take minutes."""
GOOD = Configuration(engine="best")
NARROW = Configuration(engine="iddfs", depth_limit=1, name="narrow")


@pytest.fixture(scope="module")
def processes() -> Iterator[Processes]:
    with Processes(2, grace=0.5) as shared:
        list(crow.solve_many([sussman()] * 4, executor=shared))  # they have started
        yield shared


@pytest.fixture(scope="module")
def hard(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    return cdlc.load_problem(towers(tmp_path_factory.mktemp("towers"), 12))


def test_the_first_plan_wins_and_the_others_end_at_once(
    processes: Processes, hard: Problem
) -> None:
    before = set(multiprocessing.active_children())
    start = time.monotonic()
    race = crow.race(hard, [*ENDLESS[:1], GOOD, *ENDLESS[1:]], executor=processes)
    assert time.monotonic() - start < 10
    assert race.winner is not None
    assert race.winner.configuration == GOOD
    assert race.records == (race.winner,)
    assert set(multiprocessing.active_children()) == before
    assert isinstance(race.result, crow.Plan)
    assert replay_to_goal(hard, race.result.trace).is_sound
    assert processes.room == 2
    (record,) = crow.solve_many([sussman()], executor=processes)
    assert record.status == "plan"


def test_a_race_of_its_own_leaves_no_process(hard: Problem) -> None:
    before = set(multiprocessing.active_children())
    race = crow.race(hard, [ENDLESS[0], GOOD], jobs=2)
    assert race.winner is not None
    assert race.winner.index == 1
    assert set(multiprocessing.active_children()) == before


@pytest.mark.parametrize("order", [0, 1, 2])
def test_a_deterministic_race_has_the_earliest_winner(processes: Processes, order: int) -> None:
    """The slow one, which takes ten times as long, wins when it stands first."""
    slow = Configuration(engine="iddfs", node_limit=1_000_000, name="slow")
    quick = [Configuration(seed=seed, name=f"quick {seed}") for seed in range(5)]
    problem = sussman("on(A, B) and on(B, C)")
    given = [*quick[:order], slow, *quick[order:]]
    race = crow.race(problem, given, executor=processes, deterministic=True)
    assert race.winner is not None
    assert race.winner.configuration == given[0]
    again = crow.race(problem, given, executor="in-process", deterministic=True)
    assert again.winner is not None
    assert again.winner.index == race.winner.index
    assert again.winner.result is not None
    assert race.winner.result is not None
    assert again.winner.result.steps == race.winner.result.steps


def test_a_deterministic_race_waits_only_for_earlier_ones(
    processes: Processes, hard: Problem
) -> None:
    first = Configuration(engine="iddfs", node_limit=2_000)
    race = crow.race(hard, [first, GOOD, *ENDLESS], executor=processes, deterministic=True)
    assert race.winner is not None
    assert race.winner.index == 1
    assert {record.index for record in race.records} == {0, 1}


def test_a_proof_that_there_is_no_plan_wins_too(processes: Processes) -> None:
    race = crow.race(troubled("never"), [GOOD, Configuration()], executor=processes)
    assert race.winner is not None
    assert race.winner.status == "unsolvable"


@pytest.mark.parametrize("how", ["in-process", "processes"])
def test_without_a_winner_all_have_records(how: str, processes: Processes) -> None:
    executor = processes if how == "processes" else "in-process"
    few = Configuration(node_limit=3)
    race = crow.race(sussman(), [few, NARROW, few], executor=executor)
    assert race.winner is None
    assert sorted(record.index for record in race.records) == [0, 1, 2]
    assert race.result is not None
    assert race.result.status == "limit"
    assert isinstance(race.result, crow.LimitReached)
    assert race.result.limits == ("nodes",)


def test_faults_do_not_win(processes: Processes) -> None:
    race = crow.race(troubled("raises"), [GOOD, NARROW], executor=processes)
    assert (race.winner, race.result) == (None, None)
    assert [record.status for record in race.records] == ["fault", "fault"]


def test_one_after_another_in_this_process() -> None:
    race = crow.race(sussman(), [NARROW, GOOD, Configuration()], executor="in-process")
    assert race.winner is not None
    assert race.winner.configuration == GOOD
    assert [record.index for record in race.records] == [0, 1]


def test_a_race_needs_a_configuration() -> None:
    with pytest.raises(ValueError, match="at least one configuration"):
        crow.race(sussman(), [])
