"""Aries, which plans with HDDL, in a process of its own: it starts a server and leaves warnings."""

import json
import subprocess
import sys
from collections.abc import Mapping, Sequence

Steps = list[tuple[str, tuple[str, ...]]]

SCRIPT = """
import json, sys
from unified_planning.environment import get_environment
from unified_planning.io import PDDLReader

def steps_of(plan):
    # A plan without steps comes as one in time.
    actions = getattr(plan, "actions", ())
    return [[a.action.name, *map(str, a.actual_parameters)] for a in actions]

factory = get_environment().factory
get_environment().credits_stream = None
answers = {}
for name, (domain, problem) in json.load(sys.stdin).items():
    task = PDDLReader().parse_problem_string(domain, problem)
    try:
        with factory.OneshotPlanner(name="aries") as planner:
            result = planner.solve(task, timeout=float(sys.argv[1]))
    except Exception as error:  # its server is gone
        answers[name] = [f"CRASHED: {type(error).__name__}", None]
        continue
    plan = None if result.plan is None else steps_of(result.plan.action_plan)
    answers[name] = [result.status.name, plan]
print(json.dumps(answers))
"""


def answers_of(
    tasks: Mapping[str, tuple[str, str]], seconds: float = 100
) -> dict[str, tuple[str, Steps | None]]:
    """For each task, by its name, what the planner says of it, and the steps of a plan.

    `seconds` is the time limit of one task.
    """
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", SCRIPT, str(seconds)],
        input=json.dumps(tasks),
        capture_output=True,
        text=True,
        timeout=500,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    return {name: (status, _steps(plan)) for name, (status, plan) in found.items()}


def _steps(plan: Sequence[Sequence[str]] | None) -> Steps | None:
    return None if plan is None else [(name, tuple(objects)) for name, *objects in plan]
