"""Constraint problems from CDL: variables with types, conditions as text, functions in Python."""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cache
from itertools import islice
from textwrap import dedent, indent
from typing import Any

from programs import problem_of

from crow.constraints import Conflict, Constraint, Draws, Solutions, Solver, Store
from crow.evaluate import evaluate
from crow.problem import Problem, State, World
from crow.program import Expression, Return
from crow.registration import registered
from crow.unknowns import Unknown, resolved
from crow.values import Value, stored


@cache
def _problem(domain: str, objects: str, init: str) -> Problem:
    lines = indent(dedent(init).strip(), "  ")
    given = "".join(f"  {line.strip()}\n" for line in objects.split(";")) if objects else ""
    head = f"objects:\n{given}" if given else ""
    return problem_of(domain, f'problem "p"\n{head}init:\n{lines}\ngoal: True\n')


@dataclass
class Posed:
    """Variables and constraints over a domain; the conditions are those of its functions."""

    world: World
    state: State
    unknowns: dict[str, Unknown]
    constraints: tuple[Constraint, ...]
    values: dict[str, Value] = field(default_factory=dict)

    @property
    def store(self) -> Store:
        """The store with all constraints, which do not clash at once."""
        found = Store.of(self.world).having(*self.constraints)
        assert isinstance(found, Store), str(found)
        return found

    @property
    def conflict(self) -> Conflict:
        found = Store.of(self.world).having(*self.constraints)
        assert isinstance(found, Conflict)
        return found

    def solver(self, seed: int = 0, limit: int | None = None) -> Solver:
        return Solver(self.world, Draws(self.world, seed, limit))

    def solutions(self, seed: int = 0, limit: int | None = None, **options: Any) -> Solutions:
        return self.solver(seed, limit).solutions(self.store, **options)

    def found(self, count: int = 100, **options: Any) -> list[dict[str, Value]]:
        """The first solutions by names, each checked by the interpreter."""
        return [self.checked(s) for s in islice(self.solutions(**options), count)]

    def checked(self, solution: Store) -> dict[str, Value]:
        """The values of a solution, after the interpreter has agreed to all constraints."""
        assert not solution.pending
        for constraint in self.constraints:
            assert self.is_true(constraint, solution.values), str(constraint)
        return {n: solution.values[u] for n, u in self.unknowns.items() if u in solution.values}

    def is_true(self, constraint: Constraint, values: Mapping[Unknown, Value]) -> bool:
        """Whether the interpreter finds a constraint true under some values."""
        variables = {n: resolved(v, values) for n, v in constraint.variables.items()}
        cells = {c: resolved(v, values) for c, v in constraint.state.cells.items()}
        value = evaluate(self.world, State(cells), constraint.condition, variables)
        if constraint.defined is not None:
            return bool(values[constraint.defined] == stored(value, constraint.defined.type))
        return bool(value) == constraint.is_wanted


def posed(
    variables: str,
    conditions: Iterable[str] | str,
    domain: str = "",
    *,
    objects: str = "",
    init: str = "pass",
    functions: Mapping[str, Any] | None = None,
    cells: Mapping[str, tuple[str, ...]] | None = None,
    known: Mapping[str, Value] | None = None,
) -> Posed:
    """A problem of `x, y: float64; b: bool`, one condition a line, perhaps after `not wanted:`.

    `cells` are cells that hold an unknown: its name, with feature and objects. `known` are values
    of variables.
    """
    lines = conditions.strip().splitlines() if isinstance(conditions, str) else list(conditions)
    texts = [line.strip() for line in lines]
    wanted = [not text.startswith("not wanted:") for text in texts]
    types = _types(variables)
    bodies = [text.removeprefix("not wanted:") for text in texts]
    written = "".join(
        f"def condition_{i}({_parameters(body, types)}): return {body}\n"
        for i, body in enumerate(bodies)
    )
    written += f"def variables({', '.join(f'{n}: {t}' for n, t in types.items())}): return True\n"
    problem = _problem(dedent(domain) + written, objects, init)
    world = World.of(problem.world.program)
    world = World(
        problem.world.program,
        problem.world.objects,
        registered(problem.world.program, functions) if functions else world.registered,
    )
    known = dict(known or {})
    parameters = world.functions["variables"].parameters
    unknowns = {p.name: Unknown(p.name, p.type) for p in parameters if p.name not in known}
    state = world.updated(
        problem.initial,
        {(where[0], where[1:]): unknowns[name] for name, where in (cells or {}).items()},
    )
    constraints = tuple(
        Constraint(_condition(world, i), {**unknowns, **known}, state, is_wanted)
        for i, is_wanted in enumerate(wanted)
    )
    return Posed(world, state, unknowns, constraints, known)


def _types(variables: str) -> dict[str, str]:
    found = {}
    for group in variables.split(";"):
        names, _, type_ = group.partition(":")
        found |= {name.strip(): type_.strip() for name in names.split(",")}
    return found


def _parameters(text: str, types: Mapping[str, str]) -> str:
    """The parameters of a condition: the variables that it names."""
    named = dict.fromkeys(re.findall(r"\w+", text))
    return ", ".join(f"{name}: {types[name]}" for name in named if name in types)


def _condition(world: World, index: int) -> Expression:
    body = world.functions[f"condition_{index}"].body
    assert body is not None
    (statement,) = body
    assert isinstance(statement, Return)
    return statement.value
