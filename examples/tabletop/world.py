"""What the tabletop program leaves to Python: a table in MuJoCo, asked and tried out.

Blocks stand on a table. A hand on three rails, a rod with a suction pad at its end, carries them
one at a time, or pushes them. Collisions are those that the engine finds with a block or the rod
put somewhere; what a controller leads to is what happens when it is carried out in a simulation
that begins with all blocks where the state has them, at rest.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from itertools import cycle, product
from pathlib import Path
from threading import get_ident
from typing import TYPE_CHECKING

import mujoco
import numpy as np
from numpy.typing import NDArray

import crow

if TYPE_CHECKING:
    from crow import StateView

Floats = NDArray[np.float64]
Pose = tuple[float, ...]
"""A position in metres, and a quaternion."""
Size = tuple[float, float, float]
Box = tuple[float, float, float, float]
Stroke = tuple[float, float, float, float]
"""Where the rod comes down, and where it pushes to."""

PAD = 0.012
"""Half of a side of the rod, which is square."""
SAFE, LOW = 0.32, 0.012
"""How high the end of the rod is while nothing is to be met, and while it pushes."""
SPEED, PUSHING = 0.5, 0.15
"""Metres a second."""
OVERLAP, NEAR = 5e-4, 1e-3
"""What is deeper in another thing than this collides with it, and what is nearer touches it."""
BEFORE = 0.01
"""How far from a block the rod comes down to push it."""
STRIDE = 0.02
"""Collisions of what is pushed are looked for so often."""
MARGIN = 0.004
"""To the border of a region, as nothing lands where it was put to the last digit."""
AT_REST = 1e-4
"""What has moved by less has not moved."""
MARK = (0.93, 0.84, 0.70, 1.0)
COLOURS = (
    (0.85, 0.33, 0.31), (0.42, 0.70, 0.45), (0.36, 0.58, 0.82), (0.80, 0.66, 0.45),
    (0.61, 0.49, 0.87), (0.93, 0.68, 0.29),
)  # fmt: skip


# ------------------------------------------------------------------------------------------- model


@dataclass(frozen=True)
class Body:
    """A block: the lengths of its sides in metres, and its mass in kilograms."""

    name: str
    size: Size
    mass: float


@dataclass(frozen=True)
class Setting:
    """What does not change: blocks, and the regions that are marked on the table."""

    bodies: tuple[Body, ...]
    regions: tuple[Box, ...] = ()


def model_of(setting: Setting) -> mujoco.MjModel:
    """The scene with blocks and regions."""
    scene = mujoco.MjSpec.from_file(str(Path(__file__).with_name("scene.xml")))
    box = mujoco.mjtGeom.mjGEOM_BOX
    for body, colour in zip(setting.bodies, cycle(COLOURS)):
        block = scene.worldbody.add_body(name=body.name)
        block.add_freejoint(name=body.name)
        half = np.array(body.size) / 2
        block.add_geom(name=body.name, type=box, size=half, mass=body.mass, rgba=(*colour, 1))
    for x, y, to_x, to_y in setting.regions:
        scene.worldbody.add_geom(
            type=box,
            pos=((x + to_x) / 2, (y + to_y) / 2, 0),
            size=((to_x - x) / 2, (to_y - y) / 2, 0.0005),
            rgba=MARK,
            contype=0,
            conaffinity=0,
        )
    return scene.compile()


# -------------------------------------------------------------------------------------- simulation


class Simulation:
    """A table that goes on from state to state; `tell` is called with it after each step."""

    def __init__(self, setting: Setting) -> None:
        self.bodies = {body.name: body for body in setting.bodies}
        self.model = model_of(setting)
        self.data = mujoco.MjData(self.model)
        self.tell: Callable[[Simulation], None] = lambda _: None
        self._places = {name: self.model.joint(name).qposadr[0] for name in self.bodies}

    def reset(self, poses: Mapping[str, Pose]) -> None:
        """Put blocks in their poses, at rest, and the hand above the middle of the table."""
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[2] = self.data.ctrl[2] = SAFE
        for name, pose in poses.items():
            self.put(name, pose)
        mujoco.mj_forward(self.model, self.data)

    @contextmanager
    def aside(self) -> Iterator[None]:
        """What is done within is undone: the state is saved and restored."""
        kind = mujoco.mjtState.mjSTATE_INTEGRATION
        saved = np.empty(mujoco.mj_stateSize(self.model, kind))
        mujoco.mj_getState(self.model, self.data, saved, kind)
        try:
            yield
        finally:
            mujoco.mj_setState(self.model, self.data, saved, kind)
            mujoco.mj_forward(self.model, self.data)

    def pose(self, name: str) -> Pose:
        """Where a block is."""
        place = self._places[name]
        return tuple(self.data.qpos[place : place + 7].tolist())

    def poses(self) -> dict[str, Pose]:
        """Where all blocks are."""
        return {name: self.pose(name) for name in self.bodies}

    def put(self, name: str, pose: Iterable[float]) -> None:
        """Put a block somewhere; it has to be told the engine with the rest."""
        place = self._places[name]
        self.data.qpos[place : place + 7] = tuple(pose)

    # ---------------------------------------------------------------------------------- collisions

    def touching(self, name: str, most: float = NEAR) -> set[str]:
        """The geometries that are not farther from one than some distance."""
        own, found = self.model.geom(name).id, set()
        for contact in self.data.contact[: self.data.ncon]:
            if own in contact.geom and contact.dist < most:
                found.add(self.model.geom(int(contact.geom.sum()) - own).name)
        return found

    def collisions(self, name: str) -> set[str]:
        """The geometries that one is in as things are now put; what it touches is none of them."""
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_collision(self.model, self.data)
        return self.touching(name, -OVERLAP)

    def swept(self, name: str, stroke: Stroke) -> set[str]:
        """The geometries that the rod, or the block that it pushes, is in along a stroke."""
        start, end = np.array(stroke[:2]), np.array(stroke[2:])
        x, y, z, *turned = self.pose(name)
        length = float(np.linalg.norm(end - start))
        found = set()
        with self.aside():
            for part in np.linspace(0, 1, 2 + int(length / STRIDE)):
                moved = max(0.0, part - BEFORE / length) * (end - start)
                self.put(name, (x + moved[0], y + moved[1], z, *turned))
                self.data.qpos[:3] = *(start + part * (end - start)), LOW
                found |= self.collisions(name) | self.collisions("rod")
        return found - {name, "rod"}

    # --------------------------------------------------------------------------------- controllers

    def transfer(self, name: str, pose: Pose) -> None:
        """Suck a block up at its middle, and put its middle down somewhere else."""
        (x, y, z), (to_x, to_y, to_z) = self.pose(name)[:3], pose[:3]
        half = self.bodies[name].size[2] / 2
        self._go(x, y, SAFE)
        self._go(x, y, z + half)
        self.data.ctrl[3] = 1.0
        self._wait(0.1)
        self._go(x, y, SAFE)
        self._go(to_x, to_y, SAFE)
        self._go(to_x, to_y, to_z + half + 0.001)
        self._wait(0.1)
        self.data.ctrl[3] = 0.0
        self._wait(0.1)
        self._go(to_x, to_y, SAFE)
        self.settle()

    def push(self, stroke: Stroke) -> None:
        """Lower the rod, go straight to a place, and back, so that it rubs along nothing."""
        start, end = stroke[:2], stroke[2:]
        self._go(*start, SAFE)
        self._go(*start, LOW)
        self._go(*end, LOW, PUSHING)
        self._wait(0.1)
        self._go(*start, LOW)
        self._go(*start, SAFE)
        self.settle()

    def settle(self, seconds: float = 2.0) -> None:
        """Go on until nothing moves any more, or some time is over."""
        for number in range(round(seconds / self.model.opt.timestep)):
            self.step()
            if number > 20 and np.abs(self.data.qvel).max() < 1e-3:
                break

    def step(self) -> None:
        """Go on by one step of time."""
        mujoco.mj_step(self.model, self.data)
        self.tell(self)

    def _go(self, x: float, y: float, z: float, speed: float = SPEED) -> None:
        """Move the end of the rod on a straight line, gently at its ends."""
        start, end = self.data.ctrl[:3].copy(), np.array([x, y, z])
        count = int(np.linalg.norm(end - start) / speed / self.model.opt.timestep)
        for number in range(1, count + 1):
            part = number / count
            self.data.ctrl[:3] = start + part * part * (3 - 2 * part) * (end - start)
            self.step()
        self.data.ctrl[:3] = end
        self._wait(0.04)

    def _wait(self, seconds: float) -> None:
        for _ in range(round(seconds / self.model.opt.timestep)):
            self.step()


@lru_cache(maxsize=16)
def _simulation(setting: Setting, _thread: int) -> Simulation:
    return Simulation(setting)


def simulation_of(state: "StateView") -> Simulation:
    """A simulation of a state, which is not for others: it is used again for the next one."""
    blocks = state.objects("Block")
    bodies = tuple(Body(b, state.size(b), state.mass(b)) for b in blocks)
    simulation = _simulation(Setting(bodies), get_ident())
    simulation.reset({b: state.pose(b) for b in blocks})
    return simulation


# ---------------------------------------------------------------------------------------- geometry


def axes(pose: Pose) -> Floats:
    """The directions of a block's sides, as columns."""
    found = np.zeros(9)
    mujoco.mju_quat2Mat(found, np.array(pose[3:]))
    return found.reshape(3, 3)


