"""Behaviors of one world to the instructions of the CROW engine."""

from collections.abc import Callable
from itertools import product
from threading import Lock
from typing import Final

from crow.budget import looking
from crow.conditions import Wanted as Conditions
from crow.conditions import is_opaque
from crow.evaluate import EvaluationError
from crow.matching import Matching
from crow.problem import World
from crow.program import (
    Achieve,
    And,
    Apply,
    Assert,
    Behavior,
    Bind,
    Call,
    Commit,
    Compare,
    Do,
    Expression,
    ForEach,
    ForRange,
    Group,
    If,
    Let,
    Location,
    Not,
    Or,
    Parameter,
    Quantified,
    Read,
    SetLocal,
    Statement,
)
from crow.program.names import fresh_name
from crow.program.types import is_object
from crow.program.walk import free_variables, statements_within
from crow.search import code
from crow.search.binds import candidates
from crow.search.code import Block, Code, Op, Test, Wanted
from crow.search.effects import Effect, Effects
from crow.search.expressions import Compiled, Compiler, Environment, Slots
from crow.search.reach import Reach
from crow.search.states import Snapshot
from crow.support import open_parameters
from crow.values import Value


class Programs:
    """The compiled behaviors of a world, each made when it is first asked for.

    Whoever plans in a world again, for another state or goal, finds them made.
    """

    def __init__(self, world: World) -> None:
        self.world = world
        self.compiler = Compiler(world)
        self.effects = Effects(world, self.compiler)
        self.conditions = Conditions(world)
        self.matching = Matching(world)
        self.reach = Reach(world, self.conditions, self.matching)
        self._lock = Lock()
        self._codes: dict[str, Code] = {}
        self._goals: dict[tuple[Expression, Location | None], tuple[Wanted, Test, int]] = {}
        self._controllers: dict[str, Effect | None] = {}
        self.written: dict[Compiled, tuple[Expression, Slots]] = {}

    @staticmethod
    def of(world: World) -> "Programs":
        """The programs of a world: searches share them, in other threads too."""
        found: Programs | None = world.kept.get("programs")
        if found is None:
            found = world.kept.setdefault("programs", Programs(world))
        return found

    def code(self, behavior: Behavior) -> Code:
        """The instructions of a behavior."""
        found = self._codes.get(behavior.name)
        if found is None:
            with self._lock:
                found = self._codes.get(behavior.name) or self._compiled(behavior)
                self._codes[behavior.name] = found
        return found

    def _compiled(self, behavior: Behavior) -> Code:
        limits = (a.value for a in behavior.annotations if a.name == "max_nested")
        limit = next((v for v in limits if isinstance(v, int)), None)
        made = Code(behavior, behavior.effect is not None, limit)
        _Body(self, made).compile()
        return made

    def compiled(self) -> tuple[Code, ...]:
        """The behaviors that were asked for so far."""
        return tuple(self._codes.values())

    def goal(self, goal: Expression) -> tuple[Wanted, Test, int]:
        """What a problem wants, the test of it, and how many slots it takes."""
        found = self._goals.get((goal, goal.location))
        if found is None:
            with self._lock:
                found = self._goals[goal, goal.location] = self._goal(goal)
        return found

    def _goal(self, goal: Expression) -> tuple[Wanted, Test, int]:
        root = Behavior("", (), None, (), None, (), None)
        body = _Body(self, Code(root, has_effect=False, max_nested=None))
        wanted = body.wanted(self.conditions.normal(goal), {})
        return wanted, body.test(goal, {}), body.size

    def term(self, node: Expression, slots: Slots) -> Compiled:
        """A value, compiled."""
        with self._lock:
            return self.compiler.expression(node, slots)

    def controller(self, name: str) -> Effect | None:
        """The effect of a controller, if it has one."""
        if name not in self._controllers:
            controller = self.world.controllers[name]
            slots = {p.name: i for i, p in enumerate(controller.parameters)}
            effect = controller.effect
            self._controllers[name] = None if effect is None else self.effects.effect(effect, slots)
        return self._controllers[name]


