"""The tasks and methods of a program.

An achieve is a task with a method for each behavior whose goal it is, and one that does nothing
where the goal holds already. A behavior that others call is a task of its own.
"""

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from cdlc.backends.hddl.bodies import Body, Task, start_values, used_parameters
from cdlc.backends.hddl.chains import Chain, chain_of
from cdlc.backends.hddl.forms import Form, Literal, condition_of, literals, parameters_of
from cdlc.backends.hddl.networks import Network, Subtask, beside, single
from cdlc.backends.hddl.ways import Block, Rules, ways_of, ways_through
from cdlc.backends.pddl import PddlTask
from cdlc.backends.pddl.actions import Action, Source
from cdlc.backends.pddl.conditions import condition, lowering_of
from cdlc.backends.pddl.names import variable_name
from cdlc.backends.pddl.normal import plain
from cdlc.backends.pddl.sexpr import NEVER, NotPddl, SExpr, words
from cdlc.ir.updates import NotModelled
from crow.conditions import Wanted
from crow.conditions import plain as plain_goal
from crow.problem import World
from crow.program import (
    Achieve,
    Apply,
    Assign,
    Behavior,
    Bind,
    Call,
    Compare,
    Do,
    Expression,
    ForEach,
    ObjectType,
    Parameter,
    Read,
    Statement,
    Type,
    Variable,
)
from crow.program.names import fresh_name
from crow.program.walk import statements_within, subexpressions
from crow.text import expression_text


@dataclass(frozen=True, slots=True)
class Head:
    """How a method starts: its wanted name, its task and parameters.

    `arguments` are those of the task, by their names among the parameters.
    """

    name: str
    task: Task
    arguments: Sequence[str]
    parameters: Sequence[Parameter]
    comment: str


@dataclass(frozen=True, slots=True)
class Method:
    """A method, its precondition in PDDL; `variables` are the PDDL names of its parameters."""

    name: str
    head: Head
    variables: Mapping[str, str]
    precondition: SExpr
    network: Network


