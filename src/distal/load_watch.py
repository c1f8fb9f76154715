"""Watch a scene's file while it runs: it may never end.

Input: the file, and what shows a message. Output: after 3 s, a message with the loop that the file
is in; the end of the file's run when it was saved again, or by ctrl-C even where the author's code
catches every exception. A call of C code that keeps Python's lock is not interrupted. Needs the
standard library alone.
"""

from __future__ import annotations

import contextlib
import linecache
import math
import os
import re
import signal
import sys
import threading
import time
import types
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Final

from distal import loading
from distal.diagnostics import Diagnostic, Span
from distal.error_codes import ErrorCode
from distal.forking import new_lock
from distal.interrupting import INTERRUPTED, interrupt_main, raise_in
from distal.loading import SceneCode, file_of, load, split_source
from distal.saved_files import FileWatcher

PATIENCE_S: Final = 3.0
_PERIOD_S: Final = 0.25  # between two attempts to end the run, and two looks at the file
_LOOP: Final = re.compile(r"(async\s+for|for|while)\b")
_LEFT_S: Final = 1.0  # from ctrl-C to the end of the process


class SavedAgain(BaseException):
    """Ends the run of a file that was saved meanwhile, even if the author's code catches it.

    Raised where the author's code runs, it is made there. It then raises itself once more at the
    next line, which is in the author's ``except`` and not in the ``try`` any more.
    """

    def __init__(self) -> None:
        super().__init__()
        frame: types.FrameType | None = sys._getframe(1)
        while frame is not None and frame.f_code.co_filename != loading.__file__:
            if frame.f_code.co_filename != __file__:
                frame.f_trace = _raise_again
            frame = frame.f_back
        if frame is not None:  # else nothing of the author runs
            sys.settrace(_raise_again)


def _raise_again(_frame: types.FrameType, event: str, _argument: object) -> None:
    """Raise the exception at a line; Python then forgets this function."""
    if event == "line":
        raise SavedAgain


