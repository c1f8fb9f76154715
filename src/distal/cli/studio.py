"""``distal studio``: edit a scene in the browser.

Input: parsed arguments. Output: a server on this machine until it is interrupted.
"""

from __future__ import annotations

import contextlib
import errno
import os
import signal
import sys
import threading
import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from distal.cli.arguments import UsageError
from distal.cli.base import answer, application, reporting
from distal.cli.messages import say
from distal.editor.local.early import EarlyWorker
from distal.editor.local.files import SceneFiles
from distal.example_files import EXAMPLE_PREFIX, all_examples
from distal.file_writer import SaveError

if TYPE_CHECKING:
    from distal.editor.local.serving import LocalServer

# So long the browser may take to open, until the worker that waits for it is ended.
_OPENING_S = 60.0
_KEYS = "Ctrl-C ends it; unsaved changes are kept. Enter prints an address for another browser."
_LONGEST_INPUT = 1024  # bytes that are read of the terminal at once
_BACKGROUND_S = 1.0
# What a new file begins with.
STARTER = '''"""A scene: change a number, or drag it, and see."""

from distal import *

ball = Sphere(0.6).paint("#d97757")
box = Box(0.5).translate(0.7, 0.0, 0.0).paint("#4f7cac")

scene = Scene(ball.union(box, smooth=0.2))
'''


@application.command()
@reporting
def studio(
    file: Annotated[
        str | None,
        typer.Argument(
            metavar="FILE",
            help="The scene: a Python file, or example:NAME for a copy. A file that is not there "
            "yet begins with a small scene. Or a lesson: lesson.md.",
            show_default=False,
        ),
    ] = None,
    port: Annotated[
        int, typer.Option(min=0, max=65535, help="The port; 0 for any that is free.")
    ] = 0,
    browser: Annotated[
        bool, typer.Option("--browser/--no-browser", help="Open the browser.")
    ] = True,
    time_limit: Annotated[
        float,
        typer.Option(min=0.5, help="Seconds that the scene's own code may run at each change."),
    ] = 5.0,
) -> None:
    """Edit a scene in the browser: code, picture and parameters side by side.

    A lesson (lesson.md) is shown as its page, which follows what any editor saves.
    """
    given = file or "scene.py"
    make = _lesson if given.endswith(".md") else _scene
    try:
        server, name = make(given, port, time_limit)
    except OSError as error:
        raise UsageError(f"port {port} cannot be used: {error.strerror}") from None
    try:
        answer(f"{name} at {server.address}\n{_KEYS}")
        if sys.stdin is not None:  # None: a program of Windows without a console
            _watch_terminal(server)
        if browser:
            _open_browser(server)
        server.serve()
    except KeyboardInterrupt:
        pass
    finally:
        server.close()


def _open_browser(server: LocalServer) -> None:
    try:
        reason = "" if server.open_browser() else "there is none"
    except OSError as error:
        reason = error.strerror or str(error)
    if reason:
        say(f"warning: the browser is not opened ({reason}): open the address above yourself")


def _watch_terminal(server: LocalServer) -> None:
    if hasattr(signal, "SIGTTIN"):  # it would stop a server in the background of a shell
        signal.signal(signal.SIGTTIN, signal.SIG_IGN)
    threading.Thread(target=_print_addresses, args=(server,), daemon=True).start()


def _print_addresses(server: LocalServer) -> None:
    """Print an address whenever Enter is pressed, until the input ends."""
    while True:
        try:
            # Not by the stream: a thread that reads it would hold up the end of the program.
            text = os.read(sys.stdin.fileno(), _LONGEST_INPUT)
        except OSError as error:
            if error.errno != errno.EIO:  # there is no input
                return
            time.sleep(_BACKGROUND_S)  # in the background of a shell nothing can be read
            continue
        if not text:
            return
        if b"\n" in text:
            with contextlib.suppress(SaveError, OSError):  # nobody reads what is printed
                answer(server.address)


def _scene(given: str, port: int, time_limit: float) -> tuple[LocalServer, str]:
    """Return the server of a scene, and the file's name."""
    files = _files(given)
    # Python starts beside what follows, and beside the browser.
    early = EarlyWorker(files, time_limit + _OPENING_S)
    try:
        from distal.editor.local.server import StudioServer

        server = StudioServer(files, port, time_limit, early)
    except BaseException:  # no package for the server, a port that is taken, or ctrl-C
        early.end()
        raise
    return server, files.main


def _lesson(given: str, port: int, time_limit: float) -> tuple[LocalServer, str]:
    """Return the server of a lesson, and the file's name."""
    from distal.editor.local.lesson_server import LessonServer

    path = Path(given)
    if not path.is_file():
        raise UsageError(f"there is no file '{given}'")
    return LessonServer(path, port), path.name


def _files(given: str) -> SceneFiles:
    if given.startswith(EXAMPLE_PREFIX):
        name = given.removeprefix(EXAMPLE_PREFIX)
        path = all_examples().get(name)
        if path is None:
            raise UsageError(f"there is no example '{name}'; 'distal examples' lists them")
        texts = SceneFiles(path).all().files
        return SceneFiles(Path.cwd() / path.name, texts)
    path = Path(given)
    if path.is_dir() or path.suffix != ".py":
        raise UsageError(f"'{given}' is not a Python file")
    if not path.parent.is_dir():
        raise UsageError(f"there is no folder '{path.parent}'")
    return SceneFiles(path, None if path.exists() else {path.name: STARTER})
