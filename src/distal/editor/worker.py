"""The studio's worker: answers requests about the author's code, one after the other.

Input: messages of the app, one JSON text a line on standard input, or by ``Worker.answers`` where
the host carries them itself (a browser). Output: messages, as lines on standard output. It runs the
author's code, which may never end: whoever started the worker ends it. Needs the standard library
alone; ``check``, ``probe`` and textures need NumPy.
"""

from __future__ import annotations

import contextlib
import gc
import io
import os
import queue
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import IO, Any, Final

from distal.backends import TEXT_TARGETS
from distal.compiler.driver import COMPILE_TARGETS
from distal.diagnostics import CompileError, DeviceError, LoadError
from distal.editor.answers import ANSWERS, NEEDS_NUMPY, AnswerWork
from distal.editor.commands import PAGE
from distal.editor.edits import EditError, applied, edits_of
from distal.editor.literals import LiteralError, find_literals
from distal.editor.looks import Looks, mistakes_of
from distal.editor.mailbox import Mailbox
from distal.editor.messages import (
    LONGEST_PRINTED,
    Answer,
    AppRequest,
    Dropped,
    Edit,
    HoldRequest,
    LookRequest,
    Message,
    MessageError,
    Mistake,
    Mistakes,
    Printed,
    Ready,
    SourceLiteral,
    SourceRequest,
    StopRequest,
    encoded,
    parsed,
)
from distal.editor.scene_folder import link_beside
from distal.export.payload import FORMAT
from distal.forking import new_lock
from distal.packages import explained, is_installed
from distal.version import __version__

PATIENCE_S: Final = 5.0  # for the author's code, when nobody is there any more
PAUSE_S: Final = 1.0  # without a request, until memory is tidied

Send = Callable[[Message], None]
_NAMED: Final = (CompileError, LoadError, DeviceError)
_REFUSED: Final = (EditError, LiteralError, ValueError, TypeError, OSError)


class StudioWorker:
    """Answers requests. It keeps compiled programs between them.

    Args:
        folder: Where the modules beside the scene's file are put.
        tell: Sends a message before the answer: that the author's code has ended.
    """

    def __init__(self, folder: Path, tell: Send = lambda _: None) -> None:
        self._looks = Looks(folder, tell)

    def ready(self) -> Ready:
        """Return the worker's first message."""
        has_numpy = is_installed("numpy")
        kinds = ["look", "hold", *ANSWERS, "stop"]
        return Ready(
            abilities=tuple(k for k in kinds if has_numpy or k not in NEEDS_NUMPY),
            versions={
                "distal": __version__,
                "python": ".".join(map(str, sys.version_info[:3])),
                "payload": str(FORMAT),
                "messages": "1",
            },
            targets=COMPILE_TARGETS,
            formats=(PAGE, *TEXT_TARGETS),
        )

    def answers(self, request: AppRequest) -> list[Message]:
        """Return the messages that answer a request: what was printed, then the answer."""
        printed = _PrintedText()
        with _captured(printed):
            answer = self._answer(request)
        first: list[Message] = []
        if printed.length:
            text = printed.getvalue()
            left = printed.length - len(text)
            more = f"\n… {left:,} characters more" if left else ""
            first = [Printed(**request.numbers, text=text + more)]
        return [*first, answer]

    def _answer(self, request: AppRequest) -> Message:
        begin = time.perf_counter()
        number = request.numbers
        if not isinstance(request, SourceRequest) or request.kind not in self.ready().abilities:
            return _refused(number, f"this worker cannot do '{request.kind}'")
        edits: tuple[Edit, ...] = ()
        literals: tuple[SourceLiteral, ...] | None = None
        try:
            if request.main not in request.files:
                raise EditError(f"there is no file '{request.main[:80]}' among the texts")
            if isinstance(request, LookRequest):
                edits = edits_of(request.files, request.main, request.changes)
                files = applied(request.files, edits)
                if not request.lean:
                    literals = tuple(x for f, t in files.items() for x in find_literals(f, t))
                return self._looks.look(request, files, edits, literals, begin)
            if isinstance(request, HoldRequest):
                return self._looks.hold(request, begin)
            result = ANSWERS[request.kind](AnswerWork(request, self._looks))
            return Answer(**number, request=request.kind, result=result)
        except (Exception, KeyboardInterrupt) as error:
            found = _mistakes_of(error, request)
            return Mistakes(**number, mistakes=found, literals=literals, edits=edits)


class _PrintedText(io.StringIO):
    """What the author's code prints: its begin, and its length. All of it may be gigabytes."""

    def __init__(self) -> None:
        super().__init__()
        self.length = 0

    def write(self, text: str) -> int:
        """Keep a text as far as there is room."""
        super().write(text[: max(0, LONGEST_PRINTED - self.length)])
        self.length += len(text)
        return len(text)


