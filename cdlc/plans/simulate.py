"""Applying behaviors one after another, each effect statement by statement."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

from cdlc.diagnostics import Collector
from cdlc.plans.calls import BadStepError, read_call, resolve_behavior
from cdlc.plans.errors import OpenChoice, StepFailed
from cdlc.render import span_json
from cdlc.source import SourceFile, Span
from crow.problem import Problem, State, World
from crow.program import Location
from crow.program.types import is_boolean
from crow.transition import Ambiguous, Unmet, apply
from crow.values import Value, default_value, json_value, shown


@dataclass(frozen=True, slots=True)
class Simulation:
    """The state after the last step that could be applied, and what stopped it, if anything did."""

    world: World
    state: State
    failed: StepFailed | None = None
    is_complete: bool = True

    def json(self) -> dict[str, Any]:
        """The `simulate --format json` document (schemas/simulate.json)."""
        document: dict[str, Any] = {"version": 1, "state": state_json(self.world, self.state)}
        if self.failed is not None:
            failed = self.failed
            span = None if failed.where is None else span_json(failed.where)
            document["failed"] = {"step": failed.step, "condition": failed.condition, "span": span}
        return document


def simulate(
    problem: Problem, steps: list[str], found: Collector, sources: dict[str, SourceFile]
) -> Simulation:
    """Apply steps, `behavior(a, b, bind=c)`, from the initial state.

    What is wrong with a step is reported to `found`; `sources` gets the text of each.
    """
    state = problem.initial
    for number, text in enumerate(steps, 1):
        source = SourceFile(f"<step {number}>", text)
        sources[source.name] = source
        span = Span(0, len(text))
        try:
            call = resolve_behavior(read_call(source, span), problem.world)
        except BadStepError as error:
            found.add(error.diagnostic)
            return Simulation(problem.world, state, is_complete=False)
        applied = apply(problem.world, state, call.behavior, call.arguments, call.bindings)
        location = source.location(span)
        match applied.problem:
            case Ambiguous() as open_:
                found.add(
                    OpenChoice(
                        location=location,
                        variable=open_.variable,
                        choices=open_.choices,
                        where=open_.location,
                    )
                )
                return Simulation(problem.world, state, is_complete=False)
            case Unmet() as unmet:
                failed = step_failed(location, text, number, unmet)
                found.add(failed)
                return Simulation(problem.world, state, failed, is_complete=False)
            case None:
                state = applied.state
    return Simulation(problem.world, state)


def step_failed(location: Location, text: str, number: int, unmet: Unmet) -> StepFailed:
    """The diagnostic of a step whose condition does not hold."""
    return StepFailed(
        location=location,
        step=text.strip(),
        number=number,
        condition=unmet.condition,
        reason=unmet.reason,
        where=unmet.location,
    )


def state_json(world: World, state: State) -> dict[str, Any]:
    """The features of a state by cell: Boolean ones where true, others always."""
    return {text: json_value(value) for text, value, _ in _cells(world, state)}


def state_text(world: World, state: State) -> str:
    """As state_json, a line a cell."""
    lines = []
    for text, value, written in _cells(world, state):
        lines.append(f"{text}\n" if value is True else f"{text} = {written}\n")
    return "".join(lines)


def _cells(world: World, state: State) -> Iterator[tuple[str, Value, str]]:
    """Cells with their values, and these as CDL writes them, in order of declaration."""
    for feature in world.program.features:
        cells: Iterable[tuple[str, ...]] = world.cells(feature)
        if is_boolean(feature.type):
            # Few of a feature's cells are true, and it may have very many.
            cells = _true_cells(world, state, feature.name)
        for arguments in cells:
            value = state.cells.get((feature.name, arguments), default_value(feature.type))
            text = f"{feature.name}({', '.join(arguments)})"
            yield text, value, "?" if value is None else shown(value, feature.type)


def _true_cells(world: World, state: State, feature: str) -> list[tuple[str, ...]]:
    places = {name: index for index, name in enumerate(world.objects)}
    true = [where for (name, where), value in state.cells.items() if name == feature and value]
    return sorted(true, key=lambda where: [places[name] for name in where])
