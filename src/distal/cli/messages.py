"""Print messages for the user on stderr; stdout is only for data.

Input: messages, which may quote names and texts from other sources. Output: lines without control
characters. Imports nothing heavy.
"""

from __future__ import annotations

import sys

from distal.diagnostics import printable_lines


def say(message: object) -> None:
    """Print a message for the user."""
    print(printable_lines(message), file=sys.stderr)
