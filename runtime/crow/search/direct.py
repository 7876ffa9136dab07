"""Binds of values that one generator answers: the common case, which needs no store of constraints.

The other conditions of such a bind are tests of what is drawn.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from crow.constraints import Constraint
from crow.problem import State
from crow.program import And, Apply, Expression, Generator, Variable
from crow.program.types import underlying
from crow.program.walk import free_variables, subexpressions
from crow.search.code import DrawOp
from crow.search.expressions import Compiled

if TYPE_CHECKING:
    from crow.search.compile import Programs


@dataclass(frozen=True, slots=True)
class Direct:
    """A generator with what computes its inputs, and for each variable which output it is.

    `constraint` is the condition, for counts of what it rejects.
    """

    generator: str
    inputs: tuple[Compiled, ...]
    outputs: tuple[int, ...]
    constraint: Constraint


def direct(op: DrawOp, programs: "Programs") -> Direct | None:
    """The one generator that yields all values of a bind from what is known before it, if any."""
    if op.test is None:
        return None
    names = [variable.name for variable in op.variables]
    condition = op.test.condition
    pairs = [
        (generator, conjunct)
        for conjunct in (condition.operands if isinstance(condition, And) else (condition,))
        for generator in programs.world.program.generators
        if _may_yield(generator, conjunct, frozenset(names))
    ]
    if len(pairs) != 1:
        return None
    generator, conjunct = pairs[0]
    python = programs.world.externals.generators.get(generator.name)
    bound = _bound(generator, conjunct)
    if python is None or python.is_batch or bound is None:
        return None
    outputs = [bound[name] for name in generator.outputs]
    inputs = [bound[name] for name in generator.inputs]
    drawn = [output.name if isinstance(output, Variable) else None for output in outputs]
    if sorted(map(str, drawn)) != sorted(names):
        return None
    if any(free_variables(given) & set(names) for given in inputs):
        return None
    compiled = tuple(programs.term(given, op.test.slots) for given in inputs)
    order = tuple(drawn.index(name) for name in names)
    for index, variable in zip(order, op.variables, strict=True):
        if underlying(python.outputs[index].type) != underlying(variable.type):
            return None  # the value is another one as a variable of that type
    constraint = Constraint(condition, {}, State(), location=op.location)
    return Direct(generator.name, compiled, order, constraint)


def _may_yield(generator: Generator, conjunct: Expression, names: frozenset[str]) -> bool:
    """Whether a generator may be one for any of some variables in a condition."""
    functions = {part.function for part in _calls(generator.goal)}
    own = {part.function for part in _calls(conjunct)}
    return bool(functions & own) and bool(free_variables(conjunct) & names)


def _calls(condition: Expression) -> list[Apply]:
    return [part for part in subexpressions(condition) if isinstance(part, Apply)]


def _bound(generator: Generator, conjunct: Expression) -> dict[str, Expression] | None:
    """What the parameters of a generator stand for where its goal is a call like the condition."""
    goal = generator.goal
    if not (isinstance(goal, Apply) and isinstance(conjunct, Apply)):
        return None
    if goal.function != conjunct.function:
        return None
    parameters = [a.name if isinstance(a, Variable) else None for a in goal.arguments]
    bound = {p: a for p, a in zip(parameters, conjunct.arguments, strict=True) if p is not None}
    is_plain = None not in parameters and len(bound) == len(parameters)
    return bound if is_plain and bound.keys() >= {p.name for p in generator.parameters} else None
