"""The bodies of a behavior without choices: one for each alternative and each order (semantics §2).

A planner's step is one way through a body, so each way is looked at, and carried out, on its own.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, replace
from itertools import islice, permutations
from typing import Any, Final, cast

from cdlc.backends.pddl.sexpr import NotPddl
from cdlc.ir.behaviors import achieved_in, parts_of, touched
from cdlc.ir.hoare import MAX_TRIPLES
from crow.program import (
    Behavior,
    Bind,
    Call,
    Do,
    Expression,
    Group,
    Let,
    Parameter,
    Program,
    SetLocal,
    Statement,
    Variable,
)
from crow.program.location import Node
from crow.program.names import fresh_name
from crow.program.rewrite import substitute
from crow.program.walk import statements_within

Body = tuple[Statement, ...]


def straight_bodies(program: Program, behavior: Behavior) -> tuple[Body, ...]:
    """Every way through a body, as statements one after another; all names in one are different.

    Called behaviors that achieve something or leave a choice are part of the body; the effect of
    one is a call of `effect_of` it. Raises NotPddl past MAX_TRIPLES ways.
    """
    members = behavior.promotable
    middle = () if members is None else (Group(members.order, members.members),)
    walk = _Straightening(program, behavior)
    body = walk.renamed((*behavior.left, *middle, *behavior.right), {})
    found = tuple(islice(walk.ways(body), MAX_TRIPLES + 1))
    if len(found) > MAX_TRIPLES:
        construct = f"`{behavior.name}`, with more than {MAX_TRIPLES} ways through its body,"
        raise NotPddl(construct, behavior.location)
    return found


EFFECT: Final = "'effect"


def effect_of(behavior: Behavior) -> Behavior:
    """The effect of a behavior alone, to be called where its body is part of another.

    Its parameters are those variables of the behavior and its body that the effect names.
    """
    effect = behavior.effect or ()
    named = {part.name for part in parts_of(effect) if isinstance(part, Variable)}
    own = [v for statement in behavior.body for v in declared(statement)]
    unique = {p.name: p for p in (*behavior.parameters, *own) if p.name in named}
    name = behavior.name + EFFECT
    return Behavior(name, tuple(unique.values()), None, (), None, (), effect)


def acts(statement: Statement) -> bool:
    """Whether a statement may call a controller."""
    return any(isinstance(s, Do | Call) for s in statements_within((statement,)))


def has_choice(statements: Body) -> bool:
    """Whether statements have an `alternative` among them, if only of one statement."""
    within = statements_within(statements)
    return any(isinstance(s, Group) and s.order == "alternative" for s in within)


Scope = dict[str, Expression]
"""What the names of a block stand for, where that is another name."""


@dataclass
class _Straightening:
    program: Program
    behavior: Behavior

    def __post_init__(self) -> None:
        self.behaviors = {b.name: b for b in self.program.behaviors}
        # Binds are numbered as by the runtime, which numbers no locals.
        self.bound = {p.name for p in self.behavior.parameters}
        self.taken = set(self.bound)

    # ------------------------------------------------------------------------------------ choices

    def ways(self, statements: Body) -> Iterator[Body]:
        """The ways through statements that stand one after another."""
        if not statements:
            yield ()
            return
        for first in self._ways_of(statements[0]):
            for rest in self.ways(statements[1:]):
                yield (*first, *rest)

    def _ways_of(self, node: Statement) -> Iterator[Body]:
        match node:
            case Group(order="alternative", body=body):
                for chosen in body:
                    yield from self.ways((chosen,))
            case Group(order="sequential", body=body):
                yield from self.ways(body)
            case Group(order="unordered", body=body) if self._order_matters(body):
                for ordered in _orders([_chain(part) for part in body]):
                    yield from self.ways(ordered)
            case Group(body=body) if has_choice(body):
                yield from self.ways(body)
            case _:
                yield (node,)

    def _order_matters(self, body: Body) -> bool:
        if not any(map(acts, body)):
            return False
        achieves = next(achieved_in(self.program, body), None) is not None
        each = [touched(self.program, (part,)) for part in body]
        if not achieves and not any(a.disturbs(b) for a, b in permutations(each, 2)):
            return False
        for part in body:
            if isinstance(part, Let | SetLocal | Bind):
                # In some orders, others would use its variable before it has a value.
                construct = "a local or `bind` in an `unordered` group that acts"
                raise NotPddl(construct, part.location, "put it before the group")
        return True

    # -------------------------------------------------------------------------------------- names

    def renamed(self, statements: Body, scope: Scope) -> Body:
        """Statements with a name of its own for everything they declare, calls unfolded."""
        return tuple(self._renamed(statement, scope) for statement in statements)

    def _renamed(self, node: Statement, scope: Scope) -> Statement:
        match node:
            case Let(variable=variable, value=value):
                value = substitute(value, scope)
                return replace(node, variable=self._local(variable, scope), value=value)
            case SetLocal(variable=name, value=value):
                now = scope.get(name)
                new = now.name if isinstance(now, Variable) else name
                return replace(node, variable=new, value=substitute(value, scope))
            case Bind(variables=variables, condition=condition):
                opened = tuple(self._bound(v, scope) for v in variables)
                now = None if condition is None else substitute(condition, scope)
                return replace(node, variables=opened, condition=now)
            case Group(body=body):
                return replace(node, body=self.renamed(body, dict(scope)))
            case Call(behavior=name) if self._is_unfolded(self.behaviors[name]):
                return self._unfolded(node, self.behaviors[name], scope)
            case _:
                return cast("Statement", _substituted(node, scope))

    def _local(self, variable: Parameter, scope: Scope) -> Parameter:
        name = variable.name
        if name in self.taken:
            name = fresh_name(f"{name}_local", self.taken)
        return self._named(variable, name, scope)

    def _bound(self, variable: Parameter, scope: Scope) -> Parameter:
        name = fresh_name(variable.name, self.bound)
        self.bound.add(name)
        return self._named(variable, name, scope)

    def _named(self, variable: Parameter, name: str, scope: Scope) -> Parameter:
        self.taken.add(name)
        scope[variable.name] = Variable(name, variable.type)
        return replace(variable, name=name)

    # -------------------------------------------------------------------------------------- calls

    def _is_unfolded(self, called: Behavior) -> bool:
        if next(achieved_in(self.program, called.body), None) is not None:
            return True
        return any(
            (isinstance(s, Group) and s.order != "sequential") or isinstance(s, Call)
            for s in statements_within(called.body)
        )

    def _unfolded(self, node: Call, called: Behavior, scope: Scope) -> Statement:
        """The body of a called behavior as a group, its parameters as locals."""
        inner: Scope = {}
        given = [
            Let(
                self._local(parameter, inner),
                substitute(argument, scope),
                location=node.location,
            )
            for parameter, argument in zip(called.parameters, node.arguments, strict=True)
        ]
        members = called.promotable
        middle = () if members is None else (Group(members.order, members.members),)
        body = self.renamed((*called.left, *middle, *called.right), inner)
        if called.effect is None:
            return Group("sequential", (*given, *body), location=node.location)
        effect = effect_of(called)
        arguments = tuple(inner[p.name] for p in effect.parameters)
        ended = Call(effect.name, arguments, location=called.location)
        return Group("sequential", (*given, *body, ended), location=node.location)


def _chain(part: Statement) -> Body:
    """The statements that a part of an unordered group keeps in order."""
    is_chain = isinstance(part, Group) and part.order == "sequential"
    return part.body if is_chain and isinstance(part, Group) else (part,)


def _orders(chains: list[Body]) -> Iterator[Body]:
    """Every order of statements that keeps that within each chain."""
    rest = [chain for chain in chains if chain]
    if not rest:
        yield ()
        return
    for i, chain in enumerate(rest):
        for after in _orders([*rest[:i], chain[1:], *rest[i + 1 :]]):
            yield (chain[0], *after)


def declared(statement: Statement) -> tuple[Parameter, ...]:
    """The variables that a statement adds to its block."""
    match statement:
        case Let(variable=variable):
            return (variable,)
        case Bind(variables=variables):
            return variables
        case _:
            return ()


def _substituted(node: Any, values: Mapping[str, Expression]) -> Any:
    """A statement, or a tuple of some, with its free variables replaced."""
    if isinstance(node, tuple):
        return tuple(_substituted(part, values) for part in node)
    if isinstance(node, Expression):
        return substitute(node, values)
    if not values or not isinstance(node, Node) or isinstance(node, Parameter):
        return node
    hidden = {p.name for p in _opened(node)}
    inner = {name: value for name, value in values.items() if name not in hidden}
    parts = {f.name: getattr(node, f.name) for f in fields(node)}
    changed = {n: _substituted(part, inner) for n, part in parts.items()}
    differs = {n: new for n, new in changed.items() if new is not parts[n]}
    return replace(node, **differs) if differs else node


def _opened(node: Node) -> tuple[Parameter, ...]:
    """The variables that a statement opens for the statements in it."""
    found = getattr(node, "variables", ())
    single = getattr(node, "variable", None)
    return (*found, *([single] if isinstance(single, Parameter) else ()))
