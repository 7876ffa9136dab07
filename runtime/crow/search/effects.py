"""Effects as functions from state to state; plain assignments are compiled."""

from collections.abc import Callable
from typing import Any

from crow.evaluate import changes
from crow.problem import World
from crow.program import Apply, Assign, Expression, Read, Statement
from crow.program.walk import expressions_of, subexpressions
from crow.search.expressions import Compiler, Environment, Slots, is_plain
from crow.search.states import Snapshot

Effect = Callable[[Snapshot, Environment], Snapshot]
"""May raise EvaluationError: such a transition is not applicable."""


class Effects:
    """Compiles the effects of one world."""

    def __init__(self, world: World, compiler: Compiler) -> None:
        self.world = world
        self.compiler = compiler

    def effect(self, statements: tuple[Statement, ...], slots: Slots) -> Effect:
        """A function for the state after an effect."""
        written = set[str]()
        for statement in statements:
            if not self._is_simple(statement, written):
                return self._interpreted(statements, slots)
        return self._assignments([s for s in statements if isinstance(s, Assign)], slots)

    def _is_simple(self, statement: Statement, written: set[str]) -> bool:
        """Whether a statement is `f[a, …] = e`, with values that the effect has not yet changed.

        `written` are the features that it has assigned so far.
        """
        if not isinstance(statement, Assign) or statement.operator != "=":
            return False
        feature = self.world.features[statement.feature]
        parts = [p for e in expressions_of(statement) for p in subexpressions(e)]
        changed = any(
            isinstance(part, Apply) or (isinstance(part, Read) and part.feature in written)
            for part in parts
        )
        written.add(feature.name)
        return not changed and feature.bounds == (None, None) and is_plain(feature.type)

    def _assignments(self, statements: list[Assign], slots: Slots) -> Effect:
        def value(node: Expression) -> Any:
            return self.compiler.expression(node, slots)

        writes = [(s.feature, tuple(map(value, s.arguments)), value(s.value)) for s in statements]

        def effect(state: Snapshot, values: Environment) -> Snapshot:
            return state.store.after(
                state,
                [
                    ((feature, tuple([a(state, values) for a in arguments])), new(state, values))
                    for feature, arguments, new in writes
                ],
            )

        return effect

    def _interpreted(self, statements: tuple[Statement, ...], slots: Slots) -> Effect:
        world = self.world

        def effect(state: Snapshot, values: Environment) -> Snapshot:
            variables = {name: values[slot] for name, slot in slots.items()}
            written = changes(world, state.cells, statements, variables)
            return state.store.after(state, written.items())

        return effect
