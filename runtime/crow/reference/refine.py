"""REFINE of App. A with the corrections of semantics.md §3, as plainly as possible.

It chooses from the end: a statement that may be the last one, after everything before it. Each
result is a state, the values of the variables, and a trace.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace

from crow.conditions import Wanted, is_opaque
from crow.evaluate import EvaluationError, assignments_of, execute, holds
from crow.explanation import Obstacle
from crow.matching import Matching, instances
from crow.problem import State, World
from crow.program import (
    Achieve,
    And,
    Assert,
    Behavior,
    Bind,
    Call,
    Commit,
    Do,
    Expression,
    If,
    Let,
    Location,
    Or,
    Quantified,
    SetLocal,
    Statement,
)
from crow.reference.orders import (
    EMPTY,
    Leaf,
    Order,
    is_empty,
    leaves,
    sequence,
    tail,
    unordered,
)
from crow.reference.programs import (
    Application,
    Apply,
    Check,
    Finish,
    Frame,
    Programs,
    Run,
    Values,
    Want,
    bind_names,
    environment,
    is_undecided,
    scope_of,
    section_of,
)
from crow.text import expression_text
from crow.trace import AssertItem, DoItem, EffItem, TraceItem
from crow.values import Value

HELD, BOUND = " held", " bound"
"""What is kept about an application, under names that no variable has."""

Trace = tuple[tuple[TraceItem, Application], ...]
Result = tuple[State, Values, Trace]


@dataclass(slots=True)
class Refinement:
    """The refinements of one world's programs up to a depth; `is_cut` if there are deeper ones.

    `check` is called with each node and may raise.
    """

    world: World
    depth: int
    check: Callable[[], None] = field(default=lambda: None)
    nodes: int = 0
    is_cut: bool = False
    has_committed: bool = False
    last: Expression | None = None
    farthest: tuple[int, Obstacle] | None = None
    wanted: Wanted = field(init=False)
    matching: Matching = field(init=False)
    programs: Programs = field(init=False)

    def __post_init__(self) -> None:
        self.wanted = Wanted(self.world)
        self.matching = Matching(self.world)
        self.programs = Programs(self.world)

    def goal(self, state: State, goal: Expression) -> Iterator[Result]:
        """Every refinement of `achieve g; assert g` (§2.2)."""
        self.last = goal
        frame = Frame(Application(None, (), 0, ()))
        want = Want(self.wanted.normal(goal), frame, 0, goal.location)
        check = Check(goal, frame, goal.location)
        right = sequence((Leaf(want), Leaf(check)))
        return self.refine(state, {}, EMPTY, EMPTY, right)

    def refine(
        self, state: State, values: Values, left: Order, middle: Order, right: Order
    ) -> Iterator[Result]:
        """The refinements of a program `<L, M, R>` from a state."""
        if not is_empty(left):
            for before, known, trace in self.refine(state, values, EMPTY, EMPTY, left):
                for after in self.refine(before, known, EMPTY, middle, right):
                    yield after[0], after[1], trace + after[2]
        elif is_undecided(middle):
            for opened, held in self._started(middle, state, values):
                yield from self.refine(state, held, EMPTY, opened, right)
        elif not is_empty(middle):
            for last, rest in tail(middle):
                self._count()
                yield from self._member(state, values, rest, last.content, right)
        elif not is_empty(right):
            for last, rest in tail(right):
                yield from self._last(state, values, rest, last)
        else:
            yield state, values, ()

    def _last(self, state: State, values: Values, rest: Order, last: Leaf) -> Iterator[Result]:
        """A last statement of R, after everything else in it."""
        self._count()
        for before, known, trace in self.refine(state, values, EMPTY, EMPTY, rest):
            for after, then, more in self._statement(before, known, last.content):
                yield after, then, trace + more
            if isinstance(last.content, Run) and isinstance(last.content.statement, Commit):
                self.has_committed = True
                return

    def _count(self) -> None:
        self.nodes += 1
        self.check()

    # ------------------------------------------------------------------------------------------ M

    def _started(
        self, middle: Order, state: State, values: Values
    ) -> Iterator[tuple[Order, Values]]:
        """M when it starts, in each way; its conditions are held for the R of its behavior."""
        known = {id(leaf) for leaf in leaves(middle)}
        try:
            orders = tuple(self.programs.started(middle, state, values))
        except EvaluationError:
            return
        for order in orders:
            held = values
            for leaf in leaves(order):
                if id(leaf) not in known and isinstance(leaf.content, Run):
                    held = self._hold(held, leaf.content)
            yield order, held

    def _member(
        self, state: State, values: Values, rest: Order, member: object, right: Order
    ) -> Iterator[Result]:
        """A last member of M: where it completes is the beginning of R."""
        match member:
            case Run(statement=Assert(condition=condition) as node, frame=frame):
                check = Leaf(Check(condition, frame, node.location))
                yield from self.refine(state, values, EMPTY, rest, sequence((check, right)))
            case Run(statement=Achieve(condition=condition) as node, frame=frame):
                after = sequence((*self._stands(node, frame), right))
                want = self._want(condition, frame, node.location)
                yield from self._wanted_member(state, values, rest, want, after, right)
            case Want():
                yield from self._wanted_member(state, values, rest, member, right, right)
            case Run(statement=Call() as node, frame=frame):
                try:
                    applied = self._called(node, frame, state, values)
                except EvaluationError:
                    return
                yield from self._joined(state, values, rest, applied, right)
            case Apply():
                yield from self._joined(state, values, rest, member, right)
            case _:
                raise AssertionError(f"{member} in M")

    def _wanted_member(
        self,
        state: State,
        values: Values,
        rest: Order,
        want: Want,
        after: Order,
        null: Order,
    ) -> Iterator[Result]:
        """A condition in M: null where it completes, else refined, with `after` behind it."""
        check = Leaf(Check(want.condition, want.frame, want.location))
        yield from self.refine(state, values, EMPTY, rest, sequence((check, null)))
        for part in self._choices(want):
            yield from self._wanted_member(state, values, rest, part, after, null)
        parts = self._parts(want)
        if parts:
            joined = unordered((rest, unordered(tuple(map(Leaf, parts)))))
            right = sequence((check, after))
            yield from self.refine(state, values, EMPTY, joined, right)
        found, is_step = self._applications(want, state, values)
        for behavior, arguments in found:
            applied = Apply(behavior, arguments, want.frame, want.depth, want, is_step)
            if is_step:
                again = replace(want, depth=want.depth + 1)
                joined = unordered((rest, sequence((Leaf(applied), Leaf(again)))))
                if self._is_within(want.depth + 1):
                    yield from self.refine(state, values, EMPTY, joined, after)
            else:
                yield from self._joined(state, values, rest, applied, after)

    def _joined(
        self, state: State, values: Values, rest: Order, applied: Apply, after: Order
    ) -> Iterator[Result]:
        """A behavior for a member of M: its L before M, its M beside the rest, its R before R."""
        application = self._application(applied)
        if application is None:
            return
        for left, middle, right, known in self._body(application, values):
            joined = unordered((rest, middle))
            yield from self.refine(state, known, left, joined, sequence((right, after)))

    # ---------------------------------------------------------------------------------- L and R

    def _statement(self, state: State, values: Values, content: object) -> Iterator[Result]:
        """What a statement of L or R does in a state where control reaches it."""
        try:
            match content:
                case Check(condition=condition, frame=frame, location=location):
                    yield from self._check(state, values, condition, frame, location)
                case Want():
                    yield from self._achieve(state, values, content)
                case Apply():
                    yield from self._apply(state, values, content)
                case Finish(application=application, frame=frame):
                    yield from self._finish(state, values, application, frame)
                case Run(statement=statement, frame=frame):
                    yield from self._run(state, values, content, statement, frame)
                case _:
                    raise AssertionError(content)
        except EvaluationError:
            return  # what has no value is false, wherever it stands

    def _run(
        self, state: State, values: Values, run: Run, statement: Statement, frame: Frame
    ) -> Iterator[Result]:
        match statement:
            case Assert(condition=condition, location=location):
                held = self._hold(values, run)
                yield from self._check(state, held, condition, frame, location)
            case Achieve(condition=condition, location=location):
                want = self._want(condition, frame, location)
                for after, known, trace in self._achieve(state, values, want):
                    checks = sequence(tuple(self._stands(statement, frame)))
                    held = self._hold(known, run)
                    for last in self.refine(after, held, EMPTY, EMPTY, checks):
                        yield last[0], last[1], trace + last[2]
            case Bind():
                yield from self._bind(state, values, run, statement, frame)
            case Do():
                yield from self._do(state, values, statement, frame)
            case Call():
                yield from self._apply(state, values, self._called(statement, frame, state, values))
            case If():
                for block in self.programs.chosen(statement, frame, state, values):
                    yield from self.refine(state, values, EMPTY, EMPTY, block)
            case Let(variable=variable, value=value):
                known = self.programs.value(value, frame, state, values)
                yield state, {**values, (frame, variable.name): known}, ()
            case SetLocal(variable=name, value=value):
                known = self.programs.value(value, frame, state, values)
                yield state, {**values, (scope_of(values, frame, name), name): known}, ()
            case Commit():
                yield state, values, ()
            case _:
                raise AssertionError(f"{type(statement).__name__} in a body")

    def _achieve(self, state: State, values: Values, want: Want) -> Iterator[Result]:
        """`achieve` in L or R: nothing where it is true, else each alternative."""
        variables = environment(values, want.frame)
        check = Check(want.condition, want.frame, want.location)
        if holds(self.world, state, want.condition, variables):
            yield from self._statement(state, values, check)
            return
        for part in self._choices(want):
            yield from self._statement(state, values, part)
        parts = self._parts(want)
        if parts:
            middle = unordered(tuple(map(Leaf, parts)))
            yield from self.refine(state, values, EMPTY, middle, Leaf(check))
        found, is_step = self._applications(want, state, values)
        if is_opaque(want.condition):
            self._note(state, values, want, "nothing can make it true")
        elif not found and not isinstance(want.condition, And | Or | Quantified):
            self._note(state, values, want, "no behavior achieves it")
        for behavior, arguments in found:
            applied = Apply(behavior, arguments, want.frame, want.depth, want, is_step)
            again = Leaf(replace(want, depth=want.depth + 1))
            steps = sequence((Leaf(applied), again)) if is_step else Leaf(applied)
            if not is_step or self._is_within(want.depth + 1):
                yield from self.refine(state, values, EMPTY, EMPTY, steps)

    def _apply(self, state: State, values: Values, applied: Apply) -> Iterator[Result]:
        yield from self._joined(state, values, EMPTY, applied, EMPTY)

    def _check(
        self,
        state: State,
        values: Values,
        condition: Expression,
        frame: Frame,
        location: Location | None,
    ) -> Iterator[Result]:
        variables = environment(values, frame)
        if holds(self.world, state, condition, variables):
            item = AssertItem(condition, variables, expression_text(condition), location)
            yield state, values, ((item, frame.application),)
        else:
            where = Want(condition, frame, 0, location)
            self._note(state, values, where, "it is false here")

    def _bind(
        self, state: State, values: Values, run: Run, node: Bind, frame: Frame
    ) -> Iterator[Result]:
        is_possible = False
        for chosen in assignments_of(self.world, node.variables, environment(values, frame)):
            known = dict(values)
            for variable in node.variables:
                known[frame, variable.name] = chosen[variable.name]
            behavior = frame.application.behavior
            assert behavior is not None
            names = bind_names(behavior).get(id(node), ())
            own = [chosen[v.name] for v in node.variables]
            bound = dict(zip(names, own, strict=True)) if names else {}
            key = (frame.application, BOUND)
            known[key] = {**known.get(key, {}), **bound}
            if node.condition is None:
                yield state, known, ()
            elif self._is_true(state, known, node.condition, frame):
                is_possible = True
                held = self._hold(known, run)
                check = Check(node.condition, frame, node.location)
                yield from self._statement(state, held, check)
        if node.condition is not None and not is_possible:
            want = Want(node.condition, frame, 0, node.location)
            self._note(state, values, want, "no object is like this")

    def _is_true(self, state: State, values: Values, condition: Expression, frame: Frame) -> bool:
        try:
            return holds(self.world, state, condition, environment(values, frame))
        except EvaluationError:
            return False

    def _do(self, state: State, values: Values, node: Do, frame: Frame) -> Iterator[Result]:
        controller = self.world.controllers[node.controller]
        arguments = tuple(self.programs.value(a, frame, state, values) for a in node.arguments)
        item = DoItem(node.controller, arguments, node.location)
        for _, known, trace in self._recheck(state, values, frame):
            done: Trace = (*trace, (item, frame.application))
            if controller.effect is None:
                yield state, known, done
                continue
            names = [p.name for p in controller.parameters]
            variables = dict(zip(names, arguments, strict=True))
            effect = EffItem(
                controller.name, controller.effect, controller.parameters, variables, node.location
            )
            after = execute(self.world, state, controller.effect, variables)
            yield after, known, (*done, (effect, frame.application))

    def _finish(
        self, state: State, values: Values, application: Application, frame: Frame
    ) -> Iterator[Result]:
        behavior = application.behavior
        assert behavior is not None
        if behavior.effect is None:
            yield state, values, ()
            return
        for _, known, trace in self._recheck(state, values, frame):
            variables = environment(known, frame)
            item = EffItem(
                behavior.name, behavior.effect, behavior.parameters, variables, behavior.location
            )
            after = execute(self.world, state, behavior.effect, variables)
            yield after, known, (*trace, (item, application))

    def _note(self, state: State, values: Values, want: Want, reason: str) -> None:
        """Remember what failed, if nothing came farther: the goal is last, then more variables are.

        The engine knows no trace before it is complete; but variables only come to those before.
        """
        how_far = len(values) + (1 << 30) * (want.condition is self.last)
        if self.farthest is None or how_far > self.farthest[0]:
            variables = environment(values, want.frame)
            told = Obstacle(want.condition, variables, want.location, reason, state.cells)
            self.farthest = how_far, told

    # ------------------------------------------------------------------------------- what is held

    def _stands(self, node: Achieve, frame: Frame) -> Iterator[Leaf]:
        """An `achieve` of a behavior with an effect is a precondition: true where it stands."""
        if frame.application.has_effect and not node.once:
            yield Leaf(Check(node.condition, frame, node.location))

    def _hold(self, values: Values, run: Run) -> Values:
        """The values, with the condition of a statement held until the next `do`."""
        application = run.frame.application
        match run.statement:
            case Assert(condition=condition) | Achieve(condition=condition, once=False):
                pass
            case Bind(condition=condition) if condition is not None:
                pass
            case _:
                return values
        if not application.has_effect:
            return values
        check = Check(condition, run.frame, run.statement.location)
        held = (*values.get((application, HELD), ()), check)
        return {**values, (application, HELD): held}

    def _recheck(self, state: State, values: Values, frame: Frame) -> Iterator[Result]:
        """What is held, asserted again before a `do` or the effect."""
        key = (frame.application, HELD)
        checks = sequence(tuple(map(Leaf, values.get(key, ()))))
        for after, known, trace in self.refine(state, values, EMPTY, EMPTY, checks):
            yield after, {**known, key: ()}, trace

    # ------------------------------------------------------------------------------- alternatives

    def _want(self, condition: Expression, frame: Frame, location: Location | None) -> Want:
        normal = self.wanted.normal(condition)
        return Want(normal, frame, frame.application.depth, location)

    def _choices(self, want: Want) -> Iterator[Want]:
        """The disjuncts of `or`, the objects of `exists`."""
        match want.condition:
            case Or(operands=operands):
                for operand in operands:
                    yield replace(want, condition=operand)
            case Quantified(quantifier="exists", body=body) as quantified:
                for fixed in instances(self.world, quantified):
                    yield replace(want, condition=body, frame=want.frame.inner(fixed))
            case _:
                return

    def _parts(self, want: Want) -> tuple[Want, ...]:
        """The conjuncts of `and`, the objects of `forall`."""
        match want.condition:
            case And(operands=operands):
                return tuple(replace(want, condition=o) for o in operands)
            case Quantified(quantifier="forall", body=body) as quantified:
                return tuple(
                    replace(want, condition=body, frame=want.frame.inner(fixed))
                    for fixed in instances(self.world, quantified)
                )
            case _:
                return ()

    def _applications(
        self, want: Want, state: State, values: Values
    ) -> tuple[list[tuple[Behavior, tuple[Value, ...]]], bool]:
        if is_opaque(want.condition) or isinstance(want.condition, And | Or | Quantified):
            return [], False

        def evaluate(node: Expression) -> Value:
            return self.programs.value(node, want.frame, state, values)

        try:
            return self.matching.applications(want.condition, evaluate)
        except EvaluationError:
            return [], False

    def _called(self, node: Call, frame: Frame, state: State, values: Values) -> Apply:
        arguments = tuple(self.programs.value(a, frame, state, values) for a in node.arguments)
        behavior = self.world.behaviors[node.behavior]
        return Apply(behavior, arguments, frame, frame.application.depth, node)

    def _is_within(self, depth: int) -> bool:
        self.is_cut |= depth > self.depth
        return depth <= self.depth

    def _application(self, applied: Apply) -> Application | None:
        """The application of a behavior, unless it is too deep or nested too often."""
        behavior, above = applied.behavior, applied.frame.application
        ancestors = above.ancestors
        if above.behavior is not None:
            ancestors = (*ancestors, above.behavior.name)
        limit = max_nested(behavior)
        if limit is not None and ancestors.count(behavior.name) >= limit:
            return None
        if not self._is_within(applied.depth + 1):
            return None
        return Application(behavior, applied.arguments, applied.depth + 1, ancestors, applied)

    def _body(
        self, application: Application, values: Values
    ) -> Iterator[tuple[Order, Order, Order, Values]]:
        """L, M and R of an applied behavior, `eff(b)` at the end of R, and its variables."""
        behavior = application.behavior
        assert behavior is not None
        frame = Frame(application)
        known = dict(values)
        for parameter, value in zip(behavior.parameters, application.arguments, strict=True):
            known[frame, parameter.name] = value
        finish = Leaf(Finish(application, frame))
        for left in self.programs.sequence(behavior.left, frame):
            for right in self.programs.sequence(behavior.right, frame):
                middle = section_of(behavior, frame)
                yield left, middle, sequence((right, finish)), known


def max_nested(behavior: Behavior) -> int | None:
    """How often a behavior may be applied for itself, if it says so."""
    found = (a.value for a in behavior.annotations if a.name == "max_nested")
    return next((v for v in found if isinstance(v, int)), None)
