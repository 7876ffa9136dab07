"""Verifying programs given as text, and what is said about each behavior."""

from textwrap import dedent

from programs import program_of

from cdlc.verify.results import Check, Report
from cdlc.verify.run import verify

# Seconds for a check; what is decided takes a small part of it.
LIMIT = 20.0


def report(text: str, limit: float = LIMIT) -> Report:
    """The report on a domain without mistakes."""
    return verify("domain.cdl", program_of(dedent(text)), limit)


def check(text: str, name: str, behavior: str = "act", limit: float = LIMIT) -> Check:
    """One check of one behavior."""
    (verified,) = [v for v in report(text, limit).behaviors if v.behavior == behavior]
    (found,) = [c for c in verified.checks if c.name == name]
    return found


def verdict(text: str, name: str = "goal", behavior: str = "act", limit: float = LIMIT) -> str:
    """The verdict of one check."""
    return str(check(text, name, behavior, limit).verdict)
