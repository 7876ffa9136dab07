"""Search for inputs that break the compiler: `python tools/fuzz.py [--seconds N] [--seed N]`.

Inputs are files of the repository, changed by bytes, tokens, lines and pieces of other files, and
texts that follow the rules of the grammar. For each, `check` may report whatever it likes, but must
not raise, must not take long, and must point into the file. What breaks it is printed and saved.
"""

import argparse
import json
import multiprocessing
import random
import re
import signal
import sys
import time
import traceback
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path

from cdlc.diagnostics import Diagnostic, Severity
from cdlc.driver import Compilation, CompileError, compilation
from cdlc.frontend import grammar
from cdlc.render import as_json, as_text

ROOT = Path(__file__).resolve().parent.parent
PATTERNS = ("examples/**/*.cdl", "tests/listings/**/*.cdl", "tests/errors/*/*.cdl")
SLOW = 5.0
ENDLESS = 120  # seconds of the clock
LONGEST = 20_000
TOKEN = re.compile(r"[A-Za-z_]\w*|\d+|\s+|\"[^\"\n]*\"|.", re.DOTALL)
EXTRAS = [
    "(", ")", "[", "]", ":", ",", ";", ".", "...", "=", "==", "->", "\n", "\n  ", "\t", "\r", "\f",
    '"', "'", "#", "\\", "\0", "\x1b", "é", "漢", "\u202e", "&&", "!", "{", "999999999999999999999",
    "1e999", "-", "not ", "forall x: T: ", "if ", "else:", "0", "[[min=1]]", "True", "_", "vector",
]  # fmt: skip


@cache
def corpus() -> list[str]:
    """The texts to start from."""
    files = sorted(file for pattern in PATTERNS for file in ROOT.glob(pattern))
    return [file.read_text(encoding="utf-8") for file in files]


@cache
def vocabulary() -> list[str]:
    """Words and signs of the corpus."""
    return sorted({token for text in corpus() for token in TOKEN.findall(text)})


# ---------------------------------------------------------------------------------------- mutation


def mutated(rng: random.Random) -> bytes:
    """A text of the corpus with a few changes."""
    text = rng.choice(corpus())
    for _ in range(rng.choice((1, 1, 1, 2, 3, 5, 20))):
        text = rng.choice(_CHANGES)(text, rng)[:LONGEST]
    data = text.encode("utf-8", "surrogatepass")
    return _with_bytes_changed(data, rng) if rng.random() < 0.1 else data


def _with_bytes_changed(data: bytes, rng: random.Random) -> bytes:
    changed = bytearray(data)
    for _ in range(rng.randint(1, 5)):
        position = rng.randrange(len(changed) + 1)
        changed[position : position + rng.randint(0, 3)] = rng.randbytes(rng.randint(0, 3))
    return bytes(changed)


def _change_token(text: str, rng: random.Random) -> str:
    tokens = TOKEN.findall(text)
    if not tokens:
        return rng.choice(vocabulary())
    position = rng.randrange(len(tokens))
    other = rng.choice(vocabulary() if rng.random() < 0.6 else EXTRAS)
    tokens[position : position + rng.randint(0, 2)] = [other] * rng.randint(0, 2)
    return "".join(tokens)


def _swap_tokens(text: str, rng: random.Random) -> str:
    tokens = TOKEN.findall(text)
    if len(tokens) < 2:
        return text
    a, b = rng.randrange(len(tokens)), rng.randrange(len(tokens))
    tokens[a], tokens[b] = tokens[b], tokens[a]
    return "".join(tokens)


def _change_line(text: str, rng: random.Random) -> str:
    lines = text.split("\n")
    position = rng.randrange(len(lines))
    match rng.randrange(5):
        case 0:
            del lines[position]
        case 1:
            lines.insert(position, rng.choice(lines))
        case 2:
            lines[position] = " " * rng.randint(0, 12) + lines[position].lstrip()
        case 3:
            other = rng.choice(corpus()).split("\n")
            start = rng.randrange(len(other))
            lines[position:position] = other[start : start + rng.randint(1, 8)]
        case _:
            lines = lines[:position]
    return "\n".join(lines)


def _repeat_piece(text: str, rng: random.Random) -> str:
    start = rng.randrange(len(text) + 1)
    piece = text[start : start + rng.choice((1, 2, 5, 20, 100))]
    return text[:start] + piece * rng.choice((2, 3, 10, 200)) + text[start:]


def _cut(text: str, rng: random.Random) -> str:
    start = rng.randrange(len(text) + 1)
    return text[:start] + text[start + rng.choice((1, 2, 5, 50)) :]


_CHANGES: list[Callable[[str, random.Random], str]] = [
    _change_token, _change_token, _change_token, _swap_tokens, _change_line, _repeat_piece, _cut,
]  # fmt: skip


# ----------------------------------------------------------------------------------------- grammar


@cache
def rules() -> dict[str, list[list[str]]]:
    """What each symbol of the grammar can be, first what ends soonest."""
    found: dict[str, list[list[str]]] = {}
    for rule in grammar.parser().rules:
        expansion = [symbol.name for symbol in rule.expansion]
        if not {"ERROR", "error", "_error_line"} & set(expansion):
            found.setdefault(rule.origin.name, []).append(expansion)
    sizes = _sizes(found)

    def size(expansion: list[str]) -> float:
        return sum(sizes.get(symbol, 1) for symbol in expansion)

    return {name: sorted(each, key=size) for name, each in found.items()}


def _sizes(found: dict[str, list[list[str]]]) -> dict[str, float]:
    """How many tokens each symbol has at least."""
    sizes = dict.fromkeys(found, float("inf"))
    for _ in found:
        for name, options in found.items():
            sizes[name] = min(sum(sizes.get(s, 1) for s in option) for option in options)
    return sizes


