"""Show progress bars and timings on stderr.

Input: progress and statistics. Output: a bar, and one line of text. Does not depend on scenes.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Mapping
from types import TracebackType
from typing import Any, Final, Self

from rich.console import Console
from rich.progress import (
    BarColumn,
    Progress,
    ProgressColumn,
    TaskID,
    TextColumn,
    TimeRemainingColumn,
)

from distal.cli.messages import say
from distal.cli.progress_lines import JSON, FrameLines, PictureLines

PATIENCE_S: Final = 1.0  # shorter work shows no bar


class _Bar:
    """A progress bar on stderr, shown only on a terminal and only for long work."""

    def __init__(self, *columns: ProgressColumn) -> None:
        self._begin = time.monotonic()
        self._columns = columns
        self._progress: Progress | None = None
        self._wanted = sys.stderr.isatty()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self._stop()

    def stage(self, name: str) -> None:
        """Begin a stage of the work; a bar shows only the one that takes long."""

    def _shown(self) -> Progress | None:
        """Return the bar, started if necessary; None if it must not be shown (yet)."""
        if not self._wanted or time.monotonic() - self._begin < PATIENCE_S:
            return None
        if self._progress is None:
            self._progress = Progress(*self._columns, console=Console(stderr=True), transient=True)
            self._progress.start()
        return self._progress

    def _stop(self) -> None:
        if self._progress is not None:
            self._progress.stop()
            self._progress = None


class ProgressBar(_Bar):
    """The progress bar of a picture or a mesh.

    Call it with the finished fraction.

    Args:
        what: The kind of work.
    """

    def __init__(self, what: str = "rendering") -> None:
        self._what = what
        super().__init__(
            TextColumn(what),
            BarColumn(),
            TextColumn("{task.fields[figures]}"),
            TimeRemainingColumn(),
        )
        self._task: TaskID | None = None
        self._figures = ""

    def describe(self, figures: str) -> None:
        """Show a short text beside the bar."""
        self._figures = figures

    def __call__(self, done: float) -> None:
        """Show the finished fraction of the work."""
        bar = self._shown()
        if bar is None:
            return
        if self._task is None:
            self._task = bar.add_task(self._what, total=1.0, figures="")
        bar.update(self._task, completed=done, figures=self._figures)


class FrameBar(_Bar):
    """The progress bar of a sequence: frames, frames per second, remaining time.

    Call it with the number of finished frames, the number of all frames, and the kind of work.
    """

    def __init__(self) -> None:
        super().__init__(
            TextColumn("{task.description}"),
            BarColumn(),
            TextColumn("{task.completed:.0f}/{task.total:.0f}"),
            TextColumn("{task.fields[pace]}"),
            TimeRemainingColumn(),
        )
        self._tasks: dict[str, tuple[TaskID, float, int]] = {}

    def __call__(self, done: int, total: int, what: str) -> None:
        """Show the number of finished frames.

        Args:
            done: Number of finished frames.
            total: Number of all frames.
            what: The kind of work: "rendering" or "encoding".
        """
        bar = self._shown()
        if bar is None:
            return
        now = time.monotonic()
        if what not in self._tasks:
            # Frames of an earlier run took no time now, so the rate counts only this run's frames.
            task = bar.add_task(what, total=total, completed=done, pace="")
            self._tasks[what] = (task, now, done)
        task, begin, first = self._tasks[what]
        pace = f"{(done - first) / (now - begin):.1f} fps" if now > begin else ""
        bar.update(task, completed=done, total=total, pace=pace)

    def say(self, line: str) -> None:
        """Print a line above the bar that stays when the bar is updated."""
        self._stop()
        self._tasks = {}
        say(line)


def picture_progress(kind: str) -> ProgressBar | PictureLines:
    """Return the progress of a picture, as a bar or as lines of JSON."""
    return PictureLines() if kind == JSON else ProgressBar()


def frame_progress(kind: str) -> FrameBar | FrameLines:
    """Return the progress of a sequence, as a bar or as lines of JSON."""
    return FrameLines() if kind == JSON else FrameBar()


def stages(figures: Mapping[str, Any]) -> str:
    """Return a text like "load 0.01 s, compile 0.30 s" of all entries that are times."""
    return ", ".join(
        f"{name.removesuffix('_s')} {seconds:.3f} s"
        for name, seconds in figures.items()
        if name.endswith("_s") and isinstance(seconds, float)
    )
