"""Which functions of a folder run, for whom: in the process of the tests and in those it starts.

In a child process a line is appended when a function runs the first time, so that a process that is
killed, or forked, leaves what it ran. Scene code never runs as Python: the front end asks for each
function's signature, in every compilation. Python 3.12 and newer stop reporting a function that has
been seen; older ones report every call, which takes a few times as long. Standard library only.
"""

from __future__ import annotations

import os
import sys
import threading
from types import CodeType, FrameType
from typing import Any

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]

FOLDER, TEST, SOURCE = "DISTAL_RECORD", "DISTAL_RECORD_TEST", "DISTAL_RECORD_SOURCE"
TOOL = 4
HIGH = 500
ASKED = "Compilation.signature"


class Monitor:
    """Records the functions that run.

    Args:
        source: The folder of the source, with a slash.

    Attributes:
        seen: Code objects since the last ``begin``.
    """

    def __init__(self, source: str) -> None:
        self.source, self.seen = source, set[CodeType]()
        self._file = -1

    def start(self) -> None:
        """Begin to record, in all threads."""
        if hasattr(sys, "monitoring"):
            m = sys.monitoring
            m.use_tool_id(TOOL, "distal record")
            m.register_callback(TOOL, m.events.PY_START, self._started)
            m.set_events(TOOL, m.events.PY_START)
        else:
            threading.setprofile(self._called)
            sys.setprofile(self._called)

    def begin(self) -> None:
        """Forget what ran: each function is recorded again."""
        self.seen = set()
        if hasattr(sys, "monitoring"):
            sys.monitoring.restart_events()

    def write_to(self, folder: str) -> None:
        """Write each function to a file of this child process at once, for the current test."""
        name = os.path.join(folder, f"child-{os.getpid()}-{os.urandom(3).hex()}")
        low = os.open(name, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o600)
        self._file = low if fcntl is None else fcntl.fcntl(low, fcntl.F_DUPFD_CLOEXEC, HIGH)
        if self._file != low:  # programs use the lowest numbers for what they are given
            os.close(low)
        os.write(self._file, f"test {os.environ.get(TEST, '')}\n".encode())

    def names(self) -> set[str]:
        """Return the functions since the last ``begin``, without what has no name of its own."""
        return {name for name in map(self._name, self.seen) if ":<" not in name}

    def _started(self, code: CodeType, offset: int) -> Any:
        if sys is None:  # the interpreter ends
            return None
        if code.co_filename.startswith(self.source):
            self._add(code)
            if code.co_qualname == ASKED:
                self._ask(sys._getframe(1))
                return None
        return sys.monitoring.DISABLE

    def _called(self, frame: FrameType, event: str, arg: object) -> None:
        code = frame.f_code
        if event == "call" and code.co_filename.startswith(self.source):
            self._add(code)
            if code.co_qualname == ASKED:
                self._ask(frame)

    def _ask(self, frame: FrameType) -> None:
        """Record the scene function for whose signature the front end asks."""
        asked = frame.f_locals.get("overload")
        code = getattr(getattr(asked, "python", None), "__code__", None)
        if code is not None and code.co_filename.startswith(self.source):
            self._add(code)

    def _add(self, code: CodeType) -> None:
        if code not in self.seen:
            self.seen.add(code)
            if self._file >= 0:
                os.write(self._file, f"{self._name(code)}\n".encode())

    def _name(self, code: CodeType) -> str:
        """Return "file:qualified name" of the outermost function."""
        file = code.co_filename[len(self.source) :]
        return f"{file}:{code.co_qualname.partition('.<locals>')[0]}"


def start_in_child() -> None:
    """Record in this process, if the environment says so; called by ``sitecustomize``."""
    folder = os.environ.get(FOLDER)
    if folder and os.environ.get(TEST):
        monitor = Monitor(os.environ[SOURCE])
        monitor.write_to(folder)
        monitor.start()
