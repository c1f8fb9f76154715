"""One tab of the studio: its worker, what it asked for, and the clock that ends an endless loop.

Input: messages of the app. Output: messages of the worker and of the server. While the author's
code runs, a worker has a few seconds; once it compiles, it has longer. Needs the standard library
alone.
"""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Callable
from typing import Final

from distal.diagnostics import LoadError
from distal.editor.local.early import EARLY_ID, EarlyWorker
from distal.editor.local.files import SceneFiles
from distal.editor.local.keeping import TabKeeping, refusal
from distal.editor.local.process import WorkerProcess
from distal.editor.local.renders import RenderQueue, command_of, render_choices
from distal.editor.messages import (
    Answer,
    AppRequest,
    CancelRequest,
    Changed,
    ChoicesRequest,
    CommandRequest,
    DraftRequest,
    Dropped,
    HelloRequest,
    Message,
    MessageError,
    Planned,
    RenderRequest,
    Restarted,
    SaveRequest,
    StopRequest,
    VersionRequest,
    VersionsRequest,
    encoded,
    parsed,
)
from distal.file_writer import SaveError
from distal.forking import new_lock

# Seconds that the author's code has, and that a compilation, a check or an export has after it.
CODE_S: Final = 5.0
WORK_S: Final = 120.0
_TICK_S: Final = 0.1
_ANSWERS: Final = ("scene", "numbers", "answer", "mistakes", "dropped")
_FROM_WORKER: Final = ("ready", "progress", "printed", *_ANSWERS)


