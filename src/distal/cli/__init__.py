"""The ``distal`` command: parses, calls, reports.

Input: words of a command line. Output: files, text on stdout (data only),
messages on stderr, and an exit code: 0, 1 for a mistake in a scene or a file, 2 for a wrong
command line, 130 after ctrl-C. Knows no algorithm.
"""

from __future__ import annotations

import io
import os
import sys
import warnings


def _show_warning(message: Warning | str, *_: object, **__: object) -> None:
    """A warning in one line: where in our code it arose is of no use to who gave the command."""
    from distal.cli.messages import say

    say(f"warning: {message}")


def _open_what_is_closed() -> None:
    """Stand-ins for standard streams that were closed: a scene's file must not become one."""
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest number that is free: this one
    if sys.stdout is None:
        sys.stdout = open(1, "w", closefd=False)  # noqa: SIM115 (for good)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # a file's name may be no text
    if sys.stderr is None:
        sys.stderr = open(2, "w", closefd=False)  # noqa: SIM115 (for good)


def main() -> None:
    """Run the command line of this process."""
    try:
        _open_what_is_closed()
        # Inside the try, and nothing heavy before it, so that ctrl-C is never a traceback.
        from distal.cli.application import application

        warnings.showwarning = _show_warning
        application()
    except KeyboardInterrupt:
        sys.exit(130)
    except Exception as error:
        from distal.packages import explained

        found = explained(error)  # typer, rich or what they need
        if found is None:
            raise
        print(f"error: {found}", file=sys.stderr)
        sys.exit(1)
