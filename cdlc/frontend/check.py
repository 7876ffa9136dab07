"""From syntax to a checked program and problem: the last stage of the frontend."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from cdlc.diagnostics import Collector
from cdlc.frontend import errors, syntax
from cdlc.frontend.check_behaviors import (
    check_behavior,
    check_controller,
    check_function,
    check_generator,
    check_goal,
    check_open_value,
)
from cdlc.frontend.check_declarations import (
    Sourced,
    constants,
    declare,
    objects_of,
    type_definitions,
)
from cdlc.frontend.check_statements import check_block
from cdlc.frontend.check_writes import check_writes
from cdlc.frontend.cycles import report_recursion
from cdlc.frontend.infer import infer_signatures
from cdlc.frontend.scope import Context, Declarations, Scope
from cdlc.frontend.sections import Section
from crow.program import Parameter, ProblemStatement, Program, Statement


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
    infer_signatures(listed, declared, found)
    program = _start(_title(listed, "domain") or name, listed, declared, found)
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


def _start(name: str, listed: list[Sourced], declared: Declarations, found: Collector) -> Program:
    types = tuple(type_definitions(listed, declared, found))
    return Program(name, types=types, constants=constants(declared))


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
    file: Iterable[Sourced], domain_name: str, domain: Iterable[Sourced], found: Collector
) -> CheckedProblem | None:
    """Check a problem file against its domain; None when it has no goal."""
    whole, theirs = list(file), list(domain)
    parts: list[Sourced] = [(source, n) for source, n in whole if isinstance(n, _PROBLEM_PARTS)]
    own = [(source, n) for source, n in whole if not isinstance(n, (*_PROBLEM_PARTS, syntax.Title))]
    listed = [*theirs, *own]
    declared = declare(listed, found)
    program = _start(_title(theirs, "domain") or domain_name, listed, declared, found)
    # The problem's own definitions see its objects; those of the domain cannot know them.
    extended = declared.extended()
    objects = [
        added
        for source, n in parts
        if isinstance(n, syntax.Objects)
        for added in objects_of(n, Context(source, extended, found))
    ]
    infer_signatures(listed, extended, found)
    for source, node in theirs:
        program = _add(program, node, Context(source, declared, found))
    for source, node in own:
        program = _add(program, node, Context(source, extended, found))
    report_recursion(program, found)
    problem = _problem(parts, tuple(objects), extended, found)
    if problem is None:
        return None
    name = _title(whole, "problem") or "problem"
    return CheckedProblem(CheckedDomain(program, extended), replace(problem, name=name))


def _problem(
    parts: Sequence[Sourced],
    objects: tuple[Parameter, ...],
    declared: Declarations,
    found: Collector,
) -> ProblemStatement | None:
    """Initial state, goal and measure of a problem; None without a goal."""
    init: list[Statement] = []
    goals, minimized = [], []
    for source, part in parts:
        context = Context(source, declared, found)
        match part:
            case syntax.Init(statements=statements):
                init += check_block(statements, Scope(), Section("init"), context)
            case syntax.Goal():
                goals.append(check_goal(part, Scope(), context))
            case syntax.Minimize(expression=expression):
                minimized.append(check_open_value(expression, context))
            case _:
                pass
    check_writes(tuple(init), found)
    _report_repeated(parts, found)
    if not goals:
        return None
    minimize = minimized[0] if minimized else None
    return ProblemStatement("", objects, tuple(init), goals[0], minimize)


def _report_repeated(parts: Sequence[Sourced], found: Collector) -> None:
    for kind, section in ((syntax.Goal, "goal"), (syntax.Minimize, "minimize")):
        places = [source.location(n.span) for source, n in parts if isinstance(n, kind)]
        for other in places[1:]:
            found.add(errors.DuplicateSection(location=other, section=section, first=places[0]))
