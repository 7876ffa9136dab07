"""A counterexample for people: as little of it as will do, and what is wrong in it."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from cdlc.diagnostics import Label
from cdlc.verify.situation import Opaque, Situation, Table, changed_cells, literal
from crow.evaluate import assignments_of
from crow.plan import call_text
from crow.problem import Cell, State
from crow.program import (
    OBJECT,
    And,
    Apply,
    Compare,
    Constant,
    Expression,
    Feature,
    Not,
    Object,
    Or,
    Quantified,
    Read,
    Return,
    Type,
    Variable,
)
from crow.program.rewrite import substitute
from crow.program.types import is_object
from crow.program.walk import free_variables, subexpressions
from crow.text import expression_text
from crow.values import Value, shown

_MOST_TRIALS = 2_000


@dataclass(frozen=True, slots=True)
class FalsePart:
    """A part of a goal that is false, for the objects at hand; `cell` where it is one."""

    text: str
    finding: str
    cell: Cell | None = None


@dataclass(frozen=True, slots=True)
class Counterexample:
    """A situation that the interpreter has confirmed, and the parts of the goal false in it."""

    situation: Situation
    false_parts: tuple[FalsePart, ...] = ()

    @property
    def call(self) -> str:
        """The behavior with its arguments and binds."""
        return call_text(
            self.situation.way.behavior.name, self.situation.arguments, self.situation.bindings
        )

    @property
    def controllers(self) -> tuple[str, ...]:
        """The controller calls that the behavior runs."""
        return tuple(call_text(c.controller, c.arguments, {}) for c in self.situation.ran.calls)

    def objects(self) -> tuple[str, ...]:
        """The objects by type, as `objects:` has them."""
        by_type: dict[str, list[str]] = {}
        for o in self.situation.objects:
            by_type.setdefault(str(o.type), []).append(o.name)
        return tuple(f"{', '.join(names)}: {type_}" for type_, names in by_type.items())

    def state(self) -> tuple[str, ...]:
        """The state, as `init:` has it: what is not False or 0."""
        world = self.situation.world
        cells = self.situation.state.cells
        return tuple(
            f"{_cell_text((feature.name, where))} = {_shown(cells[feature.name, where], feature)}"
            for feature in world.program.features
            for where in world.cells(feature)
            if (feature.name, where) in cells
        )

    def functions(self) -> tuple[str, ...]:
        """What external functions are taken to return."""
        return tuple(
            line
            for function in self.situation.program.functions
            if function.name in self.situation.tables and function.name in self._called()
            for line in _table_lines(
                function.name,
                [p.type for p in function.parameters],
                function.type,
                self.situation.tables[function.name],
            )
        )

    def _called(self) -> frozenset[str]:
        formulas = (*self.situation.triple.pre, *self._written())
        goal = self.situation.way.behavior.goal
        nodes = (n for f in (*formulas, *([goal] if goal else [])) for n in subexpressions(f))
        return frozenset(n.function for n in nodes if isinstance(n, Apply))

    def _written(self) -> Iterator[Expression]:
        for update in self.situation.triple.post:
            yield from (*update.arguments, update.guard, update.value)

    def changes(self) -> tuple[tuple[str, str, str], ...]:
        """The cells that the behavior changes: as `init:` has them, the value now, and before."""
        features = self.situation.world.features
        return tuple(
            (_cell_text(cell), _shown(new, features[cell[0]]), _shown(old, features[cell[0]]))
            for cell, old, new in changed_cells(self.situation)
        )

    def json(self) -> dict[str, Any]:
        """The counterexample as it stands in the report's JSON."""
        situation = self.situation
        return {
            "objects": {o.name: str(o.type) for o in situation.objects},
            "init": list(self.state()),
            "functions": list(self.functions()),
            "behavior": situation.way.behavior.name,
            "arguments": [_plain(v) for v in situation.arguments],
            "bindings": {name: _plain(v) for name, v in situation.bindings.items()},
            "controllers": list(self.controllers),
            "changes": [
                {"cell": cell, "before": old, "after": new} for cell, new, old in self.changes()
            ],
            "false": [{"condition": p.text, "finding": p.finding} for p in self.false_parts],
        }


