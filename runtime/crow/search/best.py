"""Best-first search over the points of the CROW engine, guided by a delete relaxation.

Points are compared where the state has changed, each by what is left to do there. Between two
changes the search goes on along behaviors that a relaxed plan applies, those first that begin the
least; every other way on is put off, and costs more with each time it was. So all of the space is
searched in the end, but its interleavings last.
"""

from collections.abc import Callable, Hashable, Iterator
from heapq import heappop, heappush
from math import inf
from typing import Final, NamedTuple

from crow.search.follow import Follower
from crow.search.frames import Frame, Kind, Refined
from crow.search.machine import Machine
from crow.search.members import begun, member_at
from crow.search.points import Choice, Cuts, Point
from crow.search.relaxed.guide import Guide, Guiding
from crow.search.relaxed.outlines import Outlines

PUT_OFF: Final = 5
"""What it costs to go a way that is not preferred, each time."""
DOUBT: Final = 3
"""How many times a way counts as put off that leaves open what is true, to achieve it again."""
BELOW_ITSELF: Final = 6
"""How many times one counts as put off that applies a behavior on the way to itself."""
BEGUN: Final = 0.1
"""What each behavior costs that was begun: of two points equally near, the freer one is better."""

MOST_STATES: Final = 2_000
"""The states that are searched for an outline."""
LEAST_NODES: Final = 1_000
NODES_A_STEP: Final = 400
"""The nodes that going along an outline may take."""


class Stick(NamedTuple):
    """The chain of an M in which something was begun, what follows that M, and its size.

    Until the state changes, only what is in this chain goes on: beginning things side by side
    is what interleaves without end.
    """

    following: Frame | None
    place: int
    size: int


class Way(NamedTuple):
    """A point to go on from; `begun` counts what was begun since the last change of state."""

    begun: int
    number: int
    point: Point
    stick: Stick | None = None
    is_fresh: bool = False


class Node(NamedTuple):
    """Ways to go on from, or a choice: its preferred ways, or all of them for `is_rest`."""

    number: int
    guide: Guide
    put_off: int
    ways: tuple[Way, ...] = ()
    choice: Choice | None = None
    is_rest: bool = False


class BestFirst:
    """One best-first search. `check` is called again and again and may raise."""

    def __init__(self, machine: Machine, check: Callable[[], None], heuristic: str) -> None:
        self.machine = machine
        self.check = check
        self.guiding = Guiding(machine, heuristic)
        self.seen: set[Hashable] = set()
        self.queue: list[tuple[float, int, Node]] = []
        self.numbers = 0
        self.duplicates = 0
        self.is_cut_by_commit = False
        self.pause_at: float = inf
        self.committed: dict[Hashable, int] = {}
        machine.height = self.number
        machine.commit = self._commit

    def points(self) -> Iterator[Point | None]:
        """The points with nothing left to do; None where `pause_at` nodes have been made."""
        for point in self._outlined():
            if point is not None or self.machine.counters.nodes >= self.pause_at:
                yield point
        start = self.machine.start()
        yield from _Expansion(self, Guide(start.state, 0), 0).run([Way(0, 0, start, is_fresh=True)])
        while self.queue:
            node = heappop(self.queue)[2]
            if node.is_rest:
                self._others(node)
            elif node.choice is None:
                yield from _Expansion(self, node.guide, node.put_off).run(list(node.ways))
            elif not self.is_dropped(node.choice.point, node.number):
                yield from _Expansion(self, node.guide, node.put_off).go_on(node.choice)
            if self.machine.counters.nodes >= self.pause_at:
                yield None

    def _outlined(self) -> Iterator[Point | None]:
        """A point with nothing left to do along an outline, if that is found soon."""
        outlines = Outlines(self.machine, self.guiding, self.check)
        for outline in outlines.search(MOST_STATES):
            if outline is not None:
                nodes = LEAST_NODES + NODES_A_STEP * len(outline.operators)
                links = outlines.links(outline)
                yield from Follower(self.machine, self.guiding, links, self.check).search(nodes)
            else:
                yield None

    def push(self, cost: float, node: Node) -> None:
        """Queue a node; of equal ones the last comes first."""
        total = cost + PUT_OFF * node.put_off
        heappush(self.queue, (total, -self.number(), node))

    def _others(self, node: Node) -> None:
        """Queue all ways of a choice, each by itself; those gone before are known as seen."""
        assert node.choice is not None
        if self.is_dropped(node.choice.point, node.number):
            return
        again = self.machine.run(node.choice.point)
        assert isinstance(again, Choice)
        for point in again.options:
            ways = (Way(0, self.number(), point, is_fresh=True),)
            put_off = node.put_off + BELOW_ITSELF * is_below_itself(point)
            self.push(node.guide.cost, Node(node.number, node.guide, put_off, ways))

    def number(self) -> int:
        """A number higher than all before."""
        self.numbers += 1
        return self.numbers

    # ------------------------------------------------------------------------------------- commit

    def _commit(self, point: Point) -> None:
        """Other ways through this section are dropped (semantics.md §2)."""
        if point.cuts is not None:
            self.committed[point.cuts[:2]] = self.number()

    def is_dropped(self, point: Point, number: int) -> bool:
        """Whether a point, made at a time, is in a section that has committed since."""
        cuts: Cuts = point.cuts
        while cuts is not None:
            if self.committed.get(cuts[:2], -1) >= number:
                self.is_cut_by_commit = True
                return True
            cuts = cuts[2]
        return False


