"""Truth values alone: random 3-SAT and nested formulas, beside a SAT solver (python-sat)."""

from collections.abc import Callable
from importlib.util import find_spec
from random import Random
from statistics import median
from time import process_time

from benchmarks.plot import Plot
from benchmarks.table import Figure, Table
from crow.budget import Budget, Stopped
from crow.constraints import Conflict, Constraint, Draws, Solver, Store
from crow.evaluate import holds
from crow.problem import State, World
from crow.program import BOOL, And, Conditional, Expression, Not, Or, Program, Variable, Xor
from crow.unknowns import Unknown

_WORLD = World(Program("booleans"), {})
_LIMIT = 30.0
_COLUMNS = (
    "instances", "variables", "constraints", "runs", "satisfiable", "agree", "CPU s", "most CPU s",
    "nodes", "python-sat CPU s",
)  # fmt: skip
_NOTE = (
    "target: all agree; models are checked by the interpreter. 3-SAT has 4.26 clauses a variable,"
    " where it is hardest; CPU are medians, 30 s at most for one; python-sat is Cadical, on clauses"
)
Clauses = list[list[int]]


def run(quick: bool) -> Table:
    """Both kinds in each size."""
    three, nested = ((10, 20), (10,)) if quick else ((20, 40, 60, 80), (20, 50, 100))
    runs = 3 if quick else 20
    rows = [_row("3-SAT", n, round(4.26 * n), runs, three_sat) for n in three]
    rows += [_row("nested", n, round(0.6 * n), runs, nested_formulas) for n in nested]
    plots = (Plot("variables", ("CPU s", "python-sat CPU s"), "CPU s", by="instances"),)
    return Table("sat", _COLUMNS, tuple(rows), _NOTE, plots)


def three_sat(random: Random, variables: int, clauses: int) -> list[Expression]:
    """Random clauses of three literals."""
    return [
        Or(tuple(_literal(random, v) for v in random.sample(range(1, variables + 1), 3)))
        for _ in range(clauses)
    ]


def nested_formulas(random: Random, variables: int, count: int) -> list[Expression]:
    """Random formulas of all connectives, three deep."""
    return [_nested(random, variables, 3) for _ in range(count)]


def _nested(random: Random, variables: int, depth: int) -> Expression:
    if not depth:
        return _literal(random, random.randint(1, variables))
    parts = [_nested(random, variables, depth - 1) for _ in range(3)]
    match random.randrange(4):
        case 0:
            return And(tuple(parts[:2]))
        case 1:
            return Xor(parts[0], parts[1])
        case _:
            return Or(tuple(parts))


def _literal(random: Random, number: int) -> Expression:
    variable = Variable(f"x{number}", BOOL)
    return variable if random.random() < 0.5 else Not(variable)


def _row(
    name: str,
    variables: int,
    count: int,
    runs: int,
    make: Callable[[Random, int, int], list[Expression]],
) -> tuple[Figure, ...]:
    seconds, nodes, theirs, satisfiable, agree = [], [], [], 0, 0
    for seed in range(runs):
        formulas = make(Random(seed), variables, count)  # noqa: S311 - instances, not secrets
        own, spent, looked = _ours(formulas, variables)
        expected, peer = _theirs(formulas, variables)
        seconds.append(spent)
        nodes.append(looked)
        theirs.append(peer)
        satisfiable += own is True
        agree += own is not None and expected in (None, own)
    peers = [s for s in theirs if s is not None]
    told: Figure = median(peers) if peers else "not installed"
    figures = (median(seconds), max(seconds), median(nodes), told)
    return (name, variables, count, runs, satisfiable, agree, *figures)


def _ours(formulas: list[Expression], variables: int) -> tuple[bool | None, float, int]:
    """The answer, None for none in time, with CPU seconds and nodes; a model is checked."""
    unknowns = {f"x{i}": Unknown(f"x{i}", BOOL) for i in range(1, variables + 1)}
    constraints = [Constraint(formula, unknowns, State()) for formula in formulas]
    began = process_time()
    store = Store.of(_WORLD).having(*constraints)
    if isinstance(store, Conflict):
        return False, process_time() - began, 0
    solutions = Solver(_WORLD, Draws(_WORLD)).solutions(store)
    try:
        with Budget(time_limit=_LIMIT).running():
            found = next(solutions, None)
    except Stopped:
        return None, process_time() - began, solutions.nodes
    seconds = process_time() - began
    if found is None:
        return (False if solutions.is_proved else None), seconds, solutions.nodes
    values = {name: found.values.get(unknown, False) for name, unknown in unknowns.items()}
    assert all(holds(_WORLD, State(), formula, values) for formula in formulas)
    return True, seconds, solutions.nodes


def _theirs(formulas: list[Expression], variables: int) -> tuple[bool | None, float | None]:
    """The answer of python-sat with its CPU seconds; None where it is not installed."""
    if find_spec("pysat") is None:
        return None, None
    from pysat.solvers import Cadical153

    clauses = Translation(variables).clauses_of(formulas)
    began = process_time()
    with Cadical153(bootstrap_with=clauses) as solver:
        found = bool(solver.solve())
    return found, process_time() - began


class Translation:
    """Formulas as clauses, by Tseitin's encoding."""

    def __init__(self, variables: int) -> None:
        self.count = variables
        self.clauses: Clauses = []

    def clauses_of(self, formulas: list[Expression]) -> Clauses:
        """Clauses that can be satisfied if the formulas can; those of clauses are themselves."""
        for formula in formulas:
            parts = formula.operands if isinstance(formula, Or) else (formula,)
            self.clauses.append([self.literal(part) for part in parts])
        return self.clauses

    def literal(self, formula: Expression) -> int:
        """What is true if a formula is; its clauses are added."""
        match formula:
            case Variable(name=name):
                return int(name[1:])
            case Not(operand=operand):
                return -self.literal(operand)
            case And(operands=operands):
                return -self._any([-self.literal(o) for o in operands])
            case Or(operands=operands):
                return self._any([self.literal(o) for o in operands])
            case Xor(left=left, right=right):
                other = self.literal(right)
                return self._chosen(self.literal(left), -other, other)
            case Conditional(condition=condition, then=then, otherwise=otherwise):
                return self._chosen(*map(self.literal, (condition, then, otherwise)))
            case _:
                raise AssertionError(f"{type(formula).__name__} is not made here")

    def _any(self, literals: list[int]) -> int:
        self.count += 1
        own = self.count
        self.clauses += [[-own, *literals], *([own, -literal] for literal in literals)]
        return own

    def _chosen(self, condition: int, then: int, otherwise: int) -> int:
        self.count += 1
        own = self.count
        for sign in (1, -1):
            self.clauses.append([-condition, -sign * own, sign * then])
            self.clauses.append([condition, -sign * own, sign * otherwise])
        return own
