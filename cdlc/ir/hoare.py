"""The Hoare model: `{pre} b(params) {post}` of a behavior, by symbolic execution (App. D.5).

`pre` collects the asserts, achieves and object binds of the body; `post` is one simultaneous
assignment whose arguments and values read the state before the behavior. Bodies are straight-line
here: a statement that is not is named in NotModelled.
"""

from collections import ChainMap
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

from crow.program import (
    Achieve,
    Apply,
    Assert,
    Assign,
    Behavior,
    Bind,
    Commit,
    Do,
    Expression,
    Function,
    Group,
    Hierarchy,
    Let,
    Location,
    ObjectType,
    Parameter,
    Program,
    Read,
    Return,
    SetLocal,
    Statement,
    Variable,
)
from crow.program.locals import Locals, set_local
from crow.program.names import named_binds
from crow.program.rewrite import rename_quantified, rewrite, substitute
from crow.program.walk import free_variables, statements_within, subexpressions

from cdlc.ir.logic import choice, conjunction, conjuncts, equality, folded, follows


@dataclass(frozen=True, slots=True)
class Update:
    """`feature[arguments] := value`, both over the state before the behavior."""

    feature: str
    arguments: tuple[Expression, ...]
    value: Expression
    location: Location | None = field(default=None, compare=False)


@dataclass(frozen=True, slots=True)
class Triple:
    """A transition: `parameters` are the behavior's followed by its object binds.

    `pre` is a list of conjuncts; `post` writes no cell twice with the same arguments, and where two
    updates may meet in one cell the later one wins.
    """

    behavior: str
    parameters: tuple[Parameter, ...]
    goal: Expression | None
    calls: tuple[Do, ...]
    pre: tuple[Expression, ...]
    post: tuple[Update, ...]


class NotModelled(Exception):  # noqa: N818 - not an error of the program
    """A construct without a Hoare model in this version, with its place."""

    def __init__(self, construct: str, location: Location | None) -> None:
        super().__init__(construct)
        self.construct = construct
        self.location = location


def triple(program: Program, behavior: Behavior) -> Triple | None:
    """The triple of a behavior, or None for a method, which has no effect of its own.

    Raises NotModelled for a construct that is not straight-line or not discrete.
    """
    if behavior.effect is None:
        return None
    try:
        return _Execution(program, behavior).run()
    except RecursionError:
        construct = "a condition or effect nested this deeply"
        raise NotModelled(construct, behavior.location) from None


def regress(condition: Expression, post: Iterable[Update], hierarchy: Hierarchy) -> Expression:
    """The weakest precondition of a condition: what must hold before for it to hold after `post`.

    Each read of a written feature becomes a choice on whether it reads the written cell.
    """
    return _before(condition, tuple(post), {}, hierarchy)


def _before(
    expression: Expression,
    updates: tuple[Update, ...],
    variables: Mapping[str, Expression],
    hierarchy: Hierarchy,
) -> Expression:
    """An expression over the state after some updates as one over the state before them.

    `variables` stand for values of before already: reads in them are left as they are.
    """

    def rule(node: Expression) -> Expression:
        match node:
            case Variable(name=name):
                return variables.get(name, node)
            case Read():
                return _value_after(node, updates, hierarchy)
            case _:
                return folded(node, hierarchy)

    values = (e for u in updates for e in (*u.arguments, u.value))
    inside = map(free_variables, (*variables.values(), *values))
    taken = frozenset(variables).union(*inside)
    return rewrite(rename_quantified(expression, taken), rule)


def _value_after(read: Read, updates: tuple[Update, ...], hierarchy: Hierarchy) -> Expression:
    value: Expression = read
    for update in updates:
        if update.feature == read.feature:
            pairs = zip(update.arguments, read.arguments, strict=True)
            same = conjunction(equality(a, b, hierarchy) for a, b in pairs)
            value = choice(same, update.value, value)
    return value


# ---------------------------------------------------------------------------------------- inlining

# What inlining may come to; functions that call each other twice double with every level.
_MOST_PARTS = 20_000


def inline(program: Program, expression: Expression) -> Expression:
    """The expression with calls of derived functions replaced by what they return.

    Raises NotModelled for a function that is not straight-line, or that grows beyond all measure.
    """
    return _Inlining(program).inlined(expression)


class _Inlining:
    def __init__(self, program: Program) -> None:
        self.functions = {f.name: f for f in program.functions if f.body is not None}
        self.parts = 0

    def inlined(self, expression: Expression) -> Expression:
        return rewrite(expression, self._rule)

    def _rule(self, node: Expression) -> Expression:
        self.parts += 1
        if not isinstance(node, Apply) or node.function not in self.functions:
            return node
        function = self.functions[node.function]
        if self.parts > _MOST_PARTS:
            construct = f"a call of `{function.name}`, which is too large when written out,"
            raise NotModelled(construct, node.location)
        return self.inlined(_returned(function, node))


def _returned(function: Function, call: Apply) -> Expression:
    """What a call of a straight-line function returns."""
    names = [p.name for p in function.parameters]
    variables: dict[str, Expression] = dict(zip(names, call.arguments, strict=True))
    for statement in function.body or ():
        match statement:
            case Let(variable=Parameter(name=name), value=value) | SetLocal(name, value):
                variables[name] = substitute(value, variables)
            case Return(value=value):
                return substitute(value, variables)
            case _:
                construct = f"{_construct(statement)} in `{function.name}`"
                raise NotModelled(construct, statement.location)
    raise AssertionError("a checked function returns")


