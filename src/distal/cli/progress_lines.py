"""Progress as lines of JSON on stdout, for programs that run a command.

Input: stages and shares of the work. Output: one object a line: ``stage``, ``done`` (0 to 1) and
``text``. What the author's code prints goes nowhere, so that no line of it is taken for one of
these. A reader that is gone ends the command. Standard library only.
"""

from __future__ import annotations

import json
import os
import sys
import time
from types import TracebackType
from typing import IO, Final, Self

from distal.cli.messages import say
from distal.diagnostics import readable
from distal.forking import new_lock
from distal.lang.progress_lines import COMPILING, KEY, RENDERING

JSON: Final = "json"
_PAUSE_S: Final = 0.1  # at least, between two lines of one stage


def _own_stdout() -> IO[str]:
    """Return stdout for these lines alone; who prints from now on writes to nothing.

    A stdout that somebody in this process has put in place is left to them.
    """
    if sys.stdout is not sys.__stdout__ or sys.stdout is None:
        return sys.stdout
    sys.stdout.flush()
    nothing = os.open(os.devnull, os.O_WRONLY)
    own = os.dup(1)
    os.dup2(nothing, 1)
    os.close(nothing)
    return os.fdopen(own, "w", encoding="utf-8", newline="\n")


class _ProgressWriter:
    """Writes lines; may be called by several threads."""

    def __init__(self) -> None:
        self._stream = _own_stdout()
        self._lock = new_lock()
        self._stage = COMPILING
        self._last = 0.0

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        """Nothing is left to do."""

    def stage(self, name: str) -> None:
        """Begin a stage of the work."""
        self._write(name, 0.0, "")

    def _write(self, stage: str, done: float, text: str) -> None:
        with self._lock:
            now = time.monotonic()
            if stage == self._stage and done < 1.0 and now - self._last < _PAUSE_S:
                return
            self._stage, self._last = stage, now
            self.answer(json.dumps({KEY: stage, "done": done, "text": text}))

    def answer(self, line: str) -> None:
        """Write a line of data."""
        self._stream.write(f"{readable(line)}\n")
        self._stream.flush()


class PictureLines(_ProgressWriter):
    """The progress of a picture. Call it with the finished fraction."""

    def __init__(self) -> None:
        super().__init__()
        self._figures = ""

    def describe(self, figures: str) -> None:
        """Give a short text with the next lines."""
        self._figures = figures

    def __call__(self, done: float) -> None:
        """Write the finished fraction of the work."""
        self._write(RENDERING, done, self._figures)


class FrameLines(_ProgressWriter):
    """The progress of a sequence. Call it as a ``FrameBar``."""

    def __call__(self, done: int, total: int, what: str) -> None:
        """Write the number of finished frames.

        Args:
            done: Number of finished frames.
            total: Number of all frames.
            what: The kind of work: "rendering" or "encoding".
        """
        self._write(what, done / max(1, total), f"{done} of {total} frames")

    def say(self, line: str) -> None:
        """Print a line for people, on stderr."""
        say(line)
