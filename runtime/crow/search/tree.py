"""The trail of a point as a refinement tree, and a search's dead ends as failures.

Equal applications are one object in a search, so which of several an event belongs to is found
here: by what each of them has left to do.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from typing import Any

from crow.explanation import NOT_YET
from crow.plan import call_text
from crow.program import Bind
from crow.refinement import Draft, Failure, Kind, Refinement, finished, instance_text
from crow.search.code import (
    AchieveOp,
    AllOf,
    AlternativeOp,
    AssertOp,
    BindOp,
    Block,
    CallOp,
    Code,
    DoOp,
    IfOp,
    OneOf,
    Op,
    SequenceOp,
    Test,
    UnorderedOp,
    Wanted,
)
from crow.search.explain import obstacle
from crow.search.expressions import Environment, names_of
from crow.search.frames import Application, Context
from crow.search.machine import Machine
from crow.search.plans import events_of, in_order, items_of
from crow.search.points import Failures, Point
from crow.text import expression_text
from crow.trace import DoItem, TraceItem


@dataclass(frozen=True, slots=True, eq=False)
class Role:
    """What a condition is in a program: its instruction, and for a part what it is a part of.

    `code` is None for the goal. `main` stands for the condition of an `achieve` in each of its
    forms: as it is written, and as it is wanted.
    """

    kind: Kind
    code: Code | None
    main: Test
    whole: Test | None = None
    op: Op | None = None


@dataclass(slots=True, eq=False)
class Instance:
    """One application on the way, and the conditions it has dealt with."""

    application: Application
    draft: Draft
    has_begun: bool = False
    seen: set[tuple[Test, Environment]] = field(default_factory=set)
    opened: set[Test] = field(default_factory=set)
    open_below: int = 0
    above: "Instance | None" = None
    has_called: bool = False


def refinement(machines: Iterable[Machine], finder: Machine | None) -> Refinement:
    """The tree of the plan that a machine has found, or of the branch that came farthest.

    With what failed in all of the machines.
    """
    searched = tuple(machines)
    if not any(searching.dead.failures for searching in searched):
        for searching in searched[:1]:
            start = Point(searching.store.initial, None, None, None, None)
            if searching.goals:
                searching.dead.note(start, NOT_YET, searching.goals[-1].test, ())
    failures = _failures(searched)
    machine, point = finder, None if finder is None else finder.finished
    if point is None:
        machine = max(searched, key=lambda m: m.dead.depth, default=None)
        point = None if machine is None else machine.dead.point
        if machine is None or point is None:
            return Refinement((), (), failures)
        return _Tree(machine, point).with_failure(failures)
    assert machine is not None
    return _Tree(machine, point).whole(failures)


# ------------------------------------------------------------------------------------------ roles


def roles_of(machine: Machine) -> dict[Test, Role]:
    """What the conditions of a machine's programs are."""
    found: dict[Test, Role] = {}
    for goal in machine.goals:
        _role(found, None, goal)
    for code in machine.programs.compiled():
        middle = () if code.middle is None else (code.middle,)
        for op in _ops((*code.left, *middle, *code.right)):
            _role(found, code, op)
    for code, test in machine.valueless:
        found[test] = Role(Kind.EFFECT, code, test)
    return found


def _ops(block: Block) -> Iterator[Op]:
    pending = list(block)
    while pending:
        op = pending.pop()
        yield op
        match op:
            case SequenceOp(body=body) | AlternativeOp(body=body) | UnorderedOp(body=body):
                pending.extend(body)
            case IfOp(then=then, otherwise=otherwise):
                pending.extend((*then, *otherwise))
            case _:
                pass


def _role(found: dict[Test, Role], code: Code | None, op: Op) -> None:
    match op:
        case AssertOp(test=test):
            found[test] = Role(Kind.ASSERT, code, test)
        case BindOp(test=Test() as test):
            found[test] = Role(Kind.BIND, code, test, op=op)
        case AchieveOp(wanted=wanted, test=test):
            found[test] = Role(Kind.ACHIEVE, code, wanted.test)
            _wanted(found, code, wanted, None)
        case _:
            pass


def _wanted(found: dict[Test, Role], code: Code | None, wanted: Wanted, whole: Test | None) -> None:
    found[wanted.test] = Role(Kind.ACHIEVE, code, wanted.test, whole)
    if isinstance(wanted, AllOf | OneOf):
        for part in wanted.parts:
            _wanted(found, code, part, whole or wanted.test)


# ------------------------------------------------------------------------------------------- tree


