"""A command on a pseudo-terminal, as somebody at a keyboard runs it."""

import os
import pty
import select
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class OnTerminal:
    """How a command ended: what stood on the terminal, and on standard output, a file."""

    status: int
    shown: str
    out: str
    seconds_to_end: float


def on_terminal(
    *arguments: str | Path,
    folder: Path,
    interrupt_at: str | None = None,
    environment: dict[str, str] | None = None,
) -> OnTerminal:
    """Run `cdlc` with its standard error on a terminal; Ctrl-C once that shows some text."""
    master, slave = pty.openpty()
    out = folder / "out"
    own = {k: v for k, v in os.environ.items() if k != "NO_COLOR"}
    own |= {"TERM": "xterm-256color", "COLUMNS": "80", "LINES": "24", **(environment or {})}
    with out.open("wb") as file:
        process = subprocess.Popen(
            [sys.executable, "-m", "cdlc", *map(str, arguments)],
            stdin=slave, stdout=file, stderr=slave, env=own,
            # A shell may have made this process ignore SIGINT; the child must not inherit that.
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
        )  # fmt: skip
    os.close(slave)
    shown, interrupted = b"", None
    try:
        while more := _read(master, process):
            shown += more
            if interrupted is None and interrupt_at and interrupt_at.encode() in shown:
                process.send_signal(signal.SIGINT)
                interrupted = time.monotonic()
        status = process.wait(timeout=10)
    finally:
        process.kill()
        os.close(master)
    took = 0.0 if interrupted is None else time.monotonic() - interrupted
    return OnTerminal(status, shown.decode(), out.read_text("utf-8"), took)


def _read(master: int, process: subprocess.Popen[bytes]) -> bytes:
    """More of what a terminal shows; nothing when the command has ended."""
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline:
        if select.select([master], [], [], 0.05)[0]:
            try:
                return os.read(master, 1 << 16)
            except OSError:  # Linux says so when the last writer has gone
                return b""
        if process.poll() is not None and not select.select([master], [], [], 0)[0]:
            return b""
    raise AssertionError("the command does not end")


def is_unbroken(shown: str) -> bool:
    """Whether the cursor is shown again, and the last line stands alone."""
    hides, shows = shown.rfind("\x1b[?25l"), shown.rfind("\x1b[?25h")
    return hides <= shows and shown.endswith("\n")
