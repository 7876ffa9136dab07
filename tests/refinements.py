"""What is true of every refinement tree of a plan, whichever engine made it."""

from bisect import bisect

from crow.plan import call_text
from crow.problem import Problem
from crow.program import Not, Read
from crow.refinement import Kind, Node, Refinement, instance_text
from crow.results import Plan
from crow.trace import DoItem, EffItem, Trace


def check_tree(problem: Problem, plan: Plan, tree: Refinement) -> None:
    """Each item and step once, each under its behavior, each subgoal in the body that has it."""
    assert tree.trace == plan.trace
    nodes = tree.nodes
    assert nodes[0].kind is Kind.GOAL
    assert all(node.is_done for node in nodes)
    for index, node in enumerate(nodes[1:], 1):
        assert 0 <= node.above < index
        assert node.level == nodes[node.above].level + 1
    assert sorted(n.item for n in nodes if n.item is not None) == _own_places(problem, plan.trace)
    assert sorted(n.step for n in nodes if n.step is not None) == list(range(len(plan.steps)))
    for node in nodes:
        _check_step(plan, nodes, node)
        _check_place(problem, nodes, node)
        _check_goal(problem, node)
    _check_effects(nodes)


def _own_places(problem: Problem, trace: Trace) -> list[int]:
    """Every place in a trace, but for the effects of controllers: they belong to their calls."""
    behaviors = problem.world.behaviors
    after_call = {i + 1 for i, item in enumerate(trace) if isinstance(item, DoItem)}
    return [
        i
        for i, item in enumerate(trace)
        if not (isinstance(item, EffItem) and item.owner not in behaviors and i in after_call)
    ]


def _check_step(plan: Plan, nodes: tuple[Node, ...], node: Node) -> None:
    if node.step is None:
        return
    step = plan.steps[node.step]
    by = call_text(step.behavior, step.behavior_arguments, step.bindings)
    assert nodes[node.above].by == by
    if step.controller is not None:
        assert node.text == call_text(step.controller, step.arguments, {})


def _check_place(problem: Problem, nodes: tuple[Node, ...], node: Node) -> None:
    """A place within the text of a behavior is within that of the behavior above."""
    program = problem.world.program
    others = (*program.functions, *program.features, *program.controllers)
    starts = sorted(
        (d.location.line, d.name if d in program.behaviors else "")
        for d in (*program.behaviors, *others)
        if d.location is not None
    )
    files = {b.location.file for b in program.behaviors if b.location is not None}
    if node.location is None or node.location.file not in files or node.above <= 0:
        return
    found = starts[bisect(starts, (node.location.line, "\uffff")) - 1][1]
    if found:
        assert found == nodes[node.above].by.split("(")[0], node


def _check_goal(problem: Problem, node: Node) -> None:
    """A subgoal is the goal of the behavior that refined it, where it is a literal."""
    if node.kind is not Kind.ACHIEVE or not node.by:
        return
    name, arguments = node.by.removesuffix(")").split("(", 1)
    behavior = problem.world.behaviors[name]
    values = dict(zip((p.name for p in behavior.parameters), arguments.split(", "), strict=False))
    match behavior.goal:
        case Read() | Not(operand=Read()) as goal if goal.location is not None:
            assert instance_text(goal, values) == node.text
        case _:
            pass


def _check_effects(nodes: tuple[Node, ...]) -> None:
    """The effect of a behavior comes after all that is below the behavior."""
    last: dict[int, int] = {}
    for node in reversed(nodes):
        if node.item is not None:
            above = node.above
            while above >= 0:
                last[above] = max(last.get(above, -1), node.item)
                above = nodes[above].above
    for node in nodes:
        if node.kind is Kind.EFFECT:
            assert last[node.above] == node.item
