"""Python bound to the declarations of one program, with all that does not fit told at once."""

import inspect
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from difflib import get_close_matches
from typing import Any, Final, assert_never, get_args

from crow.functions import (
    NOTHING,
    FunctionsError,
    Given,
    Kind,
    Mark,
    Mistake,
    Python,
    Registered,
    Registration,
    collected,
)
from crow.program import Controller, Function, Generator, Program, Simulate, Variable
from crow.program.dependencies import declared_reads, generator_reads

_Declared = Function | Generator | Controller


def registered(program: Program, given: object) -> Registered:
    """What is given, bound to the declarations of a program; None for nothing.

    Raises FunctionsError, with every mistake: what the program does not declare or declares
    otherwise, what is given twice, and what cannot be called with as many values.
    """
    if given is None:
        return NOTHING
    if isinstance(given, Registered):
        return given
    taken = collected(given).given
    binding = _Binding(program, taken)
    for one in taken:
        binding.take(one)
    if binding.mistakes:
        told = "\n".join(
            m.message if m.help is None else f"{m.message}; {m.help}" for m in binding.mistakes
        )
        raise FunctionsError(told, tuple(binding.mistakes))
    return Registered(**{f"{kind}s": found for kind, found in binding.found.items()})


def with_effects(program: Program, given: Registered) -> Program:
    """The program whose controllers have the effects that Python computes for them."""
    if not given.effects:
        return program
    controllers = [
        replace(c, effect=(_simulated(c),)) if c.name in given.effects else c
        for c in program.controllers
    ]
    return replace(program, controllers=tuple(controllers))


def _simulated(controller: Controller) -> Simulate:
    arguments = tuple(Variable(p.name, p.type) for p in controller.parameters)
    return Simulate(controller.name, arguments, location=controller.location)


class _Binding:
    """What was taken so far for the declarations of one program, and what is wrong with it."""

    def __init__(self, program: Program, given: Sequence[Given]) -> None:
        self.program = program
        self.given = given
        self.mistakes: list[Mistake] = []
        self.found: dict[Kind, dict[str, Registration]] = {k: {} for k in get_args(Kind)}
        self.declared: dict[Kind, dict[str, _Declared]] = {
            "function": {f.name: f for f in program.functions if f.body is None},
            "generator": {g.name: g for g in program.generators},
            "effect": {c.name: c for c in program.controllers},
            "controller": {c.name: c for c in program.controllers},
        }

    def take(self, given: Given) -> None:
        """Bind one function, or note why it cannot be."""
        mark = given.mark or self._plain(given)
        if mark is None:
            return
        declared = self.declared[mark.kind].get(given.name)
        if declared is None:
            if self._is_mistaken(given, mark.kind):
                self._undeclared(given.name, mark.kind)
            return
        if given.name in self.found[mark.kind]:
            if given.is_meant:
                self._mistake(f"the {mark.kind} `{given.name}` is given twice", declared)
            return
        one = self._registration(given, mark, declared)
        if one is not None:
            self.found[mark.kind][given.name] = one

    def _plain(self, given: Given) -> Mark | None:
        """What a function without a decorator is for, by its name."""
        for kind, mark in _PLAIN.items():
            if given.name in self.declared[kind]:
                return mark
        if given.is_meant and given.name in self.declared["controller"]:
            self._mistake(
                f"`{given.name}` is a controller: its Python has to say what it is",
                self.declared["controller"][given.name],
                "decorate it with `@crow.effect` or `@crow.controller`",
            )
        elif given.is_meant:
            self._undeclared(given.name, "function")
        return None

    def _is_mistaken(self, given: Given, kind: Kind) -> bool:
        """Whether something that the program does not declare is a mistake.

        A module or object may serve several programs: what is decorated in it is a mistake only if
        something of its kind is missing that it was perhaps meant to be.
        """
        if given.is_named or any(given.name == d.name for d in _definitions(self.program)):
            return given.is_meant
        missing = list(self.declared[kind].keys() - {one.name for one in self.given})
        others = [one for one in self.given if one.name not in self.declared[kind]]
        likely = [one for one in others if get_close_matches(one.name, missing, 1)]
        return bool(missing) and (given in likely or not likely)

    def _undeclared(self, name: str, kind: Kind) -> None:
        declared = {d.name: d for d in _definitions(self.program)}
        other = declared.get(name)
        wanted = _WANTED[kind]
        if other is not None:
            self._mistake(f"`{name}` is {_what(other)}, not {wanted}", other)
            return
        near = get_close_matches(name, list(self.declared[kind]), 1)
        message = f"the program has no {_KINDS[kind]} `{name}`"
        self._mistake(message, None, f"did you mean `{near[0]}`?" if near else None)

    def _registration(self, given: Given, mark: Mark, declared: _Declared) -> Registration | None:
        reads: frozenset[str] | None = None
        match declared:
            case Function(parameters=values):
                reads = declared_reads(self.program, declared)
            case Generator(inputs=values):
                reads = generator_reads(self.program, declared)
            case Controller(parameters=values):
                if mark.kind == "effect":
                    reads = _every(self.program)
            case _:
                assert_never(declared)
        fault = _fault(given, mark, len(values), has_state=reads is not None)
        help_ = None
        if mark.kind == "effect" and getattr(declared, "effect", None) is not None:
            fault = f"the controller `{given.name}` has an `eff:` of its own already"
            help_ = "take one of the two away"
        if fault is not None:
            self._mistake(fault, declared, help_)
            return None
        takes = mark.kind == "generator" and _takes_random(given.call)
        return Registration(given.name, given.call, mark, reads, takes)

    def _mistake(self, message: str, declared: Any, help_: str | None = None) -> None:
        self.mistakes.append(Mistake(message, getattr(declared, "location", None), help_))


