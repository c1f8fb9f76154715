"""What holds a process that runs the author's code: it ends with the server, and has limits.

Input: the number of a process that leads its own group. Output: none. Each measure is one of the
system's own, and is left out where the system has none (all are Linux's). Needs the standard
library alone.
"""

from __future__ import annotations

import contextlib
import os
import signal
import sys
from pathlib import Path
from typing import Final

if sys.platform == "linux":
    import fcntl
    import resource

WORKER_MEMORY: Final = 0.5  # the share of this machine's memory that a worker may have
RENDER_MEMORY: Final = 1.0
_FIRST: Final = "500"  # when memory runs out, the system ends these processes before others


class Leash:
    """A pipe whose end, that of the server, closes with the server.

    The process gets the other end (``passed``). The system then kills the whole group, even if its
    interpreter is busy for ever.
    """

    def __init__(self) -> None:
        self._ends = os.pipe() if sys.platform == "linux" else None

    @property
    def passed(self) -> tuple[int, ...]:
        """The file descriptors that the process must get."""
        return () if self._ends is None else self._ends[:1]

    def hold(self, process: int, memory: float) -> None:
        """Hold a process that has been started.

        Args:
            process: Its number, which is that of its group.
            memory: The share of this machine's memory that it may have.
        """
        if sys.platform != "linux" or self._ends is None:
            return
        read = self._ends[0]
        with contextlib.suppress(OSError):
            fcntl.fcntl(read, fcntl.F_SETOWN, -process)
            fcntl.fcntl(read, fcntl.F_SETSIG, signal.SIGKILL)
            flags = fcntl.fcntl(read, fcntl.F_GETFL)
            fcntl.fcntl(read, fcntl.F_SETFL, flags | fcntl.FASYNC)
        os.close(read)
        self._ends = (-1, self._ends[1])
        with contextlib.suppress(OSError, ValueError):  # it has ended already
            most = int(memory * os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
            resource.prlimit(process, resource.RLIMIT_DATA, (most, most))
        with contextlib.suppress(OSError):
            Path(f"/proc/{process}/oom_score_adj").write_text(_FIRST)

    def cut(self) -> None:
        """Close the pipe; what still holds the other end is killed."""
        if self._ends is not None:
            for end in self._ends:
                if end >= 0:
                    os.close(end)
            self._ends = None
