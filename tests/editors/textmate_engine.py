"""As much of TextMate's way of reading as the grammar uses: patterns tried line by line."""

import re
from collections.abc import Iterator
from typing import Any

Coloured = tuple[int, str, str]


def coloured(grammar: dict[str, Any], text: str) -> Iterator[Coloured]:
    """The place, text and scope of everything that has a colour.

    At each place the leftmost match counts, and of those the pattern that comes first.
    """
    rules = [(re.compile(rule["match"]), rule) for rule in grammar["patterns"]]
    offset = 0
    for line in text.split("\n"):
        position = 0
        while position <= len(line):
            found = [(m, r) for p, r in rules if (m := p.search(line, position)) and m.group()]
            if not found:
                break
            match, rule = min(found, key=lambda pair: pair[0].start())
            yield from _scopes(match, rule, offset)
            position = match.end()
        offset += len(line) + 1


def _scopes(
    match: re.Match[str], rule: dict[str, Any], offset: int
) -> Iterator[tuple[int, str, str]]:
    if "name" in rule:
        yield offset + match.start(), match.group(), rule["name"]
    for group, capture in rule.get("captures", {}).items():
        yield offset + match.start(int(group)), match.group(int(group)), capture["name"]