def corners(pose: Pose, size: Size) -> Floats:
    """The corners of a block, a row for each."""
    signs = np.array(list(product((-0.5, 0.5), repeat=3)))
    return np.asarray(pose[:3]) + (signs * size) @ axes(pose).T


def lies_in(points: Floats, area: Box, margin: float = 0.0) -> bool:
    """Whether a block with some corners stands on the table, within an area."""
    low, high = np.array(area[:2]) + margin, np.array(area[2:]) - margin
    across = points[:, :2]
    stands = abs(points[:, 2].min()) < 5 * NEAR
    return bool(stands and (low <= across).all() and (across <= high).all())


# --------------------------------------------------------------------------------------- functions


@crow.function
def inside(state: "StateView", b: str, r: str) -> bool:
    """Whether a block stands on the table within a region."""
    return lies_in(corners(state.pose(b), state.size(b)), state.area(r))


@crow.function
def on(state: "StateView", a: str, b: str) -> bool:
    """Whether a block rests on another."""
    height = (state.size(a)[2] + state.size(b)[2]) / 2
    is_above = state.pose(a)[2] - state.pose(b)[2] > 0.9 * height
    return is_above and b in simulation_of(state).touching(a)


def is_free(state: "StateView", b: str, p: Pose) -> bool:
    """Whether a block would collide with nothing somewhere."""
    simulation = simulation_of(state)
    simulation.put(b, p)
    return not simulation.collisions(b)