def _plain(value: Value) -> Any:
    match value:
        case tuple():
            return [_plain(item) for item in value]
        case Opaque():
            return {"opaque": repr(value)}
        case _:
            return value


def _cell_text(cell: Cell) -> str:
    name, where = cell
    return f"{name}[{', '.join(where) or '...'}]"


def _shown(value: Value, feature: Feature) -> str:
    return "not set" if value is None else shown(value, feature.type)


def _table_lines(name: str, types: list[Type], result: Type, table: Table) -> Iterator[str]:
    for arguments, value in table.rows.items():
        if value != table.otherwise:
            inside = ", ".join(shown(a, t) for a, t in zip(arguments, types, strict=True))
            yield f"{name}({inside}) = {shown(value, result)}"
    inside = "..." if types else ""
    is_only = all(value == table.otherwise for value in table.rows.values())
    yield f"{name}({inside}) = {shown(table.otherwise, result)}" + (
        "" if is_only else "   for all others"
    )


# ------------------------------------------------------------------------------------------ smaller


def smaller(situation: Situation, confirm: Callable[[Situation], str]) -> Situation:
    """The situation without what makes no difference; `confirm` says what is wrong with one."""
    trials = 0
    features = situation.world.features
    types = {p.name: p.type for p in situation.triple.parameters}

    def accept(candidate: Situation) -> bool:
        nonlocal trials
        trials += 1
        return trials <= _MOST_TRIALS and not confirm(candidate)

    for name in list(situation.tables):
        for row in list(situation.tables[name].rows):
            candidate = _without_row(situation, name, row)
            situation = candidate if accept(candidate) else situation
    for cell in list(situation.state.cells):
        without = {c: v for c, v in situation.state.cells.items() if c != cell}
        candidate = replace(situation, state=State(without))
        if accept(candidate):
            situation = candidate
            continue
        for value in _simpler(situation.state.cells[cell], features[cell[0]].type):
            changed = {**situation.state.cells, cell: value}
            candidate = replace(situation, state=State(changed))
            if accept(candidate):
                situation = candidate
                break
    for name, old in situation.values.items():
        for value in _simpler(old, types.get(name, OBJECT)):
            candidate = replace(situation, values={**situation.values, name: value})
            if accept(candidate):
                situation = candidate
                break
    return situation


def _without_row(situation: Situation, name: str, row: tuple[Value, ...]) -> Situation:
    table = situation.tables[name]
    rows = {arguments: value for arguments, value in table.rows.items() if arguments != row}
    return replace(situation, tables={**situation.tables, name: Table(rows, table.otherwise)})


def _simpler(value: object, type_: Type) -> Iterator[Value]:
    """Simpler values, the simplest first: numbers nearer to 0, no text, the first opaque one."""
    match value:
        case str() if value and not is_object(type_):
            yield ""
        case Opaque(type=name, number=number) if number:
            yield Opaque(name, 0)
        case tuple() if any(value):
            yield tuple(type(item)(0) if isinstance(item, int | float) else item for item in value)
        case bool():
            return
        case int() | float():
            yield from _nearer_to_zero(value)
        case _:
            return


def _nearer_to_zero(value: float) -> Iterator[float]:
    kind = type(value)
    for number in (0, 1, -1, 2, -2, 3, -3, 5, 10, -10, 100, -100):
        if abs(number) < abs(value):
            yield kind(number)
    if value != round(value):
        yield float(round(value))


# ------------------------------------------------------------------------------------ what is false


def false_parts(situation: Situation, goal: Expression) -> tuple[FalsePart, ...]:
    """The parts of a goal that are false after the behavior, and make the goal false."""
    return tuple(dict.fromkeys(_parts(situation, goal, {}, wanted=True)))


