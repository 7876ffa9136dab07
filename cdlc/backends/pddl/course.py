"""Carrying out the steps of a plan, one part of a behavior after another."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

from cdlc.backends.pddl.parts import Part
from cdlc.backends.pddl.phases import Open, called_effects
from cdlc.backends.pddl.plans import PlannedTransition
from cdlc.backends.pddl.straight import EFFECT
from crow.plan import Step
from crow.problem import State, World
from crow.trace import DoItem, EffItem, TraceItem
from crow.transition import Transition, Unmet, apply
from crow.values import Value

Key = tuple[str, tuple[Value, ...]]


@dataclass(frozen=True, slots=True)
class Begun:
    """A behavior between two phases, with the values it goes on with."""

    behavior: str
    values: Mapping[str, Value]


@dataclass(frozen=True)
class Course:
    """A plan on its way: the state, and what has begun and not ended, by what PDDL says of it."""

    world: World
    state: State
    begun: Mapping[Key, Begun] = field(default_factory=dict)

    def after(self, planned: PlannedTransition) -> tuple[Transition, "Course"]:
        """What a transition does, and the course after it: the same one if that is a problem."""
        part = planned.part
        names = [p.name for p in part.whole.parameters]
        values: dict[str, Value] = dict(zip(names, planned.arguments, strict=True))
        values |= planned.bindings
        begun = dict(self.begun)
        if part.needs is not None:
            before = begun.pop(_key(part.needs, values), None)
            if before is None:
                return self._unmet(part, "the phase before this one has not been"), self
            values |= before.values
        arguments = tuple(values[p.name] for p in part.applied.parameters)
        applied = apply(self._inside, self.state, part.applied, arguments, planned.bindings)
        if applied.problem is not None:
            return applied, self
        if part.gives is not None:
            values |= applied.variables
            key = _key(part.gives, values)
            if key in begun:
                return self._unmet(part, "it has begun already and not ended"), self
            begun[key] = Begun(part.whole.name, {v.name: values[v.name] for v in part.gives.all})
        made = replace(applied, trace=tuple(_own(applied, part)))
        return made, replace(self, state=applied.state, begun=begun)

    def _unmet(self, part: Part, reason: str) -> Transition:
        unmet = Unmet(part.whole.name, reason, part.behavior.location)
        return Transition((), self.state, {}, unmet)

    def begun_for(
        self, part: Part, arguments: tuple[Value, ...], bindings: Mapping[str, Value]
    ) -> Iterator[PlannedTransition]:
        """The transitions of a part that a step with these arguments and binds may stand for."""
        if part.needs is None:
            yield PlannedTransition(part, arguments, bindings)
            return
        names = [p.name for p in part.whole.parameters]
        given = {**dict(zip(names, arguments, strict=True)), **bindings}
        for (feature, _), begun in self.begun.items():
            values = begun.values
            if feature == part.needs.feature.name and all(
                values.get(name, value) == value for name, value in given.items()
            ):
                others = {n: v for n, v in values.items() if n not in names}
                yield PlannedTransition(part, arguments, {**others, **bindings})

    @cached_property
    def _inside(self) -> World:
        """The world with what parts may call."""
        program = self.world.program
        behaviors = (*program.behaviors, *called_effects(program))
        return replace(self.world, program=replace(program, behaviors=behaviors))


def steps_of(planned: PlannedTransition, applied: Transition) -> list[Step]:
    """The steps of an applied transition, one a controller call."""
    calls = [item for item in applied.trace if isinstance(item, DoItem)]
    part, bindings = planned.part, dict(applied.bindings)
    if part.applied is not part.whole:
        locals_ = frozenset[str]() if part.needs is None else part.needs.locals
        known = {n: v for n, v in planned.bindings.items() if n not in locals_}
        bindings = {**known, **bindings}
    own = (part.whole.name, planned.arguments, bindings)
    if not calls:
        return [Step(*own, None, (), planned.also)]
    return [Step(*own, call.controller, call.arguments, planned.also) for call in calls]


def _key(open_: Open, values: Mapping[str, Value]) -> Key:
    return open_.feature.name, tuple(values[v.name] for v in open_.variables)


def _own(applied: Transition, part: Part) -> Iterator[TraceItem]:
    """The trace of a part as one of its behavior, without effects that are only the part's."""
    for item in applied.trace:
        if not isinstance(item, EffItem):
            yield item
            continue
        owner = item.owner.removesuffix(EFFECT)
        if owner == part.applied.name and part.applied is not part.whole:
            if part.whole.effect is None or part.gives is not None:
                continue
            owner = part.whole.name
        yield replace(item, owner=owner)
