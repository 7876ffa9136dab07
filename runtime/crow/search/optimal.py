"""The cheapest plan: points in the order of what a plan through them costs at least.

The cost is the number of controller calls, of which those that are sure to come are counted before
they are made; or the value of `minimize`, which bounds nothing unless no effect can make it less.
"""

from collections.abc import Callable, Hashable, Iterator
from heapq import heappop, heappush
from math import inf

from crow.evaluate import evaluate
from crow.problem import Problem
from crow.program import Assign, Constant, Expression, Read, Simulate
from crow.program.types import is_number
from crow.program.walk import statements_within
from crow.search.code import (
    AlternativeOp,
    Block,
    CallOp,
    Code,
    DoOp,
    IfOp,
    Op,
    SequenceOp,
    UnorderedOp,
)
from crow.search.engine import Found
from crow.search.frames import Frame, Kind, Members, Nested, Open, Refined
from crow.search.machine import Machine
from crow.search.plans import plan_of
from crow.search.points import Choice, Point, Trail
from crow.search.states import Snapshot, state_of


class Cheapest:
    """A search for plans that cost less than `bound`, until there are none.

    `check` is called again and again with the nodes so far and may raise.
    """

    def __init__(
        self, problem: Problem, check: Callable[[int], None], depth_limit: int | None
    ) -> None:
        self.problem = problem
        self.check = check
        self.bound = inf
        self.machine = machine = Machine(problem, counts_depth=depth_limit is not None)
        machine.protects = False
        machine.depth_limit = 1 if depth_limit is None else depth_limit
        self.least = LeastCalls(machine)
        self.has_bounds = problem.minimize is None or only_grows(problem)
        self.duplicates = 0
        self._queue: list[tuple[float, int, int, Point]] = []
        self._seen: dict[Hashable, int] = {}
        self._pushed = 0

    def plans(self) -> Iterator[Found]:
        """Plans that cost less than `bound`, which the caller sets to what the last one costs."""
        self._push(self.machine.start(), 0)
        while self._queue:
            self.check(self.machine.counters.nodes)
            least, _, calls, point = heappop(self._queue)
            if self.has_bounds and least >= self.bound:
                return
            step = self.machine.run(point)
            if step is None:
                continue
            here = step.point if isinstance(step, Choice) else step
            calls += calls_since(here.trail, point.trail)
            if isinstance(step, Choice):
                self._go_on(step, calls)
            elif self._cost(here.state, calls) < self.bound:
                yield plan_of(self.machine, here)

    def left_out(self) -> tuple[str, ...]:
        """What was left out in the end."""
        return ("depth",) if self.machine.is_cut else ()

    def _go_on(self, choice: Choice, calls: int) -> None:
        key = choice.point.key
        # Where calls cost nothing, it is the same to come here after more of them.
        spent = calls if self.problem.minimize is None else 0
        if self._seen.get(key, inf) <= spent:
            self.duplicates += 1
            return
        self._seen[key] = spent
        for option in choice.options:
            self._push(option, calls + calls_since(option.trail, choice.point.trail))

    def _push(self, point: Point, calls: int) -> None:
        """Queue a point; of equal ones the first comes first, so that none waits for ever."""
        least: float = calls + self.least.of(point.frame)
        if self.problem.minimize is not None and self.has_bounds:
            least = self._cost(point.state, calls)
        if not self.has_bounds or least < self.bound:
            self._pushed += 1
            heappush(self._queue, (least, self._pushed, calls, point))

    def _cost(self, state: Snapshot, calls: int) -> float:
        """What a plan costs that ends in a state."""
        if self.problem.minimize is None:
            return calls
        world = self.problem.world
        return float(evaluate(world, state_of(state, world), self.problem.minimize, {}))


def calls_since(trail: Trail, before: Trail) -> int:
    """The controller calls on a trail since an earlier one."""
    calls = 0
    while trail is not None and trail is not before:
        trail, event, _ = trail
        calls += event[0] == "do"
    return calls


class LeastCalls:
    """How many controller calls are sure to come, whatever is chosen."""

    def __init__(self, machine: Machine) -> None:
        self.machine = machine
        self._known: dict[Frame, int] = {}

    def of(self, frame: Frame | None) -> int:
        """Those of a frame and all that follow it."""
        pending = []
        while frame is not None and frame not in self._known:
            pending.append(frame)
            frame = frame.next
        total = 0 if frame is None else self._known[frame]
        for below in reversed(pending):
            total += self._own(below)
            self._known[below] = total
        return total

    def _own(self, frame: Frame) -> int:
        match frame.kind:
            case Kind.BLOCK:
                return self._block(frame.first[frame.second :])
            case Kind.MIDDLE:
                return self._members(frame.second)
            case Kind.TAIL:
                return self._members(frame.first)
            case _:
                return 0

    def _members(self, members: Members) -> int:
        total = 0
        for member in (member for chain in members for member in chain):
            match member:
                case Refined(context=context, children=children):
                    code = None if context is None else context.application.code
                    total += self._members(children)
                    total += 0 if code is None else self._block(code.right)
                case Nested(members=inner):
                    total += self._members(inner)
                case Open(what=CallOp() as call):
                    total += self._op(call)
                case Open(what=(Code() as code, _)):
                    total += self._block(code.left) + self._block(code.right)
                case _:
                    pass
        return total

    def _block(self, block: Block) -> int:
        return sum(map(self._op, block))

    def _op(self, op: Op) -> int:
        match op:
            case DoOp():
                return 1
            case SequenceOp(body=body):
                return self._block(body)
            case UnorderedOp(body=body, variables=variables):
                times = 1 if variables is None else len(variables[1])
                return times * self._block(body)
            case IfOp(then=then, otherwise=otherwise):
                return min(self._block(then), self._block(otherwise))
            case AlternativeOp(body=body):
                return min(map(self._op, body), default=0)
            case CallOp(behavior=name):
                code = self.machine.programs.code(self.machine.problem.world.behaviors[name])
                return self._block(code.left) + self._block(code.right)
            case _:
                return 0


# ---------------------------------------------------------------------------------- costs that grow


def only_grows(problem: Problem) -> bool:
    """Whether no effect can make `minimize` less: it is a feature that is only added to."""
    cost = problem.minimize
    if not isinstance(cost, Read):
        return False
    program = problem.world.program
    bodies = [b.effect or () for b in program.behaviors]
    bodies += [c.effect or () for c in program.controllers]
    if any(isinstance(s, Simulate) for body in bodies for s in body):
        return False
    writes = [s for body in bodies for s in statements_within(body) if isinstance(s, Assign)]
    written = {write.feature for write in writes}
    return all(
        write.operator == "+=" and _is_positive(problem, write.value, written)
        for write in writes
        if write.feature == cost.feature
    )


def _is_positive(problem: Problem, value: Expression, written: set[str]) -> bool:
    """Whether an expression is never negative: a number, or a feature that never is."""
    match value:
        case Constant(value=bool()):
            return False
        case Constant(value=int() | float() as number):
            return number >= 0
        case Read(feature=name):
            feature = problem.world.features[name]
            least = feature.bounds[0]
            if least is not None and least >= 0:
                return True
            cells = problem.initial.cells.items()
            values = [value for (own, _), value in cells if own == name]
            is_kept = name not in written and is_number(feature.type)
            return is_kept and all(isinstance(v, int | float) and v >= 0 for v in values)
        case _:
            return False
