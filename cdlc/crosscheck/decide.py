"""Two answers to one outcome.

A plan that the other side does not take is a mismatch, whatever else there is. So is a proof by the
planner that there is no plan where the program has one, because every plan of the program is one of
its PDDL. The other way round is not: a program plans with its own rules only, and may have none
where the PDDL, which knows nothing of them, has one.
"""

from cdlc.crosscheck.results import Outcome, Side


def decide(planner: Side, program: Side) -> tuple[Outcome, str]:
    """The outcome of two answers, and why; a plan outside the plan space is so by the runtime."""
    faults = [side.fault for side in (planner, program) if side.fault]
    if faults:
        return Outcome.MISMATCH, "; ".join(faults)
    match planner.status, program.status:
        case "unsolvable", "unsolvable":
            return Outcome.AGREE_NONE, ""
        case "unsolvable", "plan":
            engine = planner.result.engine
            return Outcome.MISMATCH, f"{engine} proves that there is no plan, the program has one"
        case "plan", "plan" if program.unchecked:
            return Outcome.INCONCLUSIVE, program.unchecked
        case "plan", "plan":
            return Outcome.AGREE_PLAN, ""
        case "plan", "unsolvable":
            return Outcome.OUTSIDE, "the planner finds a plan outside the program's plan space"
        case _:
            return Outcome.INCONCLUSIVE, "; ".join(s.stop for s in (planner, program) if s.stop)
