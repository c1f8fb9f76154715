"""What the commands say to a person, on stderr; stdout stays for data.

Input: messages, which may quote names and texts that others wrote. Output: lines
without control characters. Loads nothing heavy.
"""

from __future__ import annotations

import sys

from distal.diagnostics import printable_lines


def say(message: object) -> None:
    """A message to the person."""
    print(printable_lines(message), file=sys.stderr)
