"""Problems that no engine is done with soon: many blocks, or very many objects."""

from itertools import pairwise
from pathlib import Path

from support import BLOCKS


def towers(folder: Path, count: int) -> Path:
    """One tower to be taken down and built the other way round, in pieces."""
    names = [f"b{i}" for i in range(count)]
    on = [f"on[{x}, {y}]" for x, y in pairwise(names)]
    wanted = [f"on({names[i - 7]}, {names[i]})" for i in range(count) if i % 3]
    facts = [*on, f"on_table[{names[-1]}]", "clear[b0]", "handempty[...]"]
    text = ['problem "towers"', f'domain "{BLOCKS / "blocks.cdl"}"', "objects:"]
    text += [f"  {', '.join(names)}: block", "init:", *(f"  {fact} = True" for fact in facts)]
    file = folder / f"towers{count}.cdl"
    file.write_text("\n".join([*text, "goal:", f"  {' and '.join(wanted)}", ""]))
    return file


BODIES = {
    "bind": ("bind y: T, z: T where: w(y) > w(z)", ""),
    "foreach": ("foreach y: T, z: T:\n      assert w(y) <= w(z)", ""),
    "exists": ("assert exists y: T, z: T: w(y) > w(z)", ""),
    "goal": ("pass", ""),
    "effect": ("pass", "    foreach y: T, z: T:\n      q[y, z] = True\n"),
}
"""Statements, and an effect, over all pairs of objects."""

GOALS = {"goal": "forall y: T, z: T: q(y, z)"}


def pairs(folder: Path, kind: str, count: int = 3_000) -> Path:
    """So many objects that going over their pairs once takes longer than a second."""
    statement, effect = BODIES[kind]
    (folder / "pairs.cdl").write_text(
        'domain "pairs"\ntypedef T\nfeature p(x: T)\nfeature q(x: T, y: T)\n'
        "feature w(x: T) -> int64\ncontroller c(x: T)\n"
        "behavior b(x: T):\n  goal: p(x)\n  body:\n"
        f"    {statement}\n    do c(x)\n  eff:\n{effect}    p[x] = True\n"
    )
    names = ", ".join(f"t{i}" for i in range(count))
    file = folder / f"{kind}.cdl"
    file.write_text(
        f'problem "{kind}"\ndomain "pairs.cdl"\nobjects:\n  {names}: T\ninit:\n  pass\n'
        f"goal: {GOALS.get(kind, 'p(t1) and p(t2)')}\n"
    )
    return file
