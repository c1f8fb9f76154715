"""The size of the terminal, where a variable of the environment gives one that cannot be.

Input: ``COLUMNS``, ``LINES`` and their like. Output: an environment without those that are no
number above 0: to rich, a width of 0 is a terminal in which no text fits, and typer converts its
own to an int. Imports nothing heavy; called before typer and rich are imported.
"""

from __future__ import annotations

import os
from typing import Final

_SIZES: Final = ("COLUMNS", "LINES", "TERMINAL_WIDTH", "JUPYTER_COLUMNS", "JUPYTER_LINES")


def forget_impossible_sizes() -> None:
    """Remove sizes that are no whole number above 0: the terminal is then asked, or 80 x 25."""
    for name in _SIZES:
        value = os.environ.get(name)
        if value is not None and not (value.isascii() and value.isdigit() and int(value) > 0):
            del os.environ[name]
