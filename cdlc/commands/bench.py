"""The command bench: many problems solved, and what became of each recorded."""

import argparse
import sys
from collections import Counter
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from cdlc import driver
from cdlc.commands.shared import DONE, INPUT_ERRORS, usage
from cdlc.diagnostics import Collector

if TYPE_CHECKING:
    from cdlc.bench.results import Appender
    from cdlc.bench.suite import Options, Run, Suite
    from crow.many.cluster import Ray
    from crow.many.executors import Executor


def bench(options: argparse.Namespace) -> int:
    """`cdlc bench`: a record for each run of a suite, on standard output or in a file."""
    from cdlc.bench.results import InUseError
    from cdlc.bench.suite import suite_of
    from crow.many.processes import WorkersError
    from crow.planning import ENGINES

    if options.resume and options.out is None:
        return usage("--resume goes on with a file: name it with --out")
    if options.ray is not None and options.jobs is not None:
        return usage("--jobs is for processes on this machine; a cluster uses all of its cores")
    if unknown := [engine for engine in options.engine if engine not in ENGINES]:
        return usage(f"bench takes the engines of the runtime, not {unknown[0]}")
    found = Collector()
    suite = suite_of(options.suites, _stated(options), found)
    _stop_at_errors(found)
    try:
        with ExitStack() as at_end:
            appender = _appender(options, suite, found, at_end)
            _stop_at_errors(found)
            done = frozenset() if appender is None else appender.done
            runs = [run for run in suite.runs if run.key not in done]
            executor = _executor(options, runs, at_end)
            return _run(runs, len(suite.runs), executor, appender)
    except FileExistsError:
        told = f"`{options.out}` is there already; `--resume` goes on with it"
        print(f"error[results-exist]: {told}", file=sys.stderr)
    except InUseError as error:
        print(f"error[{error.code}]: {error}", file=sys.stderr)
    except WorkersError as error:
        print(f"error[no-workers]: {error}", file=sys.stderr)
    except _NoCluster as error:
        print(f"error[no-cluster]: {error}", file=sys.stderr)
    return INPUT_ERRORS


class _NoCluster(Exception):  # noqa: N818 - about an installation or an address
    """There is no Ray, or no cluster where one was named."""


def _stated(options: argparse.Namespace) -> "Options":
    from cdlc.bench.suite import Options

    limits = {
        "time_limit": options.time_limit,
        "node_limit": options.node_limit,
        "draw_limit": options.draw_limit,
        "memory_limit_mb": options.max_memory,
    }
    return Options(
        tuple(dict.fromkeys(options.engine)),
        tuple(range(options.seeds or 0)),
        {name: limit for name, limit in limits.items() if limit is not None},
        options.functions,
    )


def _stop_at_errors(found: Collector) -> None:
    from cdlc.source import SourceFile

    if found.has_errors:
        names = {d.location.file for d in found.found if d.location.file.endswith(".toml")}
        texts = {n: Path(n).read_text("utf-8", "replace") for n in names if Path(n).is_file()}
        sources = {name: SourceFile(name, text) for name, text in texts.items()}
        raise driver.CompileError(found.sorted(), sources)


def _appender(
    options: argparse.Namespace, suite: "Suite", found: Collector, at_end: ExitStack
) -> "Appender | None":
    from cdlc.bench.results import Appender

    if options.out is None:
        return None
    made = (
        Appender.resumed(options.out, suite, found)
        if options.resume
        else Appender.new(options.out, suite)
    )
    return None if made is None else at_end.enter_context(made)


def _executor(options: argparse.Namespace, runs: "list[Run]", at_end: ExitStack) -> "Executor":
    """A cluster, processes, or this process where nothing can happen to it.

    Python of the user's may hang or die, and memory that was used up stays with a process.
    """
    from crow.many.executors import InProcess
    from crow.many.processes import Processes

    if options.ray is not None:
        return at_end.enter_context(_cluster(options.ray))
    is_risky = any(
        run.functions is not None or run.configuration.memory_limit_mb is not None for run in runs
    )
    jobs = options.jobs or 1
    if jobs > 1 or is_risky:
        return at_end.enter_context(Processes(jobs))
    return at_end.enter_context(InProcess(is_alone=True))


def _cluster(address: str) -> "Ray":
    from crow.many.cluster import Ray, RayMissing

    try:
        return Ray(None if address == "local" else address)
    except RayMissing as error:
        raise _NoCluster(str(error)) from None
    except (ConnectionError, RuntimeError, ValueError) as error:
        told = str(error).strip().splitlines()
        raise _NoCluster(
            f"Ray does not find one at `{address}`: {told[0] if told else error}"
        ) from None


def _run(runs: "list[Run]", total: int, executor: "Executor", appender: "Appender | None") -> int:
    """Carry the runs out; what was found so far is told however this ends."""
    from cdlc.bench.results import line_of
    from cdlc.bench.running import documents
    from cdlc.progress import Bar

    statuses: Counter[str] = Counter()
    with _told_at_the_end(statuses, len(runs)), Bar(sys.stderr, total) as bar:
        bar.show(total - len(runs), "")
        for document in documents(runs, executor):
            if appender is None:
                sys.stdout.write(line_of(document))
                sys.stdout.flush()
            else:
                appender.write(document)
            statuses[document["status"]] += 1
            bar.show(total - len(runs) + statuses.total(), _counted(statuses))
    return INPUT_ERRORS if statuses["fault"] else DONE


@contextmanager
def _told_at_the_end(statuses: "Counter[str]", total: int) -> Iterator[None]:
    try:
        yield
    finally:
        left = total - statuses.total()
        rest = f"; {left} left" if left else ""
        print(f"{statuses.total()} runs: {_counted(statuses) or 'none'}{rest}", file=sys.stderr)


def _counted(statuses: "Counter[str]") -> str:
    """`12 plan, 3 timeout`."""
    order = ("plan", "unsolvable", "limit", "timeout", "memory", "fault")
    return ", ".join(f"{statuses[status]} {status}" for status in order if statuses[status])
