"""Behaviors that achieve something after they have acted: one transition a phase (lowering.md §2).

What other behaviors do in between stands between the phases in a plan. That a phase is open, with
the values of its variables, is a feature: the phase before sets it, the next one needs and ends it.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

from cdlc.backends.pddl.sexpr import NotPddl
from cdlc.backends.pddl.straight import (
    EFFECT,
    Body,
    acts,
    declared,
    effect_of,
    has_choice,
    straight_bodies,
)
from cdlc.ir.behaviors import achieved_in, applied_for, disturbed, parts_of
from crow.program import (
    BOOL,
    Achieve,
    Assert,
    Assign,
    Behavior,
    Bind,
    Call,
    Constant,
    Expression,
    Feature,
    ForEach,
    ForRange,
    Group,
    If,
    Let,
    Not,
    Parameter,
    Program,
    Read,
    Statement,
    Variable,
)
from crow.program.types import is_object
from crow.program.walk import free_variables, statements_within

TRUE, FALSE = (Constant(value, BOOL) for value in (True, False))


@dataclass(frozen=True, slots=True, eq=False)
class Open:
    """That a phase is over and the next one is not: `feature` of the variables that are objects.

    `values` keep those that are not, each in a feature of the same parameters. `locals` are the
    names of those that are neither parameters nor binds.
    """

    feature: Feature
    variables: tuple[Parameter, ...]
    values: tuple[tuple[Parameter, Feature], ...]
    locals: frozenset[str]

    @property
    def all(self) -> tuple[Parameter, ...]:
        """The variables that are handed on."""
        return (*self.variables, *(variable for variable, _ in self.values))

    @property
    def features(self) -> tuple[Feature, ...]:
        """What it takes to say so."""
        return (self.feature, *(feature for _, feature in self.values))

    def read(self, feature: Feature) -> Read:
        """One of the features, of the variables."""
        return Read(feature.name, self._arguments, feature.type)

    def write(self, feature: Feature, value: Expression) -> Assign:
        """One of the features, of the variables, set."""
        return Assign(feature.name, self._arguments, "=", value)

    @property
    def _arguments(self) -> tuple[Expression, ...]:
        return tuple(Variable(v.name, v.type) for v in self.variables)


@dataclass(frozen=True, slots=True, eq=False)
class Phase:
    """A stretch of a way through a body of `whole`, alone as a behavior."""

    whole: Behavior
    behavior: Behavior
    needs: Open | None = None
    gives: Open | None = None

    @property
    def applied(self) -> Behavior:
        """What it does in the program's own world, to `apply`."""
        behavior = self.behavior
        if not _has_unfolded(behavior.left):
            return behavior
        # What a called behavior demands need not hold any longer than the call, so nothing is held.
        ending = effect_of(self.whole)
        named = tuple(Variable(p.name, p.type) for p in ending.parameters)
        called = () if self.gives is not None else (Call(ending.name, named),)
        return replace(behavior, left=(*behavior.left, *called), effect=None)

    @property
    def kept(self) -> Behavior:
        """The phase with the features that keep the order of phases."""
        behavior, needs, gives = self.behavior, self.needs, self.gives
        if needs is None and gives is None:
            return behavior
        left, effect = behavior.left, behavior.effect or ()
        parameters = behavior.parameters
        if needs is not None:
            values = (Let(v, needs.read(f)) for v, f in needs.values)
            left = (Assert(needs.read(needs.feature)), *values, *left)
            effect = (needs.write(needs.feature, FALSE), *effect)
            parameters = needs.variables
        if gives is not None:
            # Two that are open at once would be one.
            left = (*left, Assert(Not(gives.read(gives.feature))))
            values_kept = (gives.write(f, Variable(v.name, v.type)) for v, f in gives.values)
            opened = gives.write(gives.feature, TRUE)
            effect = (*effect, opened, *values_kept)
        return replace(behavior, parameters=parameters, left=left, effect=effect)


def phases(program: Program, behavior: Behavior) -> tuple[Phase, ...]:
    """The phases of every way through a behavior with an effect, in order of the ways.

    A behavior with one way and one phase is that phase. Raises NotPddl for one that may occur in
    itself while a phase is open, or has too many ways.
    """
    bodies = straight_bodies(program, behavior)
    stretches = [_stretches(program, behavior, body) for body in bodies]
    is_straight = (
        len(bodies) == 1 and not _has_unfolded(bodies[0]) and not has_choice(behavior.body)
    )
    if is_straight and len(stretches[0]) == 1:
        return (Phase(behavior, behavior),)
    for stretch in (s for way in stretches for s in way[1:]):
        if behavior in applied_for(program, achieved_in(program, tuple(stretch))):
            construct = (
                f"`{behavior.name}`, which achieves something after it has acted and may be applied"
                " for that itself,"
            )
            cure = "move the `achieve` before the first `do`, or what follows to another behavior"
            raise NotPddl(construct, behavior.location, cure)
    found: list[Phase] = []
    for way in stretches:
        found += _phases(program, behavior, way, len(found))
    return tuple(found)


