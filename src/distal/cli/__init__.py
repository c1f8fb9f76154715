"""The ``distal`` command: parses the command line, calls the library, reports errors.

Input: the arguments of the command line. Output: files, text on stdout (data only), messages on
stderr, and an exit code (``distal.cli.exit_codes``). Contains no algorithms.
"""

from __future__ import annotations

import importlib
import io
import os
import sys
import threading
import warnings

from distal.cli.exit_codes import ExitCode
from distal.interrupting import interrupt_main
from distal.lang.notices import receive_notices

# The commands, as --help lists them: first those that new users need.
COMMANDS = (
    *("render", "view", "studio", "new", "video", "sweep", "mesh", "slice", "export", "rerender"),
    *("check", "probe", "measure", "compile", "examples", "doctor"),
)
# The others have a module of their name: one of them is imported without the rest.
SHORT = ("compile", "examples", "doctor")


def _show_warning(message: Warning | str, *_: object, **__: object) -> None:
    """Print a warning in one line, without the place in distal's code, which users do not need."""
    from distal.cli.messages import say

    say(f"warning: {message}")


def _show_notice(line: str) -> None:
    """Print what the library says of its work in one line."""
    from distal.cli.messages import say

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
        threading.Timer(0.01, interrupt_main).start()
    else:
        sys.__unraisablehook__(unraisable)


def _is_scene(argument: str) -> bool:
    """Return whether the first argument is a scene and no command."""
    file, _, name = argument.rpartition(":")
    ends = argument.endswith(".py") or (file.endswith(".py") and name.isidentifier())
    return ends or argument.startswith("example:")


def main() -> None:
    """Run the command line of this process."""
    try:
        _open_what_is_closed()
        # Nothing slow runs before the try, so that ctrl-C never prints a traceback.
        from distal.cli.ending import run_to_its_end
        from distal.cli.terminal import forget_impossible_sizes

        wanted = next(iter(sys.argv[1:]), "")
        if _is_scene(wanted):
            sys.argv.insert(1, wanted := "render")
        name = wanted if wanted in COMMANDS and wanted not in SHORT else "application"
        forget_impossible_sizes()
        module = importlib.import_module(f"distal.cli.{name}")

        sys.unraisablehook = _unraisable
        warnings.showwarning = _show_warning
        receive_notices(_show_notice)
        run_to_its_end(module.application)
    except KeyboardInterrupt:
        sys.exit(ExitCode.INTERRUPTED)
    except Exception as error:
        from distal.packages import explained

        found = explained(error)  # typer, rich or one of their dependencies
        if found is None:
            raise
        print(f"error: {found}", file=sys.stderr)
        sys.exit(ExitCode.FAILED)
