"""The rules of ARCHITECTURE.md that the source itself can be asked about."""

import ast
import re
import subprocess
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

import pytest
from support import ROOT

PACKAGES = {"cdlc": ROOT / "cdlc", "crow": ROOT / "runtime" / "crow"}


def module_name(path: Path) -> str:
    for package, folder in PACKAGES.items():
        if path.is_relative_to(folder):
            parts = (package, *path.relative_to(folder).with_suffix("").parts)
            return ".".join(parts).removesuffix(".__init__")
    raise AssertionError(path)


FILES = {module_name(p): p for folder in PACKAGES.values() for p in sorted(folder.rglob("*.py"))}
TREES = {name: ast.parse(path.read_text("utf-8")) for name, path in FILES.items()}


def is_type_checking(node: ast.AST) -> bool:
    return isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"


def walk(node: ast.AST, *, at_run_time: bool, in_functions: bool) -> Iterator[ast.AST]:
    """Nodes of a tree; perhaps without those for the type checker, or within functions."""
    for child in ast.iter_child_nodes(node):
        if at_run_time and is_type_checking(child):
            continue
        yield child
        if in_functions or not isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef):
            yield from walk(child, at_run_time=at_run_time, in_functions=in_functions)


def imports(module: str, *, at_run_time: bool = False, in_functions: bool = True) -> set[str]:
    """The modules that a module imports; a name from a package counts as a module if it is one."""
    found = set()
    nodes = walk(TREES[module], at_run_time=at_run_time, in_functions=in_functions)
    for node in nodes:
        match node:
            case ast.Import(names=names):
                found |= {alias.name for alias in names}
            case ast.ImportFrom(module=str(source), names=names, level=0):
                inner = {f"{source}.{alias.name}" for alias in names}
                found |= {name for name in inner if name in FILES} or {source}
            case ast.ImportFrom():
                raise AssertionError(f"{module}: imports are absolute")
            case _:
                pass
    return found


# --------------------------------------------------------------------------------------- direction

# What each part may import of `cdlc`; `crow` is for all of it. The longest prefix counts.
EVERYWHERE = ("cdlc.diagnostics", "cdlc.source", "cdlc.render")
MAY_IMPORT: Mapping[str, tuple[str, ...]] = {
    "cdlc.source": (),
    "cdlc.diagnostics": (),
    "cdlc.render": (),
    "cdlc.output": (),
    "cdlc.frontend": ("cdlc.frontend", "cdlc.ir"),
    "cdlc.ir": ("cdlc.ir",),
    "cdlc.backends": ("cdlc.backends", "cdlc.ir"),
    # Conditions in traces are read as text.
    "cdlc.plans": ("cdlc.plans", "cdlc.backends", "cdlc.ir", "cdlc.frontend"),
    "cdlc.verify": ("cdlc.verify", "cdlc.ir"),
    "cdlc.view": ("cdlc.view", "cdlc.ir"),
    "cdlc.progress": (),
    "cdlc.editors": ("cdlc.editors", "cdlc.frontend"),
    "cdlc.engines": ("cdlc.backends",),
    "cdlc.driver": ("cdlc.frontend", "cdlc.ir", "cdlc.backends", "cdlc.plans"),
    "cdlc.library": ("cdlc.driver", "cdlc.frontend", "cdlc.ir", "cdlc.backends", "cdlc.plans"),
    "cdlc.bench": ("cdlc.bench", "cdlc.driver", "cdlc.frontend", "cdlc.view"),
    "cdlc.crosscheck": (
        "cdlc.crosscheck",
        "cdlc.driver",
        "cdlc.backends",
        "cdlc.ir",
        "cdlc.output",
    ),
    "cdlc.commands": ("cdlc",),
    "cdlc.cli": ("cdlc",),
    "cdlc": ("cdlc",),
    "crow": (),
}
THIRD_PARTY: Mapping[str, tuple[str, ...]] = {
    "lark": ("cdlc.frontend",),
    "pygments": ("cdlc.editors",),
    "ray": ("crow.many.cluster",),
    "rich": ("cdlc.progress",),
    "matplotlib": ("cdlc.view",),
    "networkx": ("cdlc.view",),
    "numpy": ("crow.calls", "crow.constraints", "crow.externals", "crow.generators"),
    "psutil": ("cdlc.backends.engines",),
    "sympy": ("cdlc.ir.algebra",),
    "z3": ("cdlc.verify.smt",),
    "unified_planning": ("cdlc.backends.engines.solver", "cdlc.backends.up", "cdlc.library"),
}


