"""What goals and achieves are about: the same feature or function, as true, false, equal or not.

An achieve and a goal of one form are one compound task; the arguments are the task's.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from crow.conditions import MIRRORED, plain
from crow.problem import World
from crow.program import Apply, Compare, Expression, Not, ObjectType, Parameter, Read, Variable
from crow.program.names import fresh_name
from crow.program.types import is_object


@dataclass(frozen=True, slots=True)
class Form:
    """A feature or derived function; with `has_value` it is compared with an object."""

    name: str
    has_value: bool
    is_positive: bool


@dataclass(frozen=True, slots=True, eq=False)
class Literal:
    """A form with its arguments, the object it is compared with last."""

    form: Form
    arguments: tuple[Expression, ...]


def literals(condition: Expression) -> Iterator[Literal]:
    """A condition as a literal: `f(x) == g(y)` in two ways, what is none in no way."""
    match plain(condition):
        case Read() | Apply() as atom:
            yield Literal(Form(_name(atom), has_value=False, is_positive=True), atom.arguments)
        case Not(operand=Read() | Apply() as atom):
            yield Literal(Form(_name(atom), has_value=False, is_positive=False), atom.arguments)
        case Compare(operator="==" | "!=" as operator, left=left, right=right):
            for side, other in ((left, right), (right, left)):
                if isinstance(side, Read | Apply) and is_object(side.type):
                    form = Form(_name(side), has_value=True, is_positive=operator == "==")
                    yield Literal(form, (*side.arguments, other))
        case _:
            return


def _name(atom: Read | Apply) -> str:
    return atom.feature if isinstance(atom, Read) else atom.function


def oriented(condition: Expression) -> Iterator[Expression]:
    """The condition, for a comparison also with its sides exchanged."""
    yield condition
    if isinstance(condition, Compare):
        operator = MIRRORED[condition.operator]
        yield replace(condition, operator=operator, left=condition.right, right=condition.left)


def parameters_of(form: Form, world: World) -> tuple[Parameter, ...]:
    """The parameters of a form's task."""
    declared = world.features.get(form.name) or world.functions[form.name]
    if not form.has_value:
        return declared.parameters
    taken = {p.name for p in declared.parameters}
    assert isinstance(declared.type, ObjectType)
    return (*declared.parameters, Parameter(fresh_name("value", taken), declared.type))


def condition_of(form: Form, world: World) -> Expression:
    """The condition that a form stands for, over the parameters of its task."""
    variables = [Variable(p.name, p.type) for p in parameters_of(form, world)]
    arguments = tuple(variables[:-1] if form.has_value else variables)
    atom: Expression
    if form.name in world.features:
        atom = Read(form.name, arguments, world.features[form.name].type)
    else:
        atom = Apply(form.name, arguments, world.functions[form.name].type)
    if form.has_value:
        return Compare("==" if form.is_positive else "!=", atom, variables[-1])
    return atom if form.is_positive else Not(atom)