class _Expansion:
    """Goes on from one evaluated point until the state changes."""

    def __init__(self, search: BestFirst, guide: Guide, put_off: int) -> None:
        self.search = search
        self.machine = search.machine
        self.guide = guide
        self.put_off = put_off
        self.base = guide.cost
        self.ran: set[Hashable] = set()
        self.again: list[Way] = []
        self.rest: list[tuple[Choice, int]] = []

    def go_on(self, choice: Choice) -> Iterator[Point]:
        """The finished points along the preferred ways of a choice; other ends are queued.

        What was begun before and can end now does so: if that leads nowhere near, neither will
        other ways to put it off.
        """
        ways = self._preferred(choice, None, 0)
        ready = [way for way in ways if way.begun == 0 and _begins_right(way.point)]
        if ready:
            self.again = [way for way in ways if way not in ready]
            ways = ready
        yield from self.run(ways, is_forced=bool(ready))

    def run(self, ways: list[Way], *, is_forced: bool = False) -> Iterator[Point]:
        """The finished points along some ways; other ends are queued by their costs."""
        ways.sort()
        nearest = inf
        while ways:
            self.search.check()
            way = heappop(ways)
            step = self._step(way)
            if isinstance(step, Point):
                yield step
            elif step is not None and self._is_new(step):
                if step.point.state is self.guide.state and not way.is_fresh:
                    for after in self._preferred(step, way.stick, way.begun):
                        heappush(ways, after)
                else:
                    nearest = min(nearest, self._land(step))
                    if len(self.ran) >= self.guide.helpful:
                        break
        self.again.extend(ways)
        if is_forced:
            self.base = max(self.base, nearest)
        self._put_off_others()

    def _step(self, way: Way) -> Point | Choice | None:
        """What a way leads to, unless another led to the same change of state."""
        search, point = self.search, way.point
        if search.is_dropped(point, way.number):
            return None
        if _begins_right(point) and point.state is self.guide.state:
            context = point.context
            assert context is not None
            key = (context.application.code, context.values)
            if key in self.ran:
                self.again.append(way._replace(number=way.number))
                return None
            self.ran.add(key)
        return self.machine.run(point)

    def _is_new(self, choice: Choice) -> bool:
        point, seen = choice.point, self.search.seen
        key = point.key if point.cuts is None else (point.key, point.cuts)
        if key in seen:
            self.search.duplicates += 1
            return False
        seen.add(key)
        return True

    def _land(self, choice: Choice) -> float:
        """Queue a choice by what is left to do at it, which is returned."""
        guide = self.search.guiding.guide(choice.point)
        node = Node(self.search.numbers, guide, self.put_off, choice=choice)
        self.search.push(guide.cost + BEGUN * guide.begun, node)
        return guide.cost

    def _put_off_others(self) -> None:
        search, guide, number = self.search, self.guide, self.search.numbers
        if self.again:
            node = Node(number, guide, self.put_off + 1, tuple(self.again))
            search.push(self.base, node)
        for choice, times in self.rest:
            node = Node(number, guide, self.put_off + times, choice=choice, is_rest=True)
            search.push(self.base, node)

    def _preferred(self, choice: Choice, stick: Stick | None, begun: int) -> list[Way]:
        """The ways on that are preferred; the others are noted in `rest`."""
        ways: list[Way] = []
        machine, frame = self.machine, choice.point.frame
        is_middle = frame is not None and frame.kind is Kind.MIDDLE
        stick = _still(stick, frame)
        machine.screen.begin(None if stick is None else stick.place, self.guide.uses_behavior)
        machine.hint.is_doubtful = False
        times = 0
        for point in choice.options:
            if is_middle and machine.hint.is_doubtful:
                times = DOUBT
                break
            if not self._prefers(point):
                times = 1
            elif is_middle:
                ways.append(self._in_middle(point, frame, stick, begun))
            else:
                ways.append(Way(begun, self.search.number(), point, stick))
        if machine.screen.end():
            times = 1
        if times:
            self.rest.append((choice, times))
        return ways

    def _prefers(self, point: Point) -> bool:
        is_used = point.context is None or self.guide.prefers(point.context)
        return is_used and not is_below_itself(point)

    def _in_middle(self, point: Point, frame: Frame | None, stick: Stick | None, begun: int) -> Way:
        """A way on among members of an M."""
        assert frame is not None
        after, number = point.frame, self.search.number()
        if after is not None and after.kind is Kind.MIDDLE and after.third is None:
            # A member is done without a change; that it is may be the wrong thing to keep.
            return Way(begun, number, point, stick, len(after.second) < len(frame.second))
        place = Stick(frame.next, self.machine.hint.place, len(frame.second))
        return Way(begun + (not _begins_right(point)), number, point, place)


def _still(stick: Stick | None, frame: Frame | None) -> Stick | None:
    """Where to go on, if the chain in which something was begun is still there."""
    if stick is None or frame is None or frame.kind is not Kind.MIDDLE:
        return None
    is_there = stick.following is frame.next and len(frame.second) == stick.size
    return stick if is_there else None


def _begins_right(point: Point) -> bool:
    """Whether the R of a member runs next."""
    return point.frame is not None and point.frame.kind is Kind.BEGIN


def is_below_itself(point: Point) -> bool:
    """Whether a behavior is begun among members on the way to itself."""
    members, path, context = begun(point)
    if context is None:
        return False
    application = context.application
    for end in range(1, len(path)):
        above = member_at(members, path[:end])
        if isinstance(above, Refined) and above.context is not None:
            other = above.context.application
            if (other.code, other.arguments) == (application.code, application.arguments):
                return True
    return False
