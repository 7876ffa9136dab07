"""An action as a controller and behaviors, one for each literal it can bring about."""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from itertools import groupby

from cdlc.frontend import syntax
from cdlc.frontend.pddl.analysis import (
    Pattern,
    atoms,
    bound_variables,
    conjunction,
    conjuncts,
    disjunction,
    reads,
    renamed,
    terms,
)
from cdlc.frontend.pddl.effects import blocks, one_a_cell
from cdlc.frontend.pddl.naming import NOWHERE, annotations
from cdlc.frontend.pddl.nodes import (
    TRUE,
    Action,
    Atom,
    Effect,
    Equal,
    Formula,
    Not,
    Number,
    Typed,
)
from cdlc.frontend.pddl.trees import Trees, literal, name, variable


@dataclass(frozen=True, slots=True)
class Dynamics:
    """What actions do: what they change, make true and make false, and what has to be false."""

    changing: frozenset[str]
    added: frozenset[Pattern]
    deleted: frozenset[Pattern]
    negated: frozenset[str]


@dataclass(frozen=True, slots=True)
class _Goal:
    """A literal that an action establishes where `condition` holds, with its own variables."""

    cell: Atom
    is_true: bool
    parameters: tuple[Typed, ...]
    condition: Formula


def definitions(action: Action, trees: Trees, dynamics: Dynamics) -> Iterator[syntax.Procedure]:
    """The controller of an action, and its behaviors.

    Raises EffectsConflictError where its effects have no order.
    """
    made = _Maker(action, trees, dynamics)
    yield made.controller()
    goals: list[_Goal | None] = [*made.goals()]
    yield from (made.behavior(goal) for goal in goals or [None])