class _Tree:
    """Reads the events of one trail, the first one first."""

    def __init__(self, machine: Machine, point: Point) -> None:
        self.machine = machine
        self.world = machine.problem.world
        self.roles = roles_of(machine)
        self.events = events_of(machine, point)
        self.trace, self.items = self._traced()
        self.steps = 0
        goal = machine.problem.goal
        self.root = Draft(Kind.GOAL, expression_text(goal), goal.location)
        self.goal: Instance | None = None
        self.live: dict[Application, list[Instance]] = {}
        self.by_code: dict[Code | None, list[Instance]] = {}
        self.running: list[Instance] = []
        for number, event in enumerate(self.events):
            self._read(number, event)

    def _traced(self) -> tuple[tuple[TraceItem, ...], dict[int, int]]:
        """The trace, and the place in it of what each event does last."""
        trace: list[TraceItem] = []
        places: dict[int, int] = {}
        for number in in_order(self.events):
            found = items_of(self.world, self.events[number])
            if found:
                places[number] = len(trace)
                trace.extend(found)
        return tuple(trace), places

    def whole(self, failures: tuple[Failure, ...]) -> Refinement:
        """The tree of a plan."""
        return Refinement(finished(self.root), self.trace, failures)

    def with_failure(self, failures: tuple[Failure, ...]) -> Refinement:
        """The tree of a branch that failed, with what failed at its end."""
        dead = self.machine.dead
        assert dead.test is not None
        role = self.roles.get(dead.test)
        owner = self._owner(role, dead.values)
        names = names_of(dead.test.slots, dead.values)
        text = f"{instance_text(dead.test.condition, names)}: {dead.reason}"
        last = Draft(Kind.FAILED, text, dead.test.location, is_done=False)
        (self.root if owner is None else owner.draft).below.append(last)
        self._reopen()
        return Refinement(finished(self.root), self.trace, failures)

    def _reopen(self) -> None:
        """What has not ended, and what is above it, is not done."""
        self.root.is_done = False
        for instances in self.live.values():
            for instance in instances:
                instance.draft.is_done = False

    def _read(self, number: int, event: Any) -> None:
        item = self.items.get(number)
        match event:
            case ("for", Application() as application, Application() as above, what, values):
                self._apply(application, above, what, values)
            case ("begin", Application() as application):
                self._begin(application)
            case ("assert", Test() as test, values):
                self._assert(test, values, item)
            case ("do", DoOp() as op, _, Context(application=application)):
                owner = self._runs(application)
                owner.has_called = True
                assert item is not None
                called = self.trace[item]
                assert isinstance(called, DoItem)
                text = call_text(called.controller, called.arguments, {})
                leaf = Draft(Kind.DO, text, op.location, item=item, step=self._step())
                owner.draft.below.append(leaf)
            case ("eff", Context(application=application)):
                owner = self._runs(application)
                step = None if owner.has_called else self._step()
                where = None if application.code is None else application.code.behavior.location
                leaf = Draft(Kind.EFFECT, "effect", where, item=item, step=step)
                owner.draft.below.append(leaf)
            case ("end", Context() as context):
                self._end(context)
            case _:
                pass

    def _step(self) -> int:
        self.steps += 1
        return self.steps - 1

    # -------------------------------------------------------------------------------- applications

    def _apply(
        self, application: Application, above: Application, what: Any, values: Environment
    ) -> None:
        """A behavior is applied for something that an application above wants."""
        test = None if isinstance(what, CallOp | tuple) else what.test
        owner = self._wanting(above, test, values)
        assert application.code is not None
        behavior = application.code.behavior
        by = call_text(behavior.name, application.arguments, {})
        if test is None:
            called = what.location if isinstance(what, CallOp) else None
            kind = Kind.CALL if isinstance(what, CallOp) else Kind.STEP
            draft = Draft(kind, by, called, by, behavior.location)
        else:
            text = instance_text(test.condition, names_of(test.slots, values))
            draft = Draft(Kind.ACHIEVE, text, test.location, by, behavior.location)
            self._take(owner, test, values)
        instance = Instance(application, draft, above=owner)
        (self.root if owner is None else owner.draft).below.append(draft)
        if owner is not None:
            owner.open_below += 1
        self.live.setdefault(application, []).append(instance)
        self.by_code.setdefault(application.code, []).append(instance)

    def _take(self, owner: "Instance | None", test: Test, values: Environment) -> None:
        role = self.roles.get(test)
        if owner is not None and role is not None:
            owner.seen.add((role.main, values))
            if role.whole is not None:
                owner.opened.add(role.whole)

    def _wanting(
        self, above: Application, test: Test | None, values: Environment
    ) -> Instance | None:
        """Which of several equal applications wants something: one that had not yet."""
        if above.code is None:
            return self._of_goal(above)
        instances = self.live.get(above, ())
        if test is not None:
            role = self.roles.get(test)
            main = test if role is None else role.main
            for instance in reversed(instances):
                if (main, values) not in instance.seen:
                    return instance
        return instances[-1] if instances else None

    def _of_goal(self, application: Application) -> Instance:
        if self.goal is None:
            self.goal = Instance(application, self.root)
        return self.goal

    def _begin(self, application: Application) -> None:
        """The R of an application begins: of one with nothing open below it, if there is one."""
        self._runs(application)
        waiting = [i for i in self.live[application] if not i.has_begun]
        if not waiting:
            return
        ready = [instance for instance in waiting if not instance.open_below]
        instance = (ready or waiting)[-1]
        instance.has_begun = True
        self.running.append(instance)

    def _runs(self, application: Application) -> Instance:
        """The application that runs; its L runs before its R has begun."""
        if self.running and self.running[-1].application is application:
            return self.running[-1]
        if not self.live.get(application):
            # Tried by itself, to see what it changes: nothing on the trail says what for.
            assert application.code is not None
            step = (application.code, application.arguments)
            self._apply(application, self._goal().application, step, ())
        return self.live[application][-1]

    def _end(self, context: Context) -> None:
        if not self.running:
            return
        instance = self.running.pop()
        code = context.application.code
        if code is not None:
            bound = {n: context.values[s] for n, s in code.bound if context.values[s] is not None}
            instance.draft.by = call_text(
                code.behavior.name, context.application.arguments, bound
            )  # fmt: skip
        if instance.above is not None:
            instance.above.open_below -= 1
        self.live[context.application].remove(instance)
        self.by_code[code].remove(instance)

    # ---------------------------------------------------------------------------------- assertions

    def _assert(self, test: Test, values: Environment, item: int | None) -> None:
        role = self.roles.get(test)
        owner = self._owner(role, values)
        kind = Kind.ASSERT if role is None else self._kind(role, owner, values)
        names = names_of(test.slots, values)
        text = instance_text(test.condition, names)
        if role is not None and isinstance(role.op, BindOp) and kind is Kind.BIND:
            text = f"{_bound_text(role.op, values)} where {text}"
        leaf = Draft(kind, text, test.location, item=item)
        (self.root if owner is None else owner.draft).below.append(leaf)

    def _kind(self, role: Role, owner: Instance | None, values: Environment) -> Kind:
        """A condition that was dealt with before is asserted again."""
        if owner is None:
            return role.kind
        key = (role.main, values)
        if role.kind is Kind.ACHIEVE:
            if role.main in owner.opened or key in owner.seen:
                return Kind.HELD
            if role.whole is not None:
                owner.opened.add(role.whole)
        is_again = key in owner.seen
        owner.seen.add(key)
        return Kind.HELD if is_again else role.kind

    def _owner(self, role: Role | None, values: Environment) -> Instance | None:
        """The application that a condition stands in; None for the goal."""
        if role is None or role.code is None:
            return self._goal()
        count = len(role.code.behavior.parameters)
        fitting = [
            instance
            for instance in self.by_code.get(role.code, ())
            if instance.application.arguments == values[:count]
        ]
        if self.running and self.running[-1] in fitting:
            return self.running[-1]
        for instance in reversed(fitting):
            if (role.main, values) not in instance.seen:
                return instance
        return fitting[-1] if fitting else None

    def _goal(self) -> Instance:
        return self._of_goal(self.machine.shared.application(None, (), 0, ()))