# --------------------------------------------------------------------------------------- execution


class _Execution:
    """One symbolic run: variables by name, conditions so far, and the writes so far."""

    def __init__(self, program: Program, behavior: Behavior) -> None:
        self.program = program
        self.behavior = behavior
        self.hierarchy = Hierarchy.of(program.types)
        self.controllers = {c.name: c for c in program.controllers}
        self.names = {id(bind): names for bind, names in named_binds(behavior)}
        self.parameters = list(behavior.parameters)
        self.variables: Locals = ChainMap(
            {p.name: Variable(p.name, p.type) for p in behavior.parameters}
        )
        self.pre: list[Expression] = []
        self.calls: list[Do] = []
        self.updates: list[Update] = []

    def run(self) -> Triple:
        behavior = self.behavior
        assert behavior.effect is not None
        for statement in behavior.body:
            self._body(statement)
        self._effect(behavior.effect, self.variables)
        return Triple(
            behavior.name,
            tuple(self.parameters),
            behavior.goal,
            tuple(self.calls),
            tuple(conjuncts(conjunction(self.pre))),
            tuple(self.updates),
        )

    def _body(self, statement: Statement) -> None:
        match statement:
            case Assert(condition=condition):
                self._require(condition)
            case Achieve(condition=condition, once=once):
                if self.calls:
                    raise NotModelled("an `achieve` after a controller call", statement.location)
                if not once:
                    self._require(condition)
            case Bind():
                self._bind(statement)
            case Do():
                self._do(statement)
            case Let(variable=Parameter(name=name), value=value):
                self.variables[name] = self._local(statement, value)
            case SetLocal(variable=name, value=value):
                set_local(self.variables, name, self._local(statement, value))
            case Group(order="sequential" | "unordered" as order, body=body):
                if order == "unordered":
                    _refuse_calls(body)
                self.variables = self.variables.new_child()
                for inner in body:
                    self._body(inner)
                self.variables = self.variables.parents
            case Commit():
                return
            case _:
                raise NotModelled(_construct(statement), statement.location)

    def _require(self, condition: Expression) -> None:
        self.pre.append(self._now(condition, self.variables))

    def _local(self, statement: Statement, value: Expression) -> Expression:
        """The value of a local of the body, which an `achieve` after it must not change."""
        now = self._now(value, self.variables)
        if any(isinstance(part, Read) for part in subexpressions(now)):
            raise NotModelled("a local that reads the state", statement.location)
        return now

    def _bind(self, statement: Bind) -> None:
        for variable, name in zip(statement.variables, self.names[id(statement)], strict=True):
            if not isinstance(variable.type, ObjectType):
                raise NotModelled(f"a `bind` of type `{variable.type}`", statement.location)
            self.parameters.append(replace(variable, name=name))
            self.variables[variable.name] = Variable(name, variable.type)
        if statement.condition is not None:
            self._require(statement.condition)

    def _do(self, statement: Do) -> None:
        values = tuple(self._now(a, self.variables) for a in statement.arguments)
        self.calls.append(Do(statement.controller, values, location=statement.location))
        controller = self.controllers[statement.controller]
        if controller.effect is not None:
            names = [p.name for p in controller.parameters]
            self._effect(controller.effect, dict(zip(names, values, strict=True)))

    def _effect(
        self, statements: tuple[Statement, ...], variables: Mapping[str, Expression]
    ) -> None:
        for statement in statements:
            match statement:
                case Assign(operator="="):
                    self._write(statement, variables)
                case Let(variable=Parameter(name=name), value=value) | SetLocal(name, value):
                    variables = {**variables, name: self._now(value, variables)}
                case _:
                    raise NotModelled(_construct(statement), statement.location)

    def _write(self, statement: Assign, variables: Mapping[str, Expression]) -> None:
        arguments = tuple(self._now(a, variables) for a in statement.arguments)
        value = self._now(statement.value, variables)
        cell = (statement.feature, arguments)
        self.updates = [u for u in self.updates if (u.feature, u.arguments) != cell]
        self.updates.append(Update(*cell, value, location=statement.location))

    def _now(self, expression: Expression, variables: Mapping[str, Expression]) -> Expression:
        """The value of an expression at this point, over the state before the behavior."""
        plain = inline(self.program, expression)
        return _before(plain, tuple(self.updates), variables, self.hierarchy)


def _refuse_calls(body: tuple[Statement, ...]) -> None:
    """Controller calls in any order are as many transitions as there are orders."""
    for statement in statements_within(body):
        if isinstance(statement, Do):
            raise NotModelled("a controller call in `unordered:`", statement.location)


def _construct(statement: Statement) -> str:
    """A statement in words."""
    names = {
        "Assign": "an augmented assignment",
        "ForEach": "`foreach`",
        "ForRange": "`for`",
        "If": "`if`",
        "Group": "`alternative:`",
        "Call": "a behavior call",
    }
    return names.get(type(statement).__name__, f"`{type(statement).__name__.lower()}`")


def establishes_goal(program: Program, model: Triple) -> bool | None:
    """Whether the goal holds after every transition, as far as its Boolean structure tells.

    None when that does not tell: values, external functions and quantifiers are opaque.
    """
    if model.goal is None:
        return True
    hierarchy = Hierarchy.of(program.types)
    before = regress(inline(program, model.goal), model.post, hierarchy)
    return follows(model.pre, before, hierarchy)
