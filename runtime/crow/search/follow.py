"""Goes through the program along an outline: a plan, if the program can be refined to that one.

What an outline leaves open is which member each of its behaviors is applied for. Only those are
tried whose links last, the ones that end first before the others.
"""

from collections.abc import Callable, Hashable, Iterator
from dataclasses import dataclass
from math import inf

from crow.search.code import Code
from crow.search.frames import Application, Kind, Open, Refined
from crow.search.machine import Machine
from crow.search.members import begun, walk
from crow.search.points import Choice, Point
from crow.search.relaxed.guide import Guiding
from crow.search.relaxed.links import Links, applied
from crow.search.relaxed.operators import FIRST
from crow.search.relaxed.remaining import agrees
from crow.search.states import Snapshot
from crow.values import Value


@dataclass(slots=True)
class _Entry:
    """A choice on the way: the step in which it is, and the ways on that are left."""

    step: int
    options: Iterator[Point]


class Follower:
    """Depth-first search along one outline. `check` is called again and again and may raise."""

    def __init__(
        self, machine: Machine, guiding: Guiding, links: Links, check: Callable[[], None]
    ) -> None:
        self.machine = machine
        self.guiding = guiding
        self.links = links
        self.outline = links.outline
        self.check = check
        self.changing = {o.code for o in guiding.task.operators if o.writes}
        self._seen: set[Hashable] = set()

    def search(self, nodes: int) -> Iterator[Point | None]:
        """A point with nothing left to do, after None for each way on; none within so many nodes:
        nothing.
        """
        machine = self.machine
        most = machine.counters.nodes + nodes
        stack = [_Entry(0, iter((machine.start(),)))]
        while stack and machine.counters.nodes < most:
            self.check()
            yield None
            entry = stack[-1]
            point = next(entry.options, None)
            if point is None:
                stack.pop()
                continue
            step = machine.run(point)
            if isinstance(step, Point):
                yield step
                return
            if step is not None:
                number = self.outline.steps.get(_reached(step.point), -1)
                if self._goes_on(step.point, entry.step, number):
                    stack.append(_Entry(number, iter(self._options(step, number))))

    def _goes_on(self, point: Point, before: int, step: int) -> bool:
        """Whether a point is on the outline, new, and leaves nothing that no step is for."""
        if step < before or point.key in self._seen:
            return False
        self._seen.add(point.key)
        return step == before or self._is_possible(point, step)

    def _is_possible(self, point: Point, step: int) -> bool:
        """Whether later steps are there for all that has begun or has to be achieved again."""
        frame = point.frame
        while frame is not None and frame.kind is not Kind.MIDDLE:
            frame = frame.next
        if frame is None:
            return True
        return all(self._has_step(member, step) for _, member, _ in walk(frame.second, None))

    def _has_step(self, member: Open | Refined, step: int) -> bool:
        if isinstance(member, Refined):
            if member.context is None or member.context.application.code not in self.changing:
                return True
            return self.links.end(member.context.application, step) is not None
        if member.may_be_null:
            return True
        facts, end = self._facts(member), self.links.end(member.application, step)
        return end is not None and any(
            not facts.isdisjoint(operator.claims)
            and self.links.is_for(applied(operator), number, end)
            for number in range(step, self.links.last)
            for operator in self.links.at(number)
        )

    def _facts(self, member: Open) -> set[int]:
        """The facts that a member wants."""
        operators = self.guiding.operators
        return set(operators.wanted(member.what, member.values, FIRST) or ())  # type: ignore[arg-type]

    # ------------------------------------------------------------------------------------- ways on

    def _options(self, choice: Choice, step: int) -> list[Point]:
        """The ways on that the outline has, those first that end first."""
        beginning, machine, frame = self.links.beginning(step), self.machine, choice.point.frame

        def prefers(code: Code, arguments: tuple[Value, ...], above: Application) -> bool:
            return self._may_begin(code, arguments, above, step)

        def place(point: Point) -> float:
            context = point.context if point.context is not None else begun(point)[2]
            if context is None or context.application.code is None:
                return inf
            application = context.application
            return beginning.get((application.code, application.arguments), inf)  # type: ignore[arg-type]

        machine.screen.begin(None, prefers)
        options = list(choice.options)
        machine.screen.end()
        if frame is not None and frame.kind is Kind.MIDDLE:
            settled = machine.forward.settled(choice.point, frame)
            if settled is not None:
                return options[::-1] if self._is_for_it(settled, step) else options
        return sorted((p for p in options if self._is_planned(p, step)), key=place)

    def _may_begin(
        self, code: Code, arguments: tuple[Value, ...], above: Application, step: int
    ) -> bool:
        """Whether a behavior may begin at a step for the one above."""
        if code not in self.changing:
            return True
        place = self.links.beginning(step).get((code, arguments))
        if place is None:
            return False
        if above.code is not None and above.code not in self.changing:
            return True
        end = self.links.end(above, step)
        return end is not None and self.links.is_for((code, arguments), place, end)

    def _is_planned(self, point: Point, step: int) -> bool:
        """Whether the objects that a body has chosen are those of a step."""
        context = point.context
        if context is None or context.application.code not in self.changing:
            return True
        own = context.application.code, context.application.arguments
        return any(
            applied(operator) == own and agrees(operator.values, context.values)
            for number in range(step, self.links.last)
            for operator in self.links.at(number)
        )

    def _is_for_it(self, member: Open, step: int) -> bool:
        """Whether a member that is true has to be left open: a later step is for it alone.

        That makes it true again, after it has become false.
        """
        links, facts = self.links, self._facts(member)
        end = links.end(member.application, step)
        if end is None:
            return False
        for number in range(end[1] - 1, step, -1):
            if any(not facts.isdisjoint(operator.claims) for operator in links.at(number)):
                return links.purposes(number) == {end}
            state = self.outline.states[number]
            if not all(self.guiding.task.is_true(fact, state) for fact in facts):
                return False
        return False


def _reached(point: Point) -> Snapshot:
    """The state that a point has reached; the L of a member of M runs in the one M started in."""
    frame = point.frame
    while frame is not None and frame.kind is not Kind.LEFT_DONE:
        frame = frame.next
    return point.state if frame is None else frame.first[0]
