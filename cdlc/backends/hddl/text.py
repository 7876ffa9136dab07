"""Tasks, methods and networks as text."""

from collections.abc import Iterator, Mapping

from cdlc.backends.hddl.bodies import Task
from cdlc.backends.hddl.methods import Method
from cdlc.backends.hddl.networks import Network
from cdlc.backends.pddl.conditions import typed
from cdlc.backends.pddl.domain import clauses
from cdlc.backends.pddl.names import Names, variable_name
from cdlc.backends.pddl.sexpr import ALWAYS, SExpr, conjuncts, printed
from crow.program import Expression, Object, Parameter, Type, Variable


def task_text(task: Task, names: Names) -> str:
    """The declaration of a task."""
    chosen: list[str] = []
    for parameter in task.parameters:
        chosen.append(variable_name(parameter.name, chosen))
    types = [p.type for p in task.parameters]
    listed = printed(typed([(f"?{n}", t) for n, t in zip(chosen, types, strict=True)], names))
    return f"(:task {task.name}  ; {task.comment}\n  :parameters {listed})"


def method_text(method: Method, names: Names) -> str:
    """A method; without subtasks it says nothing of any."""
    written = {name: f"?{variable}" for name, variable in method.variables.items()}
    declared: list[tuple[str, Type]] = [(written[p.name], p.type) for p in method.head.parameters]
    arguments = (written[name] for name in method.head.arguments)
    lines = [
        f"(:method {method.name}  ; {method.head.comment}",
        f"  :parameters {printed(typed(declared, names))}",
        f"  :task {printed((method.head.task.name, *arguments))}",
    ]
    if method.precondition != ALWAYS:
        lines.append(f"  :precondition {clauses(conjuncts(method.precondition))}")
    lines += _network(method.network, written, names)
    return "\n".join(lines) + ")"


def problem_network(network: Network, written: Mapping[str, str], names: Names) -> str:
    """The `:htn` section of a problem; `written` are the objects behind variables."""
    chosen = dict(written)
    extra: list[Parameter] = []
    for subtask in network.subtasks:
        for argument in subtask.arguments:
            if isinstance(argument, Variable) and argument.name not in chosen:
                taken = [name.removeprefix("?") for name in chosen.values()]
                chosen[argument.name] = f"?{variable_name(argument.name, taken)}"
                extra.append(Parameter(argument.name, argument.type))
    listed = printed(typed([(chosen[p.name], p.type) for p in extra], names))
    lines = ["(:htn", f"  :parameters {listed}", *_network(network, chosen, names)]
    return "\n".join(lines) + ")"


def _network(network: Network, written: Mapping[str, str], names: Names) -> Iterator[str]:
    subtasks: list[SExpr] = [
        (s.name, *(_argument(a, written, names) for a in s.arguments)) for s in network.subtasks
    ]
    if not subtasks:
        return
    if network.is_sequence:
        yield f"  :ordered-subtasks {clauses(tuple(subtasks))}"
        return
    labelled = [(f"t{number}", subtask) for number, subtask in enumerate(subtasks, 1)]
    yield f"  :subtasks {clauses(tuple(labelled))}"
    order = [("<", f"t{i + 1}", f"t{j + 1}") for i, j in sorted(network.order)]
    if order:
        yield f"  :ordering {clauses(tuple(order))}"


def _argument(value: Expression, written: Mapping[str, str], names: Names) -> str:
    match value:
        case Variable(name=name):
            return written[name]
        case Object(name=name):
            return names.get("object", name)
        case _:
            raise AssertionError(f"{type(value).__name__} as an argument of a task")
