"""Plans of the runtime as plans of the emitted PDDL, for others to validate (lowering.md §2).

A trace is cut where controllers and effects end. A stretch between two cuts is a step of an action
if the triple behind the action makes the calls of the stretch, holds before it, and writes what the
trace has after it. A called behavior is part of its caller's action, so a stretch may have several
effects; a phase that only remembers something has no stretch at all.
"""

from collections import ChainMap
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import product
from typing import cast

from cdlc.backends.engines import PddlStep
from cdlc.backends.pddl.actions import Action, Source
from cdlc.backends.pddl.emit import PddlTask
from cdlc.backends.pddl.instances import Known, Stretch, Values, instances
from crow.plan import Result, Step
from crow.problem import Cell, Problem, State, World
from crow.replay import replay
from crow.trace import DoItem, EffItem
from crow.values import Value, default_value

# Places looked at; one a transition of the plan is usual.
_MOST_PLACES = 20_000

Open = frozenset[tuple[Cell, Value]]
"""The phases that are open, by what PDDL says of them."""


class NoAction(Exception):  # noqa: N818 - a fault of ours, not of the input
    """A stretch of a runtime plan that no action of the emitted PDDL stands for."""


class TooManyWays(Exception):  # noqa: N818 - a limit
    """A plan that may be cut into actions in too many ways to try."""


@dataclass(frozen=True, slots=True)
class _Cut:
    """A place in a trace: the state, and how many calls have been made.

    `ended` is the behavior whose effect ends here, `step` the one whose controller's does; `known`
    are the variables of either, as far as the plan tells them.
    """

    state: State
    calls: int
    ended: str | None = None
    step: str | None = None
    known: Known = field(default_factory=dict)


def to_pddl_plan(task: PddlTask, problem: Problem, plan: Result) -> tuple[PddlStep, ...]:
    """The steps of the emitted task that a plan of the runtime takes.

    `plan` is a Result with status plan and its trace. Raises NoAction at the first place that
    cannot be reached by actions, and TooManyWays.
    """
    cuts = tuple(_cuts(problem.world, problem.initial, plan))
    calls = tuple(item for item in plan.trace if isinstance(item, DoItem))
    return _Search(task, problem, cuts, calls).run()


# --------------------------------------------------------------------------------------------- cuts


def _cuts(world: World, initial: State, plan: Result) -> Iterator[_Cut]:
    """The initial state, and the place after each controller and effect."""
    states = replay(world, initial, plan.trace).states
    acting = [step for step in plan.steps if step.controller is not None]
    silent = [step for step in plan.steps if step.controller is None]
    begun: dict[str, int] = {}
    calls = 0
    yield _Cut(initial, 0)
    following = [*plan.trace[1:], None]
    for index, (item, after) in enumerate(zip(plan.trace, following, strict=True)):
        cut = _Cut(states[index + 1], calls)
        match item:
            case DoItem(controller=name):
                calls += 1
                if not (isinstance(after, EffItem) and after.owner == name):
                    yield _of_step(world, replace(cut, calls=calls), acting[calls - 1])
            case EffItem(owner=name) if _is_controller_s(plan, index):
                yield _of_step(world, cut, acting[calls - 1])
            case EffItem(owner=name):
                own = [s for s in acting[begun.get(name, 0) : calls] if s.behavior == name]
                begun[name] = calls
                found = own[-1] if own else next((s for s in silent if s.behavior == name), None)
                if not own and found is not None:
                    silent.remove(found)
                known = {} if found is None else _known(world, found)
                yield replace(cut, ended=name, known=known)
            case _:
                pass


def _is_controller_s(plan: Result, index: int) -> bool:
    item, before = plan.trace[index], plan.trace[index - 1] if index else None
    return (
        isinstance(item, EffItem) and isinstance(before, DoItem) and before.controller == item.owner
    )


def _of_step(world: World, cut: _Cut, step: Step) -> _Cut:
    return replace(cut, step=step.behavior, known=_known(world, step))


def _known(world: World, step: Step) -> Known:
    names = [p.name for p in world.behaviors[step.behavior].parameters]
    return {**dict(zip(names, step.behavior_arguments, strict=True)), **step.bindings}


# ------------------------------------------------------------------------------------------- search


@dataclass(frozen=True, slots=True)
class _Place:
    """How far a plan has come: the cut, and the phases that are open."""

    index: int
    open: Open = frozenset()


_Move = tuple[PddlStep, _Place]


