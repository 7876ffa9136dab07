"""`cdlc crosscheck`: a program and its PDDL, compared on problems (lowering.md §2, back-mapping).

results    what comparing one problem came to, and its JSON
decide     two answers to one outcome
sides      the two answers: of a PDDL engine, replayed; of the runtime, validated as PDDL
space      what the program's plan space leaves out
compare    one problem; files to problems
reproduce  a folder to repeat a mismatch from
text       the table, and what is to be said of its rows
progress   a bar on a terminal
"""

from cdlc.crosscheck.compare import Settings, compare, problems
from cdlc.crosscheck.progress import Progress
from cdlc.crosscheck.reproduce import reproduce
from cdlc.crosscheck.results import Comparison, Outcome, document, outcome_of_all

__all__ = [
    "Settings",
    "compare",
    "problems",
    "Progress",
    "reproduce",
    "Comparison",
    "Outcome",
    "document",
    "outcome_of_all",
]