@crow.function
def fits(state: "StateView", b: str, r: str, p: Pose) -> bool:
    """Whether a block can stand on the table somewhere in a region, and collide with nothing."""
    return lies_in(corners(p, state.size(b)), state.area(r), MARGIN) and is_free(state, b, p)


@crow.generator
def spots(state: "StateView", b: str, r: str, *, rng: np.random.Generator) -> Iterator[Pose]:
    """Free poses of a block in a region, turned as it is."""
    pose, size, area = state.pose(b), state.size(b), np.array(state.area(r))
    half = np.ptp(corners(pose, size), axis=0)[:2] / 2 + 1.5 * MARGIN
    low, high = area[:2] + half, area[2:] - half
    while (low <= high).all():
        x, y = rng.uniform(low, high).tolist()
        if is_free(state, b, p := (x, y, size[2] / 2, *pose[3:])):
            yield p


@crow.function
def over(state: "StateView", a: str, b: str, p: Pose) -> bool:
    """Whether a block would be on top of another, its middle over it, and collide with nothing."""
    size, middle = np.array(state.size(b)), np.array(state.pose(b)[:3])
    x, y, z = axes(state.pose(b)).T @ (np.array(p[:3]) - middle)
    is_above = abs(z - (size[2] + state.size(a)[2]) / 2) < 5 * NEAR
    return bool(is_above and 2 * abs(x) < size[0] and 2 * abs(y) < size[1]) and is_free(state, a, p)


