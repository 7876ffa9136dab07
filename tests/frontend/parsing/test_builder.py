"""The builder has a method for each rule of the grammar that makes a node."""

from cdlc.frontend import grammar
from cdlc.frontend.build import Builder


def test_every_rule_is_built() -> None:
    named = {
        str(rule.alias or rule.origin.name)
        for rule in grammar.parser().rules
        if rule.alias or not rule.options.expand1  # `?rule` stands for what is in it
    }
    assert {
        name for name in named if not name.startswith("_") and not hasattr(Builder, name)
    } == set()
