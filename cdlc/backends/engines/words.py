"""What unified-planning calls the features of a task, in words."""

from collections.abc import Iterable
from types import MappingProxyType
from typing import Final

# In the order they are listed; names without an entry say what every engine of ours takes.
WORDS: Final = MappingProxyType(
    {
        "NEGATIVE_CONDITIONS": "negative conditions",
        "DISJUNCTIVE_CONDITIONS": "disjunctions",
        "EQUALITIES": "equality",
        "EXISTENTIAL_CONDITIONS": "existential conditions",
        "UNIVERSAL_CONDITIONS": "universal conditions",
        "CONDITIONAL_EFFECTS": "conditional effects",
        "FORALL_EFFECTS": "universal effects",
        "ACTIONS_COST": "costs",
        "REAL_NUMBERS_IN_ACTIONS_COST": "fractional costs",
        "REAL_FLUENTS": "numbers",
        "INT_FLUENTS": "numbers",
        "SIMPLE_NUMERIC_PLANNING": "numbers",
        "GENERAL_NUMERIC_PLANNING": "numbers",
        "INCREASE_EFFECTS": "numbers",
        "DECREASE_EFFECTS": "numbers",
        "FLUENTS_IN_NUMERIC_ASSIGNMENTS": "numbers",
        "STATIC_FLUENTS_IN_NUMERIC_ASSIGNMENTS": "numbers",
        "FINAL_VALUE": "minimizing a number",
        "DERIVED_PREDICATES": "derived predicates",
        "HIERARCHICAL_TYPING": "subtypes",
    }
)


def in_words(features: Iterable[str]) -> tuple[str, ...]:
    """Features of a task or an engine, in words where there are any, each once."""
    given = set(features)
    known = [word for name, word in WORDS.items() if name in given]
    return tuple(dict.fromkeys(known))


def lacks_in_words(features: Iterable[str]) -> tuple[str, ...]:
    """What an engine lacks for a task: in words, and by name where there are none."""
    given = tuple(features)
    others = [name for name in given if name not in WORDS]
    return (*in_words(given), *others)
