"""The parts of a lesson, as its file states them.

Input: none. Output: plain data with the line of each part. Does not depend on scenes or HTML.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Final, TypeAlias

LAYERS: Final = ("coordinate", "signal", "color")
# Mean difference of display values, from 0 to 1, by which an experiment changes the picture.
LEAST_DIFFERENCE: Final = 0.01
# Mean difference of display values at which an exercise's goal is reached.
GOAL_WITHIN: Final = 0.006


@dataclass(frozen=True, slots=True)
class Head:
    """The settings at the head of a lesson's file.

    Attributes:
        number: The lesson's number in the course.
        title: The lesson's title.
        summary: One sentence that says what the reader will learn.
        scene: A Python file beside the lesson, or ``example:NAME``.
        size: Width and height of the picture in pixels.
        time: The initial time in seconds.
        view: The initial view.
        code: The names in the scene's file whose definitions are shown unfolded.
        source: Where the lesson comes from; empty if it has no source.
    """

    number: int
    title: str
    summary: str
    scene: str
    size: tuple[int, int] = (480, 360)
    time: float = 0.0
    view: str = "color"
    code: tuple[str, ...] = ()
    source: str = ""


@dataclass(frozen=True, slots=True)
class Prose:
    """Text in Markdown."""

    line: int
    text: str


@dataclass(frozen=True, slots=True)
class Try:
    """An experiment: a button that sets values.

    Attributes:
        line: The line of its fence.
        title: The button's text.
        values: Values of parameters as the author wrote them, by name.
        text: What to do and why, in Markdown.
        watch: What to watch for, in Markdown.
        view: The view to show; empty for the current one.
        least: The least mean difference that it makes to the picture, from 0 to 1.
    """

    line: int
    title: str
    values: dict[str, str]
    text: str
    watch: str = ""
    view: str = ""
    least: float = LEAST_DIFFERENCE


@dataclass(frozen=True, slots=True)
class Phrase:
    """What a person says, the values that it moves, and an explanation in Markdown."""

    line: int
    phrase: str
    values: dict[str, str]
    text: str


@dataclass(frozen=True, slots=True)
class Phrases:
    """The table of phrases."""

    line: int
    rows: tuple[Phrase, ...]


@dataclass(frozen=True, slots=True)
class Layers:
    """The strip of stills: a view and a caption for each of ``LAYERS``."""

    line: int
    views: dict[str, str]
    captions: dict[str, str]


@dataclass(frozen=True, slots=True)
class Goal:
    """An exercise: a picture to reach.

    Attributes:
        line: The line of its fence.
        file: The scene that draws the goal.
        values: The stored solution: the values of the lesson's scene that reach the goal.
        text: The task, in Markdown.
        within: The mean difference at which the goal is reached, from 0 to 1.
    """

    line: int
    file: str
    values: dict[str, str]
    text: str
    within: float = GOAL_WITHIN


Part: TypeAlias = Prose | Try | Phrases | Layers | Goal


@dataclass(frozen=True, slots=True)
class Lesson:
    """A lesson.

    Attributes:
        file: The file that it was read from.
        lines: The lines of the file, for messages.
        head: The settings.
        head_lines: The line of each setting that the author wrote, by name.
        parts: The parts in order.
    """

    file: Path
    lines: tuple[str, ...]
    head: Head
    head_lines: dict[str, int]
    parts: tuple[Part, ...]

    def of_kind(self, kind: type[Part]) -> tuple[Part, ...]:
        """Return the parts of a kind, in order."""
        return tuple(part for part in self.parts if isinstance(part, kind))
