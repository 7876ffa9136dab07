"""The tasks and methods of a program.

An achieve is a task with a method for each behavior whose goal it is, and one that does nothing
where the goal holds already. A behavior that others call is a task of its own.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from cdlc.backends.hddl.bodies import Body, Task, start_values, used_parameters
from cdlc.backends.hddl.chains import Chain, chain_of
from cdlc.backends.hddl.forms import Form, Literal, condition_of, literals, parameters_of
from cdlc.backends.hddl.networks import Network, Subtask, single
from cdlc.backends.hddl.ways import Block, Rules, ways_of, ways_through
from cdlc.backends.pddl import PddlTask
from cdlc.backends.pddl.actions import Action, Source
from cdlc.backends.pddl.conditions import Lowering, condition
from cdlc.backends.pddl.names import variable_name
from cdlc.backends.pddl.normal import plain
from cdlc.backends.pddl.sexpr import ALWAYS, NEVER, NotPddl, SExpr
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
    Type,
    Variable,
)
from crow.program.names import fresh_name
from crow.program.walk import statements_within, subexpressions
from crow.text import expression_text


@dataclass(frozen=True, slots=True)
class Method:
    """A method of a task, its precondition in PDDL; `variables` are the names of its parameters.

    `arguments` are those of the task, parameters of the method.
    """

    name: str
    task: Task
    arguments: tuple[str, ...]
    parameters: tuple[Parameter, ...]
    variables: dict[str, str]
    precondition: SExpr
    network: Network
    comment: str


class ProgramTasks:
    """The tasks of a program: those of its behaviors' goals, then others as they are asked for."""

    def __init__(self, task: PddlTask, world: World) -> None:
        self.emitted = task
        self.names = task.names
        self.program = task.program
        self.model = task.parts.model
        self.world = world
        self.wanted = Wanted(world)
        self.tasks: list[Task] = []
        self.methods: list[Method] = []
        self.chains: dict[str, Chain] = {}
        self._forms: dict[Form, Task] = {}
        self._called: dict[str, Task] = {}
        self._checks: dict[object, Task] = {}
        self._achieved: dict[Form, list[tuple[Behavior, Literal]]] = {}
        bodies = [s for b in self.program.behaviors for s in (*b.body, *(b.effect or ()))]
        bodies += [s for c in self.program.controllers for s in c.effect or ()]
        self._written = {s.feature for s in statements_within(bodies) if isinstance(s, Assign)}
        self._called_names = {s.behavior for s in statements_within(bodies) if isinstance(s, Call)}

    def add_all(self) -> None:
        """Add the tasks of all goals, of called behaviors, and of what these ask for."""
        for behavior in self.program.behaviors:
            if behavior.goal is not None:
                literal = _goal(plain_goal(behavior.goal))
                self._achieved.setdefault(literal.form, []).append((behavior, literal))
        for form in list(self._achieved):
            self._form(form)
        for behavior in self.program.behaviors:
            if behavior.goal is None:
                self.running(behavior.name)

    @property
    def achieved(self) -> frozenset[Form]:
        """The forms that behaviors have for goals."""
        return frozenset(self._achieved)

    # -------------------------------------------------------------------------- what bodies ask

    def is_static(self, condition: Expression) -> bool:
        """Whether nothing ever changes the truth of a condition."""
        return all(
            part.feature not in self._written if isinstance(part, Read) else True
            for part in subexpressions(condition)
            if not isinstance(part, Apply)
        ) and not any(isinstance(part, Apply) for part in subexpressions(condition))

    def is_subtype(self, lower: Type, upper: Type) -> bool:
        """Whether every object of the first type is one of the second."""
        return self.world.hierarchy.is_subtype(lower, upper)

    def achieving(self, literal: Expression) -> tuple[Task, tuple[Expression, ...]]:
        """The task of a literal, with the arguments it has."""
        found = next(literals(literal))
        return self._form(found.form), found.arguments

    def running(self, behavior: str) -> Task:
        """The task of a behavior that is called."""
        if behavior not in self._called:
            rule = self.world.behaviors[behavior]
            name = self.names.add("task", f"run'{behavior}", f"run-{behavior}")
            task = Task(name, rule.parameters, f"what `{behavior}` does")
            self._called[behavior] = task
            self.tasks.append(task)
            self._behavior(rule, task, [p.name for p in rule.parameters], list(rule.parameters), ())
        return self._called[behavior]

    def is_part(self, behavior: str) -> bool:
        """Whether all that a called behavior does is in its caller's action.

        The variables of its binds would be further ones of the action.
        """
        body = self.world.behaviors[behavior].body
        return not any(
            isinstance(s, Achieve | Bind)
            or (isinstance(s, Call) and not self.is_part(s.behavior))
            for s in statements_within(body)
        )

    def choosing(
        self, owner: Body, parameters: tuple[Parameter, ...], blocks: Iterable[Block]
    ) -> Task:
        """A task that is done by going through one of some blocks."""
        task = self._helper(owner, parameters)
        for block in blocks:
            self._through(owner, task, parameters, block, {}, Network())
        return task

    def looping(self, owner: Body, parameters: tuple[Parameter, ...], loop: ForEach) -> Task:
        """A task that is done by going through a block for each object, in any order.

        It goes from the first object of a type to the next: the block of one beside the rest.
        """
        variable, *others = loop.variables
        assert isinstance(variable.type, ObjectType)
        chain = self.chains.setdefault(str(variable.type), chain_of(variable.type, self.names))
        inner = ForEach(tuple(others), loop.body, location=loop.location)
        block: Block = (inner,) if others else loop.body
        whole = self._helper(owner, parameters)
        own = fresh_name(variable.name, {p.name for p in parameters})
        one = Parameter(own, variable.type)
        following = Parameter(fresh_name("next", {p.name for p in (*parameters, one)}), one.type)
        rest = self._helper(owner, (*parameters, one))
        each = self._helper(owner, (*parameters, one))
        more = {variable.name: Variable(own, variable.type)}
        self._through(owner, each, (*parameters, one), block, more, Network())
        here, there = (
            _call_of(t, (*parameters, v))
            for t, v in ((each, one), (rest, following))
        )
        at_one, at_next = Variable(one.name, one.type), Variable(following.name, one.type)
        begun = single(_call_of(rest, (*parameters, one)))
        both = single(here).beside(single(there))
        inside = (*parameters, one)
        self._chained(whole, parameters, one, (chain.first, at_one), begun)
        self._chained(whole, parameters, None, (chain.empty,), Network())
        self._chained(rest, inside, following, (chain.next, at_one, at_next), both)
        self._chained(rest, inside, None, (chain.last, at_one), single(here))
        return whole

    def steps(self, behavior: Behavior, node: Do) -> list[tuple[Action, Source]]:
        """The actions of a controller call in a method; none if nothing describes its effect."""
        return [
            (action, source)
            for action in self.emitted.actions
            for source in action.sources
            if source.behavior == behavior.name
            and source.step is not None
            and source.step.behavior.location == node.location
        ]

    # ------------------------------------------------------------------------------------- tasks

    def _form(self, form: Form) -> Task:
        """The task of a form, with all of its methods."""
        if form not in self._forms:
            word = "achieve" if form.is_positive else "achieve-not"
            shown = self.names.get("feature", form.name) if form.name in self.world.features else form.name
            name = self.names.add("task", f"{word}'{form.name}'{form.has_value}", f"{word}-{shown}")
            parameters = parameters_of(form, self.world)
            holds = condition_of(form, self.world)
            task = Task(name, parameters, f"achieve {expression_text(holds)}")
            self._forms[form] = task
            self.tasks.append(task)
            suffix = name.removeprefix("achieve-")
            self._add(f"{suffix}-holds", task, parameters, [p.name for p in parameters], [holds],
                      Network(), "nothing to do")
            for behavior, literal in self._achieved.get(form, ()):
                self._for_goal(behavior, literal, task)
        return self._forms[form]

    def _for_goal(self, behavior: Behavior, literal: Literal, task: Task) -> None:
        """The methods of a behavior for the task of its goal."""
        parameters = list(behavior.parameters)
        arguments: list[str] = []
        equal: list[Expression] = []
        for value, wanted in zip(literal.arguments, task.parameters, strict=True):
            if isinstance(value, Variable) and value.name not in arguments:
                arguments.append(value.name)
                index = next(i for i, p in enumerate(parameters) if p.name == value.name)
                if self.is_subtype(wanted.type, parameters[index].type):
                    parameters[index] = Parameter(value.name, wanted.type)
            else:
                name = fresh_name(wanted.name, {p.name for p in parameters})
                parameters.append(Parameter(name, wanted.type))
                arguments.append(name)
                equal.append(Compare("==", Variable(name, wanted.type), value))
        order = {name: index for index, name in enumerate(arguments)}
        parameters.sort(key=lambda p: order.get(p.name, len(order)))
        if behavior.name in self._called_names:
            run = self.running(behavior.name)
            called = single(_call_of(run, run.parameters))
            self._add(behavior.name, task, parameters, arguments, equal, called, f"call `{behavior.name}`")
        else:
            self._behavior(behavior, task, arguments, parameters, equal)

    def _behavior(
        self,
        behavior: Behavior,
        task: Task,
        arguments: list[str],
        parameters: list[Parameter],
        equal: Sequence[Expression],
    ) -> None:
        """A method for each way through a behavior's body, and each action it may end with."""
        has_action = behavior.effect is not None
        rules = Rules(self.wanted, self.achieved, checks=not has_action)
        own = [
            (action, source)
            for action in self.emitted.actions
            for source in action.sources
            if source.behavior == behavior.name and source.step is None
        ]
        for way in ways_of(behavior, rules):
            for last in own if has_action else [None]:
                body = Body(
                    self, behavior, behavior.name, list(parameters), start_values(parameters),
                    has_action=has_action, conditions=list(equal), known=start_values(behavior.parameters),
                )  # fmt: skip
                network = body.block(way, has_acted=False, acts_after=False)
                if last is not None:
                    network = network.then(body.action(*last))
                self._add_body(behavior.name, task, arguments, body, network)

    def _through(
        self,
        owner: Body,
        task: Task,
        parameters: tuple[Parameter, ...],
        block: Block,
        more: dict[str, Expression],
        after: Network,
    ) -> None:
        """A method for each way through a block of a body."""
        rules = Rules(self.wanted, self.achieved, checks=True)
        names = [p.name for p in parameters]
        known = {n: v for n, v in owner.known.items() if getattr(v, "name", None) in names}
        for way in ways_through(block, rules, owner.behavior):
            body = Body(
                self, owner.behavior, owner.label, list(parameters), {**owner.values, **more},
                known={**known, **more},
            )  # fmt: skip
            network = body.block(way, has_acted=False, acts_after=False)
            self._add_body(task.name, task, names, body, network.then(after))

    def _helper(self, owner: Body, parameters: tuple[Parameter, ...]) -> Task:
        number = 1
        while self.names.has("task", f"{owner.label}'{number}"):
            number += 1
        name = self.names.add("task", f"{owner.label}'{number}", f"{owner.label}-part-{number}")
        task = Task(name, parameters, f"part of `{owner.label}`")
        self.tasks.append(task)
        return task

    # ----------------------------------------------------------------------------------- methods

    def _add_body(
        self, name: str, task: Task, arguments: list[str], body: Body, network: Network
    ) -> None:
        parameters = used_parameters(body, network, arguments)
        comment = f"`{body.label}`"
        self._add(name, task, parameters, arguments, body.conditions, network, comment)

    def _add(
        self,
        name: str,
        task: Task,
        parameters: Sequence[Parameter],
        arguments: list[str],
        conditions: Iterable[Expression],
        network: Network,
        comment: str,
    ) -> None:
        """Add a method, unless its precondition holds in no state."""
        variables = self._variables(parameters)
        precondition = self._precondition(conditions, parameters, variables)
        if precondition != NEVER:
            self._method(name, task, parameters, arguments, variables, precondition, network, comment)

    def _chained(
        self,
        task: Task,
        parameters: tuple[Parameter, ...],
        other: Parameter | None,
        fact: tuple[str | Variable, ...],
        network: Network,
    ) -> None:
        """A method of a loop, where a fact of its chain holds."""
        every = [*parameters, *([] if other is None else [other])]
        variables = self._variables(every)
        precondition = tuple(w if isinstance(w, str) else f"?{variables[w.name]}" for w in fact)
        names = [p.name for p in parameters]
        self._method(task.name, task, every, names, variables, precondition, network, "in any order")

    def _method(
        self,
        name: str,
        task: Task,
        parameters: Sequence[Parameter],
        arguments: list[str],
        variables: dict[str, str],
        precondition: SExpr,
        network: Network,
        comment: str,
    ) -> None:
        wanted = f"{name}-way" if name == task.name else name
        chosen = self.names.add("method", f"'{len(self.methods)}", wanted)
        self.methods.append(
            Method(chosen, task, tuple(arguments), tuple(parameters), variables, precondition,
                   network, comment)
        )  # fmt: skip

    def _variables(self, parameters: Iterable[Parameter]) -> dict[str, str]:
        chosen: dict[str, str] = {}
        for parameter in parameters:
            chosen[parameter.name] = variable_name(parameter.name, chosen.values())
        return chosen

    def _precondition(
        self, conditions: Iterable[Expression], parameters: Sequence[Parameter], variables: dict[str, str]
    ) -> SExpr:
        pool = self.model.pool
        try:
            formulas = [plain(self.model.formula(c, parameters), pool) for c in conditions]
        except NotModelled as refused:
            raise NotPddl(refused.construct, refused.location) from None
        written = {name: f"?{variable}" for name, variable in variables.items()}
        return condition(pool.conjunction(formulas), Lowering(self.names, pool, written))


def _goal(goal: Expression) -> Literal:
    found = next(literals(goal), None)
    if found is None:
        raise NotPddl(f"the goal `{expression_text(goal)}`", goal.location)
    return found


def _call_of(task: Task, arguments: Iterable[Parameter]) -> Subtask:
    return Subtask(task.name, tuple(Variable(p.name, p.type) for p in arguments))


NO_CONDITION = ALWAYS
