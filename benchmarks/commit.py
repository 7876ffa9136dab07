"""`commit` (§2.5): what it saves, and the plan it loses.

N stages each choose one of two tools, and any will do; what comes after them all lies deeper than
the first rounds of deepening go. Without `commit` every round tries all 2^N choices before it ends,
with one after each stage a single way. Where the last step wants the other tool of one stage,
`commit` keeps it from being chosen; the result names `commit` and claims nothing.
"""

import crow
from benchmarks.fit import exponential, power
from benchmarks.plot import Plot
from benchmarks.problems import from_texts
from benchmarks.table import Figure, Table
from benchmarks.thm1 import told

_SIZES = (2, 4, 6, 8, 10, 12, 14)
_LONG = (25, 50, 100, 200)
_COLUMNS = (
    "stages N", "nodes without", "nodes with commit", "status", "base without", "exponent with",
    "fussy without", "fussy with commit", "nodes fussy",
)  # fmt: skip
_NOTE = (
    "base: b of b^N, expected 2 without `commit`; exponent: of N, expected 1 with it. fussy: the"
    " last step wants the tool that is not tried first"
)

_DOMAIN = """
typedef stage
typedef tool
object_constant good: tool
feature used(x: stage) -> tool
feature prepared()
feature ready()
feature finished()
controller use(x: stage, y: tool)
controller end()

behavior work(x: stage, y: tool):
  body:
    do use(x, y)
  eff:
    used[x] = y

behavior prepare():
  goal: prepared()
  body:
    pass
  eff:
    prepared[...] = True

behavior get_ready():
  goal: ready()
  body:
    achieve prepared()
  eff:
    ready[...] = True

behavior finish():
  goal: finished()
  body:
{stages}
    achieve ready()
{last}
    do end()
  eff:
    finished[...] = True
"""


def run(quick: bool) -> Table:
    """Both programs at small N, and the one with `commit` at large N."""
    sizes, long = (_SIZES[:4], _LONG[:2]) if quick else (_SIZES, _LONG)
    rows = [_row(count, is_small=count in sizes) for count in (*sizes, *long)]
    without = [row[1] for row in rows if not isinstance(row[1], str)]
    grows = exponential(sizes, [float(n) for n in without]).value
    fitted = power([*sizes, *long], [float(row[2]) for row in rows]).value
    filled = tuple((*row[:4], grows, fitted, *row[4:]) for row in rows)
    ys = ("nodes without", "nodes with commit")
    plots = (Plot("stages N", ys, "nodes"),)
    return Table("commit", _COLUMNS, filled, _NOTE, plots)


def stages(count: int, *, commits: bool, is_fussy: bool = False) -> crow.Problem:
    """The problem of so many stages; a fussy one wants the second tool at the first stage."""
    names = [f"s{i}" for i in range(1, count + 1)]
    lines = []
    for i, name in enumerate(names, 1):
        lines += [f"    bind t{i}: tool", f"    work({name}, t{i})"] + ["    commit"] * commits
    last = "    assert used(s1) == other" if is_fussy else ""
    constants = "".join(f"object_constant {name}: stage\n" for name in names)
    domain = _DOMAIN.format(stages="\n".join(lines), last=last)
    constants += "object_constant other: tool\n"
    return from_texts(domain + constants, 'problem "stages"\ngoal:\n  finished()\n')


def _row(count: int, *, is_small: bool) -> tuple[Figure, ...]:
    with_commit = crow.plan(stages(count, commits=True), "iddfs")
    lost = crow.plan(stages(count, commits=True, is_fussy=True), "iddfs")
    without: Figure = "-"
    kept = "-"
    if is_small:
        result = crow.plan(stages(count, commits=False), "iddfs")
        without = result.statistics["nodes"]
        kept = told(crow.plan(stages(count, commits=False, is_fussy=True), "iddfs"))
    nodes = with_commit.statistics["nodes"]
    return (count, without, nodes, with_commit.status, kept, told(lost), lost.statistics["nodes"])