@dataclass
class _Search:
    """Looks for a way from the first cut to the last, depth first."""

    task: PddlTask
    problem: Problem
    cuts: tuple[_Cut, ...]
    calls: tuple[DoItem, ...]

    @cached_property
    def world(self) -> World:
        """The world with the features that say which phases are open."""
        return replace(self.problem.world, program=self.task.program)

    @cached_property
    def own(self) -> frozenset[str]:
        """The names of the program's features."""
        return frozenset(self.problem.world.features)

    @cached_property
    def sources(self) -> list[tuple[Action, Source]]:
        """What actions stand for."""
        return [(action, source) for action in self.task.actions for source in action.sources]

    @cached_property
    def most_calls(self) -> int:
        """The most calls of an action."""
        return max((len(source.triple.calls) for _, source in self.sources), default=0)

    def run(self) -> tuple[PddlStep, ...]:
        """The steps of the first way. Raises NoAction and TooManyWays."""
        start = _Place(0)
        path: list[PddlStep] = []
        stack = [self._moves(start)]
        seen = {start}
        if self._is_end(start):
            return ()
        while stack:
            move = next(stack[-1], None)
            if move is None:
                stack.pop()
                del path[max(0, len(stack) - 1) :]
            elif move[1] not in seen:
                step, place = move
                seen.add(place)
                path.append(step)
                if self._is_end(place):
                    return tuple(path)
                if len(seen) > _MOST_PLACES:
                    raise TooManyWays("the program's plan may be cut into actions in too many ways")
                stack.append(self._moves(place))
        raise NoAction(self._failure(max(place.index for place in seen)))

    def _is_end(self, place: _Place) -> bool:
        return place.index == len(self.cuts) - 1 and not any(
            value is True for _, value in place.open
        )

    def _failure(self, reached: int) -> str:
        following = (cut for cut in self.cuts[reached + 1 :] if cut.ended or cut.step)
        cut = next(following, self.cuts[reached])
        values = ", ".join(f"{name}={value}" for name, value in cut.known.items())
        name = cut.ended or cut.step
        what = "the end" if name is None else f"`{name}({values})`"
        return f"no action of the emitted PDDL stands for {what}, after {reached} effects or calls"

    def _moves(self, place: _Place) -> Iterator[_Move]:
        """The steps from a place: those of a stretch, the shortest first, then those of none."""
        for end in range(place.index + 1, len(self.cuts)):
            made = self.cuts[end].calls - self.cuts[place.index].calls
            if made > self.most_calls:
                break
            for action, source in self.sources:
                if len(source.triple.calls) == made:
                    yield from self._taken(place, end, action, source)
        for action, source in self.sources:
            if source.part.gives is not None and not source.triple.calls:
                yield from self._taken(place, place.index, action, source)

    def _taken(self, place: _Place, end: int, action: Action, source: Source) -> Iterator[_Move]:
        """The ways in which an action takes a stretch."""
        before, after = self.cuts[place.index], self.cuts[end]
        cells = cast("dict[Cell, object]", before.state.cells)
        state = State(ChainMap(dict[Cell, object](place.open), cells))
        made = self.calls[before.calls : after.calls]
        stretch = Stretch(self.world, self.own, state, made, after.state)
        for known in self._known(place, end, source):
            for values, written in instances(source, action, known, stretch):
                yield self._step(action, source, values), _Place(end, self._opened(place, written))

    def _step(self, action: Action, source: Source, values: Values) -> PddlStep:
        names = self.task.names
        return PddlStep(action.name, tuple(names.get("object", values[n]) for n in source.order))

    def _opened(self, place: _Place, written: Mapping[Cell, Value]) -> Open:
        """The open phases after something was written; cells with their default are left out."""
        cells = {**dict(place.open), **written}
        types = {name: f.type for name, f in self.world.features.items()}
        return frozenset(
            (cell, value) for cell, value in cells.items() if value != default_value(types[cell[0]])
        )

    def _known(self, place: _Place, end: int, source: Source) -> Iterator[Known]:
        """What may be known of the variables of a part that ends at a cut; nothing if it cannot.

        A phase that is not the last belongs to an effect that is still to come.
        """
        part, cut = source.part, self.cuts[end]
        name = source.behavior
        begun = self._begun(place, source)
        if part.gives is not None:
            later = (c.known for c in self.cuts[end + 1 :] if c.ended == name)
            distinct = {tuple(known.items()): known for known in later}
            yield from _joined(begun, distinct.values())
        elif part.whole.effect is None:
            yield from (cut.known, {}) if cut.step == name else ()
        elif cut.ended == name:
            yield from _joined(begun, (cut.known, {}))

    def _begun(self, place: _Place, source: Source) -> list[Known]:
        """The variables of each open phase that a part goes on with."""
        needs = source.part.needs
        if needs is None:
            return [{}]
        return [
            dict(zip((v.name for v in needs.variables), where, strict=True))
            for (feature, where), _ in place.open
            if feature == needs.feature.name
        ]


def _joined(begun: Iterable[Known], known: Iterable[Known]) -> Iterator[Known]:
    """Each two that do not contradict one another, as one."""
    for first, second in product(begun, known):
        if all(second.get(name, value) == value for name, value in first.items()):
            yield {**second, **first}