class _Maker:
    def __init__(self, action: Action, trees: Trees, dynamics: Dynamics) -> None:
        self.action = replace(action, effects=one_a_cell(action.effects))
        action = self.action
        self.dynamics = dynamics
        self.called = trees.naming.value("action", action.name)
        typed = [*action.parameters, *bound_variables(action.precondition)]
        typed += [_of_goal(v) for effect in action.effects for v in effect.variables]
        for effect in action.effects:
            typed += [*effect.variables, *bound_variables(effect.condition)]
        names = trees.naming.variables(dict.fromkeys(t.name for t in typed))
        self.trees = trees.inside(names, typed)
        self.changes = tuple(self._effect())

    def controller(self) -> syntax.Procedure:
        """The command that the action is to a robot."""
        pddl = annotations(self.action.name, self.called)
        declared = self.trees.declared(self.action.parameters)
        return syntax.Procedure(
            "controller", name(self.called), declared, (), annotations=pddl, span=NOWHERE
        )

    # -------------------------------------------------------------------------------------- goals

    def goals(self) -> Iterator[_Goal]:
        """The literals that are worth making true with the action, each once."""
        found: dict[tuple[Atom, bool], list[Effect]] = {}
        for effect in self.action.effects:
            if effect.value is True or (
                effect.value is False and effect.cell.name in self.dynamics.negated
            ):
                found.setdefault((effect.cell, effect.value), []).append(effect)
        for (cell, is_true), effects in found.items():
            looped = {v.name: _of_goal(v) for e in effects for v in e.variables}
            own = {**looped, **{p.name: p for p in self.action.parameters}}
            parameters = tuple(own[a] for a in dict.fromkeys(cell.arguments) if a in own)
            condition = disjunction(effect.condition for effect in effects)
            if any(e.condition == TRUE for e in effects):
                condition = TRUE
            if not is_true:
                condition = conjunction(
                    part for part in (condition, *self._kept(cell)) if part != TRUE
                )
            names = {loop: variable_.name for loop, variable_ in looped.items()}
            reached = Atom(cell.name, tuple(names.get(a, a) for a in cell.arguments))
            yield _Goal(reached, is_true, parameters, renamed(condition, names))

    def _kept(self, cell: Atom) -> Iterator[Formula]:
        """For a fact that is made false: that no add of the same action makes it true again."""
        for effect in self.action.effects:
            added = effect.cell
            if effect.value is not True or effect.variables or effect.condition != TRUE:
                continue
            if self.trees.patterns.may_meet([added], [cell]):
                pairs = zip(added.arguments, cell.arguments, strict=True)
                differing = [Equal(*sorted(pair)) for pair in pairs if pair[0] != pair[1]]
                if not any(part in self._known_to_differ() for part in differing):
                    yield Not(conjunction(differing))

    def _known_to_differ(self) -> set[Formula]:
        """The equations that the precondition denies, each with its sides in order."""
        denied = (p.operand for p in conjuncts(self.action.precondition) if isinstance(p, Not))
        return {Equal(*sorted((e.left, e.right))) for e in denied if isinstance(e, Equal)}

    # ---------------------------------------------------------------------------------- behaviors

    def behavior(self, goal: _Goal | None) -> syntax.Procedure:
        """The behavior for a goal; they differ in what they are for, not in what they do."""
        sections: list[syntax.Section] = []
        parameters: tuple[Typed, ...] = ()
        if goal is not None:
            parameters = goal.parameters
            literal_ = goal.cell if goal.is_true else Not(goal.cell)
            sections.append(syntax.Goal(self.trees.formula(literal_), None, span=NOWHERE))
        sections.append(syntax.Body(tuple(self._body(goal, parameters)), span=NOWHERE))
        changes = self.changes or (syntax.Word("pass", span=NOWHERE),)
        sections.append(syntax.Effect(changes, span=NOWHERE))
        called = name(self.trees.naming.claim(self._name(goal)))
        declared = self.trees.declared(parameters)
        return syntax.Procedure("behavior", called, declared, tuple(sections), span=NOWHERE)

    def _name(self, goal: _Goal | None) -> str:
        if goal is None:
            return f"do_{self.action.name}"
        return f"{'' if goal.is_true else 'not_'}{goal.cell.name}_by_{self.action.name}"

    def _body(self, goal: _Goal | None, known: tuple[Typed, ...]) -> Iterator[syntax.Statement]:
        """Static conditions, binds for the other parameters, subgoals, and the controller."""
        parts = [part for part in conjuncts(self.action.precondition) if part != TRUE]
        static = [part for part in parts if self._is_static(part)]
        yield from self._binds(static, known)
        members = [self._achieve(part) for part in parts if part not in static]
        if goal is not None and goal.condition != TRUE:
            # The effect comes about only where this holds; the action is possible without it.
            members.append(self._achieve(goal.condition, once=True))
        if members:
            yield syntax.Promotable("sequential", tuple(members), span=NOWHERE)
        arguments = tuple(self.trees.term(p.name) for p in self.action.parameters)
        call = syntax.Call(name(self.called), arguments, bracketed=False, span=NOWHERE)
        yield syntax.CallStatement(call, has_do=True, span=NOWHERE)

    def _achieve(self, condition: Formula, *, once: bool = False) -> syntax.Statement:
        return syntax.Achieve(self.trees.formula(condition), once=once, span=NOWHERE)

    def _is_static(self, part: Formula) -> bool:
        """Whether a condition that is false cannot become true."""
        match part:
            case Atom():
                return not self._is_among(part, self.dynamics.added)
            case Not(operand=Atom() as atom):
                return not self._is_among(atom, self.dynamics.deleted)
            case _:
                return not reads(part) & self.dynamics.changing

    def _is_among(self, atom: Atom, changes: frozenset[Pattern]) -> bool:
        patterns = self.trees.patterns
        own = patterns.of(atom)
        return any(patterns.may_be(own, change) for change in changes)

    def _binds(self, static: list[Formula], known: tuple[Typed, ...]) -> Iterator[syntax.Statement]:
        """Binds, those first that most conditions restrict, each with the conditions it decides."""
        waiting = list(static)
        bound = {p.name for p in known}
        left = [p for p in self.action.parameters if p.name not in bound]
        scope = {p.name for p in self.action.parameters} | bound

        def decided(names: set[str]) -> list[Formula]:
            return [part for part in waiting if set(terms(part)) & scope <= names]

        for part in decided(bound):
            waiting.remove(part)
            yield syntax.Assert(self.trees.formula(part), span=NOWHERE)
        while left:
            chosen = max(left, key=lambda p: len(decided({*bound, p.name})))
            left.remove(chosen)
            bound.add(chosen.name)
            conditions = decided(bound)
            waiting = [part for part in waiting if part not in conditions]
            declared = self.trees.declared((chosen,))
            if conditions:
                condition = self.trees.formula(conjunction(conditions))
                yield syntax.Bind(declared, "where", condition, span=NOWHERE)
            else:
                yield syntax.Bind(declared, "free", None, span=NOWHERE)

    # ------------------------------------------------------------------------------------ effects

    def _effect(self) -> Iterator[syntax.Statement]:
        """The statements of `eff:`; first what they change and still have to know."""
        effects = self.action.effects
        plain = tuple(e for e in effects if not e.variables)
        remembered = _Remembered()
        yield from self._remember(plain, [e.cell for e in effects], remembered)
        for block in blocks(effects, self.trees.patterns):
            if not block.variables:
                yield from self._changes(block.effects, remembered)
                continue
            inner = _Remembered()
            lets = tuple(self._remember(block.effects, block.writes, inner))
            changes = tuple(self._changes(block.effects, inner))
            declared = self.trees.declared(block.variables)
            yield syntax.ForEach(declared, (*lets, *changes), span=NOWHERE)

    def _remember(
        self, effects: tuple[Effect, ...], writes: list[Atom], remembered: "_Remembered"
    ) -> Iterator[syntax.Statement]:
        """A `let` for each condition and value that the writes may change before it is used."""
        patterns = self.trees.patterns
        for effect in effects if len(effects) > 1 else ():
            condition, value = effect.condition, effect.value
            if condition not in remembered.conditions and patterns.may_meet(
                atoms(condition), writes
            ):
                remembered.conditions[condition] = chosen = self._fresh()
                yield syntax.Let(name(chosen), None, self.trees.formula(condition), span=NOWHERE)
            if isinstance(value, bool) or value in remembered.values:
                continue
            if patterns.may_meet(atoms(value), writes):
                remembered.values[value] = chosen = self._fresh()
                yield syntax.Let(name(chosen), None, self.trees.number(value), span=NOWHERE)

    def _fresh(self) -> str:
        names = dict(self.trees.variables)
        chosen = self.trees.naming.variables([*names, "?before"])["?before"]
        number = 1
        while chosen in names.values():
            number += 1
            chosen = f"before_{number}"
        self.trees = self.trees.inside({**names, f"?before'{number}": chosen}, ())
        return chosen

    def _changes(
        self, effects: tuple[Effect, ...], remembered: "_Remembered"
    ) -> Iterator[syntax.Statement]:
        for condition, together in groupby(effects, key=lambda e: e.condition):
            assigned = tuple(self._assignment(effect, remembered) for effect in together)
            if condition == TRUE:
                yield from assigned
                continue
            known = remembered.conditions.get(condition)
            test = self.trees.formula(condition) if known is None else variable(known)
            yield syntax.If(((test, assigned),), None, span=NOWHERE)

    def _assignment(self, effect: Effect, remembered: "_Remembered") -> syntax.Statement:
        value = effect.value
        if isinstance(value, bool):
            target = self.trees.call("predicate", effect.cell, bracketed=True)
            return syntax.Assignment(target, "=", literal(value), span=NOWHERE)
        target = self.trees.call("function", effect.cell, bracketed=True)
        known = remembered.values.get(value)
        amount = self.trees.number(value) if known is None else variable(known)
        return syntax.Assignment(target, effect.operator, amount, span=NOWHERE)


def _of_goal(looped: Typed) -> Typed:
    """The parameter of a behavior for a variable that the effect loops over."""
    return Typed(f"{looped.name}'goal", looped.type)


@dataclass(slots=True)
class _Remembered:
    """The variables that hold conditions and values from before the effect."""

    conditions: dict[Formula, str] = field(default_factory=dict)
    values: dict[Number, str] = field(default_factory=dict)