def _parts(
    situation: Situation, node: Expression, inner: Mapping[str, Value], *, wanted: bool
) -> Iterator[FalsePart]:
    """Why an expression is not as wanted."""
    if situation.after(node, inner) is wanted:
        return
    match node:
        case Not(operand=operand):
            yield from _parts(situation, operand, inner, wanted=not wanted)
        case And(operands=operands) if wanted:
            for operand in operands:
                yield from _parts(situation, operand, inner, wanted=True)
        case Or(operands=operands) if not wanted:
            for operand in operands:
                yield from _parts(situation, operand, inner, wanted=False)
        case Quantified(quantifier=quantifier, variables=variables, body=body) if wanted is (
            quantifier == "forall"
        ):
            for more in assignments_of(situation.world, variables, inner):
                if situation.after(body, more) is not wanted:
                    yield from _parts(situation, body, more, wanted=wanted)
                    return
        case Apply() if (unfolded := _unfolded(situation, node)) is not None:
            yield from _parts(situation, unfolded, inner, wanted=wanted)
        case _:
            yield _leaf(situation, node, inner, wanted=wanted)


def _unfolded(situation: Situation, node: Apply) -> Expression | None:
    """What a derived function returns, where its body is no more than that."""
    function = situation.world.functions[node.function]
    match function.body:
        case (Return(value=value),):
            pairs = zip(function.parameters, node.arguments, strict=True)
            return substitute(value, {p.name: argument for p, argument in pairs})
        case _:
            return None


def _leaf(
    situation: Situation, node: Expression, inner: Mapping[str, Value], *, wanted: bool
) -> FalsePart:
    values = {**situation.values, **inner}
    text = expression_text(_filled(node, values))
    if not wanted:
        text = expression_text(Not(_filled(node, values)))
    match node:
        case Read(feature=feature, arguments=arguments):
            where = tuple(str(situation.after(a, inner)) for a in arguments)
            return FalsePart(text, f"is {not wanted}", (feature, where))
        case Compare(left=left, right=right):
            sides = [
                f"`{expression_text(_filled(side, values))}` is "
                f"{_shown_value(situation.after(side, inner), side.type)}"
                for side in (left, right)
                if not isinstance(side, Constant | Object | Variable)
            ]
            cell = None
            if isinstance(left, Read):
                where = tuple(str(situation.after(a, inner)) for a in left.arguments)
                cell = (left.feature, where)
            return FalsePart(text, " and ".join(sides) or "is False", cell)
        case _:
            return FalsePart(text, "is False")


def _shown_value(value: Value | None, type_: Type) -> str:
    return "nothing" if value is None else shown(value, type_)


def _filled(node: Expression, values: Mapping[str, Value]) -> Expression:
    """An expression with its variables' values in their places."""
    free = free_variables(node)
    types = {v.name: v.type for v in subexpressions(node) if isinstance(v, Variable)}
    return substitute(node, {name: literal(values[name], types[name]) for name in free})


def write_labels(example: Counterexample) -> Iterator[Label]:
    """What the effect does about the false parts, at the statements that do it."""
    situation = example.situation
    features = situation.world.features
    for part in example.false_parts:
        for update in situation.triple.post:
            if part.cell is None or update.feature != part.cell[0] or update.location is None:
                continue
            if update.variables:
                yield Label(update.location, f"sets `{update.feature}` for some objects")
                continue
            where = tuple(str(situation.before(a)) for a in update.arguments)
            value = situation.before(update.value)
            cell = _cell_text((update.feature, where))
            if not situation.before(update.guard):
                yield Label(update.location, "not done here: its condition is false")
            elif where != part.cell[1]:
                yield Label(update.location, f"sets another cell, `{cell}`")
            else:
                yield Label(
                    update.location, f"sets `{cell}` to {_shown(value, features[update.feature])}"
                )
