"""Print messages for the user on stderr; stdout is only for data.

Input: messages, which may quote names and texts from other sources. Output: lines without control
characters. Imports nothing heavy.
"""

from __future__ import annotations

import os
import sys

from distal.diagnostics import printable_lines, readable


def say(message: object) -> None:
    """Print a message for the user, unless stderr cannot be written."""
    try:
        print(printable_lines(readable(message)), file=sys.stderr, flush=True)
    except OSError:  # a full disk, or what reads it has ended: the exit code still tells
        sys.stderr = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115 (for good)
