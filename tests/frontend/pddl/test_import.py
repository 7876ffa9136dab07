"""PDDL translated into CDL: the text, what is refused, and that effects mean the same."""

import re
from collections.abc import Callable, Iterator
from itertools import product
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from programs import checked_domain
from support import cdlc

from cdlc.diagnostics import Collector
from cdlc.frontend.formatter import format_module
from cdlc.frontend.pddl.nodes import (
    Action,
    Atom,
    Compare,
    Domain,
    Equal,
    Formula,
    Junction,
    Not,
    Quantified,
    Typed,
)
from cdlc.frontend.pddl.read import read_domain
from cdlc.frontend.pddl.translate import Translation
from cdlc.importing import Imported, import_pddl
from cdlc.source import SourceFile
from crow.evaluate import execute
from crow.problem import State, World
from crow.program import Parameter
from crow.program.types import ObjectType

HERE = Path(__file__).parent


def imported(folder: Path, domain: str, problem: str | None = None) -> Imported:
    (folder / "d.pddl").write_text(domain)
    if problem is None:
        return import_pddl(str(folder / "d.pddl"), None, bytes)
    (folder / "p.pddl").write_text(problem)
    return import_pddl(str(folder / "d.pddl"), str(folder / "p.pddl"), bytes)


# --------------------------------------------------------------------------------------- the text


def test_golden(golden: Callable[[Path, str], None], tmp_path: Path) -> None:
    domain, second = (HERE / "golden" / "depots.pddl").read_text().split("\n(define (problem")
    made = imported(tmp_path, domain, f"(define (problem{second}")
    assert not made.diagnostics
    for name, text in made.texts.items():
        golden(HERE / "golden" / f"depots-{name}", text)
        (tmp_path / name).write_text(text)
    checked = cdlc("check", "domain.cdl", "problem.cdl", "--warnings", "error", cwd=tmp_path)
    warned = re.findall(r"^warning.*`(\w+)`", checked.err, re.MULTILINE)
    assert warned == ["hoist", "near", "do_honk"], checked.err


DOMAIN = """(define (domain d) (:requirements :adl)
  (:types t u) (:constants k - t)
  (:predicates (p ?x - t) (q ?x - t ?y - u) (s ?y - u) (flag))
  (:functions (n ?x - t) (total-cost))
  (:action a :parameters (?x - t ?y - u) :precondition PRE :effect EFF))"""


def domain_with(precondition: str = "(and)", effect: str = "(flag)") -> str:
    return DOMAIN.replace("PRE", precondition).replace("EFF", effect)


REFUSED = {
    "(define (domain d) (:durative-action a))": "a durative action cannot be imported",
    "(define (domain d) (:process a))": "a process cannot be imported",
    "(define (domain d) (:constraints (and)))": "a constraint on the trajectory cannot be imported",
    "(define (domain d) (:functions (f) - object))": "an object fluent cannot be imported",
    "(define (domain d) (:types a b) (:action m :parameters (?x - (either a b))))": (
        "a type `either` cannot be imported"
    ),
    domain_with("(preference g (flag))"): "a preference cannot be imported",
    domain_with(effect="(when (flag) (increase (total-cost) 1))"): (
        "a cost that depends on a condition cannot be imported"
    ),
    domain_with(effect="(q (f ?x) ?y)"): "`(f …)` as an argument cannot be imported",
    "(define (domain d) (:predicates (p) (q)) (:derived (p) (q)) (:derived (q) (not (p))))": (
        "the recursive definition of `p` cannot be imported"
    ),
    domain_with(
        effect="(and (forall (?b - u) (when (exists (?a - t) (q ?a ?b)) (not (s ?b))))"
        " (forall (?z - t) (when (exists (?c - u) (s ?c)) (forall (?c - u) (q ?z ?c)))))"
    ): "the effect of `a` cannot be imported",
}
MISTAKES = {
    "": "expected one `(define …)`",
    "(define (domain d)": "`(` is never closed",
    "(define (domain d)))": "unmatched `)`",
    "(define (problem p))": "expected `(define (domain …) …)`",
    "(define (domain d) :types)": "expected a section such as `(:action …)`",
    "(define (domain d) (:nonsense))": "unknown section `:nonsense`",
    "(define (domain d) (:types a - ))": "expected a type after `-`",
    "(define (domain d) (:predicates (p ?x - tt)))": "type `tt` is not declared",
    "(define (domain d) (:action))": "expected the name of the action",
    "(define (domain d) (:action a :effects (and)))": "unknown part `:effects` of an action",
    "(define (domain d) (:action a :effect))": "nothing follows this",
    domain_with("(pp ?x)"): "predicate `pp` is not declared",
    domain_with("(p ?z)"): "variable `?z` is not declared",
    domain_with("(p kk)"): "object `kk` is not declared",
    domain_with("(p ?x ?y)"): "name `p` takes 1 arguments, not 2",
    domain_with("(not)"): "`not` takes 1 parts, not 0",
    domain_with("flag"): "expected a condition in parentheses",
    domain_with("(> (n ?x) many)"): "expected a number, found `many`",
    domain_with("(> (m ?x) 1)"): "function `m` is not declared",
    domain_with(effect="(increase 3 4)"): "expected a function",
    f"{'(' * 2000}": "nested more than 1,000 deep",
}


