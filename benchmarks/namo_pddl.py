"""A map of NAMO as PDDL: cells are objects, and obstacles are at the places that they fit."""

from collections.abc import Iterator

from examples.namo import rows_of
from examples.namo.world import Cell, Map, map_of, moved

_SIDES = {"up": (-1, 0), "down": (1, 0), "left": (0, -1), "right": (0, 1)}
_DOMAIN = """(define (domain namo)
  (:requirements :strips :typing :negative-preconditions :universal-preconditions
                 :conditional-effects :disjunctive-preconditions :equality)
  (:types cell obstacle direction)
  (:predicates
    (next ?d - direction ?a ?b - cell)
    (covers ?o - obstacle ?p ?c - cell)
    (beside ?o - obstacle ?p ?c - cell)
    (at ?c - cell)
    (placed ?o - obstacle ?p - cell)
    (taken ?c - cell)
    (held ?o - obstacle)
    (alone))
  (:action walk
    :parameters (?d - direction ?a ?b - cell)
    :precondition (and (next ?d ?a ?b) (at ?a) (alone) (not (taken ?b)))
    :effect (and (not (at ?a)) (at ?b)))
  (:action attach
    :parameters (?o - obstacle ?p ?a - cell)
    :precondition (and (at ?a) (alone) (placed ?o ?p) (beside ?o ?p ?a))
    :effect (and (held ?o) (not (alone))))
  (:action detach
    :parameters (?o - obstacle)
    :precondition (held ?o)
    :effect (and (alone) (not (held ?o))))
  (:action carry
    :parameters (?o - obstacle ?d - direction ?a ?b ?p ?q - cell)
    :precondition (and (beside ?o ?p ?a) (next ?d ?a ?b) (next ?d ?p ?q) (beside ?o ?q ?b)
                       (at ?a) (held ?o) (placed ?o ?p)
                       (or (not (taken ?b)) (covers ?o ?p ?b))
                       (forall (?c - cell) (or (not (covers ?o ?q ?c)) (covers ?o ?p ?c)
                                               (not (taken ?c)))))
    :effect (and (not (at ?a)) (at ?b) (not (placed ?o ?p)) (placed ?o ?q)
                 (forall (?c - cell) (when (and (covers ?o ?p ?c) (not (covers ?o ?q ?c)))
                                           (not (taken ?c))))
                 (forall (?c - cell) (when (covers ?o ?q ?c) (taken ?c))))))
"""


def pddl_of(of: str) -> tuple[str, str]:
    """Domain and problem of a map, which is one of `MAPS` or a text."""
    rows = rows_of(of)
    marks = {
        mark: (r, row.index(mark)) for r, row in enumerate(rows) for mark in set(row) & {*"SG"}
    }
    grid = map_of(rows)
    cells = [(r, c) for r, row in enumerate(rows) for c, mark in enumerate(row) if mark != "#"]
    first = {
        o: next((r, row.index(o)) for r, row in enumerate(rows) if o in row) for o in grid.shapes
    }
    facts = [f"(next {name} {_name(a)} {_name(b)})" for a in cells for name, b in _around(grid, a)]
    for o in grid.shapes:
        facts += _geometry(grid, o)
        facts.append(f"(placed {o} {_name(first[o])})")
        facts += [f"(taken {_name(cell)})" for cell in moved(grid.shapes[o], first[o])]
    lines = ["(define (problem rooms) (:domain namo)", "  (:objects"]
    lines += [f"    {' '.join(map(_name, cells))} - cell", f"    {' '.join(_SIDES)} - direction"]
    lines += [f"    {' '.join(grid.shapes)} - obstacle)", "  (:init (alone)"]
    lines += [f"    (at {_name(marks['S'])})", *(f"    {fact}" for fact in facts)]
    lines += [f"  )\n  (:goal (at {_name(marks['G'])})))"]
    return _DOMAIN, "\n".join(lines) + "\n"


def _name(cell: Cell) -> str:
    return f"c{cell[0]}-{cell[1]}"


def _around(grid: Map, cell: Cell) -> Iterator[tuple[str, Cell]]:
    """The open cells that share a side with one, by direction."""
    for name, way in _SIDES.items():
        (other,) = moved([cell], way)
        if grid.has(other) and grid.open[other]:
            yield name, other


def _geometry(grid: Map, o: str) -> Iterator[str]:
    """What an obstacle covers wherever it fits, and where the agent is beside it."""
    fits = grid.room_for(grid.shapes[o], grid.open)
    for row, column in zip(*fits.nonzero(), strict=True):
        place = (int(row), int(column))
        covered = moved(grid.shapes[o], place)
        yield from (f"(covers {o} {_name(place)} {_name(cell)})" for cell in covered)
        beside = {cell for inside in covered for _, cell in _around(grid, inside)}
        yield from (f"(beside {o} {_name(place)} {_name(c)})" for c in sorted(beside - {*covered}))
