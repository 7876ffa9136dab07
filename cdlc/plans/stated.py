"""Goals as text and Python functions, for problems that are stated in Python."""

import re
from collections.abc import Mapping
from dataclasses import dataclass

from cdlc.frontend.check import CheckedDomain
from cdlc.plans.traces import TraceFormatError, read_condition, read_number, typed_value
from crow.problem import Problem, World
from crow.program import Constant, Expression, Object, ObjectType, Type, Vector, VectorType
from crow.program.rewrite import substitute
from crow.reading import WrongValueError
from crow.stated import ProblemError
from crow.values import Value


@dataclass(frozen=True)
class Text:
    """What `cdlc.load` attaches to a domain: its declarations."""

    domain: CheckedDomain

    def expression(
        self, text: str, world: World, values: Mapping[str, Value], *, is_number: bool
    ) -> Expression:
        """A condition or number in text about objects and named values. Raises ProblemError."""
        words = set(re.findall(r"\w+", text))
        named: dict[str, Expression] = {
            name: Object(name, world.objects[name]) for name in words & world.objects.keys()
        }
        try:
            for name in words & values.keys():
                named[name] = _literal(*typed_value(name, values[name], world))
            types = {name: node.type for name, node in named.items()}
            read = read_number if is_number else read_condition
            return substitute(read(text, types, self.domain), named)
        except (TraceFormatError, WrongValueError) as error:
            raise ProblemError(str(error)) from None

    def prepared(self, problem: Problem) -> Problem:
        """The problem with tables of the Python functions.

        Raises crow.FunctionError for one that fails.
        """
        from cdlc.backends.functions import tabulated_problem

        return tabulated_problem(problem)


def _literal(value: Value, type_: Type) -> Expression:
    match value, type_:
        case str(), ObjectType():
            return Object(value, type_)
        case tuple(), VectorType(element=element):
            return Vector(tuple(_literal(item, element) for item in value), type_)
        case _:
            return Constant(value, type_)
