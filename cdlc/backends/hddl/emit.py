"""HDDL of a program and a problem, or diagnostics for what has none."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from cdlc.backends.hddl.bodies import Body, start_values
from cdlc.backends.hddl.fit import refused, report_unfit
from cdlc.backends.hddl.methods import ProgramTasks
from cdlc.backends.hddl.networks import Network
from cdlc.backends.hddl.text import method_text, problem_network, task_text
from cdlc.backends.hddl.ways import ways_through
from cdlc.backends.pddl import PddlTask
from cdlc.backends.pddl.domain import Domain, domain_text
from cdlc.backends.pddl.problems import problem_text
from cdlc.backends.pddl.sexpr import NotPddl, SExpr
from cdlc.diagnostics import Collector
from crow.conditions import Wanted
from crow.matching import instances
from crow.problem import Problem, World
from crow.program import Achieve, And, Expression, Object, Or, Parameter, Quantified, Variable
from crow.program.rewrite import rewrite, substitute


@dataclass(frozen=True)
class HddlTask:
    """The HDDL of a program, and of a problem if there is one; its actions are those of `pddl`."""

    pddl: PddlTask
    domain: str
    problem: str | None


def to_hddl(task: PddlTask, problem: Problem | None, found: Collector) -> HddlTask | None:
    """Add tasks and methods to an emitted program. None, with diagnostics, where HDDL has none."""
    before = found.errors
    report_unfit(task, found)
    if found.errors > before:
        return None
    try:
        return _task(task, problem)
    except RecursionError:
        found.add(refused("a program nested this deeply", None))
        return None
    except NotPddl as no_form:
        found.add(refused(no_form.construct, no_form.location, no_form.cure))
        return None


def _task(task: PddlTask, problem: Problem | None) -> HddlTask:
    world = World.of(task.program) if problem is None else problem.world
    tasks = ProgramTasks(task, world)
    tasks.add_all()
    goal = None if problem is None else _goal(problem, tasks)
    tasks.finish()
    domain = _with_tasks(task.sections.domain, tasks)
    text = task.sections.heading + domain_text(domain)
    if problem is None or goal is None or task.sections.goal is None:
        return HddlTask(task, text, None)
    objects = {_stand_in(n): task.names.get("object", n) for n in world.objects}
    stated = task.sections.problem_heading + problem_text(
        problem,
        task.sections.goal,
        domain,
        task.sections.metric,
        _chained(tasks, world),
        problem_network(goal, objects, task.names),
    )
    return HddlTask(task, text, stated)


def _with_tasks(domain: Domain, tasks: ProgramTasks) -> Domain:
    """A domain with tasks, then the methods of each."""
    names = domain.names
    texts = [task_text(task, names) for task in tasks.tasks]
    for task in tasks.tasks:
        texts += [method_text(m, names) for m in tasks.methods if m.head.task is task]
    chained = tuple(p for chain in tasks.chains.values() for p in chain.predicates(names))
    conditions = (*domain.conditions, *(m.precondition for m in tasks.methods))
    return replace(domain, tasks=tuple(texts), predicates=chained, conditions=conditions)


def _chained(tasks: ProgramTasks, world: World) -> Iterator[SExpr]:
    for chain in tasks.chains.values():
        yield from chain.facts(world, tasks.names)


# ------------------------------------------------------------------------------- goals of problems


def _goal(problem: Problem, tasks: ProgramTasks) -> Network:
    """The network of a problem's goal: a task for each of its conjuncts, in no order.

    Methods cannot name objects of the problem, so these are variables until the end.
    """
    grounded = _grounded(tasks.wanted.normal(problem.goal), tasks.wanted, problem.world)
    goal = Achieve(rewrite(grounded, _without_object), location=problem.goal.location)
    parameters = [Parameter(_stand_in(n), t) for n, t in problem.world.objects.items()]
    body = Body(tasks, None, "goal", parameters, start_values(parameters), has_start=False)
    ways = ways_through((goal,), tasks.goal_rules(), problem.goal.location)
    if len(ways) == 1:
        return body.block(ways[0], has_acted=True, acts_after=True)
    return body.choice(goal, ((goal,),))


def _grounded(condition: Expression, wanted: Wanted, world: World) -> Expression:
    """A condition in normal form, what has to hold for all objects written out."""
    match condition:
        case And(operands=operands) | Or(operands=operands):
            return replace(condition, operands=tuple(_grounded(o, wanted, world) for o in operands))
        case Quantified(quantifier="forall", body=body):
            parts = tuple(
                _grounded(substitute(body, _objects(chosen, world)), wanted, world)
                for chosen in instances(world, condition)
            )
            return And(parts, location=condition.location)
        case _:
            return condition


def _objects(chosen: Mapping[str, object], world: World) -> dict[str, Expression]:
    return {name: Object(str(o), world.objects[str(o)]) for name, o in chosen.items()}


def _without_object(node: Expression) -> Expression:
    if isinstance(node, Object):
        return Variable(_stand_in(node.name), node.type, location=node.location)
    return node


def _stand_in(name: str) -> str:
    """The variable of an object, which no name of CDL can be."""
    return f"'{name}"
