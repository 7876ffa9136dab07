"""Every message of the backends. The docstring of a kind is its page."""

from dataclasses import dataclass

from cdlc.diagnostics import Diagnostic


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class NoInitialValue(Diagnostic):
    """An `init` that cannot be computed: an unset value is read, or a number does not fit.

        init:
          size[A] = size[B] / count

    Numbers are 0 and truth values False until they are set; all other values have to be set first.
    """

    reason: str

    def message(self) -> str:
        return f"the initial state cannot be computed: {self.reason}"


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class NotInPddl(Diagnostic):
    """Something that PDDL, or this version's PDDL, has no form for.

        feature position(x: Object) -> Pose

    Boolean features over objects become predicates. Continuous values, Python functions and
    features of other types stay with the runtime, which plans with the CDL program itself.
    """

    construct: str

    def message(self) -> str:
        return f"{self.construct} has no PDDL in this version"

    def notes(self) -> tuple[str, ...]:
        return ("PDDL is emitted for Boolean features of objects",)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class NotPlannable(Diagnostic):
    """Something that needs a value chosen or computed, where the planner chooses objects.

        bind t: Trajectory where: clear_of(o, t)

    Numbers may be features, and parameters that a goal gives a value. A `bind` of a value, a value
    parameter that the goal does not mention, and functions in Python need a solver of constraints.
    """

    construct: str

    def message(self) -> str:
        return f"planning does not cover {self.construct} in this version"

    def notes(self) -> tuple[str, ...]:
        return ("the planner chooses among objects; it does not compute or sample values yet",)