class ProgramTasks:
    """The tasks of a program: those of its behaviors' goals, then others as they are asked for."""

    def __init__(self, task: PddlTask, world: World) -> None:
        self.names = task.names
        self.world = world
        self.wanted = Wanted(world)
        self.tasks: list[Task] = []
        self.methods: list[Method] = []
        self.chains: dict[str, Chain] = {}
        self._emitted = task
        self._achieved: dict[Form, list[tuple[Behavior, Literal]]] = {}
        self._forms: dict[Form, Task] = {}
        self._called: dict[str, Task] = {}
        self._checks: dict[object, Task] = {}
        # With the statements they are for, which are told apart by identity.
        self._shared: dict[object, tuple[Task, Statement]] = {}
        self._parts: dict[str, int] = {}
        self._pending: deque[Callable[[], None]] = deque()
        bodies = [s for b in task.program.behaviors for s in (*b.body, *(b.effect or ()))]
        bodies += [s for c in task.program.controllers for s in c.effect or ()]
        self._written = {s.feature for s in statements_within(bodies) if isinstance(s, Assign)}
        self._called_names = {s.behavior for s in statements_within(bodies) if isinstance(s, Call)}
        kept = {f.name for f in task.sections.domain.features}
        gone = [f.name for f in task.program.features if f.name not in kept]
        self._gone = {self.names.get("feature", name): name for name in gone}

    def add_all(self) -> None:
        """Add the tasks of all goals, and of what their behaviors ask for."""
        for behavior in self._emitted.program.behaviors:
            if behavior.goal is not None:
                literal = _goal(plain_goal(behavior.goal))
                self._achieved.setdefault(literal.form, []).append((behavior, literal))
        for form in list(self._achieved):
            self._form(form)
        self.finish()

    def finish(self) -> None:
        """Add the methods of the tasks that were asked for."""
        while self._pending:
            self._pending.popleft()()

    def goal_rules(self) -> Rules:
        """How the goal of a problem is taken apart."""
        return self._rules(checks=False)

    def _rules(self, *, checks: bool) -> Rules:
        return Rules(self.wanted, frozenset(self._achieved), self.is_static, checks)

    # -------------------------------------------------------------------------- what bodies ask

    def is_static(self, condition: Expression) -> bool:
        """Whether nothing ever changes the truth of a condition."""
        return not any(
            isinstance(part, Apply) or (isinstance(part, Read) and part.feature in self._written)
            for part in subexpressions(condition)
        )

    def is_subtype(self, lower: Type, upper: Type) -> bool:
        """Whether every object of the first type is one of the second."""
        return self.world.hierarchy.is_subtype(lower, upper)

    def is_part(self, behavior: str) -> bool:
        """Whether all that a called behavior does is in its caller's action.

        The variables of its binds would be further ones of the action.
        """
        return not any(
            isinstance(s, Achieve | Bind) or (isinstance(s, Call) and not self.is_part(s.behavior))
            for s in statements_within(self.world.behaviors[behavior].body)
        )

    def achieving(self, literal: Expression) -> tuple[Task, tuple[Expression, ...]]:
        """The task of a literal, with the arguments it has."""
        found = next(literals(literal))
        return self._form(found.form), found.arguments

    def running(self, behavior: str) -> Task:
        """The task of a behavior that is called."""
        if behavior not in self._called:
            rule = self.world.behaviors[behavior]
            name = self.names.add("task", f"run'{behavior}", f"run-{behavior}")
            task = self._task(name, rule.parameters, f"what `{behavior}` does")
            self._called[behavior] = task
            head = Head(rule.name, task, _names(rule.parameters), rule.parameters, f"`{behavior}`")
            self._pending.append(lambda: self._behavior(rule, head, ()))
        return self._called[behavior]

    def checking(
        self, owner: Body, parameters: tuple[Parameter, ...], condition: Expression
    ) -> Task:
        """A task that can only be done where a condition over some parameters holds."""
        key = (owner.label, parameters, condition)
        if key not in self._checks:
            task = self._part(owner, parameters, f"needs `{expression_text(condition)}`")
            self._checks[key] = task
            head = Head(task.name, task, _names(parameters), parameters, "where this holds")
            self._add(head, [condition], Network())
        return self._checks[key]

    def choosing(
        self,
        owner: Body,
        parameters: tuple[Parameter, ...],
        node: Statement,
        blocks: Iterable[Block],
    ) -> Task:
        """A task that is done by going through one of some blocks, those of a statement."""
        key = _key(owner, parameters, node)
        if key not in self._shared:
            self._shared[key] = (task := self._part(owner, parameters), node)
            for block in blocks:
                self._through(owner, task, block, {})
        return self._shared[key][0]

    def looping(self, owner: Body, parameters: tuple[Parameter, ...], loop: ForEach) -> Task:
        """A task that is done by going through a block for each object, in any order.

        It goes from the first object of a type to the next: the block of one beside the rest.
        """
        key = _key(owner, parameters, loop)
        if key not in self._shared:
            self._shared[key] = (self._loop(owner, parameters, loop), loop)
        return self._shared[key][0]

    def _loop(self, owner: Body, parameters: tuple[Parameter, ...], loop: ForEach) -> Task:
        variable, *others = loop.variables
        assert isinstance(variable.type, ObjectType)
        block: Block = loop.body
        if others:
            block = (ForEach(tuple(others), loop.body, location=loop.location),)
        own = fresh_name(variable.name, _names(parameters))
        one = Parameter(own, variable.type)
        inside = (*parameters, one)
        whole, rest, each = (self._part(owner, p) for p in (parameters, inside, inside))
        self._chain(variable.type, one, whole, rest, each)
        self._through(owner, each, block, {variable.name: Variable(own, variable.type)})
        return whole

    def _chain(
        self, type_: ObjectType, one: Parameter, whole: Task, rest: Task, each: Task
    ) -> None:
        """The methods of a loop, along the objects of a type."""
        chain = self.chains.setdefault(str(type_), chain_of(type_, self.names))
        inside = rest.parameters
        other = Parameter(fresh_name("next", _names(inside)), one.type)
        here, begun, going_on = (
            _subtask(t, (*whole.parameters, v))
            for t, v in ((each, one), (rest, one), (rest, other))
        )
        self._link(whole, (one,), (chain.first, one), single(begun))
        self._link(whole, (), (chain.empty,), Network())
        both = beside((single(here), single(going_on)))
        self._link(rest, (other,), (chain.next, one, other), both)
        self._link(rest, (), (chain.last, one), single(here))

    def steps(self, behavior: Behavior, node: Do) -> list[tuple[Action, Source]]:
        """The actions of a controller call in a method; none if nothing describes its effect."""
        return [
            (action, source)
            for action, source in self._sources(behavior)
            if source.part.behavior.location == node.location
        ]

    def _sources(self, behavior: Behavior) -> Iterator[tuple[Action, Source]]:
        for action in self._emitted.actions:
            for source in action.sources:
                if source.behavior == behavior.name:
                    yield action, source

    # ------------------------------------------------------------------------------------- tasks

    def _task(self, name: str, parameters: Sequence[Parameter], comment: str) -> Task:
        task = Task(name, tuple(parameters), comment)
        self.tasks.append(task)
        return task

    def _part(
        self, owner: Body, parameters: tuple[Parameter, ...], comment: str | None = None
    ) -> Task:
        """A task for a part of a body."""
        number = self._parts[owner.label] = self._parts.get(owner.label, 0) + 1
        wanted = f"{owner.label}-part-{number}"
        name = self.names.add("task", f"{owner.label}'{number}", wanted)
        return self._task(name, parameters, comment or f"part of `{owner.label}`")

    def _form(self, form: Form) -> Task:
        """The task of a form; its methods follow when the tasks are finished."""
        if form not in self._forms:
            word = "achieve" if form.is_positive else "achieve-not"
            is_feature = form.name in self.world.features
            shown = self.names.get("feature", form.name) if is_feature else form.name
            name = self.names.add("task", f"{word}'{form.name}", f"{word}-{shown}")
            holds = condition_of(form, self.world)
            comment = f"achieve {expression_text(holds)}"
            task = self._task(name, parameters_of(form, self.world), comment)
            self._forms[form] = task
            self._pending.append(lambda: self._form_methods(form, task, holds))
        return self._forms[form]

    def _form_methods(self, form: Form, task: Task, holds: Expression) -> None:
        name = f"{task.name.removeprefix('achieve-')}-holds"
        head = Head(name, task, _names(task.parameters), task.parameters, "nothing to do")
        self._add(head, [holds], Network())
        for behavior, literal in self._achieved.get(form, ()):
            self._for_goal(behavior, literal, task)

    def _for_goal(self, behavior: Behavior, literal: Literal, task: Task) -> None:
        """The methods of a behavior for the task of its goal."""
        own = {p.name: p for p in behavior.parameters}
        first: dict[str, Parameter] = {}
        equal: list[Expression] = []
        for value, wanted in zip(literal.arguments, task.parameters, strict=True):
            if isinstance(value, Variable) and value.name not in first:
                is_wider = self.is_subtype(wanted.type, own[value.name].type)
                first[value.name] = (
                    replace(own[value.name], type=wanted.type) if is_wider else own[value.name]
                )
            else:
                name = fresh_name(wanted.name, {*own, *first})
                first[name] = Parameter(name, wanted.type)
                equal.append(Compare("==", Variable(name, wanted.type), value))
        parameters = [*first.values(), *(p for n, p in own.items() if n not in first)]
        head = Head(behavior.name, task, list(first), parameters, f"`{behavior.name}`")
        if behavior.name in self._called_names:
            run = self.running(behavior.name)
            self._add(head, equal, single(_subtask(run, run.parameters)))
        else:
            self._behavior(behavior, head, equal)

    def _behavior(self, behavior: Behavior, head: Head, equal: Sequence[Expression]) -> None:
        """A method for each way through a behavior's body, and each action it may end with."""
        has_action = behavior.effect is not None
        rules = self._rules(checks=not has_action)
        own = list(self._sources(behavior)) if has_action else []
        for _, source in own:
            if source.part.needs is not None or source.part.gives is not None:
                construct = f"`{behavior.name}`, which achieves something after it has acted,"
                raise NotPddl(construct, behavior.location, _ONE_PHASE)
        names = _names(behavior.parameters)
        for way in ways_of(behavior, rules):
            for last in _ending(way, own, behavior) if has_action else [None]:
                body = Body(
                    self,
                    behavior,
                    behavior.name,
                    list(head.parameters),
                    start_values(p for p in head.parameters if p.name in names),
                    has_action=has_action,
                    conditions=list(equal),
                    known=start_values(behavior.parameters),
                )
                network = body.block(way, has_acted=False, acts_after=False)
                if last is not None:
                    network = network.then(body.action(*last))
                self._add_body(head, body, network)

    def _through(
        self, owner: Body, task: Task, block: Block, more: Mapping[str, Expression]
    ) -> None:
        """A method for each way through a block of a body."""
        # The goal of a problem is demanded in the end, anyway.
        rules = self._rules(checks=owner.behavior is not None)
        names = _names(task.parameters)
        known = {
            n: v for n, v in owner.known.items() if isinstance(v, Variable) and v.name in names
        }
        head = Head(task.name, task, names, task.parameters, f"part of `{owner.label}`")
        location = None if owner.behavior is None else owner.behavior.location
        for way in ways_through(block, rules, location):
            body = Body(
                self,
                owner.behavior,
                owner.label,
                list(task.parameters),
                {**owner.values, **more},
                known={**known, **more},
            )
            network = body.block(way, has_acted=False, acts_after=False)
            self._add_body(head, body, network)

    # ----------------------------------------------------------------------------------- methods

    def _add_body(self, head: Head, body: Body, network: Network) -> None:
        parameters = used_parameters(body, network, head.arguments)
        self._add(replace(head, parameters=parameters), body.conditions, network)

    def _add(self, head: Head, conditions: Iterable[Expression], network: Network) -> None:
        """Add a method, unless its precondition holds in no state."""
        variables = _variables(head.parameters)
        precondition = self._precondition(conditions, head.parameters, variables)
        if precondition != NEVER:
            self._method(head, variables, precondition, network)

    def _link(
        self,
        task: Task,
        others: tuple[Parameter, ...],
        fact: tuple[str | Parameter, ...],
        network: Network,
    ) -> None:
        """Add a method of a loop, for where a fact of its chain holds."""
        parameters = (*task.parameters, *others)
        variables = _variables(parameters)
        precondition = tuple(w if isinstance(w, str) else f"?{variables[w.name]}" for w in fact)
        head = Head(task.name, task, _names(task.parameters), parameters, "one after another")
        self._method(head, variables, precondition, network)

    def _method(
        self, head: Head, variables: Mapping[str, str], precondition: SExpr, network: Network
    ) -> None:
        wanted = f"{head.name}-way" if head.name == head.task.name else head.name
        name = self.names.add("method", f"'{len(self.methods)}", wanted)
        self.methods.append(Method(name, head, variables, precondition, network))

    def _precondition(
        self,
        conditions: Iterable[Expression],
        parameters: Sequence[Parameter],
        variables: Mapping[str, str],
    ) -> SExpr:
        model = self._emitted.sections.model
        try:
            formulas = [plain(model.formula(c, parameters), model.pool) for c in conditions]
        except NotModelled as refused:
            raise NotPddl(refused.construct, refused.location) from None
        written = {name: f"?{variable}" for name, variable in variables.items()}
        lowering = lowering_of(model, self.names, written)
        formula = condition(model.pool.conjunction(formulas), lowering)
        gone = next((self._gone[word] for word in words(formula) if word in self._gone), None)
        if gone is not None:
            raise NotPddl(f"`{gone}`, a number,", self.world.features[gone].location)
        return formula


