"""The Hoare model: `{pre} b(params) {post}` of a behavior, by symbolic execution (App. D.5).

`pre` collects the asserts, achieves and object binds of the body; `post` is one simultaneous
assignment whose arguments and values read the state before the behavior. Bodies are straight-line
here: a statement that is not is named in NotModelled.
"""

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
from crow.program.names import fresh_name
from crow.program.rewrite import rewrite, substitute
from crow.program.walk import subexpressions

from cdlc.ir.logic import TRUE, choice, conjunction, conjuncts, equality


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
    return _Execution(program, behavior).run()


def regress(condition: Expression, post: Iterable[Update], hierarchy: Hierarchy) -> Expression:
    """The weakest precondition of a condition: what must hold before for it to hold after `post`.

    Each read of a written feature becomes a choice on whether it reads the written cell.
    """
    updates = tuple(post)

    def rule(node: Expression) -> Expression:
        if not isinstance(node, Read):
            return node
        value: Expression = node
        for update in updates:
            if update.feature == node.feature:
                pairs = zip(update.arguments, node.arguments, strict=True)
                same = conjunction(equality(a, b, hierarchy) for a, b in pairs)
                value = choice(same, update.value, value)
        return value

    return rewrite(condition, rule)


def inline(program: Program, expression: Expression) -> Expression:
    """The expression with calls of derived functions replaced by what they return."""
    functions = {f.name: f for f in program.functions if f.body is not None}

    def rule(node: Expression) -> Expression:
        if not isinstance(node, Apply) or node.function not in functions:
            return node
        return inline(program, _returned(functions[node.function], node))

    return rewrite(expression, rule)


def _returned(function: Function, call: Apply) -> Expression:
    match function.body:
        case (Return(value=value),):
            names = [p.name for p in function.parameters]
            return substitute(value, dict(zip(names, call.arguments, strict=True)))
        case _:
            raise NotModelled(f"the body of `{function.name}`", function.location)


class _Execution:
    """One symbolic run: variables by name, conditions so far, and the writes so far."""

    def __init__(self, program: Program, behavior: Behavior) -> None:
        self.program = program
        self.behavior = behavior
        self.hierarchy = Hierarchy.of(program.types)
        self.controllers = {c.name: c for c in program.controllers}
        self.parameters = list(behavior.parameters)
        self.variables: dict[str, Expression] = {
            p.name: Variable(p.name, p.type) for p in behavior.parameters
        }
        self.pre: list[Expression] = []
        self.calls: list[Do] = []
        self.updates: list[Update] = []

    def run(self) -> Triple:
        behavior = self.behavior
        assert behavior.effect is not None
        members = () if behavior.promotable is None else behavior.promotable.members
        for statement in (*behavior.left, *members, *behavior.right):
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
            case Do(controller=name, arguments=arguments):
                values = tuple(self._now(a, self.variables) for a in arguments)
                self.calls.append(replace(statement, arguments=values))
                controller = self.controllers[name]
                if controller.effect is not None:
                    names = [p.name for p in controller.parameters]
                    self._effect(controller.effect, dict(zip(names, values, strict=True)))
            case Let(variable=variable, value=value):
                now = self._now(value, self.variables)
                if any(isinstance(part, Read) for part in subexpressions(now)):
                    raise NotModelled("a `let` that reads the state", statement.location)
                self.variables = {**self.variables, variable.name: now}
            case Group(order="sequential" | "unordered", body=body):
                for inner in body:
                    self._body(inner)
            case Commit():
                return
            case _:
                raise NotModelled(_construct(statement), statement.location)

    def _require(self, condition: Expression) -> None:
        self.pre.append(self._now(condition, self.variables))

    def _bind(self, statement: Bind) -> None:
        for variable in statement.variables:
            if not isinstance(variable.type, ObjectType):
                raise NotModelled(f"a `bind` of type `{variable.type}`", statement.location)
            taken = {p.name for p in self.parameters}
            fresh = replace(variable, name=fresh_name(variable.name, taken))
            self.parameters.append(fresh)
            self.variables = {**self.variables, variable.name: Variable(fresh.name, fresh.type)}
        if statement.condition is not None:
            self._require(statement.condition)

    def _effect(
        self, statements: tuple[Statement, ...], variables: Mapping[str, Expression]
    ) -> None:
        for statement in statements:
            match statement:
                case Assign(operator="="):
                    self._write(statement, variables)
                case Let(variable=variable, value=value):
                    variables = {**variables, variable.name: self._now(value, variables)}
                case SetLocal(variable=name, value=value):
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
        plain = substitute(inline(self.program, expression), variables)
        return regress(plain, self.updates, self.hierarchy)


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
    """Whether the goal follows from pre and post by folding alone; None when that cannot tell.

    External functions are opaque, so a goal that calls one is never judged.
    """
    if model.goal is None:
        return True
    goal = inline(program, model.goal)
    if any(isinstance(part, Apply) for part in subexpressions(goal)):
        return None
    before = regress(goal, model.post, Hierarchy.of(program.types))
    return all(part in model.pre for part in conjuncts(before)) or before == TRUE
