"""Many objects with sparse relations: a task of 20 steps among 10² to 10⁵ of them.

Parcels are in rooms and belong to people, who live in rooms; five are to be delivered. Each size
runs in a process of its own, which is asked for its peak of memory.
"""

import gc
import json
import resource
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time

import cdlc
import crow
from benchmarks.fit import power
from benchmarks.plot import Plot
from benchmarks.table import Figure, Table

DOMAIN = """
typedef room
typedef person
typedef parcel

feature door(x: room, y: room)
feature inside(x: parcel, y: room)
feature owner(x: parcel, y: person)
feature home(x: person, y: room)
feature at(x: room)
feature carrying(x: parcel)
feature delivered(x: parcel)

controller go(x: room)
controller pick(x: parcel)
controller place(x: parcel)

behavior move(y: room):
  goal: at(y)
  body:
    bind x: room where: at(x)
    do go(y)
  eff:
    at[x] = False
    at[y] = True

behavior take(x: parcel):
  goal: carrying(x)
  body:
    bind y: room where: inside(x, y)
    achieve at(y)
    do pick(x)
  eff:
    inside[x, y] = False
    carrying[x] = True

behavior deliver(x: parcel):
  goal: delivered(x)
  body:
    bind p: person where: owner(x, p)
    bind y: room where: home(p, y) and exists z: room: door(z, y)
    promotable:
      achieve carrying(x)
    achieve at(y)
    do place(x)
  eff:
    carrying[x] = False
    inside[x, y] = True
    delivered[x] = True
"""
_SIZES = (100, 1_000, 10_000, 100_000)
_COLUMNS = (
    "objects", "facts", "load CPU s", "plan CPU s", "best CPU s", "iddfs CPU s", "cdlc plan CPU s",
    "steps", "peak MB", "load exponent", "plan exponent", "MB exponent",
)  # fmt: skip
_NOTE = (
    "target: linear in stored facts. Exponents: of facts, fitted; what a process of 100 objects"
    " takes is taken off memory. Load is from text to the runtime's problem; cdlc plan is a whole"
    " process"
)
_ROOT = Path(__file__).resolve().parent.parent


def run(quick: bool) -> Table:
    """Each size in a process of its own."""
    measured = [_measure(count) for count in (_SIZES[:2] if quick else _SIZES)]
    facts = [row[1] for row in measured]
    least = measured[0][-1]
    fitted: list[Figure] = [power(facts, [row[i] for row in measured]).value for i in (2, 3)]
    used = [(row[1], row[-1] - least) for row in measured if row[-1] - least > 1]
    fitted.append(power(*zip(*used, strict=True)).value if len(used) > 1 else "-")
    rows = tuple((*row, *fitted) for row in measured)
    ys = ("load CPU s", "plan CPU s", "best CPU s", "iddfs CPU s", "cdlc plan CPU s")
    plots = (
        Plot("objects", ys, "CPU seconds"),
        Plot("objects", ("peak MB",), "peak MB", name="-memory"),
    )
    return Table("objects", _COLUMNS, rows, _NOTE, plots)


def house(count: int) -> tuple[str, int]:
    """A problem file with so many objects, and how many facts it states."""
    rooms, people, parcels = count // 4, count // 4, count - 2 * (count // 4)
    lines = ['problem "house"', 'domain "domain.cdl"', "objects:"]
    for name, number, type_ in (
        ("r", rooms, "room"),
        ("p", people, "person"),
        ("c", parcels, "parcel"),
    ):
        every = [f"{name}{i}" for i in range(number)]
        lines += [f"  {', '.join(every[i : i + 20])}: {type_}" for i in range(0, number, 20)]
    facts = [f"door[r{i}, r{(i * k + 1) % rooms}]" for i in range(rooms) for k in (1, 3, 7)]
    facts += [f"home[p{i}, r{i * 5 % rooms}]" for i in range(people)]
    facts += [f"owner[c{i}, p{i * 3 % people}]" for i in range(parcels)]
    facts += [f"inside[c{i}, r{(i * 7 + 1) % rooms}]" for i in range(parcels)]
    facts = [*dict.fromkeys(facts), "at[r0]"]
    wanted = [f"delivered(c{parcels * i // 5 + 3})" for i in range(5)]
    lines += ["init:", *(f"  {fact} = True" for fact in facts)]
    return "\n".join([*lines, "goal:", f"  {' and '.join(wanted)}", ""]), len(facts)


def _measure(count: int) -> tuple[float, ...]:
    with TemporaryDirectory() as folder:
        (Path(folder) / "domain.cdl").write_text(DOMAIN)
        file = Path(folder) / "problem.cdl"
        text, facts = house(count)
        file.write_text(text)
        command = [sys.executable, "-m", "benchmarks.objects", str(file)]
        done = subprocess.run(command, check=True, capture_output=True, cwd=_ROOT)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        command = [sys.executable, "-m", "cdlc", "plan", str(file)]
        subprocess.run(command, check=True, capture_output=True, cwd=_ROOT)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    whole = after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime
    *seconds, steps, peak = json.loads(done.stdout)
    return count, facts, *seconds, whole, steps, peak


def _measured(file: Path) -> list[float]:
    """CPU seconds of loading and of planning with three engines, steps, and peak megabytes."""
    domain = file.parent / "domain.cdl"
    gc.set_threshold(100_000, 50, 50)  # as the command line has it
    cdlc.compile(domain)  # start-up
    began = process_time()
    problem = cdlc.compile(domain, file).task()
    seconds = [process_time() - began]
    steps = 0
    for engine in ("auto", "best", "iddfs"):
        began = process_time()
        result = crow.plan(problem, engine, time_limit=600)
        seconds.append(process_time() - began)
        assert result.status == "plan", result
        steps = steps or len(result.steps)
    return [*seconds, steps, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1_000]


if __name__ == "__main__":
    print(json.dumps(_measured(Path(sys.argv[1]))))