def rule_of(module: str) -> tuple[str, ...]:
    prefixes = [p for p in MAY_IMPORT if module == p or module.startswith(f"{p}.")]
    return MAY_IMPORT[max(prefixes, key=len)]


def is_under(module: str, prefixes: tuple[str, ...]) -> bool:
    return any(module == p or module.startswith(f"{p}.") for p in prefixes)


@pytest.mark.parametrize("module", FILES)
def test_imports_go_one_way(module: str) -> None:
    allowed = rule_of(module)
    for imported in imports(module):
        package = imported.split(".")[0]
        if package == "crow":
            continue
        if package == "cdlc":
            assert not module.startswith("crow"), f"{module} imports {imported}"
            assert is_under(imported, (*allowed, *EVERYWHERE)), f"{module} imports {imported}"


@pytest.mark.parametrize("module", FILES)
def test_other_packages_are_imported_where_they_belong(module: str) -> None:
    import sys

    for imported in imports(module):
        package = imported.split(".")[0]
        if package in ("cdlc", "crow") or package in sys.stdlib_module_names:
            continue
        assert is_under(module, THIRD_PARTY.get(package, ())), f"{module} imports {package}"


def test_modules_import_each_other_in_no_circle() -> None:
    """Imports inside functions are left out: they are made when both modules are there."""
    graph = {
        module: sorted(imports(module, at_run_time=True, in_functions=False) & FILES.keys())
        for module in FILES
    }
    done: set[str] = set()

    def visit(module: str, chain: tuple[str, ...]) -> None:
        assert module not in chain, " -> ".join((*chain[chain.index(module) :], module))
        if module not in done:
            for imported in graph[module]:
                visit(imported, (*chain, module))
            done.add(module)

    for module in FILES:
        visit(module, ())


def test_the_folders_are_those_the_rules_name() -> None:
    folders = {
        f"cdlc.{p.name}" for p in PACKAGES["cdlc"].iterdir() if (p / "__init__.py").is_file()
    }
    assert folders <= set(MAY_IMPORT)


def test_files_of_tests_have_names_of_their_own() -> None:
    """pytest imports them by their names alone."""
    names = Counter(path.name for path in Path(__file__).parent.rglob("*.py"))
    assert {name for name, count in names.items() if count > 1} == set()


# ------------------------------------------------------------------------------------------- sizes

MOST_LINES_OF_A_FUNCTION = 60
MOST_LINES_OF_A_FILE = 600
LONG_FILE = 450


def functions(tree: ast.AST) -> Iterator[ast.FunctionDef | ast.AsyncFunctionDef]:
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            yield node


@pytest.mark.parametrize("module", FILES)
def test_functions_fit_on_a_screen(module: str) -> None:
    long = {
        f"{node.name}: {node.end_lineno - node.lineno + 1} lines"
        for node in functions(TREES[module])
        if node.end_lineno and node.end_lineno - node.lineno + 1 > MOST_LINES_OF_A_FUNCTION
    }
    assert not long


@pytest.mark.parametrize("module", FILES)
def test_files_are_about_one_thing(
    module: str, record_property: Callable[[str, object], None]
) -> None:
    lines = len(FILES[module].read_text("utf-8").splitlines())
    if lines > LONG_FILE:
        record_property("long file", f"{module}: {lines} lines")
    assert lines <= MOST_LINES_OF_A_FILE


# ------------------------------------------------------------------------------------------- texts

# Written in parts, or this file would be found.
MACHINE_PATHS = re.compile(r"(?<![\w.~-])/(?:home|Users|root|work|var/folders)/[\w.-]+")


def tracked() -> list[Path]:
    done = subprocess.run(
        ["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    if done.returncode != 0:
        pytest.skip("not a checkout of the repository")
    return [ROOT / name for name in done.stdout.split("\0") if name]


def test_no_file_names_a_place_on_somebodys_machine() -> None:
    found = []
    for path in tracked():
        if path.is_file():
            text = path.read_bytes().decode("utf-8", "replace")
            found += [f"{path.relative_to(ROOT)}: {m[0]}" for m in MACHINE_PATHS.finditer(text)]
    assert not found
