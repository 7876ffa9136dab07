"""Values found for unknowns, put in where those stand: in states and in what is left to do."""

from collections.abc import Mapping
from typing import Any

from crow.search.frames import Application, Context, Frame, Nested, Open, Refined, Shared
from crow.search.points import Point
from crow.search.states import Snapshot
from crow.unknowns import Unknown, has_unknown, resolved
from crow.values import Value


class Substitution:
    """Replaces unknowns by values in the data of one search; what has none of them stays itself."""

    def __init__(self, shared: Shared, values: Mapping[Unknown, Value]) -> None:
        self.shared = shared
        self.values = values
        self._made: dict[int, tuple[Any, Any]] = {}

    def point(self, point: Point) -> Point:
        """The point, its trail apart: that is replaced once it is read."""
        state, context, frame = map(self.of, (point.state, point.context, point.frame))
        return point._replace(state=state, context=context, frame=frame)

    def of(self, thing: Any) -> Any:
        """A part of a point, or an event of its trail."""
        match thing:
            case Unknown():
                return self.values.get(thing, thing)
            case tuple() | Frame() | Context() | Application() | Open() | Refined() | Nested():
                known = self._made.get(id(thing))
                if known is None:
                    # With the thing itself, so that no other one gets its identity.
                    known = self._made[id(thing)] = thing, self._changed(thing)
                return known[1]
            case Snapshot():
                return self._state(thing)
            case _:
                return thing

    def _changed(self, thing: Any) -> Any:
        of, shared = self.of, self.shared
        match thing:
            case tuple():
                new = tuple(map(of, thing))
                return thing if all(map(_is, new, thing)) else new
            case Frame():
                return self._frames(thing)
            case Context(application=application, values=values, held=held):
                return shared.context(of(application), of(values), of(held))
            case Application(code=code, arguments=arguments, depth=depth, nested=nested):
                return shared.application(code, of(arguments), depth, nested)
            case Open():
                made = shared.open(
                    of(thing.what), of(thing.values), of(thing.application), thing.depth,
                    thing.after,
                )  # fmt: skip
                return made if thing.may_be_null else shared.tried(made)
            case Refined(context=context, children=children, after=after):
                return shared.refined(of(context), of(children), of(after))
            case Nested(members=members):
                return shared.nested(of(members))
            case _:
                raise AssertionError(thing)

    def _frames(self, frame: Frame) -> Frame | None:
        """A frame and those after it, without recursion: there may be thousands."""
        chain: list[Frame] = []
        here: Frame | None = frame
        while here is not None:
            chain.append(here)
            here = here.next
        following: Frame | None = None
        for old in reversed(chain):
            parts = [self.of(part) for part in (old.first, old.second, old.third)]
            following = self.shared.frame(old.kind, following, *parts)
        return following

    def _state(self, state: Snapshot) -> Snapshot:
        written = {c: v for c, v in state.delta.items() if has_unknown(v)}
        if not written:
            return state
        return state.store.after(state, ((c, resolved(v, self.values)) for c, v in written.items()))


def _is(left: object, right: object) -> bool:
    return left is right