class _Body:
    """One behavior on the way to its instructions; each variable gets a slot of its own."""

    def __init__(self, programs: Programs, target: Code) -> None:
        self.programs = programs
        self.target = target
        self.size = len(target.behavior.parameters)
        self.taken = {p.name for p in target.behavior.parameters}
        self.bound: list[tuple[str, int]] = []
        self.loops = 0
        self.unsure: set[int] = set()
        self.values_bound: set[int] = set()

    def compile(self) -> None:
        """Fill the target."""
        target, behavior = self.target, self.target.behavior
        slots: Slots = {p.name: i for i, p in enumerate(behavior.parameters)}
        drawn = open_parameters(behavior)
        own = tuple(slots[p.name] for p in drawn)
        self.values_bound.update(own)
        target.left, slots = self.block(behavior.left, slots)
        opening: Block = ()
        if drawn:
            opening = (code.DrawOp(own, drawn, None, behavior.location, is_parameter=True),)
        if behavior.promotable is not None:
            target.left = (*opening, *target.left)
        if behavior.promotable is not None:
            members, slots = self.block(behavior.promotable.members, slots)
            is_sequence = behavior.promotable.order == "sequential"
            target.middle = (
                code.SequenceOp(members)
                if is_sequence
                else code.UnorderedOp(members, None, (), commits=False)
            )
        target.right, slots = self.block(behavior.right, slots)
        if behavior.promotable is None:
            target.right = (*opening, *target.right)
        if behavior.effect is not None:
            target.effect = self.programs.effects.effect(behavior.effect, slots)
            target.effect_slots = slots
        target.size = self.size
        target.bound = tuple(self.bound)
        target.middle_acts = self.programs.reach.acts(behavior)
        target.commits = (_commits(behavior.left), _commits(behavior.right))

    # -------------------------------------------------------------------------------- statements

    def block(self, statements: tuple[Statement, ...], slots: Slots) -> tuple[Block, Slots]:
        """Statements in order, with what is in scope after them."""
        ops = []
        for statement in statements:
            op, slots = self.statement(statement, slots)
            ops.append(op)
        return tuple(ops), slots

    def inner(self, statements: tuple[Statement, ...], slots: Slots) -> Block:
        """A block within another."""
        return self.block(statements, slots)[0]

    def statement(self, node: Statement, slots: Slots) -> tuple[Op, Slots]:
        """An instruction, with what is in scope after it."""
        match node:
            case Let(variable=variable, value=value):
                op = code.LetOp(self.size, self.value(value, slots), value, slots, node.location)
                return op, self.declared((variable,), slots)
            case Bind():
                return self.bind(node, slots)
            case _:
                return self.plain(node, slots), slots

    def plain(self, node: Statement, slots: Slots) -> Op:
        """An instruction that declares nothing."""
        has_effect = self.target.has_effect
        match node:
            case Assert(condition=condition):
                is_held = has_effect and not self.is_of_values(condition, slots)
                return code.AssertOp(self.test(condition, slots, node.location), is_held)
            case Achieve(condition=condition, once=once):
                normal = self.programs.conditions.normal(condition)
                wanted = self.wanted(normal, slots, node.location)
                test = self.test(condition, slots, node.location)
                return code.AchieveOp(wanted, test, has_effect and not once)
            case Do(controller=name):
                effect = self.programs.controller(name)
                return code.DoOp(name, self.values(node.arguments, slots), effect, node.location)
            case Call(behavior=name, arguments=arguments):
                return code.CallOp(name, self.values(arguments, slots), node.location)
            case SetLocal(variable=name, value=value):
                return code.LetOp(
                    slots[name], self.value(value, slots), value, slots, node.location
                )
            case If(condition=condition, then=then, otherwise=otherwise):
                test = self.test(condition, slots, node.location)
                return code.IfOp(test, self.inner(then, slots), self.inner(otherwise, slots))
            case Commit():
                return code.CommitOp(node.location)
            case _:
                return self.group(node, slots)

    def group(self, node: Statement, slots: Slots) -> Op:
        """A group or a loop."""
        match node:
            case Group(order="sequential", body=body):
                return code.SequenceOp(self.inner(body, slots))
            case Group(order="alternative", body=body):
                return code.AlternativeOp(self.inner(body, slots))
            case Group(body=body):
                return self.parts(node, body, slots)
            case ForEach(variables=variables, body=body):
                ranges = self.ranges(variables)
                self.loops += 1
                inner = self.inner(body, self.declared(variables, slots))
                self.loops -= 1
                op = code.SequenceOp(inner)
                return self.unordered(node, (op,), ranges, slots)
            case ForRange(variable=variable, body=body):
                slot = self.size
                self.loops += 1
                inner = self.inner(body, self.declared((variable,), slots))
                self.loops -= 1
                numbers = range(node.start, node.stop, node.step)
                return code.SequenceOp(
                    tuple(op for n in numbers for op in (code.FixOp(slot, n), *inner))
                )
            case _:
                raise AssertionError(f"{type(node).__name__} in a body")

    def parts(self, node: Statement, body: tuple[Statement, ...], slots: Slots) -> Op:
        """`unordered:`; what one part declares, others see once it has run."""
        declared: list[int] = []
        ops: list[Op] = []
        inner = slots
        for part in body:
            first = self.size
            op, inner = self.statement(part, inner)
            ops.append(op)
            if isinstance(part, Bind | Let):
                own = range(first, self.size) if isinstance(part, Bind) else (first,)
                declared += own
                self.unsure.update(own)
        group = self.unordered(node, tuple(ops), None, slots)
        assert isinstance(group, code.UnorderedOp)
        group.shared += tuple(declared)
        return group

    def unordered(
        self, node: Statement, body: Block, variables: "code.Variables", slots: Slots
    ) -> Op:
        written = {s.variable for s in statements_within((node,)) if isinstance(s, SetLocal)}
        shared = tuple(sorted(slots[name] for name in written if name in slots))
        return code.UnorderedOp(body, variables, shared, _commits((node,)))

    def bind(self, node: Bind, slots: Slots) -> tuple[Op, Slots]:
        """`bind`: its variables are in scope in its own condition."""
        first = self.size
        inner = self.declared(node.variables, slots)
        if not self.loops:
            for offset, variable in enumerate(node.variables):
                name = fresh_name(variable.name, self.taken)
                self.taken.add(name)
                self.bound.append((name, first + offset))
        condition = node.condition
        test = None if condition is None else self.test(condition, inner, node.location)
        values = tuple(v for v in node.variables if not is_object(v.type))
        if values:
            return self.bind_values(node, values, test, inner), inner
        choices = candidates(self.programs, node, test, inner)
        own = tuple(range(first, first + len(node.variables)))
        return code.BindOp(own, choices, test, self.target.has_effect, node), inner

    def is_of_values(self, condition: Expression, slots: Slots) -> bool:
        """Whether a condition is about a value that is bound: it is one of its own time step."""
        return any(slots[n] in self.values_bound for n in free_variables(condition) if n in slots)

    def bind_values(
        self, node: Bind, values: tuple[Parameter, ...], test: Test | None, slots: Slots
    ) -> Op:
        """A bind of values; any objects beside them are each of their type."""
        own = tuple(slots[v.name] for v in values)
        self.values_bound.update(own)
        drawn = code.DrawOp(own, values, test, node.location)
        objects = tuple(v for v in node.variables if is_object(v.type))
        if not objects:
            return drawn
        tuples = [*product(*(self.programs.world.objects_of(v.type) for v in objects))]
        own = tuple(slots[v.name] for v in objects)
        every = code.BindOp(
            own, lambda _state, _values: tuples, None, is_held=False, statement=node
        )
        return code.SequenceOp((every, drawn))

    # -------------------------------------------------------------------------------- expressions

    def declared(self, variables: tuple[Parameter, ...], slots: Slots) -> Slots:
        """The scope with variables in slots of their own."""
        own = {v.name: self.size + i for i, v in enumerate(variables)}
        self.size += len(variables)
        return {**slots, **own}

    def ranges(self, variables: tuple[Parameter, ...]) -> "code.Variables":
        """The slots that variables are about to get, and the tuples of objects for them."""
        domains = [self.programs.world.objects_of(v.type) for v in variables]
        own = tuple(range(self.size, self.size + len(variables)))
        return own, tuple(looking(product(*domains)))

    def value(self, node: Expression, slots: Slots) -> Compiled:
        compiled = self.programs.compiler.expression(node, slots, self.unsure)
        self.programs.written[compiled] = node, slots
        return compiled

    def values(self, nodes: tuple[Expression, ...], slots: Slots) -> tuple[Compiled, ...]:
        return tuple(self.value(node, slots) for node in nodes)

    def test(self, node: Expression, slots: Slots, location: Location | None = None) -> Test:
        """A condition, compiled."""
        return Test(self.value(node, slots), node, slots, location or node.location)

    def wanted(self, node: Expression, slots: Slots, location: Location | None = None) -> Wanted:
        """A condition in normal form as something to achieve."""
        test = self.test(node, slots, location)
        acts = self.programs.reach.wanting(node)
        match node:
            case And(operands=operands):
                parts = tuple(self.wanted(o, slots) for o in operands)
                return code.AllOf(test, parts, acts=acts)
            case Or(operands=operands):
                parts = tuple(self.wanted(o, slots) for o in operands)
                return code.OneOf(test, parts, acts=acts)
            case Quantified(quantifier=quantifier, variables=variables, body=body):
                ranges = self.ranges(variables)
                part = self.wanted(body, self.declared(variables, slots))
                kind = code.AllOf if quantifier == "forall" else code.OneOf
                return kind(test, (part,), ranges, acts=acts)
            case _ if is_opaque(node):
                return code.Opaque(test)
            case _:
                return code.Atom(test, self.alternatives(node, slots), acts=acts)

    def alternatives(
        self, node: Expression, slots: Slots
    ) -> Callable[[Snapshot, Environment], code.Alternatives]:
        """What achieves a literal or comparison, remembered by the values it depends on."""
        programs, matching = self.programs, self.programs.matching
        parts = {id(part): self.value(part, slots) for part in _parts(node)}
        plain = tuple(self.value(a, slots) for a in _parts(node))
        known: dict[tuple[Value, ...], code.Alternatives] = {}

        def found(state: Snapshot, values: Environment) -> code.Alternatives:
            key = tuple([_or_none(part, state, values) for part in plain])
            result = known.get(key)
            if result is None:
                if len(known) >= _MOST_REMEMBERED:  # values that are drawn never come again
                    known.clear()
                applications, is_step = matching.applications(
                    node, lambda part: parts[id(part)](state, values)
                )
                pairs = tuple((programs.code(b), arguments) for b, arguments in applications)
                result = known[key] = pairs, is_step
            return result

        return found


_MOST_REMEMBERED: Final = 10_000
_UNSET = object()


def _or_none(part: Compiled, state: Snapshot, values: Environment) -> Value:
    try:
        return part(state, values)
    except EvaluationError:
        return _UNSET


def _parts(node: Expression) -> list[Expression]:
    """The expressions that matching asks the values of."""
    match node:
        case Not(operand=operand):
            return _parts(operand)
        case Compare(left=left, right=right):
            return [left, right, *_parts(left), *_parts(right)]
        case Read(arguments=arguments) | Apply(arguments=arguments):
            return list(arguments)
        case _:
            return []


def _commits(statements: tuple[Statement, ...]) -> bool:
    return any(isinstance(s, Commit) for s in statements_within(statements))
