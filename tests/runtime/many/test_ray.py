"""Ray as an executor: a cluster of two nodes, each with processes of its own on this machine."""

import json
import os
import time
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest
from hard_problems import towers
from many_tasks import suite, sussman, written
from support import BLOCKS, ROOT
from support import cdlc as run
from troubles import troubled

import cdlc
import crow
from crow.many.cluster import Ray, RayMissing
from crow.many.records import comparable
from crow.many.tasks import Configuration

pytestmark = [
    pytest.mark.skipif(find_spec("ray") is None, reason="Ray is not installed (extra `ray`)"),
    # Ray's own: it leaves files and sockets to the collector.
    pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::DeprecationWarning"),
    pytest.mark.filterwarnings(
        "ignore::FutureWarning", "ignore::pytest.PytestUnraisableExceptionWarning"
    ),
]


@pytest.fixture(scope="module")
def cluster() -> Iterator[Any]:
    """Two nodes with a core each, which find the tests' modules, as a user's find the user's."""
    from ray.cluster_utils import Cluster

    paths = [ROOT, ROOT / "runtime", ROOT / "tests"]
    before = dict(os.environ)
    os.environ["PYTHONPATH"] = os.pathsep.join(map(str, paths))
    own = {"num_cpus": 1, "object_store_memory": 80 << 20}
    made = Cluster(initialize_head=True, head_node_args={**own, "include_dashboard": False})
    made.add_node(**own)
    try:
        yield made
    finally:
        made.shutdown()
        os.environ.clear()
        os.environ.update(before)


@pytest.fixture(scope="module")
def ray(cluster: Any) -> Iterator[Ray]:
    with Ray(cluster.address, grace=0.5) as executor:
        yield executor


def test_a_cluster_gives_what_this_process_gives(ray: Ray, cluster: Any) -> None:
    tasks = suite()
    assert written(crow.solve_many(tasks, executor=ray)) == written(crow.solve_many(tasks))
    assert len(cluster.list_all_nodes()) == 2


def test_the_command_line_uses_a_cluster(ray: Ray, cluster: Any, tmp_path: Path) -> None:
    suite = (str(BLOCKS), "--node-limit", "200", "--seeds", "2")
    ran = run("bench", *suite, "--ray", cluster.address, "--out", tmp_path / "cluster.jsonl")
    assert (ran.status, ran.out) == (0, ""), ran
    assert run("bench", *suite, "--out", tmp_path / "here.jsonl").status == 0
    found = [
        sorted(
            json.dumps(comparable(json.loads(line)), sort_keys=True)
            for line in (tmp_path / f"{name}.jsonl").read_text().splitlines()
        )
        for name in ("cluster", "here")
    ]
    assert found[0] == found[1]
    assert len(found[0]) == 9


def test_every_problem_has_one_record_on_a_cluster_too(ray: Ray) -> None:
    names = {"raises": "function", "insists": "hung", "dies": "killed", "sleeps": "timeout"}
    problems = [troubled(n) for name in names for n in (name, f"none_{name}")]
    records = list(crow.solve_many(problems, Configuration(time_limit=1.5), executor=ray))
    assert sorted(record.index for record in records) == list(range(len(problems)))
    found = {r.problem: r.status if r.fault is None else r.fault.kind for r in records}
    assert found == names | {f"none_{name}": "plan" for name in names}
    (killed,) = (r.fault for r in records if r.problem == "dies")
    assert killed is not None
    assert killed.message == "its process was killed by SIGKILL"


def test_a_node_that_lacks_a_module_says_so(ray: Ray, tmp_path: Path) -> None:
    file = tmp_path / "of_the_driver.py"
    file.write_text("def trouble(x):\n    return 1\n")
    problem = troubled("none", str(file))
    file.unlink()
    (record,) = crow.solve_many([problem], executor=ray)
    assert record.fault is not None
    assert record.fault.kind == "not-loaded"
    assert "of_the_driver.py" in record.fault.message


def test_losers_of_a_race_are_cancelled(ray: Ray, tmp_path: Path) -> None:
    hard = cdlc.load_problem(towers(tmp_path, 12))
    endless, good = Configuration(engine="iddfs"), Configuration(engine="best")
    start = time.monotonic()
    race = crow.race(hard, [endless, good, endless], executor=ray)
    assert race.winner is not None
    assert race.winner.index == 1
    (record,) = crow.solve_many([sussman()], executor=ray)  # there is a core for it
    assert record.status == "plan"
    assert time.monotonic() - start < 30


def test_a_process_of_ray_that_dies_is_a_fault(ray: Ray) -> None:
    problems = [troubled(name) for name in ("none_a", "orphans", "none_b", "none_c")]
    records = list(crow.solve_many(problems, Configuration(time_limit=10), executor=ray))
    assert sorted(record.index for record in records) == [0, 1, 2, 3]
    (fault,) = (record.fault for record in records if record.fault is not None)
    assert fault.kind == "killed"
    assert "WorkerCrashedError" in fault.message


def test_without_ray_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    import sys

    monkeypatch.setitem(sys.modules, "ray", None)
    with pytest.raises(RayMissing, match=r'pip install "cdlc\[ray\]"'):
        Ray()
