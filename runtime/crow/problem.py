"""A planning problem: a program with objects, an initial state and a goal."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields
from functools import cached_property
from itertools import product
from typing import TYPE_CHECKING, Any

from crow.functions import NOTHING, Registered
from crow.program import (
    BOOL,
    Constant,
    Controller,
    Expression,
    Feature,
    Function,
    Hierarchy,
    ObjectType,
    Parameter,
    ProblemStatement,
    Program,
    Type,
)
from crow.program.definitions import Behavior
from crow.registration import with_effects
from crow.unknowns import is_same
from crow.values import Value, default_value

if TYPE_CHECKING:
    from crow.domain import Domain
    from crow.externals import Externals
    from crow.stated import CellName
    from crow.support import Unsupported

TRUE = Constant(value=True, type=BOOL)
"""A goal that is reached already."""


@dataclass(frozen=True)
class World:
    """What stays the same in every state: the program and the objects, constants first.

    `registered` is the Python that is given for the program.
    """

    program: Program
    objects: Mapping[str, ObjectType]
    registered: Registered = NOTHING

    @staticmethod
    def of(
        program: Program, objects: tuple[Parameter, ...] = (), registered: Registered = NOTHING
    ) -> "World":
        """The world of a program with the objects of one problem."""
        declared = [(c.name, c.type) for c in program.constants]
        declared += [(o.name, o.type) for o in objects]
        own = {n: t for n, t in declared if isinstance(t, ObjectType)}
        return World(with_effects(program, registered), own, registered)

    def __getstate__(self) -> dict[str, object]:
        # What was found out about a world is not sent along: compiled programs cannot be.
        return {own.name: getattr(self, own.name) for own in fields(self)}

    @cached_property
    def externals(self) -> "Externals":
        """The Python of the program, ready to be called."""
        from crow.externals import Externals

        return Externals(self)

    @cached_property
    def kept(self) -> dict[str, Any]:
        """What planning has computed about the world and may use again; never pickled."""
        return {}

    @cached_property
    def hierarchy(self) -> Hierarchy:
        """The object types as a tree."""
        return Hierarchy.of(self.program.types)

    @cached_property
    def features(self) -> Mapping[str, Feature]:
        """Features by name."""
        return {f.name: f for f in self.program.features}

    @cached_property
    def defaults(self) -> Mapping[str, object]:
        """What the cells of each feature hold that `init` does not set; None where it has to."""
        return {f.name: default_value(f.type) for f in self.program.features}

    @cached_property
    def has_bounds(self) -> bool:
        """Whether the values of any feature are bounded."""
        return any(f.bounds != (None, None) for f in self.program.features)

    @cached_property
    def unsupported(self) -> "Unsupported | None":
        """What the program needs that no engine has, looked for once."""
        from crow.support import unsupported

        return unsupported(self.program, self.registered.functions.keys())

    @cached_property
    def chosen_value(self) -> "Unsupported | None":
        """The first place where the program binds a value, looked for once."""
        from crow.support import chosen_value

        return chosen_value(self.program)

    @cached_property
    def functions(self) -> Mapping[str, Function]:
        """Functions by name."""
        return {f.name: f for f in self.program.functions}

    @cached_property
    def controllers(self) -> Mapping[str, Controller]:
        """Controllers by name."""
        return {c.name: c for c in self.program.controllers}

    @cached_property
    def behaviors(self) -> Mapping[str, Behavior]:
        """Behaviors by name."""
        return {b.name: b for b in self.program.behaviors}

    def objects_of(self, type_: Type) -> tuple[str, ...]:
        """The objects of a type and its subtypes, in order of declaration."""
        found = self._domains.get(type_)
        if found is None:
            is_subtype = self.hierarchy.is_subtype
            own_types = {own.name: own for own in self.objects.values()}
            fits = {name: is_subtype(own, type_) for name, own in own_types.items()}
            found = tuple(name for name, own in self.objects.items() if fits[own.name])
            self._domains[type_] = found
        return found

    @cached_property
    def _domains(self) -> dict[Type, tuple[str, ...]]:
        return {}

    def is_of(self, name: object, type_: Type) -> bool:
        """Whether an object of that name exists and is of the type."""
        own = self.objects.get(name) if isinstance(name, str) else None
        return own is not None and self.hierarchy.is_subtype(own, type_)

    def cells(self, feature: Feature) -> Iterator[tuple[str, ...]]:
        """Every tuple of objects that a feature has a value for, in order of declaration."""
        return product(*(self.objects_of(p.type) for p in feature.parameters))

    def updated(self, state: "State", changes: Mapping["Cell", object]) -> "State":
        """The state after some cells changed."""
        cells = {**state.cells, **changes}
        for (feature, arguments), value in changes.items():
            if is_same(value, self.defaults[feature]):
                del cells[feature, arguments]
        return State(cells)


Cell = tuple[str, tuple[str, ...]]
"""A feature with the names of its arguments."""


@dataclass(frozen=True, slots=True)
class State:
    """The value of each cell that differs from its default; never changed in place."""

    cells: Mapping[Cell, object] = field(default_factory=dict)


@dataclass(frozen=True, init=False)
class Problem:
    """Objects, initial state and goal (§2); `minimize` is the cost of the final state, if any."""

    name: str
    world: World
    initial: State
    goal: Expression
    minimize: Expression | None = None

    def __init__(
        self,
        domain: "Domain",
        objects: Mapping[str, str] | None = None,
        init: "Mapping[CellName, Value] | None" = None,
        goal: str | Expression = TRUE,
        *,
        values: Mapping[str, Value] | None = None,
        minimize: str | Expression | None = None,
        name: str = "problem",
    ) -> None:
        """State a problem of a domain.

        `objects` has the type of each object. `init` has values by cells, `"on(a, b)"` or
        `("on", ("a", "b"))`; what it does not set is false or 0. `goal` and `minimize` are CDL
        text, or expressions; `values` are names with values that the text may use.

        Raises crow.ProblemError for what does not fit the domain, and for text where the domain was
        not loaded by a compiler.
        """
        from crow.stated import expression_of, state_of, world_of

        world = world_of(domain.program, objects or {}, domain.functions)
        given = values or {}
        made = Problem.made(
            name,
            world,
            state_of(world, init or {}),
            expression_of(domain, goal, world, given),
            None
            if minimize is None
            else expression_of(domain, minimize, world, given, is_number=True),
        )
        if domain.language is not None:
            made = domain.language.prepared(made)
        self.__dict__.update(made.__dict__)

    @cached_property
    def is_imperative(self) -> bool:
        """Whether the program leaves nothing to search on the way to the goal; found out once."""
        from crow.search.imperative import is_imperative

        return is_imperative(self)

    @classmethod
    def made(
        cls,
        name: str,
        world: World,
        initial: State,
        goal: Expression,
        minimize: Expression | None = None,
    ) -> "Problem":
        """A problem of parts that fit together."""
        problem = cls.__new__(cls)
        problem.__dict__.update(
            name=name, world=world, initial=initial, goal=goal, minimize=minimize
        )
        return problem

    def changed(
        self,
        *,
        world: World | None = None,
        initial: State | None = None,
        goal: Expression | None = None,
        minimize: Expression | None = None,
    ) -> "Problem":
        """The problem with some parts changed; None leaves a part as it is."""
        return Problem.made(
            self.name,
            world or self.world,
            initial or self.initial,
            goal or self.goal,
            minimize or self.minimize,
        )

    @staticmethod
    def of(
        program: Program, statement: ProblemStatement, registered: Registered = NOTHING
    ) -> "Problem":
        """The problem that a problem file states.

        Raises crow.evaluate.EvaluationError when its `init` cannot be computed, and
        crow.FunctionError where Python that it needs fails.
        """
        from crow.evaluate import check_unset, execute

        world = World.of(program, statement.objects, registered)
        initial = execute(world, State(), statement.init, {})
        check_unset(world, initial.cells)
        return Problem.made(statement.name, world, initial, statement.goal, statement.minimize)
