"""Conditions as facts that are all needed, as far as their variables are known."""

from collections.abc import Iterator, Mapping
from itertools import product

from crow.evaluate import EvaluationError
from crow.program import (
    And,
    Compare,
    Constant,
    Expression,
    Not,
    Object,
    ObjectType,
    Or,
    Quantified,
    Read,
    Variable,
)
from crow.program.dependencies import features_read, features_written
from crow.program.types import BOOL, underlying
from crow.program.walk import free_variables
from crow.search.compile import Programs
from crow.search.expressions import Compiled
from crow.search.relaxed.facts import CellFact, Made, Needs, OpaqueFact, Operator, Task
from crow.search.states import Snapshot
from crow.values import Value

Names = Mapping[str, Value]
"""The variables that have a value."""

MOST_INSTANCES = 2_000
"""A quantifier over more objects is evaluated as it stands."""


class Conditions:
    """Makes the facts of conditions of one world."""

    def __init__(self, programs: Programs, task: Task, initial: Snapshot) -> None:
        self.world = programs.world
        self.compiler = programs.compiler
        self.conditions = programs.conditions
        self.task = task
        self.initial = initial
        self.changing = frozenset(self._changing())
        self._compiled: dict[Expression, tuple[Compiled, tuple[str, ...], frozenset[str]]] = {}
        # By identity: conditions belong to the program, and hashing them walks over them.
        self._known: dict[tuple[int, tuple[Value, ...]], Needs] = {}
        self._free: dict[int, tuple[str, ...]] = {}

    def _changing(self) -> set[str]:
        """The features that any effect writes."""
        program = self.world.program
        effects = [o.effect for o in program.behaviors] + [o.effect for o in program.controllers]
        return {name for effect in effects for name in features_written(program, effect or ())}

    def needs(self, condition: Expression, names: Names) -> Needs:
        """The facts that a condition needs; parts with unknown variables are left out."""
        free = self._free.get(id(condition))
        if free is None:
            free = self._free[id(condition)] = tuple(sorted(free_variables(condition)))
        key = (id(condition), tuple([names.get(name) for name in free]))
        if key not in self._known:
            known = {name: value for name, value in zip(free, key[1], strict=True)
                     if value is not None}  # fmt: skip
            self._known[key] = self._of(self.conditions.normal(condition), known)
        return self._known[key]

    def _of(self, node: Expression, names: Names) -> Needs:
        match node:
            case Constant(value=bool(value)):
                return () if value else None
            case And(operands=operands):
                return self.all_of([self._of(o, names) for o in operands])
            case Or(operands=operands):
                return self.one_of([self._of(o, names) for o in operands])
            case Quantified():
                return self._quantified(node, names)
            case Read():
                return self._cell(node, names, value=True)
            case Not(operand=Read() as read):
                return self._cell(read, names, value=False)
            case Compare(operator="==" | "!=" as op, left=left, right=right):
                for side, other in ((left, right), (right, left)):
                    value = self.value(other, names)
                    if isinstance(side, Read) and value is not None:
                        return self._cell(side, names, value, is_equal=op == "==")
                return self._evaluated(node, names)
            case _:
                return self._evaluated(node, names)

    def all_of(self, parts: list[Needs]) -> Needs:
        """The facts of several conditions."""
        found: dict[int, None] = {}
        for part in parts:
            if part is None:
                return None
            found |= dict.fromkeys(part)
        return tuple(found)

    def one_of(self, parts: list[Needs]) -> Needs:
        """One fact that each of several conditions makes true."""
        possible = list(dict.fromkeys(part for part in parts if part is not None))
        if not possible or () in possible:
            return () if possible else None
        if len(possible) == 1:
            return possible[0]
        number = self.task.fact(Made(tuple(possible)))
        if not any(number in o.claims for o in self.task.operators[-len(possible) :]):
            for part in possible:
                self.task.operator(Operator(0, part, [number]))
        return (number,)

    def _quantified(self, node: Quantified, names: Names) -> Needs:
        domains = [self.world.objects_of(v.type) for v in node.variables]
        count = 1
        for domain in domains:
            count *= len(domain)
        if count > MOST_INSTANCES:
            return self._evaluated(node, names)
        own = [v.name for v in node.variables]
        parts = [
            self._of(node.body, {**names, **dict(zip(own, chosen, strict=True))})
            for chosen in product(*domains)
        ]
        return self.all_of(parts) if node.quantifier == "forall" else self.one_of(parts)

    def _cell(self, read: Read, names: Names, value: Value, *, is_equal: bool = True) -> Needs:
        arguments = tuple(self.value(a, names) for a in read.arguments)
        if None in arguments:
            return self._evaluated(read, names) if value is True else ()
        if underlying(read.type) == BOOL and not is_equal:
            value, is_equal = not value, True
        cell = (read.feature, arguments)
        if read.feature not in self.changing:
            own = self.initial.base.get(cell, self.task.defaults[read.feature])
            return () if (own == value) == is_equal else None
        return (self.task.fact(CellFact(cell, value, is_equal)),)

    def readings(self, read: Read, names: Names) -> Iterator[tuple[Value, Needs]]:
        """What a feature may hold, with the facts that this needs; None for any other value."""
        if isinstance(read.type, ObjectType):
            for value in self.world.objects_of(read.type):
                yield value, self._cell(read, names, value)
        else:
            yield None, ()

    def value(self, node: Expression, names: Names) -> Value:
        """The value of an expression that no state changes; None for any other."""
        match node:
            case Constant(value=value):
                return value
            case Object(name=name):
                return name
            case Variable(name=name):
                return names.get(name)
            case Read(feature=feature, arguments=arguments) if feature not in self.changing:
                own = tuple(self.value(a, names) for a in arguments)
                unset = self.task.defaults[feature]
                return None if None in own else self.initial.base.get((feature, own), unset)
            case _:
                return None

    def _evaluated(self, node: Expression, names: Names) -> Needs:
        """A condition to evaluate as it stands; nothing where a variable is unknown."""
        compiled, free, reads = self.compiled(node)
        values = tuple(names.get(name) for name in free)
        if None in values:
            return ()
        if not reads & self.changing:
            try:
                return () if compiled(self.initial, values) else None
            except EvaluationError:
                return None
        return (self.task.fact(OpaqueFact(compiled, values, reads & self.changing)),)

    def compiled(self, node: Expression) -> tuple[Compiled, tuple[str, ...], frozenset[str]]:
        """A function for an expression, the names of its slots, and the features it reads."""
        found = self._compiled.get(node)
        if found is None:
            free = tuple(sorted(free_variables(node)))
            slots = {name: index for index, name in enumerate(free)}
            reads = features_read(self.world.program, (node,))
            found = self._compiled[node] = (
                self.compiler.expression(node, slots), free, reads,
            )  # fmt: skip
        return found
