"""HDDL: achieves as compound tasks, behaviors as their methods (docs/decisions/0016-hddl.md).

forms     what goals and achieves are about, which makes them one task
ways      bodies without choices: one method each
networks  subtasks in partial order
bodies    one way through a body as the subtasks and precondition of a method
methods   the tasks and methods of a program, and the network of a goal
chains    the objects of a type one after another, for `foreach`
fit       what HDDL has no form for
text      tasks, methods and networks printed
emit      all of it in order
"""

from cdlc.backends.hddl.emit import HddlTask, to_hddl

__all__ = ["HddlTask", "to_hddl"]