class LoadWatch:
    """A context in which a file runs, in the thread that enters it.

    Args:
        file: The file.
        say: Called once, in a thread, with the message that it takes long.
        restarts: Whether a saved file ends the run by itself, with ``SavedAgain``.

    Attributes:
        is_overdue: Whether the message was said, and the file still runs.
    """

    def __init__(
        self, file: Path, say: Callable[[Diagnostic], None], *, restarts: bool = False
    ) -> None:
        self._file, self._say = file, say
        self._files = FileWatcher([file]) if restarts else None
        self.is_overdue = False
        self._is_ended = threading.Event()
        self._is_wanted_to_end = False
        self._interrupted_at: float | None = None
        self._is_main = False
        self._lock = new_lock()
        self._before: object = None

    def __enter__(self) -> LoadWatch:
        self._traced = sys.gettrace()
        if sys.platform == "emscripten":  # no threads in a browser
            return self
        self._thread = threading.get_ident()
        self._is_main = threading.current_thread() is threading.main_thread()
        if self._is_main:
            self._before = signal.getsignal(signal.SIGINT)
            signal.signal(signal.SIGINT, self._signalled)
        threading.Thread(target=self._watch, name="distal-load-watch", daemon=True).start()
        return self

    def __exit__(self, *_: object) -> None:
        is_late = False
        while not self._is_ended.is_set():
            try:
                with self._lock:
                    self._is_ended.set()
            except SavedAgain:  # on its way when the file ended
                is_late = True
        self.is_overdue = False
        sys.settrace(self._traced)
        if self._is_main:
            before = self._before
            signal.signal(signal.SIGINT, before if before is not None else signal.SIG_DFL)  # type: ignore[arg-type]
        if is_late:
            raise SavedAgain

    def interrupt(self) -> None:
        """End the run by ``SavedAgain``, again and again until it has ended."""
        self._is_wanted_to_end = True

    def _signalled(self, number: int, frame: types.FrameType | None) -> None:
        if self._is_wanted_to_end:
            raise SavedAgain
        if callable(self._before):  # a job in the background may ignore ctrl-C
            self._interrupted_at = self._interrupted_at or time.monotonic()
            self._before(number, frame)

    def _watch(self) -> None:
        begin = time.monotonic()
        while not self._is_ended.wait(_PERIOD_S):
            if not self.is_overdue and time.monotonic() - begin >= PATIENCE_S:
                self.is_overdue = True
                self._say(self._message())
            if self.is_overdue and self._files is not None and self._files.has_changed():
                self.interrupt()
            if self._interrupted_at is not None:
                self._end_process(self._interrupted_at)
            if self._is_wanted_to_end or self._interrupted_at is not None:
                self._raise()

    def _raise(self) -> None:
        """Raise the exception in the thread that runs the file, if it still does."""
        with self._lock:
            if self._is_ended.is_set():
                return
            if not self._is_main:
                raise_in(self._thread, SavedAgain)
            else:
                interrupt_main()

    def _end_process(self, interrupted_at: float) -> None:
        """End the process if the author's code has caught the exception of ctrl-C."""
        if time.monotonic() - interrupted_at > _LEFT_S and not self._is_ended.is_set():
            with contextlib.suppress(Exception):
                sys.stdout.flush()
                sys.stderr.flush()
            os._exit(INTERRUPTED)

    def _message(self) -> Diagnostic:
        text = f"{self._file.name} is still running after {PATIENCE_S:g} s"
        hint = "save the file to load it again, or end it by ctrl-C"
        return Diagnostic(ErrorCode.FILE, text, self._place(), hint)

    def _place(self) -> Span | None:
        """Return the loop that the author's code is in, or else its innermost line."""
        frame = sys._current_frames().get(self._thread)
        frames = list(_authors(frame, self._file))
        for code, line in frames:
            found = _loop_around(code.co_filename, line)
            if found is not None:
                return _span(code.co_filename, found)
        return _span(frames[0][0].co_filename, frames[0][1]) if frames else None


def load_watched(path: str, name: str | None, say: Callable[[Diagnostic], None]) -> SceneCode:
    """Load a scene from a file, and again if it does not end and is saved.

    Args:
        path: As for ``load``.
        name: As for ``load``.
        say: Called in a thread with the message that the file takes long.

    Raises:
        LoadError: There is no such file or name, or the file fails when run.
        CompileError: The file is not valid Python.
    """
    file = file_of(split_source(path)[0] if name is None else path)
    while True:
        try:
            with LoadWatch(file, say, restarts=True):
                return load(path, name)
        except SavedAgain:
            continue


def _authors(frame: types.FrameType | None, file: Path) -> Iterator[tuple[types.CodeType, int]]:
    """Yield the author's functions that run and their lines, the innermost first."""
    folder = file.resolve().parent
    while frame is not None:
        name = frame.f_code.co_filename
        if name == str(file) or Path(name).parent == folder:
            yield frame.f_code, frame.f_lineno
        frame = frame.f_back


def _loop_around(file: str, line: int) -> int | None:
    """Return the line of the innermost loop around a line, by how far lines are indented.

    ``ast.parse`` is no way: before Python 3.11.8 and 3.12.2, two threads that parse at the same
    time make each other fail with a ``SystemError``, and the author's thread may be parsing.
    """
    lines = linecache.getlines(file)[:line]
    least: float = math.inf
    for number in range(len(lines), 0, -1):
        text = lines[number - 1].expandtabs()
        rest = text.lstrip()
        indent = len(text) - len(rest)
        if indent >= least or not rest or rest.startswith("#"):
            continue
        if _LOOP.match(rest):
            return number
        least = indent
    return None


def _span(file: str, line: int) -> Span:
    text = linecache.getline(file, line).rstrip("\n")
    start = len(text) - len(text.lstrip())
    return Span(file, line, start, len(text), text, line)
