"""A process that runs the author's code, which may loop for ever or crash: a worker, a renderer.

Input: messages as lines. Output: the process's lines, and how it ended. The author's code never
runs in the server's own process. Needs the standard library alone.
"""

from __future__ import annotations

import contextlib
import os
import queue
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import IO, Final

from distal.editor.local.leash import RENDER_MEMORY, WORKER_MEMORY, Leash
from distal.editor.local.scratch import WORKER, ScratchFolder
from distal.editor.messages import LONGEST_MESSAGE

_LONGEST_REPORT: Final = 4000  # characters of what a process wrote last
_LOWERED: Final = 10  # by how much the priority of work in the background is lower
_REST_S: Final = 5.0  # for the last lines of a process that has ended


class ChildProcess:
    """A process that runs.

    Args:
        command: What to run.
        received: Called with each line of its output, in a thread.
        ended: Called once when it has ended by itself, with the exit status and what it has
            written to its stream of errors.
        folder: Where it runs; None for here.
        temporary: Where it and its libraries put temporary files; None for the system's folder.
        memory: The share of this machine's memory that it may have.
        is_lowered: Whether others go first.
    """

    def __init__(
        self,
        command: Sequence[str],
        received: Callable[[str], None],
        ended: Callable[[int, str], None],
        *,
        folder: Path | None = None,
        temporary: Path | None = None,
        memory: float = RENDER_MEMORY,
        is_lowered: bool = False,
    ) -> None:
        self._received, self._ended = received, ended
        self._is_killed = False
        self._report = ""
        self._leash = Leash()
        try:
            self._process = subprocess.Popen(
                command,
                cwd=folder,
                env=None if temporary is None else {**os.environ, "TMPDIR": str(temporary)},
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                encoding="utf-8",
                errors="replace",
                start_new_session=True,
                pass_fds=self._leash.passed,
            )
        except BaseException:
            self._leash.cut()
            raise
        self._leash.hold(self._process.pid, memory)
        if is_lowered and hasattr(os, "setpriority"):
            with contextlib.suppress(OSError):  # it has ended already
                os.setpriority(os.PRIO_PROCESS, self._process.pid, _LOWERED)
        self._lines: queue.SimpleQueue[str | None] = queue.SimpleQueue()
        self._errors = threading.Thread(target=self._listen_to_errors, daemon=True)
        self._output = threading.Thread(target=self._listen, daemon=True)
        for thread in (self._errors, self._output):
            thread.start()
        for work in (self._write, self._wait):
            threading.Thread(target=work, daemon=True).start()

    def send(self, line: str) -> None:
        """Send a line, without waiting; a worker that has ended gets nothing."""
        self._lines.put(line)

    def kill(self) -> None:
        """End it at once, with the processes that it has started."""
        self._is_killed = True
        self._kill_group()
        self._process.wait()

    def _kill_group(self) -> None:
        with contextlib.suppress(OSError):
            if hasattr(os, "killpg"):
                if self._process.returncode is None:  # the number is still that of the group
                    os.killpg(self._process.pid, signal.SIGKILL)
            else:
                self._process.kill()

    @staticmethod
    def _stream(stream: IO[str] | None) -> IO[str]:
        assert stream is not None
        return stream

    def _write(self) -> None:
        """Write what is sent: in a thread, because one that does not read would stop the server."""
        stream = self._stream(self._process.stdin)
        with contextlib.suppress(OSError, ValueError):
            while (line := self._lines.get()) is not None:
                stream.write(f"{line}\n")
                stream.flush()
        with contextlib.suppress(OSError, ValueError):
            stream.close()

    def _listen(self) -> None:
        stream = self._stream(self._process.stdout)
        while line := stream.readline(LONGEST_MESSAGE):
            if self._is_killed:
                return
            if len(line) == LONGEST_MESSAGE and not line.endswith("\n"):
                self._report = f"it wrote a line of more than {LONGEST_MESSAGE:,} characters"
                self._kill_group()
                return
            self._received(line)

    def _listen_to_errors(self) -> None:
        stream = self._stream(self._process.stderr)
        while line := stream.readline(_LONGEST_REPORT):
            self._report = (self._report + line)[-_LONGEST_REPORT:]

    def _wait(self) -> None:
        """Wait for the end of the process itself: those that it has started end with it."""
        if hasattr(os, "waitid"):
            with contextlib.suppress(ChildProcessError):  # reaped by ``kill``
                # Its number stays that of the group until it is reaped.
                os.waitid(os.P_PID, self._process.pid, os.WEXITED | os.WNOWAIT)
                self._kill_group()
        code = self._process.wait()
        self._lines.put(None)
        self._leash.cut()
        # A process that has left the group may hold the streams for ever.
        self._output.join(_REST_S)
        self._errors.join(1.0)
        is_killed, self._is_killed = self._is_killed, True
        self._is_over()
        if not is_killed:
            self._ended(code, self._report.strip())

    def _is_over(self) -> None:
        """Do what is left when the process has ended."""


class WorkerProcess(ChildProcess):
    """A worker that runs, in a folder that is removed when it has ended.

    Args:
        beside: The folder whose other files the scene may read.
        received: Called with each line that the worker sends, in a thread.
        ended: Called once when it has ended by itself, with the reason.

    Raises:
        OSError: There is no room for its folder, or for the process.
    """

    def __init__(
        self, beside: Path, received: Callable[[str], None], ended: Callable[[str], None]
    ) -> None:
        self._scratch = ScratchFolder(WORKER)
        texts, temporary = self._scratch.path / "scene", self._scratch.path / "temporary"
        try:
            texts.mkdir()
            temporary.mkdir()
            super().__init__(
                [sys.executable, "-P", "-m", "distal.editor", str(beside), str(texts)],
                received,
                lambda code, report: ended(reason_of(code, report)),
                temporary=temporary,
                memory=WORKER_MEMORY,
            )
        except BaseException:
            self._scratch.remove()
            raise

    def kill(self) -> None:
        """End it at once, with the processes that it has started and its folder."""
        super().kill()
        self._scratch.remove()

    def _is_over(self) -> None:
        self._scratch.remove()


def reason_of(code: int, report: str) -> str:
    """Return why a process has ended that the author's code has ended."""
    last = report.splitlines()
    why = f": {last[-1]}" if last else ""
    return f"the scene's code ended its process (exit status {code}){why}"
