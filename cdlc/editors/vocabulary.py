"""The words of CDL by what they do, read from the grammar so that no list of them goes stale."""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache

from cdlc.frontend.grammar import grammar_text

# Soft words act as keywords in one place each; what stands there tells it from a name.
DEFINITIONS = frozenset(
    (
        "typedef",
        "object_constant",
        "feature",
        "def",
        "controller",
        "behavior",
        "action",
        "generator",
    )
)
TITLES = frozenset(("domain", "problem", "include"))
SECTIONS = frozenset(
    (
        "goal",
        "body",
        "eff",
        "in",
        "out",
        "objects",
        "init",
        "minimize",
        "sequential",
        "unordered",
        "alternative",
        "promotable",
    )
)
ORDERS = frozenset(("sequential", "unordered", "alternative"))
"""What may stand between `promotable` and its colon."""
INNER = frozenset(("in", "where"))
"""Words that follow a name on their line; `each` follows `for`."""

OPERATORS = frozenset(("and", "or", "not"))
CONSTANTS = frozenset(("True", "False"))
TYPES = ("bool", "int32", "int64", "float32", "float64", "string", "vector", "pyobject", "object")
FUNCTIONS = ("abs", "max", "min", "range")

# What follows a soft word where it is a keyword.
BEFORE_NAME = r"(?=[ \t]+[A-Za-z_]|[ \t]*\[\[)"
BEFORE_STRING = r"(?=[ \t]*\")"
BEFORE_COLON = r"(?=[ \t]*:)"
# After the `each` of a statement comes a variable; `for each in` is a loop over `each`.
EACH = r"each(?![A-Za-z0-9_])(?![ \t]+in[ \t])"
OPERATOR_SIGNS = r"->|\*\*|//|[-+*/=!<>]=|[-+*/%^=<>]"


@dataclass(frozen=True, slots=True)
class Vocabulary:
    """`hard` words are never names, `soft` ones are names in most places, `reserved` are neither.

    `patterns` are the regular expressions of the other terminals.
    """

    hard: frozenset[str]
    soft: frozenset[str]
    reserved: frozenset[str]
    patterns: Mapping[str, str]

    @property
    def statements(self) -> frozenset[str]:
        """The hard words that are neither operators nor constants."""
        return self.hard - OPERATORS - CONSTANTS


@cache
def vocabulary() -> Vocabulary:
    """The words of the grammar's text."""
    text = grammar_text()
    words = dict(re.findall(r'^([A-Z_]+): "([A-Za-z_]+)"$', text, re.MULTILINE))
    listed = re.search(r"^!_soft: ([A-Z_|\s]+)$", text, re.MULTILINE)
    reserved = re.search(r"^RESERVED\S*: /\(([a-z_|]+)\)", text, re.MULTILINE)
    assert listed, "cdl.lark lists the soft words"
    assert reserved, "cdl.lark lists the reserved words"
    soft = {words[terminal] for terminal in (*re.findall(r"[A-Z_]+", listed[1]), "IN")}
    hard = frozenset(words.values()) - soft
    patterns = dict(re.findall(r"^([A-Z_]+): /(.*)/$", text, re.MULTILINE))
    return Vocabulary(hard, frozenset(soft), frozenset(reserved[1].split("|")), patterns)


def any_of(words: Iterable[str]) -> str:
    """A regular expression for whole words."""
    return f"(?:{'|'.join(sorted(words))})(?![A-Za-z0-9_])"