@cache
def words() -> dict[str, str]:
    """What each terminal with one spelling is written as."""
    terminals = grammar.parser().terminals
    return {t.name: t.pattern.value for t in terminals if t.pattern.type == "str"}


_NAMES = ["T", "f", "g", "x", "y", "c", "r", "block", "on", "range", "int64", "vector", "min"]


def generated(rng: random.Random) -> bytes:
    """A text that follows the rules of the grammar, with names that may mean something."""
    definitions = [_derived("definition", rng) for _ in range(rng.randint(1, 6))]
    head = rng.choice(
        ("", "", "typedef T\nfeature f(x: T)\nfeature g(x: T) -> int64\n", corpus()[0])
    )
    return (head + "".join(definitions)).encode()


def _derived(start: str, rng: random.Random) -> str:
    pieces: list[str] = []
    indentation = 0
    pending = [start]
    budget = rng.choice((30, 100, 400))
    while pending:
        symbol = pending.pop()
        if symbol in rules():
            budget -= 1
            options = rules()[symbol]
            pending.extend(reversed(rng.choice(options if budget > 0 else options[:1])))
        elif symbol in ("_INDENT", "_DEDENT"):
            indentation += 2 if symbol == "_INDENT" else -2
        elif symbol == "_NEWLINE":
            pieces.append("\n")
        else:
            if pieces and pieces[-1] == "\n":
                pieces.append(" " * indentation)
            pieces.append(f"{_spelled(symbol, rng)} ")
    return "".join(pieces) + "\n"


def _spelled(terminal: str, rng: random.Random) -> str:
    match terminal:
        case "NAME":
            return rng.choice(_NAMES)
        case "INT":
            return rng.choice(("0", "1", "3", "20000", "9" * 30))
        case "FLOAT":
            return rng.choice(("0.5", "1e9", "1e-400", "1e400"))
        case "STRING":
            return rng.choice(('""', '"d"', '"\\n"', '"gone.cdl"', '"__empty__"'))
        case _:
            return words().get(terminal, "x")


# ------------------------------------------------------------------------------------------ checks


def fault(data: bytes) -> str | None:
    """What is wrong with how the compiler takes an input, or None."""
    started = time.process_time()
    signal.alarm(ENDLESS)
    try:
        _check(data)
    except Exception:  # noqa: BLE001 - any exception is what is looked for
        return traceback.format_exc()
    finally:
        signal.alarm(0)
    seconds = time.process_time() - started
    return f"took {seconds:.1f} s" if seconds > SLOW else None


def _check(data: bytes) -> None:
    done = compilation(["-"], read_standard_input=lambda: data)
    try:
        _ = done.checked
        diagnostics = done.found.sorted()
        assert all(d.severity is not Severity.ERROR for d in diagnostics)
    except CompileError as error:
        diagnostics = error.diagnostics
        assert any(d.severity is Severity.ERROR for d in diagnostics)
    json.dumps(as_json(diagnostics))
    text = as_text(diagnostics, done.sources)
    assert all(c == "\n" or c.isprintable() for c in text), "control characters"
    for diagnostic in diagnostics:
        _check_places(diagnostic, done, data)


def _check_places(diagnostic: Diagnostic, done: Compilation, data: bytes) -> None:
    assert diagnostic.message(), diagnostic
    replacements = [h.replacement for h in diagnostic.help() if h.replacement is not None]
    places = [diagnostic.location, *(label.location for label in diagnostic.labels())]
    for place in (*places, *(replacement.location for replacement in replacements)):
        start, end = (place.line, place.column), (place.end_line, place.end_column)
        assert (1, 1) <= start <= end, diagnostic
        source = done.sources.get(place.file)
        if source is not None:
            assert place.end_line <= len(source.line_starts), diagnostic
            assert place.column <= len(source.line(place.line)) + 2, diagnostic
        elif place.file == "-":
            assert place.line <= data.count(b"\n") + 1, diagnostic


# -------------------------------------------------------------------------------------------- runs


def _inputs(seed: int) -> Iterator[bytes]:
    rng = random.Random(seed)
    while True:
        yield generated(rng) if rng.random() < 0.3 else mutated(rng)


def _on_alarm(_number: int, _frame: object) -> None:
    raise TimeoutError(f"no end after {ENDLESS} s")


def _work(seed: int, seconds: float, most: int, folder: Path) -> tuple[int, int]:
    """Try inputs for a time; returns how many were tried and how many broke something."""
    signal.signal(signal.SIGALRM, _on_alarm)
    end = time.monotonic() + seconds
    tried = broken = 0
    for tried, data in enumerate(_inputs(seed), 1):
        if (problem := fault(data)) is not None:
            broken += 1
            folder.mkdir(parents=True, exist_ok=True)
            file = folder / f"crash-{seed}-{tried}.cdl"
            file.write_bytes(data)
            print(f"{file}:\n{problem}", flush=True)
        if time.monotonic() > end or tried >= most:
            break
    return tried, broken


def main() -> int:
    """Run the search; the exit status is 1 if anything broke."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=1e9, help="stop after this time")
    parser.add_argument("--inputs", type=int, default=200_000, help="stop after so many inputs")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--processes", type=int, default=1)
    parser.add_argument("--folder", type=Path, default=Path("fuzz"), help="where crashes are saved")
    options = parser.parse_args()
    most = -(-options.inputs // options.processes)
    jobs = [
        (options.seed * options.processes + i, options.seconds, most, options.folder)
        for i in range(options.processes)
    ]
    with multiprocessing.Pool(options.processes) as pool:
        results = pool.starmap(_work, jobs)
    tried, broken = (sum(column) for column in zip(*results, strict=True))
    print(f"{tried} inputs, {broken} broke something")
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
