"""Log what a window shows, one line of JSON for each event.

Input: events. Output: lines in the file named by ``DISTAL_VIEW_LOG``; nothing without that
variable. The log is used by tests and for error reports.
"""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any, Final

VARIABLE: Final = "DISTAL_VIEW_LOG"


class Log:
    """Writes events to the file named by the environment variable, if it is set."""

    def __init__(self) -> None:
        name = os.environ.get(VARIABLE)
        self._path = Path(name) if name else None

    def __call__(self, event: str, **facts: Any) -> None:
        """Append a line: ``{"event": event, …}``."""
        if self._path is None:
            return
        try:
            with self._path.open("a", encoding="utf-8") as file:
                file.write(json.dumps({"event": event, **facts}) + "\n")
        except OSError:  # an error of the log must not close the window
            self._path = None