@pytest.mark.parametrize("text", REFUSED, ids=REFUSED.values())
def test_what_cdl_has_no_form_for_is_refused(text: str, tmp_path: Path) -> None:
    made = imported(tmp_path, text)
    assert not made.texts
    assert [d.message() for d in made.diagnostics] == [REFUSED[text]]
    assert [d.code for d in made.diagnostics] == ["pddl-unsupported"]


@pytest.mark.parametrize("text", MISTAKES, ids=MISTAKES.values())
def test_mistakes_have_a_place(text: str, tmp_path: Path) -> None:
    made = imported(tmp_path, text)
    assert not made.texts
    (diagnostic,) = made.diagnostics
    assert MISTAKES[text] in diagnostic.message()
    brackets = ("unclosed-bracket", "unmatched-bracket", "nesting-too-deep")
    assert diagnostic.code in ("pddl-syntax", "pddl-name", *brackets)
    assert diagnostic.location.file.endswith("d.pddl")


PROBLEM = "(define (problem p) (:domain d) (:objects a - t b - u) INIT (:goal GOAL))"
PROBLEM_MISTAKES = {
    ("(:init (at 5 (flag)))", "(flag)"): "a timed literal cannot be imported",
    ("(:init (p b))", "(flag)"): "",
    ("(:init (= (n a) (n k)))", "(flag)"): "expected `(= (f …) n)` with a number n",
    ("(:init (p c))", "(flag)"): "object `c` is not declared",
    ("(:metric maximize (n a))", "(flag)"): "`maximize` cannot be imported",
    ("(:metric minimize)", "(flag)"): "expected `(:metric minimize …)`",
    ("(:init)", "(preference g (flag))"): "a preference cannot be imported",
}


@pytest.mark.parametrize(("init", "goal"), PROBLEM_MISTAKES)
def test_mistakes_in_problems(init: str, goal: str, tmp_path: Path) -> None:
    expected = PROBLEM_MISTAKES[init, goal]
    text = PROBLEM.replace("INIT", init).replace("GOAL", goal)
    made = imported(tmp_path, domain_with(), text)
    assert [d.message() for d in made.diagnostics] == ([expected] if expected else [])


def test_nothing_is_written_for_a_mistake(tmp_path: Path) -> None:
    (tmp_path / "d.pddl").write_text("(define (domain d) (:types")
    ran = cdlc("import", "d.pddl", "-o", "out", cwd=tmp_path)
    assert ran.status == 1
    assert not (tmp_path / "out").exists()


# ------------------------------------------------------------------------------ effects at once

PREDICATES = {"p": 1, "q": 2, "r": 0}
NAMES = ("a", "b", "c")


@st.composite
def formulas(draw: st.DrawFn, variables: list[str], depth: int = 2) -> str:
    kinds = ["atom", "atom", "equal"] + (["not", "and", "or", "exists", "forall"] if depth else [])
    match draw(st.sampled_from(kinds)):
        case "atom":
            return draw(atoms(variables))
        case "equal":
            return f"(= {draw(st.sampled_from(variables))} {draw(st.sampled_from(variables))})"
        case "not":
            return f"(not {draw(formulas(variables, depth - 1))})"
        case ("and" | "or") as word:
            parts = draw(st.lists(formulas(variables, depth - 1), min_size=1, max_size=2))
            return f"({word} {' '.join(parts)})"
        case word:
            bound = draw(st.sampled_from(["?y", "?z"]))
            return f"({word} ({bound}) {draw(formulas([*variables, bound], depth - 1))})"


@st.composite
def atoms(draw: st.DrawFn, variables: list[str]) -> str:
    name = draw(st.sampled_from(sorted(PREDICATES)))
    arguments = [draw(st.sampled_from(variables)) for _ in range(PREDICATES[name])]
    return f"({' '.join([name, *arguments])})"


