"""Subtasks in partial order, put one after another or side by side."""

from collections.abc import Iterable
from dataclasses import dataclass

from crow.program import Expression


@dataclass(frozen=True, slots=True, eq=False)
class Subtask:
    """A task or an action, by its HDDL name, with variables and objects as arguments."""

    name: str
    arguments: tuple[Expression, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Network:
    """Subtasks, and pairs of their places of which the first is done before the second begins."""

    subtasks: tuple[Subtask, ...] = ()
    order: frozenset[tuple[int, int]] = frozenset()

    def then(self, other: "Network") -> "Network":
        """All of this before all of the other."""
        size = len(self.subtasks)
        links = {(i, size + j) for i in self.ends() for j in other.starts()}
        return Network((*self.subtasks, *other.subtasks), self.order | other.moved(size) | links)

    @property
    def is_sequence(self) -> bool:
        """Whether each subtask but the first comes right after the one that stands before it."""
        return all((i, i + 1) in self.order for i in range(len(self.subtasks) - 1))

    def ends(self) -> list[int]:
        """The places of subtasks that nothing comes after."""
        followed = {first for first, _ in self.order}
        return [i for i in range(len(self.subtasks)) if i not in followed]

    def starts(self) -> list[int]:
        """The places of subtasks that nothing comes before."""
        following = {second for _, second in self.order}
        return [i for i in range(len(self.subtasks)) if i not in following]

    def moved(self, by: int) -> frozenset[tuple[int, int]]:
        """The order of the same subtasks behind some others."""
        return frozenset((first + by, second + by) for first, second in self.order)


def single(subtask: Subtask) -> Network:
    """One subtask."""
    return Network((subtask,))


def beside(networks: Iterable[Network]) -> Network:
    """Several networks in no order."""
    subtasks: list[Subtask] = []
    order: set[tuple[int, int]] = set()
    for network in networks:
        order |= network.moved(len(subtasks))
        subtasks += network.subtasks
    return Network(tuple(subtasks), frozenset(order))
