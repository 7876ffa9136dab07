"""How large the emitted PDDL grounds, beside domains that a person wrote for the same problems."""

import re
from pathlib import Path

import cdlc
from benchmarks.table import Table
from benchmarks.translator import task_size

_ROOT = Path(__file__).resolve().parent.parent
_HANDWRITTEN = Path(__file__).parent / "handwritten"
# Each example domain with its problems and the domain that a person wrote.
_DOMAINS = {
    "blocks/blocks": (("sussman", "reverse5", "towers12"), "blocks"),
    "blocks/blocks_strips": (("sussman", "reverse5", "towers12"), "blocks"),
    "tutorial/rooms": (("swap",), "rooms"),
    "gripper/gripper": (("four",), "gripper"),
    "logistics/logistics": (("parcel",), "logistics"),
    "briefcase/briefcase": (("payday",), "briefcase"),
    "cupboard/cupboard": (("dishes",), "cupboard"),
}


def run(quick: bool) -> Table:
    """Facts and operators after Fast Downward's translator, ours and the person's."""
    rows = []
    for domain, (problems, handwritten) in _DOMAINS.items():
        person = (_HANDWRITTEN / f"{handwritten}.pddl").read_text("utf-8")
        chosen = problems[:1] if quick else problems
        rows += [_row(domain, problem, person) for problem in chosen]
    columns = ("domain", "problem", "facts", "operators", "facts by hand", "operators by hand")
    return Table("size", columns, tuple(rows), "target: equal")


def _row(domain: str, problem: str, person: str) -> tuple[str | int, ...]:
    file = _ROOT / "examples" / f"{domain}.cdl"
    task = cdlc.compile(file, file.parent / f"{problem}.cdl").pddl()
    assert task.problem is not None
    ours = task_size(task.domain, task.problem)
    name = re.search(r"\(define \(domain ([^)]+)\)", person)
    assert name is not None
    renamed = re.sub(r"\(:domain [^)]+\)", f"(:domain {name[1]})", task.problem)
    theirs = task_size(person, renamed)
    counts = (ours.facts, ours.operators, theirs.facts, theirs.operators)
    return (domain, problem, *counts)
