"""Random effects over a small world, as program nodes, for comparing ways of running them."""

from collections.abc import Sequence
from functools import cache
from typing import Any

from hypothesis import strategies as st

from crow.program import (
    BOOL,
    INT64,
    And,
    Apply,
    Arithmetic,
    Assign,
    Behavior,
    Break,
    Builtin,
    Compare,
    Conditional,
    Constant,
    Continue,
    Expression,
    Feature,
    ForEach,
    ForRange,
    Function,
    If,
    Let,
    Not,
    Object,
    ObjectConstant,
    ObjectType,
    Or,
    Parameter,
    Program,
    Quantified,
    Read,
    Return,
    SetLocal,
    Statement,
    TypeDefinition,
    Variable,
    Xor,
)

THING, BOX = ObjectType("thing"), ObjectType("box")
TYPES = (
    TypeDefinition("thing", ObjectType("object"), is_object=True),
    TypeDefinition("box", THING, is_object=True),
)
CONSTANTS = (ObjectConstant("k", THING),)
FEATURES = (
    Feature("flag", (), BOOL),
    Feature("red", (Parameter("x", THING),), BOOL),
    Feature("on", (Parameter("x", THING), Parameter("y", THING)), BOOL),
    Feature("full", (Parameter("x", BOX),), BOOL),
    Feature("count", (Parameter("x", THING),), INT64),
    Feature("total", (), INT64),
    Feature("at", (Parameter("x", THING),), THING),
)
FUNCTIONS = (
    Function(
        "odd",
        (Parameter("a", THING),),
        BOOL,
        (
            If(
                Read("red", (Variable("a", THING),), BOOL),
                (Return(Constant(True, BOOL)),),  # noqa: FBT003 - a value
                (),
            ),
            Return(Compare(">", Read("count", (Variable("a", THING),), INT64), Constant(1, INT64))),
        ),
    ),
)
PARAMETERS = (Parameter("p", THING), Parameter("q", THING), Parameter("r", BOX))

LEAVING = (Break(), Continue())

Scope = tuple[Parameter, ...]


def among(options: Sequence[Any]) -> st.SearchStrategy[Any]:
    """One of some options; making a strategy costs more than drawing from it."""
    return _among(tuple(options))


@cache
def _among(options: tuple[Any, ...]) -> st.SearchStrategy[Any]:
    return st.sampled_from(options)


@cache
def objects(scope: Scope, wanted: ObjectType, depth: int) -> st.SearchStrategy[Expression]:
    """An expression for an object of a type."""
    named = [
        Variable(v.name, v.type)
        for v in scope
        if v.type == wanted or (v.type == BOX and wanted == THING)
    ]
    simple: list[Expression] = [*named, Object("k", THING)] if wanted == THING else [*named]
    base = among(simple)
    if wanted == BOX or depth <= 0:
        return base
    return st.one_of(
        base, base, objects(scope, THING, depth - 1).map(lambda o: Read("at", (o,), THING))
    )


@cache
@st.composite
def cells(draw: st.DrawFn, scope: Scope, depth: int, kind: object) -> Read:
    """A read of some cell of a type."""
    feature = draw(among([f for f in FEATURES if f.type == kind]))
    arguments = tuple(draw(objects(scope, p.type, depth)) for p in feature.parameters)  # type: ignore[arg-type]
    return Read(feature.name, arguments, feature.type)


@cache
@st.composite
def numbers(draw: st.DrawFn, scope: Scope, depth: int) -> Expression:
    """An expression for a whole number."""
    local = [Variable(v.name, INT64) for v in scope if v.type == INT64]
    choices = ["constant", "read", *(["local"] * (2 if local else 0))]
    if depth > 0:
        choices += ["arithmetic", "conditional", "builtin"]
    match draw(among(choices)):
        case "local":
            return draw(among(local))
        case "read":
            return draw(cells(scope, depth - 1, INT64))
        case "arithmetic":
            operator = draw(among(["+", "-", "+", "-", "*"]))
            left, right = draw(numbers(scope, depth - 1)), draw(numbers(scope, depth - 1))
            return Arithmetic(operator, left, right, INT64)
        case "conditional":
            condition = draw(conditions(scope, depth - 1))
            left, right = draw(numbers(scope, depth - 1)), draw(numbers(scope, depth - 1))
            return Conditional(condition, left, right, INT64)
        case "builtin":
            left, right = draw(numbers(scope, depth - 1)), draw(numbers(scope, depth - 1))
            return Builtin(draw(among(["min", "max"])), (left, right), INT64)
        case _:
            return Constant(draw(st.integers(-2, 3)), INT64)


