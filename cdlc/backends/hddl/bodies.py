"""One way through a body as the precondition, parameters and subtasks of a method.

A condition that stands where nothing of the body has acted yet, or that nothing ever changes, is a
precondition of the method. Where an effect follows and nothing acts before it, the action demands
the condition. Any other is a subtask of its own, which can only be done where the condition holds.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Protocol

from cdlc.backends.hddl.networks import Network, Subtask, beside, single
from cdlc.backends.hddl.ways import CHOSEN, Block, branches
from cdlc.backends.pddl.actions import Action, Source
from cdlc.backends.pddl.sexpr import NotPddl
from crow.program import (
    Achieve,
    Assert,
    Behavior,
    Bind,
    Call,
    Compare,
    Do,
    Expression,
    ForEach,
    Group,
    If,
    Let,
    Object,
    Parameter,
    Read,
    SetLocal,
    Statement,
    Type,
    Variable,
)
from crow.program.names import fresh_name
from crow.program.rewrite import substitute
from crow.program.types import is_object
from crow.program.walk import expressions_of, free_variables, statements_within, subexpressions


@dataclass(frozen=True, slots=True, eq=False)
class Task:
    """A compound task: its HDDL name, its parameters, and what it is for."""

    name: str
    parameters: tuple[Parameter, ...]
    comment: str = ""


class Tasks(Protocol):
    """What a body asks of the program it is part of."""

    def is_static(self, condition: Expression) -> bool:
        """Whether nothing ever changes the truth of a condition."""

    def achieving(self, literal: Expression) -> tuple[Task, tuple[Expression, ...]]:
        """The task of a literal, with the arguments it has."""

    def running(self, behavior: str) -> Task:
        """The task of a behavior that is called."""

    def is_part(self, behavior: str) -> bool:
        """Whether all that a called behavior does is in its caller's action."""

    def checking(
        self, owner: "Body", parameters: tuple[Parameter, ...], condition: Expression
    ) -> Task:
        """A task that can only be done where a condition over some parameters holds."""

    def choosing(
        self,
        owner: "Body",
        parameters: tuple[Parameter, ...],
        node: Statement,
        blocks: Iterable[Block],
    ) -> Task:
        """A task that is done by going through one of some blocks, those of a statement."""

    def looping(self, owner: "Body", parameters: tuple[Parameter, ...], loop: ForEach) -> Task:
        """A task that is done by going through a block for each object."""

    def steps(self, behavior: Behavior, node: Do) -> list[tuple[Action, Source]]:
        """The actions of a controller call in a method; none if nothing describes its effect."""

    def is_subtype(self, lower: Type, upper: Type) -> bool:
        """Whether every object of the first type is one of the second."""


