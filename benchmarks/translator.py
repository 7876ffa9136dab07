"""How large Fast Downward's translator grounds a PDDL task: the size that its search works on."""

import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True, slots=True)
class TaskSize:
    """A grounded task: values of its variables, operators, and rules for derived predicates."""

    facts: int
    operators: int
    axioms: int


class TranslatorError(Exception):
    """The translator refused the task; the message is the end of what it printed."""


def task_size(domain: str, problem: str) -> TaskSize:
    """The size that the task of two PDDL texts is grounded to. Raises TranslatorError."""
    with tempfile.TemporaryDirectory(prefix="translator-") as name:
        folder = Path(name)
        (folder / "domain.pddl").write_text(domain, "utf-8")
        (folder / "problem.pddl").write_text(problem, "utf-8")
        done = subprocess.run(
            [sys.executable, "-P", "-m", "fast_downward.translate", "domain.pddl", "problem.pddl"],
            cwd=folder,
            capture_output=True,
            text=True,
            check=False,
        )
    if done.returncode != 0:
        raise TranslatorError((done.stdout + done.stderr)[-2000:])
    printed = re.findall(r"^Translator (facts|operators|axioms): (\d+)$", done.stdout, re.MULTILINE)
    counts = dict(printed)
    return TaskSize(*(int(counts[name]) for name in ("facts", "operators", "axioms")))
