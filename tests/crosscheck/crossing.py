"""Programs for crosschecking, and how to compare one."""

from collections.abc import Iterator
from pathlib import Path

from cdlc.crosscheck import Comparison, Settings, compare, problems

DEFAULT = Settings()

DOOR = """domain "door"
typedef door
feature open(d: door)
feature locked(d: door)
feature key(d: door)
controller push(d: door)
controller unlock(d: door)
behavior enter(d: door):
  goal: open(d)
  body:
    {condition}
    do push(d)
  eff: open[d] = True
behavior use_key(d: door):
  goal: not locked(d)
  body:
    assert key(d)
    do unlock(d)
  eff: locked[d] = False
"""
FRONT = """problem "front"
domain "door.cdl"
objects:
  front: door
init:
  locked[front] = True
{key}goal: open(front)
"""
WITH_KEY = FRONT.format(key="  key[front] = True\n")
WITHOUT_KEY = FRONT.format(key="")
ACHIEVES = DOOR.format(condition="achieve not locked(d)")
# What an `assert` wants, nothing brings about.
ASSERTS = DOOR.format(condition="assert not locked(d)")
SILENT = (
    ACHIEVES
    + """
controller knock(d: door)
behavior greet(d: door):
  goal: greeted(d)
  body:
    do knock(d)
feature greeted(d: door)
"""
)
VALUES = (
    ACHIEVES
    + """
behavior wait(d: door):
  goal: greeted(d)
  body:
    bind n: int64
    assert n > 2
  eff: greeted[d] = True
feature greeted(d: door)
"""
)


def written(folder: Path, domain: str, problem: str) -> Path:
    """A problem file, with its domain beside it."""
    (folder / "door.cdl").write_text(domain)
    file = folder / "front.cdl"
    file.write_text(problem)
    return file


def compared(*files: Path, settings: Settings = DEFAULT) -> Iterator[Comparison]:
    """What comes of files given to `crosscheck`."""
    for file, compilation in problems([str(file) for file in files]):
        yield compare(file, compilation, settings, lambda _stage: None)