_PLAIN: Final[Mapping[Kind, Mark]] = {
    "function": Mark("function"),
    "generator": Mark("generator"),
}
_KINDS: Final[Mapping[Kind, str]] = {
    "function": "external function",
    "generator": "generator",
    "effect": "controller",
    "controller": "controller",
}
_WANTED: Final[Mapping[Kind, str]] = {
    "function": "an external function (`def` without a body)",
    "generator": "a generator",
    "effect": "a controller",
    "controller": "a controller",
}


def _definitions(program: Program) -> Iterator[Any]:
    yield from (*program.features, *program.functions, *program.controllers)
    yield from (*program.behaviors, *program.generators, *program.constants)


def _what(definition: Any) -> str:
    if isinstance(definition, Function):
        return "an external function" if definition.body is None else "a derived function"
    kind = type(definition).__name__
    return {"ObjectConstant": "an object"}.get(kind, f"a {kind.lower()}")


def _every(program: Program) -> frozenset[str]:
    return frozenset(feature.name for feature in program.features)


def _fault(given: Given, mark: Mark, count: int, *, has_state: bool) -> str | None:
    """Why a Python function cannot be what it is given for."""
    python = given.call
    if inspect.iscoroutinefunction(python) or inspect.isasyncgenfunction(python):
        return f"`{given.name}` is `async`, and is called without an event loop"
    if mark.kind != "generator" and inspect.isgeneratorfunction(python):
        return f"`{given.name}` yields, which only generators do; a {mark.kind} returns"
    try:
        signature = inspect.signature(python)
    except (TypeError, ValueError):  # some of those written in C do not tell
        return None
    named = {"rng": None} if mark.kind == "generator" and _takes_random(python) else {}
    try:
        signature.bind(*[None] * (count + has_state), **named)
    except TypeError:
        state = "the state and " if has_state else ""
        values = f"{count} value{'' if count == 1 else 's'}"
        own = f"{getattr(python, '__name__', given.name)}{signature}"
        return f"`{given.name}` is called with {state}{values}, which `{own}` does not take"
    return None


def _takes_random(python: Python) -> bool:
    """Whether a function has a parameter `rng`."""
    try:
        parameter = inspect.signature(python).parameters.get("rng")
    except (TypeError, ValueError):
        return False
    kinds = (inspect.Parameter.KEYWORD_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    return parameter is not None and parameter.kind in kinds