@dataclass
class Body:
    """The method that a walk through a body makes.

    `values` are what its names stand for, `known` those of the behavior's Hoare model. `behavior`
    is None for the goal of a problem; `has_start` is False where there is no precondition, either.
    """

    tasks: Tasks
    behavior: Behavior | None
    label: str
    parameters: list[Parameter]
    values: dict[str, Expression]
    has_action: bool = False
    has_start: bool = True
    conditions: list[Expression] = field(default_factory=list)
    known: dict[str, Expression] = field(default_factory=dict)

    # ------------------------------------------------------------------------------- statements

    def block(self, block: Block, *, has_acted: bool, acts_after: bool) -> Network:
        """The subtasks of statements one after another."""
        network = Network()
        for index, statement in enumerate(block):
            later = acts_after or any(map(self._acts, block[index + 1 :]))
            network = network.then(
                self._statement(statement, has_acted=has_acted, acts_after=later)
            )
            has_acted = has_acted or self._acts(statement)
        return network

    def _acts(self, statement: Statement) -> bool:
        """Whether a statement may change the state before the action of the body, if it has one."""
        kinds = Achieve | Call if self.has_action else Achieve | Call | Do
        return any(isinstance(s, kinds) for s in statements_within((statement,)))

    def _statement(self, node: Statement, *, has_acted: bool, acts_after: bool) -> Network:
        is_kept = self.has_action and not acts_after
        match node:
            case Assert(condition=condition):
                value = substitute(condition, self.values)
                return self._condition(value, has_acted=has_acted, is_kept=is_kept)
            case Achieve():
                return self._achieve(node, has_acted=has_acted)
            case Bind(variables=variables, condition=condition):
                for variable in variables:
                    self.bind(variable, is_own=node.annotations is not CHOSEN)
                if condition is None:
                    return Network()
                value = substitute(condition, self.values)
                return self._condition(value, has_acted=has_acted, is_kept=is_kept)
            case Let(variable=Parameter(name=name), value=value):
                return self._let(name, value, has_acted=has_acted, acts_after=acts_after)
            case SetLocal(variable=name, value=value):
                return self._let(name, value, has_acted=has_acted, acts_after=acts_after)
            case Do():
                return Network() if self.has_action else self._do(node)
            case Call():
                return self._call(node, has_acted=has_acted)
            case Group():
                return self._group(node, has_acted=has_acted, acts_after=acts_after)
            case If() | ForEach() if is_kept and not self._acts(node):
                return Network()  # it only demands, and the action does so, too
            case If():
                return self.choice(node, tuple((c, *block) for c, block in branches(node)))
            case ForEach():
                parameters = self._outside((node,))
                return self._helper(self.tasks.looping(self, parameters, node))
            case _:
                return Network()

    def _group(self, node: Group, *, has_acted: bool, acts_after: bool) -> Network:
        outer = dict(self.values)
        if node.order == "unordered":
            acting = [any(self._acts(s) for s in node.body if s is not part) for part in node.body]
            network = beside(
                self._statement(s, has_acted=has_acted or others, acts_after=acts_after or others)
                for s, others in zip(node.body, acting, strict=True)
            )
        else:
            network = self.block(node.body, has_acted=has_acted, acts_after=acts_after)
        # Names of the group end with it; what it assigned to others stays.
        own = {s.variable.name for s in node.body if isinstance(s, Let)}
        own |= {v.name for s in node.body if isinstance(s, Bind) for v in s.variables}
        self.values = {n: outer[n] if n in own else self.values[n] for n in outer}
        return network

    # ------------------------------------------------------------------------------- conditions

    def _condition(self, value: Expression, *, has_acted: bool, is_kept: bool) -> Network:
        """A condition, over parameters, that has to hold where it stands."""
        if self.has_start and (not has_acted or self.tasks.is_static(value)):
            self.conditions.append(value)
            return Network()
        if is_kept:
            return Network()
        used = free_variables(value)
        parameters = tuple(p for p in self.parameters if p.name in used)
        return self._helper(self.tasks.checking(self, parameters, value))

    def choice(self, node: Statement, blocks: tuple[Block, ...]) -> Network:
        """A task of its own that goes through one of some blocks, those of a statement."""
        parameters = self._outside((node,))
        return self._helper(self.tasks.choosing(self, parameters, node, blocks))

    def _outside(self, block: Block) -> tuple[Parameter, ...]:
        """The parameters that a block depends on."""
        names = frozenset[str]().union(
            *(free_variables(e) for s in statements_within(block) for e in expressions_of(s))
        )
        values = (self.values[name] for name in names if name in self.values)
        used = frozenset[str]().union(*map(free_variables, values))
        return tuple(p for p in self.parameters if p.name in used)

    def _helper(self, task: Task) -> Network:
        return single(Subtask(task.name, tuple(Variable(p.name, p.type) for p in task.parameters)))

    # ---------------------------------------------------------------------------- names and values

    def fresh(self, name: str, type_: Type) -> Variable:
        """One more parameter of the method."""
        taken = {p.name for p in self.parameters} | {n for n in self.values if n != name}
        parameter = Parameter(fresh_name(name, taken), type_)
        self.parameters.append(parameter)
        return Variable(parameter.name, type_)

    def bind(self, variable: Parameter, *, is_own: bool = True) -> Variable:
        """A parameter for a bound variable; `is_own` says that the behavior's model has it, too."""
        if not is_object(variable.type):
            raise NotPddl(f"`bind {variable.name}` of type `{variable.type}`", variable.location)
        in_model = fresh_name(variable.name, self.known)
        bound = self.values[variable.name] = self.fresh(variable.name, variable.type)
        if is_own:
            self.known[in_model] = bound
        return bound

    def _let(self, name: str, value: Expression, *, has_acted: bool, acts_after: bool) -> Network:
        now = substitute(value, self.values)
        if not any(isinstance(part, Read) for part in subexpressions(now)):
            self.values[name] = now
            return Network()
        if is_object(now.type):
            variable, network = self._named(name, now, has_acted=has_acted, acts_after=acts_after)
            self.values[name] = variable
            return network
        if acts_after and not self.tasks.is_static(now):
            construct = f"`let {name}`, whose value of type `{now.type}` is used after others act,"
            raise NotPddl(construct, value.location)
        self.values[name] = now
        return Network()

    def _named(
        self, name: str, value: Expression, *, has_acted: bool, acts_after: bool
    ) -> tuple[Variable, Network]:
        """A parameter that has the value of an expression where it stands."""
        variable = self.fresh(name, value.type)
        is_kept = self.has_action and not acts_after
        condition = Compare("==", value, variable, location=value.location)
        return variable, self._condition(condition, has_acted=has_acted, is_kept=is_kept)

    def _argument(
        self, value: Expression, wanted: Type, name: str, *, has_acted: bool
    ) -> tuple[Expression, Network]:
        """An argument of a task as a variable or object, and what has to hold before."""
        is_plain = isinstance(value, Variable | Object)
        if is_plain and self.tasks.is_subtype(value.type, wanted):
            return value, Network()
        if not is_object(value.type):
            raise NotPddl(f"a task for a value of type `{value.type}`", value.location)
        variable = self.fresh(name, wanted)
        condition = Compare("==", value, variable, location=value.location)
        return variable, self._condition(condition, has_acted=has_acted, is_kept=False)

    def _with_arguments(
        self, task: Task, arguments: Iterable[Expression], *, has_acted: bool
    ) -> Network:
        """A subtask, after what its arguments need to have the values they have there."""
        needed, plain = Network(), []
        for value, parameter in zip(arguments, task.parameters, strict=True):
            now = substitute(value, self.values)
            argument, before = self._argument(
                now, parameter.type, parameter.name, has_acted=has_acted
            )
            plain.append(argument)
            needed = needed.then(before)
        return needed.then(single(Subtask(task.name, tuple(plain))))

    # ------------------------------------------------------------------------------- what acts

    def _achieve(self, node: Achieve, *, has_acted: bool) -> Network:
        task, arguments = self.tasks.achieving(node.condition)
        return self._with_arguments(task, arguments, has_acted=has_acted)

    def _call(self, node: Call, *, has_acted: bool) -> Network:
        if not self.has_action:
            task = self.tasks.running(node.behavior)
            return self._with_arguments(task, node.arguments, has_acted=has_acted)
        if self.tasks.is_part(node.behavior):
            return Network()
        raise NotPddl(
            f"a call of `{node.behavior}`, which does more than run controllers, in a behavior"
            " with an effect of its own,",
            node.location,
            "leave out the `eff:` of the caller, or write in it what the called behavior does",
        )

    def _do(self, node: Do) -> Network:
        assert self.behavior is not None
        found = self.tasks.steps(self.behavior, node)
        if not found:
            return Network()
        (action, source), *others = found
        if others:
            construct = f"`{node.controller}`, which one statement runs in several ways,"
            raise NotPddl(construct, node.location)
        return self.action(action, source)

    def action(self, action: Action, source: Source) -> Network:
        """The action of a behavior or step as a subtask; what it fixes becomes a condition."""
        arguments: dict[str, Expression] = {}
        for chosen in source.variables:
            own = self.known.get(chosen.variable.name)
            if own is None or (chosen.parameter is None and chosen.object is None):
                continue
            if chosen.object is not None:
                self._equal(own, Object(chosen.object, chosen.variable.type))
            elif chosen.parameter in arguments:
                self._equal(own, arguments[chosen.parameter])
            else:
                assert chosen.parameter is not None
                arguments[chosen.parameter] = own
        plain = [
            arguments[p.name] if p.name in arguments else self.fresh(p.name, p.type)
            for p in action.parameters
        ]
        return single(Subtask(action.name, tuple(plain)))

    def _equal(self, left: Expression, right: Expression) -> None:
        self.conditions.append(Compare("==", left, right))


def used_parameters(body: Body, network: Network, kept: Iterable[str]) -> list[Parameter]:
    """The parameters of a body's method that its task, its conditions or its subtasks mention."""
    used = {*kept}.union(*map(free_variables, body.conditions))
    for subtask in network.subtasks:
        used = used.union(*map(free_variables, subtask.arguments))
    return [p for p in body.parameters if p.name in used]


def start_values(parameters: Iterable[Parameter]) -> dict[str, Expression]:
    """Parameters that stand for themselves."""
    return {p.name: Variable(p.name, p.type) for p in parameters}