@crow.generator
def tops(state: "StateView", a: str, b: str, *, rng: np.random.Generator) -> Iterator[Pose]:
    """Free poses of a block on top of another: first in its middle, which may not be the place."""
    size, pose = np.array(state.size(b)), state.pose(b)
    up = (size[2] + state.size(a)[2]) / 2
    offset = np.zeros(2)
    while True:
        point = np.array(pose[:3]) + axes(pose) @ [*offset, up]
        if over(state, a, b, p := (*point.tolist(), *state.pose(a)[3:])):
            yield p
        offset = rng.uniform(-0.4, 0.4, 2) * size[:2]


# ----------------------------------------------------------------------------------------- pushing


@crow.function
def pushes(state: "StateView", b: str, r: str, s: Stroke) -> bool:
    """Whether a stroke goes straight against the middle of a side of a block, into a region."""
    moved = np.subtract(s[2:], s[:2])
    for start, way, points, area in _sides(state, b, r):
        far = float(moved @ way[:2])
        is_straight = np.allclose(s[:2], start, atol=NEAR) and np.allclose(
            moved, far * way[:2], atol=NEAR
        )
        if is_straight and lies_in(points + (far - BEFORE) * way, area):
            return True
    return False


def _sides(state: "StateView", b: str, r: str) -> Iterator[tuple[Floats, Floats, Floats, Box]]:
    """Where the rod comes down beside each side of a block, and the way that it pushes then.

    With the block's corners and the region.
    """
    pose, size = state.pose(b), state.size(b)
    for axis, sign in product((0, 1), (1, -1)):
        way = sign * axes(pose)[:, axis]
        if abs(way[2]) < 0.01:
            start = np.array(pose[:3]) - way * (size[axis] / 2 + PAD + BEFORE)
            yield start[:2], way, corners(pose, size), state.area(r)


@crow.generator
def strokes(state: "StateView", b: str, r: str, *, rng: np.random.Generator) -> Iterator[Stroke]:
    """Strokes that push a block into a region: as far into it as out of it first, then others."""
    found = []
    for start, way, points, area in _sides(state, b, r):
        near, far = 0.0, np.inf
        for axis in (0, 1):
            across, low, high = points[:, axis], area[axis] + MARGIN, area[axis + 2] - MARGIN
            if abs(way[axis]) > 0.01:
                ends = (low - across.min()) / way[axis], (high - across.max()) / way[axis]
                near, far = max(near, min(ends)), min(far, max(ends))
            elif not (low <= across.min() and across.max() <= high):
                far = -1.0
        if near <= far:
            found.append((start, way[:2], near, far))
    for start, way, near, far in found:
        yield _stroke(start, way, (near + far) / 2)
    while found:
        start, way, near, far = found[rng.integers(len(found))]
        yield _stroke(start, way, rng.uniform(near, far))


def _stroke(start: Floats, way: Floats, far: float) -> Stroke:
    x, y = start.tolist()
    to_x, to_y = (start + (far + BEFORE) * way).tolist()
    return x, y, to_x, to_y


@crow.function
def hits(state: "StateView", b: str, s: Stroke, o: str, p: Pose) -> bool:
    """Whether the rod, or a block that it pushes along a stroke, would hit another somewhere."""
    simulation = simulation_of(state)
    simulation.put(o, p)
    return o in simulation.swept(b, s)


# ----------------------------------------------------------------------------------------- effects


def _moved(simulation: Simulation, before: Mapping[str, Pose]) -> dict[tuple[str, str], Pose]:
    """The cells of the blocks that are no longer where they were."""
    after = simulation.poses().items()
    return {("pose", b): p for b, p in after if not np.allclose(p, before[b], 0, AT_REST)}


@crow.effect("transfer")
def transferred(state: "StateView", b: str, p: Pose) -> dict[tuple[str, str], Pose]:
    """Where blocks are after a block was carried somewhere."""
    simulation = simulation_of(state)
    before = simulation.poses()
    simulation.transfer(b, p)
    return _moved(simulation, before)


@crow.effect("push")
def pushed(state: "StateView", _b: str, s: Stroke) -> dict[tuple[str, str], Pose]:
    """Where blocks are after a stroke, whatever it met."""
    simulation = simulation_of(state)
    before = simulation.poses()
    simulation.push(s)
    return _moved(simulation, before)
