"""What a person sees on stderr while a command works and when it ends.

What flows in: progress and figures. What flows out: a bar, and one line. Knows no scene.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Mapping
from types import TracebackType
from typing import Any, Final

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskID, TextColumn, TimeRemainingColumn

PATIENCE_S: Final = 1.0  # a bar that flashes by is noise


class ProgressBar:
    """A bar on stderr, drawn only on a terminal and only when the work takes long.

    Called with the share that is done, or with a number done and a total.
    """

    def __init__(self) -> None:
        self._begin = time.monotonic()
        self._progress: Progress | None = None
        self._task: TaskID | None = None
        self._wanted = sys.stderr.isatty()

    def __enter__(self) -> ProgressBar:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        if self._progress is not None:
            self._progress.stop()

    def __call__(self, done: float, total: float = 1.0) -> None:
        """Show how far the work is."""
        if not self._wanted or time.monotonic() - self._begin < PATIENCE_S:
            return
        if self._progress is None:
            columns = (TextColumn("rendering"), BarColumn(), TimeRemainingColumn())
            self._progress = Progress(*columns, console=Console(stderr=True), transient=True)
            self._task = self._progress.add_task("rendering", total=total)
            self._progress.start()
        assert self._task is not None
        self._progress.update(self._task, completed=done, total=total)


def say(line: str) -> None:
    """One line to the person; stdout stays for data."""
    print(line, file=sys.stderr)


def stages(figures: Mapping[str, Any]) -> str:
    """Words like "load 0.01 s, compile 0.30 s", for the figures that are seconds."""
    return ", ".join(
        f"{name.removesuffix('_s')} {seconds:.3f} s"
        for name, seconds in figures.items()
        if name.endswith("_s") and isinstance(seconds, float)
    )
