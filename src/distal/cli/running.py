"""Run one command: import it, convert what its packages raise, keep streams and warnings in order.

Input: the arguments of the process. Output: an exit code. It imports the module of one command.
"""

from __future__ import annotations

import errno
import importlib
import io
import os
import sys
import threading
import time
import warnings
from _thread import start_new_thread
from collections.abc import Callable
from contextlib import suppress
from types import FrameType
from typing import Final, NoReturn

from distal.cli import COMMANDS, SHORT
from distal.cli.exit_codes import ExitCode
from distal.cli.messages import say
from distal.cli.terminal import forget_impossible_sizes
from distal.interrupting import interrupt_main
from distal.lang.notices import receive_notices

_NOT_WRITTEN: Final = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO)


def _show_warning(message: Warning | str, *_: object, **__: object) -> None:
    """Print a warning in one line, without the place in distal's code, which users do not need."""
    say(f"warning: {message}")


def _show_notice(line: str) -> None:
    """Print what the library says of its work in one line."""
    say(f"note: {line}")


def _open_what_is_closed() -> None:
    """Reopen closed standard streams, so that no opened file gets their descriptor."""
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # uses the lowest free number, which is this one
    if sys.stdout is None:
        sys.stdout = open(1, "w", closefd=False)  # noqa: SIM115 (for good)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # file names may not be valid text
    if sys.stderr is None:
        sys.stderr = open(2, "w", closefd=False)  # noqa: SIM115 (for good)


def _unraisable(unraisable: sys.UnraisableHookArgs) -> None:
    """Interrupt again where ctrl-C came in the middle of a finalizer, which would ignore it."""
    if isinstance(unraisable.exc_value, KeyboardInterrupt):
        start_new_thread(_interrupt_later, (sys._getframe(),))
    else:
        sys.__unraisablehook__(unraisable)


def _interrupt_later(hook: FrameType) -> None:
    """Interrupt the main thread as soon as it has left the hook, which would ignore it again."""
    frame: FrameType | None = hook
    while frame is hook:
        time.sleep(0.01)
        frame = sys._current_frames().get(threading.main_thread().ident or 0)
        while frame is not None and frame is not hook:
            frame = frame.f_back
    interrupt_main()


def _is_scene(argument: str) -> bool:
    """Return whether the first argument is a scene and no command."""
    file, _, name = argument.rpartition(":")
    ends = argument.endswith(".py") or (file.endswith(".py") and name.isidentifier())
    return ends or argument.startswith("example:")


def _leave() -> NoReturn:
    """End the process after ctrl-C: threads may be in LLVM, for which Python would wait."""
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError):
            stream.flush()
    os._exit(ExitCode.INTERRUPTED)


def _run_to_its_end(application: Callable[[], object]) -> None:
    """Run the application of typer, with one line where ``--help`` cannot be written.

    Raises:
        SystemExit: It has ended.
    """
    try:
        application()
    except SystemExit as end:
        if isinstance(end.__context__, BrokenPipeError):  # typer and rich make it a 1
            raise SystemExit(ExitCode.PIPE_CLOSED) from None
        raise
    except OSError as error:
        if error.errno not in _NOT_WRITTEN or error.filename is not None:
            raise
        say(f"error: cannot write to stdout: {error.strerror}")
        raise SystemExit(ExitCode.FAILED) from None


def run() -> None:
    """Run the command line of this process."""
    try:
        _open_what_is_closed()
        first = next(iter(sys.argv[1:]), "")
        if _is_scene(first):
            sys.argv.insert(1, first := "render")
        name = first if first in COMMANDS and first not in SHORT else "application"
        forget_impossible_sizes()
        module = importlib.import_module(f"distal.cli.{name}")
        sys.unraisablehook = _unraisable
        warnings.showwarning = _show_warning
        receive_notices(_show_notice)
        _run_to_its_end(module.application)
    except KeyboardInterrupt:  # on the way into a command, or out of it
        _leave()
    except SystemExit as end:
        if end.code == ExitCode.INTERRUPTED:
            _leave()
        raise
    except Exception as error:
        from distal.packages import explained

        cause = explained(error)  # typer, rich or one of their dependencies
        if cause is None:
            raise
        print(f"error: {cause}", file=sys.stderr)
        sys.exit(ExitCode.FAILED)
