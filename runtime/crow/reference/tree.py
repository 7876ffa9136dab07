"""A refinement that REFINE found as a tree: each item of its trace names its application."""

from crow.plan import call_text
from crow.problem import Problem
from crow.reference.programs import Application, Apply, Want, environment
from crow.reference.refine import BOUND, Result
from crow.refinement import Draft, Kind, Refinement, finished, instance_text
from crow.text import expression_text
from crow.trace import AssertItem, DoItem, EffItem, TraceItem


def tree_of(problem: Problem, result: Result) -> Refinement:
    """The tree of a refinement of a problem's goal."""
    tree = _Tree(problem, result)
    return Refinement(finished(tree.root), tuple(item for item, _ in result[2]))


class _Tree:
    def __init__(self, problem: Problem, result: Result) -> None:
        _, self.values, trace = result
        self.root = Draft(Kind.GOAL, expression_text(problem.goal), problem.goal.location)
        self.drafts: dict[Application, Draft] = {}
        self.callers = {owner for item, owner in trace if isinstance(item, DoItem)}
        self.steps = 0
        for place, (item, owner) in enumerate(trace):
            self._add(place, item, owner)

    def _add(self, place: int, item: TraceItem, owner: Application) -> None:
        leaf = self._leaf(item, owner)
        if leaf is not None:
            leaf.item = place
            self._of(owner).below.append(leaf)

    def _leaf(self, item: TraceItem, owner: Application) -> Draft | None:
        """The node of an item; none for a controller's own effect, which belongs to the `do`."""
        match item:
            case DoItem(controller=name, arguments=arguments):
                text = call_text(name, arguments, {})
                return Draft(Kind.DO, text, item.location, step=self._step())
            case EffItem(owner=name):
                if owner.behavior is None or name != owner.behavior.name:
                    return None
                step = None if owner in self.callers else self._step()
                return Draft(Kind.EFFECT, "effect", item.location, step=step)
            case AssertItem(condition=condition, variables=variables):
                text = instance_text(condition, variables)
                return Draft(Kind.ASSERT, text, item.location)

    def _step(self) -> int:
        self.steps += 1
        return self.steps - 1

    def _of(self, application: Application) -> Draft:
        """The node of an application; it and those above it are made when first needed."""
        missing = []
        while application.cause is not None and application not in self.drafts:
            missing.append(application)
            application = application.cause.frame.application
        draft = self.drafts.get(application, self.root)
        for one in reversed(missing):
            assert one.cause is not None
            below = self._applied(one, one.cause)
            draft.below.append(below)
            draft = self.drafts[one] = below
        return draft

    def _applied(self, application: Application, cause: Apply) -> Draft:
        bound = dict(self.values.get((application, BOUND), {}))
        by = call_text(cause.behavior.name, cause.arguments, bound)
        where = cause.behavior.location
        match cause.cause:
            case Want() if cause.is_step:
                return Draft(Kind.STEP, by, None, by, where)
            case Want(condition=condition, frame=frame, location=location):
                text = instance_text(condition, environment(self.values, frame))
                return Draft(Kind.ACHIEVE, text, location, by, where)
            case call:
                return Draft(Kind.CALL, by, call.location, by, where)
