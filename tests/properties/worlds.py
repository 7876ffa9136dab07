"""The small world that random effects and formulas run in, and its states."""

from hypothesis import strategies as st
from properties.effects import FEATURES, PARAMETERS, program

from crow.problem import State, World
from crow.program import BOOL, Parameter
from crow.program.types import INT64

OBJECTS = (Parameter("a", PARAMETERS[0].type), Parameter("c", PARAMETERS[2].type))
WORLD = World.of(program(()), OBJECTS)


@st.composite
def states(draw: st.DrawFn, world: World = WORLD) -> State:
    """A state with a value for every cell."""
    cells = {}
    for feature in FEATURES:
        for arguments in world.cells(feature):
            if feature.type == BOOL:
                value: object = draw(st.booleans())
            elif feature.type == INT64:
                value = draw(st.integers(-2, 4))
            else:
                value = draw(st.sampled_from(world.objects_of(feature.type)))
            cells[feature.name, arguments] = value
    return world.updated(State(), cells)
