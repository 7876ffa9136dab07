"""Walking over formulas as graphs: every shared part once, and without recursion."""

from collections.abc import Iterator

from crow.program import (
    And,
    Apply,
    Arithmetic,
    Builtin,
    Compare,
    Conditional,
    Expression,
    Negative,
    Not,
    Or,
    Quantified,
    Read,
    Vector,
    Xor,
)


def parts(node: Expression) -> tuple[Expression, ...]:
    """The expressions directly under one."""
    match node:
        case Read(arguments=inner) | Apply(arguments=inner) | Builtin(arguments=inner):
            return inner
        case And(operands=inner) | Or(operands=inner) | Vector(elements=inner):
            return inner
        case Not(operand=one) | Negative(operand=one) | Quantified(body=one):
            return (one,)
        case Xor(left=left, right=right) | Compare(left=left, right=right):
            return (left, right)
        case Arithmetic(left=left, right=right):
            return (left, right)
        case Conditional(condition=condition, then=then, otherwise=otherwise):
            return (condition, then, otherwise)
        case _:
            return ()


def in_order(*roots: Expression, into_quantifiers: bool = True) -> Iterator[Expression]:
    """Every node of a graph once, parts before wholes, without recursion."""
    seen: set[int] = set()
    stack: list[tuple[Expression, bool]] = [(root, False) for root in reversed(roots)]
    while stack:
        node, is_done = stack.pop()
        if is_done:
            yield node
        elif id(node) not in seen:
            seen.add(id(node))
            stack.append((node, True))
            if isinstance(node, Quantified) and not into_quantifiers:
                continue
            stack.extend((part, False) for part in reversed(parts(node)) if id(part) not in seen)


def size(*roots: Expression) -> int:
    """The number of nodes of a graph."""
    return sum(1 for _ in in_order(*roots))


def written_size(formula: Expression) -> int:
    """How many nodes a formula has as text, every shared part counted where it stands."""
    sizes: dict[int, int] = {}
    for node in in_order(formula):
        sizes[id(node)] = 1 + sum(sizes[id(part)] for part in parts(node))
    return sizes[id(formula)]
