"""The examples and the paper's listings with problems small enough for the reference engine."""

from dataclasses import dataclass

from programs import problem_of
from support import EXAMPLES, ROOT

import cdlc
from crow.problem import Problem
from crow.support import unsupported


@dataclass(frozen=True)
class Case:
    """A domain and a problem; compared up to a depth, a plan needs depth `needs`."""

    domain: str
    problem: str
    depth: int
    needs: int | None


def _example(name: str, problem: str, depth: int, needs: int | None) -> Case:
    return Case((EXAMPLES / f"{name}.cdl").read_text(), _problem(problem), depth, needs)


def _listing(name: str, problem: str, depth: int, needs: int | None) -> Case:
    file = ROOT / "tests" / "listings" / f"{name}.cdl"
    return Case(file.read_text(), _problem(problem), depth, needs)


def _problem(text: str) -> str:
    return f'problem "small"\n{text}'


def _calling(call: str, objects: str = "") -> str:
    """A goal that is reached by a call of a behavior that has none."""
    return f"""
feature ran()
{objects}
behavior r_ran():
  goal: ran()
  body:
    {call}
  eff:
    ran[...] = True

goal: ran()
"""


BLOCKS = """
objects:
  a, b: block
init:
  on[a, b] = True
  on_table[b] = True
  clear[a] = True
  handempty[...] = True
goal: on(b, a)
"""

CASES = {
    "rooms": _example(
        "tutorial/rooms",
        """
objects:
  left, right: room
  red: ball
init:
  robot_in[left] = True
  ball_in[red, left] = True
  free[...] = True
goal: ball_in(red, right)
""",
        3,
        2,
    ),
    "kitchen": _example(
        "kitchen/kitchen",
        """
objects:
  red: cup
  cupboard, drawer: place
init:
  inside[red, drawer] = True
  handempty[...] = True
goal: inside(red, cupboard)
""",
        3,
        3,
    ),
    "gripper": _example(
        "gripper/gripper",
        """
objects:
  here, there: room
  ball_1: ball
  left: gripper
init:
  robot_at = here
  free[left] = True
  at[ball_1, here] = True
goal: at(ball_1, there)
""",
        3,
        2,
    ),
    "logistics": _example(
        "logistics/logistics",
        """
objects:
  paris: city
  louvre, gare: location
  van: truck
  parcel: package
init:
  city_of[louvre] = paris
  city_of[gare] = paris
  at[van] = louvre
  in[parcel] = louvre
goal: in(parcel) == gare
""",
        2,
        2,
    ),
    "jugs": _example(
        "jugs/jugs",
        """
objects:
  small, large: jug
init:
  capacity[small] = 1
  capacity[large] = 2
goal: level(large) == 1
""",
        3,
        3,
    ),
    "briefcase": _example(
        "briefcase/briefcase",
        """
objects:
  book: item
init:
  briefcase_at = home
  at[book] = home
goal: at(book) == office
""",
        2,
        2,
    ),
    "cupboard": _example(
        "cupboard/cupboard",
        """
objects:
  kitchen: cupboard
  pot: item
  low: place
init:
  handempty[...] = True
  foreach x: item: loc[x] = table
  foreach x: item, c: cupboard: shelf_for[x, c] = low
  inside[low, kitchen] = True
goal: filled(kitchen, pot)
""",
        3,
        2,
    ),
    "listing a_foreach": _listing("a_foreach", _calling("run()"), 2, 2),
    "listing a_unordered": _listing("a_unordered", _calling("run()"), 2, 2),
    "listing s2_3_unordered": _listing(
        "s2_3_unordered", _calling("run()", "objects:\n  t1, t2: T"), 2, 2
    ),
    "listing s2_2_effect": _listing(
        "s2_2_effect", _calling("move(o)\n    assert g(o, o)", "objects:\n  o: Object"), 2, 2
    ),
    "listing d1_move_to": _listing(
        "d1_move_to",
        _calling("move_to(o, 1.5)\n    assert position_1d(o) > 1", "objects:\n  o: Object"),
        2,
        2,
    ),
    "listing d1_move_five_steps": _listing(
        "d1_move_five_steps",
        _calling("move_five_steps(o)\n    assert pose(o) == -5.0", "objects:\n  o: Object"),
        3,
        3,
    ),
    "listing d5_do_something": _listing(
        "d5_do_something",
        "feature ran()\nobjects:\n  o: Object\nbehavior r_ran():\n  goal: ran()\n  body:\n"
        "    do_something(o)\n    assert f(o) == 2\n  eff:\n    ran[...] = True\n"
        "init:\n  f[o] = 5\ngoal: ran()\n",
        2,
        2,
    ),
    "listing d6_blocks_world": _listing("d6_blocks_world", BLOCKS, 2, None),
    "listing d6_blocks_world_mended": _listing("d6_blocks_world_mended", BLOCKS, 3, 3),
}


def listings_with_behaviors() -> set[str]:
    """The listings that can be planned with: they have behaviors, and choose no values."""
    found = set()
    for file in (ROOT / "tests" / "listings").glob("*.cdl"):
        if not any(d.severity == "error" for d in cdlc.check(file)):
            program = cdlc.compile(file).program
            if program.behaviors and unsupported(program) is None:
                found.add(f"listing {file.stem}")
    return found


BLOCKS_PROGRAMS = ("blocks", "blocks_as_printed", "blocks_strips")
TOWERS = {
    "apart": ("on_table[a]; on_table[b]; on_table[c]; clear[a]; clear[b]; clear[c]", "on(a, b)"),
    "swap": ("on[a, b]; on_table[b]; clear[a]", "on(b, a)"),
    "clear": ("on[a, b]; on[b, c]; on_table[c]; clear[a]", "clear(c)"),
    "hold": ("on[a, b]; on_table[b]; clear[a]; on_table[c]; clear[c]", "holding(b)"),
    "two goals": ("on_table[a]; on_table[b]; clear[a]; clear[b]", "on(a, b) and on_table(b)"),
}


def blocks_problem(program: str, tower: str) -> Problem:
    """One of the blocks programs with three blocks."""
    facts, goal = TOWERS[tower]
    domain = (EXAMPLES / "blocks" / f"{program}.cdl").read_text()
    init = "".join(f"  {fact} = True\n" for fact in [*facts.split("; "), "handempty[...]"])
    text = f'problem "p"\nobjects:\n  a, b, c: block\ninit:\n{init}goal: {goal}\n'
    return problem_of(domain, text)