_ONE_PHASE = "move the `achieve` before the first `do`, or what follows to another behavior"


def _ending(
    way: Block, own: Sequence[tuple[Action, Source]], behavior: Behavior
) -> list[tuple[Action, Source]]:
    """The actions that a way through a body may end with: those of the same controller calls."""
    calls = _calls(way)
    every = _calls(behavior.body)
    return [last for last in own if _calls(last[1].part.behavior.body) & every == calls]


def _calls(statements: Block) -> set[object]:
    """Where the controller calls of some statements stand."""
    return {s.location for s in statements_within(statements) if isinstance(s, Do)}


def _goal(goal: Expression) -> Literal:
    found = next(literals(goal), None)
    if found is None:
        raise NotPddl(f"the goal `{expression_text(goal)}`", goal.location)
    return found


def _key(owner: Body, parameters: tuple[Parameter, ...], node: Statement) -> object:
    """What the tasks for a statement, which stands in several ways through a body, share."""
    return (owner.label, parameters, id(node), tuple(owner.values.items()))


def _names(parameters: Iterable[Parameter]) -> list[str]:
    return [p.name for p in parameters]


def _variables(parameters: Iterable[Parameter]) -> dict[str, str]:
    """The PDDL names of parameters."""
    chosen: dict[str, str] = {}
    for parameter in parameters:
        chosen[parameter.name] = variable_name(parameter.name, chosen.values())
    return chosen


def _subtask(task: Task, arguments: Iterable[Parameter]) -> Subtask:
    return Subtask(task.name, tuple(Variable(p.name, p.type) for p in arguments))