def called_effects(program: Program) -> tuple[Behavior, ...]:
    """What phases may call that the program has not: effects of its behaviors, alone."""
    return tuple(effect_of(b) for b in program.behaviors if b.effect is not None)


# -------------------------------------------------------------------------------------- stretches


def _stretches(program: Program, behavior: Behavior, body: Body) -> list[list[Statement]]:
    """A way through a body, cut before each `achieve` that follows a `do`, or that may change what
    a local has read which is used later.
    """
    found: list[list[Statement]] = [[]]
    has_acted, locals_ = False, dict[str, Let]()
    for position, statement in enumerate(body):
        conditions = tuple(achieved_in(program, (statement,)))
        if conditions:
            later = used_in((*body[position:], *(behavior.effect or ())))
            stale = (n for n in later & locals_.keys() if _ages(program, n, locals_, conditions))
            if has_acted or next(stale, None) is not None:
                held = [] if has_acted else _held(found[-1])
                found.append(held)
                has_acted, locals_ = False, {}
        found[-1].append(statement)
        if isinstance(statement, Let):
            locals_[statement.variable.name] = statement
        has_acted = has_acted or acts(statement)
    return found


def _ages(
    program: Program, name: str, locals_: dict[str, Let], conditions: tuple[Expression, ...]
) -> bool:
    """Whether plans for conditions may change what a local was made of."""
    pending, seen = [name], set[str]()
    while pending:
        let = locals_.get(pending.pop())
        if let is None or let.variable.name in seen:
            continue
        seen.add(let.variable.name)
        if disturbed(program, (let,), conditions):
            return True
        pending += free_variables(let.value)
    return False


def _held(stretch: list[Statement]) -> list[Statement]:
    """What a stretch without a `do` has demanded, which is to hold still at the next one."""
    return [again for statement in stretch for again in _again(statement)]


def _again(node: Statement) -> Iterator[Statement]:
    match node:
        case Assert() | Achieve(once=True):
            yield from (node,) if isinstance(node, Assert) else ()
        case Achieve(condition=condition):
            yield Assert(condition, location=node.location)
        case Bind(condition=condition) if condition is not None:
            yield Assert(condition, location=node.location)
        case Group(body=body) | ForEach(body=body) | ForRange(body=body):
            inner = tuple(again for part in body for again in _again(part))
            if inner:
                yield replace(node, body=inner)
        case If():
            construct = "an `if` before an `achieve` that may change a local read before it"
            raise NotPddl(construct, node.location, "put the `if` after the `achieve`")
        case _:
            return


def used_in(statements: tuple[Statement, ...]) -> set[str]:
    """The names of variables that statements mention."""
    return {part.name for part in parts_of(statements) if isinstance(part, Variable)}


# ----------------------------------------------------------------------------------------- phases


def _phases(
    program: Program, behavior: Behavior, way: list[list[Statement]], before: int
) -> Iterator[Phase]:
    """The phases of one way; `before` are those of other ways, for names."""
    known = list(behavior.parameters)
    needs: Open | None = None
    lets = (s.variable.name for stretch in way for s in stretch if isinstance(s, Let))
    locals_ = frozenset(lets)
    for number, stretch in enumerate(way, 1):
        name = f"{behavior.name}'{before + number}"
        known += [v for statement in stretch for v in declared(statement)]
        rest = [s for later in way[number:] for s in later]
        gives = None if number == len(way) else _open(name, behavior, known, locals_, rest)
        parameters = behavior.parameters if needs is None else needs.all
        effect = (behavior.effect or ()) if gives is None else ()
        starts = (s.location for s in stretch if next(achieved_in(program, (s,)), None) is not None)
        place = behavior.location if number == 1 else next(starts, None)
        phase = Behavior(name, parameters, None, tuple(stretch), None, (), effect, location=place)
        yield Phase(behavior, phase, needs, gives)
        needs = gives
        known = list(gives.all) if gives is not None else known


def _open(
    name: str,
    behavior: Behavior,
    known: Iterable[Parameter],
    locals_: frozenset[str],
    rest: list[Statement],
) -> Open:
    """What is handed on to the rest: arguments and binds, and the locals that it uses."""
    used = used_in((*rest, *(behavior.effect or ())))
    own = {p.name for p in behavior.parameters}
    variables: list[Parameter] = []
    values: list[Parameter] = []
    for variable in {v.name: v for v in known}.values():
        if variable.name not in own and variable.name not in used:
            continue
        (variables if is_object(variable.type) else values).append(variable)
    parameters = tuple(variables)
    kept = tuple((v, Feature(f"{name}-{v.name}", parameters, v.type)) for v in values)
    return Open(Feature(name, parameters, BOOL), parameters, kept, locals_)


def _has_unfolded(body: Iterable[Statement]) -> bool:
    return any(isinstance(s, Call) and s.behavior.endswith(EFFECT) for s in statements_within(body))
