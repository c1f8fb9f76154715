"""Logs what a window showed, one line of JSON for each event.

Input: events. Output: the file that ``DISTAL_VIEW_LOG`` names; nothing without that. It is for
tests and for error reports.
"""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any, Final

VARIABLE: Final = "DISTAL_VIEW_LOG"


class Log:
    """Writes events to the file that the environment names, or nowhere."""

    def __init__(self) -> None:
        name = os.environ.get(VARIABLE)
        self._path = Path(name) if name else None

    def __call__(self, event: str, **facts: Any) -> None:
        """Add a line: ``{"event": event, …}``."""
        if self._path is None:
            return
        try:
            with self._path.open("a", encoding="utf-8") as file:
                file.write(json.dumps({"event": event, **facts}) + "\n")
        except OSError:  # a log that cannot be written is no reason to close a window
            self._path = None