@st.composite
def effects(draw: st.DrawFn, variables: list[str], depth: int = 2) -> str:
    kinds = ["add", "delete"] + (["and", "and", "when", "forall"] if depth else [])
    match draw(st.sampled_from(kinds)):
        case "add":
            return draw(atoms(variables))
        case "delete":
            return f"(not {draw(atoms(variables))})"
        case "and":
            parts = draw(st.lists(effects(variables, depth - 1), min_size=1, max_size=3))
            return f"(and {' '.join(parts)})"
        case "when":
            return f"(when {draw(formulas(variables))} {draw(effects(variables, depth - 1))})"
        case _:
            bound = draw(st.sampled_from(["?y", "?z"]))
            return f"(forall ({bound}) {draw(effects([*variables, bound], depth - 1))})"


Facts = frozenset[Atom]


def holds(formula: Formula, facts: Facts, values: dict[str, str]) -> bool:
    """PDDL's own meaning of a condition, sharing nothing with the translation."""
    match formula:
        case Atom(name=name, arguments=arguments):
            return Atom(name, tuple(values[a] for a in arguments)) in facts
        case Equal(left=left, right=right):
            return values[left] == values[right]
        case Not(operand=operand):
            return not holds(operand, facts, values)
        case Junction(operator=operator, operands=operands):
            test = all if operator == "and" else any
            return test(holds(operand, facts, values) for operand in operands)
        case Quantified(quantifier=quantifier, variables=variables, body=body):
            test = all if quantifier == "forall" else any
            return test(holds(body, facts, inner) for inner in assignments(variables, values))
        case Compare():
            raise AssertionError(formula)


def assignments(variables: tuple[Typed, ...], values: dict[str, str]) -> Iterator[dict[str, str]]:
    for chosen in product(NAMES, repeat=len(variables)):
        yield {**values, **dict(zip([v.name for v in variables], chosen, strict=True))}


def after(action: Action, facts: Facts, values: dict[str, str]) -> Facts:
    """All effects at once; what is added and deleted is added."""
    added, deleted = set(), set()
    for effect in action.effects:
        for inner in assignments(effect.variables, values):
            if holds(effect.condition, facts, inner):
                cell = Atom(effect.cell.name, tuple(inner[a] for a in effect.cell.arguments))
                (added if effect.value else deleted).add(cell)
    return frozenset((facts - deleted) | added)


def read(text: str) -> tuple[Domain, str | None]:
    """The nodes of a domain, and the text of its translation where there is one."""
    found = Collector()
    done = read_domain(SourceFile("d.pddl", text), found)
    assert done is not None, [d.message() for d in found]
    module = Translation(done[0], None, done[1]).domain_module()
    return done[0], None if module is None else format_module(module)


CELLS = [Atom(n, args) for n, size in PREDICATES.items() for args in product(NAMES, repeat=size)]


@given(effects(["?x", "?w"]), st.lists(st.sets(st.sampled_from(CELLS)), min_size=1, max_size=3))
def test_effects_mean_what_they_do_in_pddl(effect: str, states: list[set[Atom]]) -> None:
    predicates = "(p ?x) (q ?x ?y) (r)"
    text = f"(define (domain d) (:predicates {predicates}) (:action act :parameters (?x ?w) "
    domain, translated = read(f"{text}:precondition (and) :effect {effect}))")
    if translated is None:
        return
    program = checked_domain(translated).program
    objects = tuple(Parameter(name, ObjectType("object")) for name in NAMES)
    world = World.of(program, objects)
    (action,) = domain.actions
    for facts in states:
        state = State({(f.name, f.arguments): True for f in facts})
        for x, w in product(NAMES, repeat=2):
            expected = after(action, frozenset(facts), {"?x": x, "?w": w})
            for behavior in program.behaviors:
                assert behavior.effect is not None
                done = execute(world, state, behavior.effect, {"x": x, "w": w})
                found = {Atom(f, a) for (f, a), value in done.cells.items() if value}
                assert found == expected, (translated, facts, x, w)


def test_how_often_an_order_is_found() -> None:
    """Few random effects are refused, so that the test above tests something."""
    rng_effects = effects(["?x", "?w"])
    refused = total = 0

    @given(rng_effects)
    def run(effect: str) -> None:
        nonlocal refused, total
        text = "(define (domain d) (:predicates (p ?x) (q ?x ?y) (r)) (:action act "
        _, translated = read(f"{text}:parameters (?x ?w) :effect {effect}))")
        total += 1
        refused += translated is None

    run()
    assert refused < total / 5


def test_an_action_without_goals_is_still_there() -> None:
    _, text = read("(define (domain d) (:predicates (p)) (:action a :effect (not (p))))")
    assert text is not None
    assert "behavior do_a():" in text
