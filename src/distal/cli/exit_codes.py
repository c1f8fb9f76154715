"""The exit codes of the command, each with what it tells, in one table.

Input: nothing. Output: ``ExitCode``, which ``docs/reference/options.md`` lists. Depends on
``interrupting`` alone.
"""

from __future__ import annotations

from enum import IntEnum
from typing import Self

from distal.interrupting import INTERRUPTED


class ExitCode(IntEnum):
    """How a command ended.

    Attributes:
        causes: What has happened, one of these.
    """

    causes: tuple[str, ...]

    def __new__(cls, number: int, *causes: str) -> Self:
        """Return a member: a number that has causes."""
        code = int.__new__(cls, number)
        code._value_ = number
        code.causes = causes
        return code

    DONE = 0, "the work is done"
    FAILED = (
        1,
        "there is a mistake in the scene",
        "a file cannot be read or written, or is none of its kind",
        "a package or a device is missing, or memory",
        "`check`, `--check` or `doctor` found something",
    )
    USAGE = 2, "the command line is invalid"
    INTERRUPTED = INTERRUPTED, "it was interrupted, as by ctrl-C"  # as shells name SIGINT
    PIPE_CLOSED = 141, "what reads its output has ended, as `head` does"  # as they name SIGPIPE
