"""The ``distal`` command: parses, calls, reports.

What flows in: words of a command line. What flows out: files, text on stdout (data only),
messages on stderr, and an exit code: 0, 1 for a mistake in a scene or a file, 2 for a wrong
command line, 130 after ctrl-C. Knows no algorithm.
"""

from __future__ import annotations

import sys
import warnings


def _show_warning(message: Warning | str, *_: object, **__: object) -> None:
    """A warning in one line: where in our code it arose is of no use to who gave the command."""
    print(f"warning: {message}", file=sys.stderr)


def main() -> None:
    """Run the command line of this process."""
    try:
        # Inside the try, and nothing heavy before it, so that ctrl-C is never a traceback.
        from distal.cli.application import application

        warnings.showwarning = _show_warning
        application()
    except KeyboardInterrupt:
        sys.exit(130)
