"""Which behaviors are one and the same transition."""

import pytest
from verifying import report

HEAD = """
typedef T
typedef U: T
feature p(x: T)
feature q(x: T)
feature on(x: T, y: T)
feature n(x: T) -> int64
controller go(x: T)
controller put(x: T, y: T)
"""


def behavior(name: str, parameters: str, body: str, effect: str) -> str:
    def block(head: str, lines: str) -> str:
        return f"  {head}:\n" + "".join(f"    {line}\n" for line in lines.splitlines())

    return f"behavior {name}({parameters}):\n{block('body', body)}{block('eff', effect)}"


def same(first: tuple[str, str, str], second: tuple[str, str, str]) -> bool:
    text = HEAD + behavior("one", *first) + behavior("two", *second)
    found = report(text).same
    assert found in ((), (("one", "two"),))
    return bool(found)


EQUAL = {
    "other names": (
        ("x: T", "assert p(x)\ndo go(x)", "q[x] = True"),
        ("y: T", "assert p(y)\ndo go(y)", "q[y] = True"),
    ),
    "a bind for a parameter": (
        ("x: T, y: T", "assert on(x, y)\ndo put(x, y)", "on[x, y] = False"),
        ("y: T", "bind x: T where: on(x, y)\ndo put(x, y)", "on[x, y] = False"),
    ),
    "parameters in another order": (
        ("x: T, y: T", "assert on(x, y)\ndo put(x, y)", "on[x, y] = False"),
        ("x: T, y: T", "assert on(y, x)\ndo put(y, x)", "on[y, x] = False"),
    ),
    "variables that no call mentions": (
        ("x: T, y: T", "assert on(x, y)\ndo go(x)", "on[x, y] = False\np[y] = True"),
        ("y: T, x: T", "assert on(y, x)\ndo go(y)", "p[x] = True\non[y, x] = False"),
    ),
    "conditions that say the same": (
        ("x: T", "assert p(x) and not q(x)\ndo go(x)", "n[x] = 1"),
        ("x: T", "assert not (q(x) or not p(x))\ndo go(x)", "n[x] = 1"),
    ),
    "effects that say the same where they apply": (
        ("x: T, y: T", "assert x != y\ndo put(x, y)", "p[x] = True\np[y] = False"),
        ("x: T, y: T", "assert x != y\ndo put(x, y)", "p[y] = False\np[x] = True"),
    ),
    "arithmetic that says the same": (
        ("x: T", "assert n(x) > 3\ndo go(x)", "n[x] = 2 * n(x) - n(x)\np[x] = True"),
        ("x: T", "assert n(x) >= 4\ndo go(x)", "n[x] = n(x)\np[x] = True"),
    ),
    "quantified effects": (
        ("x: T", "do go(x)", "foreach z: T: on[x, z] = p(z)"),
        ("y: T", "do go(y)", "foreach w: T: on[y, w] = p(w)"),
    ),
}
DIFFERENT = {
    "another controller": (
        ("x: T, y: T", "do put(x, y)", "p[x] = True"),
        ("x: T, y: T", "do go(x)\ndo go(y)", "p[x] = True"),
    ),
    "another role in the call": (
        ("x: T, y: T", "assert on(x, y)\ndo put(x, y)", "p[x] = True"),
        ("x: T, y: T", "assert on(x, y)\ndo put(y, x)", "p[x] = True"),
    ),
    "another type": (
        ("x: T", "do go(x)", "p[x] = True"),
        ("x: U", "do go(x)", "p[x] = True"),
    ),
    "a further condition": (
        ("x: T", "assert p(x)\ndo go(x)", "q[x] = True"),
        ("x: T", "assert p(x)\nassert q(x)\ndo go(x)", "q[x] = True"),
    ),
    "a further effect": (
        ("x: T", "assert p(x)\ndo go(x)", "q[x] = True"),
        ("x: T", "assert p(x)\ndo go(x)", "q[x] = True\nn[x] = 0"),
    ),
    "effects that differ for equal arguments": (
        ("x: T, y: T", "do put(x, y)", "p[x] = True\np[y] = False"),
        ("x: T, y: T", "do put(x, y)", "p[y] = False\np[x] = True"),
    ),
    "equal cells for some states only": (
        ("x: T", "do go(x)", "n[x] = 2 * n(x)"),
        ("x: T", "do go(x)", "n[x] = n(x)"),
    ),
}


@pytest.mark.parametrize("case", EQUAL)
def test_equal_transitions_are_one(case: str) -> None:
    assert same(*EQUAL[case])


@pytest.mark.parametrize("case", DIFFERENT)
def test_other_transitions_are_not(case: str) -> None:
    assert not same(*DIFFERENT[case])
