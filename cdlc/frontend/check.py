"""From syntax to a checked program and problem: the last stage of the frontend."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from crow.program import ProblemStatement, Program, Statement
from crow.program.types import is_number

from cdlc.diagnostics import Collector
from cdlc.frontend import errors, syntax
from cdlc.frontend.check_behaviors import (
    check_behavior,
    check_controller,
    check_function,
    check_generator,
    check_open_condition,
    check_open_value,
)
from cdlc.frontend.check_declarations import (
    Sourced,
    constants,
    declare,
    objects_of,
    type_definitions,
)
from cdlc.frontend.check_statements import Section, check_block
from cdlc.frontend.cycles import report_recursion
from cdlc.frontend.scope import Context, Declarations, Scope
from cdlc.source import SourceFile


@dataclass(frozen=True, slots=True)
class CheckedDomain:
    """A program with the declarations that a problem file or a goal in text is checked against."""

    program: Program
    declarations: Declarations


_PROBLEM_PARTS = (syntax.Objects, syntax.Init, syntax.Goal, syntax.Minimize)


def check_domain(name: str, definitions: Iterable[Sourced], found: Collector) -> CheckedDomain:
    """Check a domain; `name` is used where the file gives it none."""
    listed = list(definitions)
    declared = declare(listed, found)
    program = Program(
        _title(listed, "domain") or name,
        types=tuple(type_definitions(listed, declared, found)),
        constants=constants(declared),
    )
    for source, node in listed:
        context = Context(source, declared, found)
        if isinstance(node, _PROBLEM_PARTS):
            location = context.location(node.span)
            part = context.source.text[node.span.start : node.span.end].split(":")[0]
            found.add(errors.MisplacedPart(location=location, part=part))
        else:
            program = _add(program, node, context)
    report_recursion(program, found)
    return CheckedDomain(program, declared)


def _title(listed: list[Sourced], keyword: str) -> str | None:
    titles = (n.text for _, n in listed if isinstance(n, syntax.Title) and n.keyword == keyword)
    return next(titles, None)


def _add(program: Program, node: syntax.Definition, context: Context) -> Program:
    """The program with one more definition; the loser of a name clash is left out."""
    declared = context.declarations
    if not isinstance(node, syntax.Feature | syntax.Function | syntax.Procedure):
        return program
    if declared.places.get(node.name.text) != context.location(node.name.span):
        return program
    match node:
        case syntax.Feature(name=name):
            return replace(program, features=(*program.features, declared.features[name.text]))
        case syntax.Function():
            return replace(program, functions=(*program.functions, check_function(node, context)))
        case syntax.Procedure(keyword="controller"):
            controller = check_controller(node, context)
            return replace(program, controllers=(*program.controllers, controller))
        case syntax.Procedure(keyword="generator"):
            generator = check_generator(node, context)
            added = () if generator is None else (generator,)
            return replace(program, generators=(*program.generators, *added))
        case syntax.Procedure():
            return replace(program, behaviors=(*program.behaviors, check_behavior(node, context)))


@dataclass(frozen=True, slots=True)
class CheckedProblem:
    """A problem with the domain it is for; the file may have added definitions of its own."""

    domain: CheckedDomain
    problem: ProblemStatement


def check_problem(
    source: SourceFile,
    module: syntax.Module,
    domain_name: str,
    domain: Iterable[Sourced],
    found: Collector,
) -> CheckedProblem | None:
    """Check a problem file against its domain; None when it has no goal."""
    parts = [n for n in module.definitions if isinstance(n, _PROBLEM_PARTS)]
    own = [
        (source, n)
        for n in module.definitions
        if not isinstance(n, (*_PROBLEM_PARTS, syntax.Title))
    ]
    checked = check_domain(domain_name, [*domain, *own], found)
    context = Context(source, checked.declarations, found)
    objects = [o for n in parts if isinstance(n, syntax.Objects) for o in objects_of(n, context)]
    init: list[Statement] = []
    goals, minimized = [], []
    for part in parts:
        match part:
            case syntax.Init(statements=statements):
                init += check_block(statements, Scope(), Section("init"), context)
            case syntax.Goal(condition=condition):
                goals.append(check_open_condition(condition, context))
            case syntax.Minimize(expression=expression):
                minimized.append(check_open_value(expression, context))
                if not is_number(minimized[-1].type):
                    location = context.location(expression.span)
                    found.add(
                        errors.WrongType(
                            location=location, expected="a number", found=minimized[-1].type
                        )
                    )
            case _:
                pass
    _report_repeated(parts, context)
    if not goals:
        return None
    name = _title([(source, n) for n in module.definitions], "problem") or "problem"
    problem = ProblemStatement(
        name, tuple(objects), tuple(init), goals[0], minimized[0] if minimized else None
    )
    return CheckedProblem(checked, problem)


def _report_repeated(parts: Sequence[syntax.Definition], context: Context) -> None:
    for kind, section in ((syntax.Goal, "goal"), (syntax.Minimize, "minimize")):
        same = [part for part in parts if isinstance(part, kind)]
        for other in same[1:]:
            first = context.location(same[0].span)
            location = context.location(other.span)
            context.found.add(
                errors.DuplicateSection(location=location, section=section, first=first)
            )
