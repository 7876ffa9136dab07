"""z3's answer over a few objects as a situation: objects, state, arguments, external functions."""

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import count
from typing import Any

import z3

from cdlc.verify.situation import Opaque, Situation, Table, filler
from cdlc.verify.smt.encode import Encoder
from cdlc.verify.smt.universe import Few
from cdlc.verify.ways import Way
from crow.problem import State, World
from crow.program import (
    Feature,
    Function,
    ListType,
    ObjectType,
    Parameter,
    Program,
    Type,
    VectorType,
)
from crow.program.triples import Triple
from crow.program.types import STRING, is_boolean, is_integer, is_number, underlying
from crow.values import Value


@dataclass
class Reader:
    """Reads one model of z3."""

    program: Program
    encoder: Encoder
    universe: Few
    found: Any

    def situation(self, triple: Triple, way: Way, variables: tuple[Parameter, ...]) -> Situation:
        """The situation, with values for some variables."""
        self._name_objects(triple)
        values = {
            v.name: self._value(self.encoder.variable(v.name, v.type), v.type) for v in variables
        }
        world = World.of(self.program, self.objects)
        tables = {name: self._table(f) for name, f in self.encoder.functions.items()}
        for function in self.program.functions:
            some = filler(function.type, world.objects_of(function.type))
            if function.body is None and some is not None:
                tables.setdefault(function.name, Table({}, some))
        return Situation(
            self.program, way, triple, self.objects, self._state(world), values, tables
        )

    def _name_objects(self, triple: Triple) -> None:
        """Names like `block1`, which nothing in the program has; first those of the arguments."""
        taken = {d.name for d in _named(self.program)}
        self.names = {str(term): name for name, term in self.universe.named.items()}
        arguments = [self.encoder.variable(p.name, p.type)[0] for p in triple.parameters]
        order = [str(self._eval(term)) for term in arguments]
        others = {str(term): term for term in self.universe.others}
        first = [others[name] for name in dict.fromkeys(order) if name in others]
        declared = {c.name for c in self.program.constants}
        own = self.universe.constants.items()
        objects = [Parameter(name, type_) for name, type_ in own if name not in declared]
        for term in dict.fromkeys([*first, *self.universe.others]):
            kind = self.universe.kinds[self._eval(self.universe.kind(term)).as_long()]
            name = next(n for i in count(1) if (n := f"{kind.lower()}{i}") not in taken)
            taken.add(name)
            self.names[str(term)] = name
            objects.append(Parameter(name, ObjectType(kind)))
        self.terms = {self.names[str(term)]: term for term in self.universe.terms}
        self.objects = tuple(objects)

    def _state(self, world: World) -> State:
        cells: dict[tuple[str, tuple[str, ...]], object] = {}
        for feature in self.program.features:
            for where in world.cells(feature):
                value = self._cell(feature, where, world)
                if value is not None:
                    cells[feature.name, where] = value
        return world.updated(State(), cells)

    def _cell(self, feature: Feature, where: tuple[str, ...], world: World) -> Value | None:
        objects = world.objects_of(feature.type)
        if feature.name not in self.encoder.features:
            return filler(feature.type, objects)
        terms = self.encoder.cell(feature, [self.terms[name] for name in where])
        value = self._value(terms, feature.type)
        is_object = isinstance(underlying(feature.type), ObjectType)
        return value if not is_object or value in objects else None

    def _table(self, function: Function) -> Table:
        """The values of an external function at the arguments that z3 has thought of."""
        rows: dict[tuple[Value, ...], Value] = {}
        for arguments in self._arguments(function):
            terms = self.encoder.application(function.name, function, list(arguments))
            rows[self._split(arguments, function)] = self._value(terms, function.type)
        objects = tuple(self.terms)
        some = filler(function.type, objects)
        if not function.parameters:
            return Table(
                {},
                self._value(self.encoder.application(function.name, function, []), function.type),
            )
        default = self._otherwise(function)
        return Table(rows, some if default is None else default)

    def _arguments(self, function: Function) -> list[tuple[Any, ...]]:
        found: dict[str, tuple[Any, ...]] = {}
        for declared in self.found.decls():
            if declared.name().rpartition(":")[0] == f"e:{function.name}" and declared.arity():
                table = self.found[declared]
                for row in range(table.num_entries()):
                    entry = table.entry(row)
                    arguments = tuple(entry.arg_value(i) for i in range(entry.num_args()))
                    found[str(arguments)] = arguments
        return list(found.values())

    def _otherwise(self, function: Function) -> Value | None:
        """The value for all other arguments, if it is one."""
        terms = []
        for index in range(len(self.encoder.application_sorts(function))):
            named = [
                d
                for d in self.found.decls()
                if d.name() == f"e:{function.name}:{index}" and d.arity()
            ]
            if not named:
                return None
            otherwise = self.found[named[0]].else_value()
            if otherwise is None or z3.is_var(otherwise) or otherwise.num_args():
                return None
            terms.append(otherwise)
        return self._value(tuple(terms), function.type)

    def _split(self, terms: tuple[Any, ...], function: Function) -> tuple[Value, ...]:
        """Flat arguments as one value a parameter."""
        values, position = [], 0
        for parameter in function.parameters:
            size = len(self.encoder.variable("size", parameter.type))
            values.append(self._value(terms[position : position + size], parameter.type))
            position += size
        return tuple(values)

    # ------------------------------------------------------------------------------------- values

    def _eval(self, term: Any) -> Any:
        return self.found.eval(term, model_completion=True)

    def _value(self, terms: tuple[Any, ...], type_: Type) -> Value:
        plain = underlying(type_)
        if isinstance(plain, VectorType) and plain.length is not None:
            size = len(terms) // plain.length if plain.length else 0
            parts = [terms[i * size : (i + 1) * size] for i in range(plain.length)]
            return tuple(self._value(part, plain.element) for part in parts)
        return self._scalar(self._eval(terms[0]), plain, str(type_))

    def _scalar(self, value: Any, type_: Type, name: str) -> Value:
        match type_:
            case ObjectType():
                return self.names.get(str(value))
            case _ if is_boolean(type_):
                return z3.is_true(value)
            case _ if is_integer(type_):
                return value.as_long()
            case _ if is_number(type_):
                return _as_float(value)
            case _ if type_ == STRING:
                return self._text(value.as_long())
            case VectorType() | ListType() | _:
                return Opaque(name, value.as_long())

    def _text(self, number: int) -> str:
        known = {code: text for text, code in self.encoder.texts.items()}
        if number in known:
            return known[number]
        names = (f"text {abs(number)}" + "-" * i for i in count(number < 0))
        return next(name for name in names if name not in self.encoder.texts)


def _as_float(value: Any) -> float:
    if z3.is_algebraic_value(value):
        value = value.approx(20)
    return float(Fraction(value.numerator_as_long(), value.denominator_as_long()))


def _named(program: Program) -> tuple[Any, ...]:
    return (
        *program.constants,
        *program.features,
        *program.functions,
        *program.controllers,
        *program.behaviors,
        *program.generators,
    )


def blocked(reader: Reader, variables: Mapping[str, Type]) -> Any:
    """That something is different from a model: an argument, a kind or the value of a cell."""
    terms = [t for name, type_ in variables.items() for t in reader.encoder.variable(name, type_)]
    terms += [reader.universe.kind(term) for term in reader.universe.others]
    world = World.of(reader.program, reader.objects)
    for feature in reader.encoder.features.values():
        for where in world.cells(feature):
            terms += reader.encoder.cell(feature, [reader.terms[name] for name in where])
    differ = [term != reader.found.eval(term, model_completion=True) for term in terms]
    return z3.Or([*differ, z3.BoolVal(False, reader.encoder.ctx)])  # noqa: FBT003 - a value