class StudioTab:
    """A tab and its worker.

    Args:
        files: The files.
        send: Sends a text to the app.
        limit: Seconds that the author's code has.
        saved: Called with what was saved, for the other tabs.
        early: The worker to begin with, if there is one.
        renders: Renders pictures and films; None where there are none.
        start: Starts a worker; by default a process.
    """

    def __init__(
        self,
        files: SceneFiles,
        send: Callable[[str], None],
        limit: float = CODE_S,
        saved: Callable[[Changed], None] = lambda _: None,
        early: EarlyWorker | None = None,
        renders: RenderQueue | None = None,
        start: Callable[..., WorkerProcess] = WorkerProcess,
    ) -> None:
        self._files, self._send, self._limit, self._start = files, send, limit, start
        self._on_saved, self._renders = saved, renders
        self._keeping = TabKeeping(files)
        self._lock = new_lock()
        self._waiting: dict[int, int] = {}  # the revision by id, in the order of arrival
        self._ends = 0.0
        self._has_run = False  # the author's code, for the first request that waits
        self._hangs = ""  # the line that it is at after some seconds
        self._is_over = False
        with self._lock:  # the worker's lines wait until it is known
            self._worker = self._started(early)
        threading.Thread(target=self._watch, daemon=True).start()

    def received(self, text: str | bytes) -> None:
        """Take a message of the app."""
        try:
            self._take(parsed(text))
        except MessageError as error:
            self._tell(refusal(-1, -1, str(error)))
        except RecursionError:
            self._tell(refusal(-1, -1, "the message is nested too deeply"))

    def _take(self, request: Message) -> None:
        if isinstance(request, SaveRequest):
            self._tell(self._saved(request))
        elif isinstance(request, HelloRequest | DraftRequest | VersionsRequest | VersionRequest):
            for message in self._keeping.answered(request):
                self._tell(message)
        elif isinstance(request, RenderRequest | CommandRequest | ChoicesRequest | CancelRequest):
            self._render(request)
        elif isinstance(request, AppRequest) and not isinstance(request, StopRequest):
            with self._lock:
                if not self._waiting:
                    self._ends = time.monotonic() + self._limit
                self._waiting[request.id] = request.revision
                self._worker.send(encoded(request))

    def end(self) -> None:
        """End the worker and the renders; the app is gone."""
        with self._lock:
            self._is_over = True
            self._worker.kill()
        self._keeping.end()
        if self._renders is not None:
            self._renders.forget(self)

    def _render(
        self, request: RenderRequest | CommandRequest | ChoicesRequest | CancelRequest
    ) -> None:
        """Begin or end a render, or answer a question about one."""
        number = request.numbers
        if self._renders is None:
            self._tell(refusal(**number, text="nothing is rendered here"))
        elif isinstance(request, CancelRequest):
            self._renders.cancel(self, request.job)
        elif isinstance(request, RenderRequest):
            self._renders.add(self, request, self._tell)
        elif isinstance(request, ChoicesRequest):
            found = render_choices.choices()
            self._tell(Answer(**number, request="choices", result=found))
        else:
            try:
                planned = Planned(command=command_of(request))
            except LoadError as error:
                self._tell(refusal(**number, text=error.reason))
            else:
                self._tell(Answer(**number, request="command", result=planned))

    def _saved(self, request: SaveRequest) -> Message:
        name = request.file
        try:
            saved = self._files.save(name, request.text, request.digest, in_place=request.in_place)
        except (LoadError, SaveError) as error:
            reason = error.reason if isinstance(error, LoadError) else str(error)
            return refusal(request.id, request.revision, reason)
        if saved.is_saved:
            texts, digests = {name: request.text}, {name: saved.digest}
            self._on_saved(Changed(files=texts, digests=digests, order=saved.order))
        return Answer(**request.numbers, request="save", result=saved)

    def _started(self, early: EarlyWorker | None = None) -> WorkerProcess:
        worker: WorkerProcess

        def is_current() -> bool:
            return not self._is_over and worker is self._worker

        def received(line: str) -> None:
            with self._lock:
                if is_current():
                    self._pass_on(line)

        def ended(reason: str) -> None:
            with self._lock:
                if is_current():
                    self._restart(reason)

        taken = early.taken(received, ended) if early is not None else None
        if taken is not None:
            self._waiting[EARLY_ID] = 0
            self._ends = time.monotonic() + self._limit
        worker = taken or self._start(self._files.folder, received, ended)
        return worker

    def _pass_on(self, line: str) -> None:
        """Send a worker's message to the app; its text is not read further than needed.

        What the author's code has written to the worker's stream is left out.
        """
        try:
            found = json.loads(line)
            kind, number = found["kind"], found.get("id")
        except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
            return
        if kind not in _FROM_WORKER or not isinstance(number, int | None):
            return
        if kind in _ANSWERS:
            if number is not None and self._waiting.pop(number, None) is not None:
                self._ends = time.monotonic() + self._limit
                self._has_run, self._hangs = False, ""
        elif kind == "printed":
            self._hangs = str(found.get("hangs") or "") or self._hangs
        elif kind == "progress" and not self._has_run:
            # Once: code that says it again and again would never be ended.
            self._ends = time.monotonic() + WORK_S
            self._has_run = True
        if number != EARLY_ID:
            self._send(line.rstrip("\n"))

    def _watch(self) -> None:
        while not self._is_over:
            time.sleep(_TICK_S)
            with self._lock:
                if self._waiting and time.monotonic() > self._ends and not self._is_over:
                    self._worker.kill()
                    where = f"; it was at {self._hangs}" if self._hangs else ""
                    limit = f"{self._limit:g} s"
                    self._restart(f"the scene's code gave no answer within {limit}{where}")

    def _restart(self, reason: str) -> None:
        """Start another worker; the first request that waits is the one that was not answered."""
        number, *others = [*self._waiting, None]
        self._tell(Restarted(id=number, reason=reason))
        for other in others:
            if other is not None:
                self._tell(Dropped(id=other, revision=self._waiting[other]))
        self._waiting.clear()
        self._has_run, self._hangs = False, ""
        try:
            self._worker = self._started()
        except OSError as error:  # tried again when the next request has waited
            self._tell(Restarted(id=None, reason=f"no worker can be started: {error}"))

    def _tell(self, message: Message) -> None:
        self._send(encoded(message))
