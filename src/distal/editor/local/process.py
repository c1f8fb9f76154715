"""A process that runs the author's code, which may loop for ever or crash: a worker, a renderer.

Input: messages as lines. Output: the process's lines, and how it ended. The author's code never
runs in the server's own process. Needs the standard library alone.
"""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import IO, Final

_LONGEST_REPORT: Final = 4000  # characters of what a process wrote last
_LOWERED: Final = 10  # by how much the priority of work in the background is lower


class ChildProcess:
    """A process that runs.

    Args:
        command: What to run.
        received: Called with each line of its output, in a thread.
        ended: Called once when it has ended by itself, with the exit status and what it has
            written to its stream of errors.
        folder: Where it runs; None for here.
        is_lowered: Whether others go first.
    """

    def __init__(
        self,
        command: Sequence[str],
        received: Callable[[str], None],
        ended: Callable[[int, str], None],
        *,
        folder: Path | None = None,
        is_lowered: bool = False,
    ) -> None:
        self._received, self._ended = received, ended
        self._is_killed = False
        self._report = ""
        self._process = subprocess.Popen(
            command,
            cwd=folder,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            encoding="utf-8",
            errors="replace",
            start_new_session=True,
        )
        if is_lowered and hasattr(os, "setpriority"):
            with contextlib.suppress(OSError):  # it has ended already
                os.setpriority(os.PRIO_PROCESS, self._process.pid, _LOWERED)
        self._errors = threading.Thread(target=self._listen_to_errors, daemon=True)
        self._errors.start()
        threading.Thread(target=self._listen, daemon=True).start()

    def send(self, line: str) -> None:
        """Send a line; a worker that has ended gets nothing."""
        with contextlib.suppress(OSError, ValueError):
            self._stream(self._process.stdin).write(f"{line}\n")
            self._stream(self._process.stdin).flush()

    def kill(self) -> None:
        """End it at once, with the processes that it has started."""
        self._is_killed = True
        with contextlib.suppress(OSError):
            if hasattr(os, "killpg"):
                os.killpg(self._process.pid, signal.SIGKILL)
            else:
                self._process.kill()
        self._process.wait()

    @staticmethod
    def _stream(stream: IO[str] | None) -> IO[str]:
        assert stream is not None
        return stream

    def _listen(self) -> None:
        for line in self._stream(self._process.stdout):
            if self._is_killed:
                return
            self._received(line)
        code = self._process.wait()
        self._errors.join(1.0)
        if not self._is_killed:
            self._ended(code, self._report.strip())

    def _listen_to_errors(self) -> None:
        for line in self._stream(self._process.stderr):
            self._report = (self._report + line)[-_LONGEST_REPORT:]


class WorkerProcess(ChildProcess):
    """A worker that runs.

    Args:
        beside: The folder whose other files the scene may read.
        received: Called with each line that the worker sends, in a thread.
        ended: Called once when it has ended by itself, with the reason.
    """

    def __init__(
        self, beside: Path, received: Callable[[str], None], ended: Callable[[str], None]
    ) -> None:
        command = [sys.executable, "-m", "distal.editor", str(beside)]
        super().__init__(command, received, lambda code, report: ended(reason_of(code, report)))


def reason_of(code: int, report: str) -> str:
    """Return why a process has ended that the author's code has ended."""
    last = report.splitlines()
    why = f": {last[-1]}" if last else ""
    return f"the scene's code ended its process (exit status {code}){why}"