@cache
@st.composite
def conditions(draw: st.DrawFn, scope: Scope, depth: int) -> Expression:
    """A Boolean expression."""
    choices = ["read", "read", "equal", "compare"]
    if depth > 0:
        choices += ["not", "and", "or", "xor", "quantified", "apply", "constant"]
    match draw(among(choices)):
        case "equal":
            operator = draw(among(["==", "!="]))
            sides = draw(objects(scope, THING, depth)), draw(objects(scope, THING, depth))
            return Compare(operator, *sides)
        case "compare":
            operator = draw(among(["==", "!=", "<", "<=", ">", ">="]))
            return Compare(
                operator, draw(numbers(scope, depth - 1)), draw(numbers(scope, depth - 1))
            )
        case "not":
            return Not(draw(conditions(scope, depth - 1)))
        case "and" | "or" as word:
            operands = (draw(conditions(scope, depth - 1)), draw(conditions(scope, depth - 1)))
            return And(operands) if word == "and" else Or(operands)
        case "xor":
            return Xor(draw(conditions(scope, depth - 1)), draw(conditions(scope, depth - 1)))
        case "quantified":
            variable = Parameter(f"v{depth}", draw(among([THING, BOX])))
            quantifier = draw(among(["forall", "exists"]))
            body = draw(conditions((*scope, variable), depth - 1))
            return Quantified(quantifier, (variable,), body)
        case "apply":
            return Apply("odd", (draw(objects(scope, THING, depth - 1)),), BOOL)
        case "constant":
            return Constant(draw(st.booleans()), BOOL)
        case _:
            return draw(cells(scope, depth - 1, BOOL))


@cache
@st.composite
def assignments(draw: st.DrawFn, scope: Scope, *, in_foreach: bool) -> Statement:
    """An assignment to some cell."""
    feature = draw(among(FEATURES))
    arguments = tuple(draw(objects(scope, p.type, 1)) for p in feature.parameters)  # type: ignore[arg-type]
    if feature.type == BOOL:
        is_constant = draw(st.booleans())
        truth = st.booleans().map(lambda b: Constant(b, BOOL))
        value = draw(truth if is_constant else conditions(scope, 2))
        return Assign(feature.name, arguments, "=", value)
    if feature.type == THING:
        return Assign(feature.name, arguments, "=", draw(objects(scope, THING, 1)))
    operators = ["="] if in_foreach else ["=", "+=", "-="]
    operator = draw(among(operators))
    return Assign(feature.name, arguments, operator, draw(numbers(scope, 2)))


@cache
@st.composite
def blocks(
    draw: st.DrawFn,
    scope: Scope,
    depth: int,
    *,
    in_for: bool = False,
    in_foreach: bool = False,
) -> tuple[Statement, ...]:
    """A block of statements; locals it introduces are seen by later ones."""
    statements: list[Statement] = []
    for index in range(draw(st.integers(1, 3))):
        kinds = ["assign", "assign", "let", "if", "for", "foreach"]
        locals_ = [v for v in scope if v.name.startswith("l") and v.type == INT64]
        kind = draw(among(kinds + ["set"] * bool(locals_) + ["leave"] * in_for))
        if depth <= 0 and kind in ("if", "for", "foreach"):
            kind = "assign"
        match kind:
            case "let":
                variable = Parameter(f"l{depth}{index}{len(scope)}", INT64)
                statements.append(Let(variable, draw(numbers(scope, 2))))
                scope = (*scope, variable)
            case "set":
                name = draw(among(locals_)).name
                statements.append(SetLocal(name, draw(numbers(scope, 1))))
            case "if":
                inner = blocks(scope, depth - 1, in_for=in_for, in_foreach=in_foreach)
                otherwise = draw(st.one_of(st.just(()), inner))
                statements.append(If(draw(conditions(scope, 2)), draw(inner), otherwise))
            case "for":
                variable = Parameter(f"i{depth}", INT64)
                body = draw(
                    blocks((*scope, variable), depth - 1, in_for=True, in_foreach=in_foreach)
                )
                stop = draw(st.integers(0, 3))
                statements.append(ForRange(variable, 0, stop, 1, body))
            case "foreach":
                variable = Parameter(f"o{depth}", draw(among([THING, BOX])))
                # Outer locals may be read, not assigned: hide them under other names.
                outer = tuple(v for v in scope if not v.name.startswith("l"))
                body = draw(blocks((*outer, variable), depth - 1, in_foreach=True))
                statements.append(ForEach((variable,), body))
            case "leave":
                leave = draw(among(LEAVING))
                statements.append(If(draw(conditions(scope, 1)), (leave,), ()))
            case _:
                statements.append(draw(assignments(scope, in_foreach=in_foreach)))
    return tuple(statements)


def program(effect: tuple[Statement, ...]) -> Program:
    """A program with one behavior of that effect."""
    behavior = Behavior("b", PARAMETERS, None, (), None, (), effect)
    return Program("random", TYPES, CONSTANTS, FEATURES, FUNCTIONS, (), (behavior,))
