"""A worker that has compiled the scene when the browser opens.

Input: the files. Output: the worker of the first tab. While the browser starts, Python starts, too,
and runs the scene once, so that the tab's own first request is answered from what is kept. Needs
the standard library alone.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Final

from distal.editor.local.files import SceneFiles
from distal.editor.local.process import WorkerProcess
from distal.editor.messages import LookRequest, encoded
from distal.forking import new_lock

EARLY_ID: Final = 0  # of the request that no app has made


class EarlyWorker:
    """A worker without a tab.

    Args:
        files: The files.
        limit: Seconds after which it is ended if no tab has taken it: the scene may run for ever.
        start: Starts a worker; by default a process.
    """

    def __init__(
        self,
        files: SceneFiles,
        limit: float,
        start: Callable[..., WorkerProcess] = WorkerProcess,
    ) -> None:
        self._lock = new_lock()
        self._lines: list[str] = []
        self._received: Callable[[str], None] | None = None
        self._on_end: Callable[[str], None] | None = None
        self._is_over = False
        self._process = start(files.folder, self._arrived, self._ended)
        texts = files.all().files
        first = LookRequest(id=EARLY_ID, revision=0, files=texts, main=files.main, guided=False)
        self._process.send(encoded(first))
        self._timer = threading.Timer(limit, self.end)
        self._timer.daemon = True
        self._timer.start()

    def taken(
        self, received: Callable[[str], None], ended: Callable[[str], None]
    ) -> WorkerProcess | None:
        """Return the worker; None if it has ended.

        Args:
            received: Gets each line in another thread, from the first one on: also the answer to
                the request with ``EARLY_ID``.
            ended: Called when the worker ends by itself.
        """
        self._timer.cancel()
        with self._lock:
            if self._is_over or self._received is not None:
                return None
            self._received, self._on_end = received, ended
        threading.Thread(target=self._pass_on, daemon=True).start()
        return self._process

    def end(self) -> None:
        """End the worker, unless a tab has taken it."""
        self._timer.cancel()
        with self._lock:
            if self._received is None and not self._is_over:
                self._is_over = True
                self._process.kill()

    def _arrived(self, line: str) -> None:
        with self._lock:
            self._lines.append(line)
        self._pass_on()

    def _pass_on(self) -> None:
        with self._lock:
            if self._received is not None:
                lines, self._lines = self._lines, []
                for line in lines:
                    self._received(line)

    def _ended(self, reason: str) -> None:
        with self._lock:
            self._is_over = True
            on_end = self._on_end
        if on_end is not None:
            on_end(reason)
