"""Limits of the process: a timer that reaches any loop, and a bound for a single allocation."""

import resource
import signal
import subprocess
import sys
import threading
import time

import pytest

from crow.budget import Budget, Stopped
from crow.limits import limited_memory, timer


def spin() -> None:
    while True:
        pass


def test_a_timer_reaches_a_loop_that_checks_nothing() -> None:
    budget = Budget(time_limit=0.2)
    before = signal.getsignal(signal.SIGALRM)
    with pytest.raises(Stopped, match="time"), timer(budget.look):
        spin()
    assert 0.2 <= budget.seconds < 1.0
    assert signal.getsignal(signal.SIGALRM) is before
    assert signal.getitimer(signal.ITIMER_REAL) == (0, 0)


def test_a_timer_that_has_raised_lets_what_follows_run() -> None:
    budget = Budget(time_limit=0.05)
    with timer(budget.look):
        with pytest.raises(Stopped):
            spin()
        budget.end()
        end = time.monotonic() + 0.3
        while time.monotonic() < end:
            pass


def test_off_the_main_thread_there_is_no_timer() -> None:
    looks: list[int] = []

    def run() -> None:
        with timer(lambda: looks.append(1)):
            time.sleep(0.2)

    thread = threading.Thread(target=run)
    thread.start()
    thread.join()
    assert looks == []


@pytest.mark.skipif(sys.platform != "linux", reason="the limit of data is Linux's")
def test_one_large_allocation_fails() -> None:
    before = resource.getrlimit(resource.RLIMIT_DATA)
    with limited_memory(4_000):
        small = bytearray(1 << 20)
    assert len(small) == 1 << 20
    assert resource.getrlimit(resource.RLIMIT_DATA) == before
    script = (
        "from crow.limits import limited_memory\n"
        "with limited_memory(200):\n"
        "    fits = bytearray(100 << 20)\n"
        "    try:\n"
        "        bytearray(300 << 20)\n"
        "    except MemoryError:\n"
        "        print('too much')\n"
        "bytearray(300 << 20)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    assert done.stdout == "too much\n"
