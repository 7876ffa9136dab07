"""Tasks that unified-planning's reader does not take, those with derived predicates, solved as they
are: by Fast Downward and by Kairos. Kairos' validator, where installed, checks the plan.
"""

import subprocess
import sys
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

Answer = dict[str, Any]

# Exit codes of Fast Downward.
_FOUND = range(4)
_OUTCOMES = {10: "unsolvable", 11: "unsolvable", 12: "limit", 13: "limit", 21: "timeout",
             23: "timeout", 20: "memory", 22: "memory", 24: "memory"}  # fmt: skip
_LACKING: Answer = {"outcome": "unsupported", "features": ["DERIVED_PREDICATES"]}


def needs_direct(domain: str) -> bool:
    """Whether unified-planning cannot read a domain."""
    return "(:derived" in domain


def lacks_directly(engine: str, domain: str) -> list[str]:
    """What an engine lacks for such a domain, by unified-planning's names where it has any."""
    if engine == "kairos":
        return []
    if not engine.startswith("fast-downward"):
        return ["DERIVED_PREDICATES"]
    return ["REAL_FLUENTS"] if ":numeric-fluents" in domain else []


def solve_directly(request: dict[str, Any], planner_class: Any) -> Answer:
    """Solve a task in the current directory, which is the run's own."""
    for name in ("domain", "problem"):
        Path(f"{name}.pddl").write_text(request[name], "utf-8")
    if request["engine"].startswith("fast-downward"):
        found = _fast_downward(planner_class)
    elif request["engine"] == "kairos":
        found = _kairos(request)
    else:
        return _LACKING
    return found if found["outcome"] != "plan" else _validated(request, found)


def _fast_downward(planner_class: Any) -> Answer:
    command = planner_class()._get_cmd("domain.pddl", "problem.pddl", "plan")  # noqa: SLF001
    done = subprocess.run(  # noqa: S603 - the command of the installed engine
        command, stdout=sys.stdout, stderr=sys.stderr, check=False
    )
    if done.returncode in _FOUND:
        lines = Path("plan").read_text("utf-8").splitlines()
        steps = [line.strip("()\n ").split() for line in lines if not line.startswith(";")]
        return {"outcome": "plan", "steps": steps}
    if done.returncode in _OUTCOMES:
        return {"outcome": _OUTCOMES[done.returncode]}
    return {"outcome": "failed", "reason": f"it ended with status {done.returncode}"}


def _kairos(request: dict[str, Any]) -> Answer:
    kairos = import_module("kairos")
    domain = kairos.parse_domain(request["domain"], "domain.pddl")
    options = kairos.SearchOptions()
    options.anytime, options.timeout = False, 1e6
    task = kairos.parse_problem(request["problem"], domain, "problem.pddl")
    result = kairos.Planner().solve(task, options)
    if result.plan is not None:
        steps = [[step.name, *step.args] for step in result.plan.steps]
        return {"outcome": "plan", "steps": steps}
    outcomes = {"UNSOLVABLE": "unsolvable", "NO_PLAN_FOUND": "limit", "TIMEOUT": "timeout",
                "OUT_OF_MEMORY": "memory", "GROUNDING_TOO_LARGE": "memory"}  # fmt: skip
    name = result.status.name
    if name in outcomes:
        return {"outcome": outcomes[name]}
    return {"outcome": "failed", "reason": f"it reports {name}"}


def _validated(request: dict[str, Any], found: Answer) -> Answer:
    verdict = validated_directly(request["domain"], request["problem"], found["steps"])
    if verdict["outcome"] != "invalid":
        return found
    reason = f"it returned an invalid plan: {verdict['reason']}"
    return {"outcome": "failed", "reason": reason, "steps": found["steps"]}


def validated_directly(domain: str, problem: str, steps: list[list[str]]) -> Answer:
    """What Kairos' validator says of a plan; unsupported where it is not installed."""
    if find_spec("kairos") is None:
        return _LACKING
    kairos = import_module("kairos")
    plan = kairos.parse_plan("".join(f"({' '.join(step)})\n" for step in steps))
    report = kairos.validate_plan(domain, problem, plan)
    if report.status == kairos.ValidationStatus.VALID:
        return {"outcome": "valid", "by": "kairos"}
    said = " ".join(map(str, report.diagnostics))
    return {"outcome": "invalid", "by": "kairos", "reason": said}