def _mistakes_of(error: BaseException, request: SourceRequest) -> tuple[Mistake, ...]:
    """Return what the author or the app did wrong; an unknown error names its type, too."""
    if isinstance(error, _NAMED):
        return mistakes_of(error, request.files)
    if isinstance(error, RecursionError):
        text = "the scene is nested too deeply"
    elif isinstance(error, _REFUSED):
        text = str(error)
    elif isinstance(error, KeyboardInterrupt):
        text = "the scene's code raised KeyboardInterrupt"
    else:
        found = explained(error) if isinstance(error, Exception) else None
        text = str(found or f"{type(error).__name__}: {error}".removesuffix(": "))
    return (Mistake(severity="error", message=text),)


def _refused(number: dict[str, Any], text: str) -> Mistakes:
    return Mistakes(**number, mistakes=(Mistake(severity="error", message=text),))


@contextlib.contextmanager
def _captured(into: IO[str]) -> Iterator[None]:
    """Keep what the author's code prints from the messages."""
    with contextlib.redirect_stdout(into), contextlib.redirect_stderr(into):
        yield


def serve(worker: StudioWorker, lines: Iterable[str], send: Send) -> None:
    """Answer requests until ``stop`` or the end of the input.

    Args:
        worker: The worker.
        lines: A request on each line.
        send: Sends a message.
    """
    arriving: queue.SimpleQueue[str | None] = queue.SimpleQueue()
    threading.Thread(target=_read, args=(lines, arriving), daemon=True).start()
    mailbox = Mailbox()
    send(worker.ready())
    # Collections take a fifth of a compilation: they are left to the pauses between requests.
    gc.disable()
    while True:
        waiting = mailbox.take()
        if waiting is None:
            if not _received(_next(arriving), mailbox, send):
                return
        else:
            # What arrived meanwhile may be newer.
            for dropped in mailbox.put(waiting):
                send(Dropped(**dropped.numbers))
        while not arriving.empty():
            if not _received(arriving.get(), mailbox, send):
                return
        request = mailbox.take()
        if request is not None:
            for message in worker.answers(request):
                send(message)


def _next(arriving: queue.SimpleQueue[str | None]) -> str | None:
    """Return the next line; memory is tidied when none comes for a while."""
    try:
        return arriving.get(timeout=PAUSE_S)
    except queue.Empty:
        gc.collect()
        return arriving.get()


def _received(line: str | None, mailbox: Mailbox, send: Send) -> bool:
    """Put a line's request into the mailbox; return whether the worker goes on."""
    if line is None:
        return False
    if not line.strip():
        return True
    try:
        request = parsed(line)
    except MessageError as error:
        send(_refused({"id": -1, "revision": -1}, str(error)))
        return True
    if isinstance(request, StopRequest):
        return False
    if not isinstance(request, AppRequest):
        send(_refused({"id": -1, "revision": -1}, f"'{request.kind}' is not a request"))
        return True
    for dropped in mailbox.put(request):
        send(Dropped(**dropped.numbers))
    return True


def _read(lines: Iterable[str], arriving: queue.SimpleQueue[str | None]) -> None:
    for line in lines:
        arriving.put(line)
    arriving.put(None)


def main() -> None:
    """Answer requests on standard input, in a folder that is removed at the end.

    The streams of messages are copies: the author's code has neither. The first argument names the
    folder of the scene, whose other files are linked beside the texts, so that a scene finds its
    pictures; the second one a folder for the texts that somebody else removes.
    """
    requests = os.fdopen(os.dup(0), "r", encoding="utf-8", newline="\n")
    messages = os.fdopen(os.dup(1), "w", encoding="utf-8", newline="\n")
    nothing = os.open(os.devnull, os.O_RDWR)
    os.dup2(nothing, 0)
    os.dup2(2, 1)

    lock = new_lock()

    def send(message: Any) -> None:
        with lock:  # a thread tells where the author's code is
            messages.write(f"{encoded(message)}\n")
            messages.flush()

    with contextlib.ExitStack() as stack:
        beside, texts = [*sys.argv[1:3], None, None][:2]
        folder = Path(texts or stack.enter_context(tempfile.TemporaryDirectory()))
        if beside is not None:
            link_beside(Path(beside), folder)
        serve(StudioWorker(folder, send), _until_left(requests), send)


def _until_left(lines: IO[str]) -> Iterator[str]:
    """Yield the lines. After the last one nobody is there: what does not end by itself is ended."""
    yield from lines
    timer = threading.Timer(PATIENCE_S, os._exit, (1,))
    timer.daemon = True
    timer.start()


if __name__ == "__main__":
    main()