def _bound_text(op: BindOp, values: Environment) -> str:
    assert isinstance(op.statement, Bind)
    names = (variable.name for variable in op.statement.variables)
    pairs = zip(names, (values[slot] for slot in op.slots), strict=True)
    return ", ".join(f"{name} = {value}" for name, value in pairs)


# --------------------------------------------------------------------------------------- failures


def _failures(machines: tuple[Machine, ...]) -> tuple[Failure, ...]:
    """What failed in any of the machines, by place; what came farthest first."""
    merged: dict[tuple[Any, ...], tuple[int, Failure]] = {}
    for machine in machines:
        roles = roles_of(machine)
        for (test, _), found in machine.dead.failures.items():
            role = roles.get(test)
            failure = _failure(machine, test, found.reason, found, role)
            key = (failure.location, failure.text, failure.reason, failure.behavior)
            before = merged.get(key)
            merged[key] = (found.depth, failure) if before is None else _both(
                before, (found.depth, failure)
            )  # fmt: skip
    ranked = sorted(merged.values(), key=lambda pair: (-pair[0], -pair[1].count))
    return tuple(failure for _, failure in ranked)


def _both(one: tuple[int, Failure], other: tuple[int, Failure]) -> tuple[int, Failure]:
    """One failure in two searches."""
    depth, farthest = max(one, other, key=lambda pair: pair[0])
    return depth, replace(farthest, count=one[1].count + other[1].count)


def _failure(
    machine: Machine, test: Test, reason: str, found: Failures, role: Role | None
) -> Failure:
    failed = obstacle(found.point, test, found.values, reason)
    events = events_of(machine, found.point)
    return Failure(
        text=expression_text(test.condition),
        reason=reason,
        location=test.location,
        behavior="" if role is None or role.code is None else role.code.behavior.name,
        count=found.count,
        steps=sum(1 for event in events if event[0] == "do"),
        variables=failed.used(),
        facts=tuple(failed.facts(machine.problem)),
    )
