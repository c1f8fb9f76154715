"""A reader that is ended by a thread, and what is left in the interpreter afterwards."""

from __future__ import annotations

import subprocess
import sys
import time

import pytest

from distal.read_watch import limited

MANY = 2**40
ERRORS = (lambda: TimeoutError("late"), lambda: MemoryError("over"))


def turn(seconds: float) -> str:
    end = time.process_time() + seconds
    while time.process_time() < end:
        try:
            sum(range(1000))
        except BaseException:  # as a reader that catches everything
            if time.process_time() > end - 0.1:
                raise
    return "done"


def test_what_is_quick_returns() -> None:
    assert limited(lambda: "result", 1.0, MANY, ERRORS) == "result"


def test_time_that_is_up_ends_also_what_catches_everything() -> None:
    with pytest.raises(TimeoutError, match="late"):
        limited(lambda: turn(0.4), 0.1, MANY, ERRORS)


# CPython 3.11 hung under a profiler after an exception that was taken back.
AFTER = """
import cProfile, faulthandler, sys
from distal.read_watch import limited
from tests.unit.test_read_watch import ERRORS, MANY, turn
faulthandler.dump_traceback_later(30, exit=True)
for seconds in (0.0, 0.0, 0.3):
    try:
        print(limited(lambda: turn(seconds), 0.05, MANY, ERRORS))
    except TimeoutError as error:
        print(error)
profile = cProfile.Profile()
print(profile.runcall(lambda: sum(map(abs, range(1000)))))
"""


def test_a_profiler_runs_after_a_watch() -> None:
    done = subprocess.run([sys.executable, "-c", AFTER], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["done", "done", "late", "499500"]
