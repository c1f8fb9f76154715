"""What an exported file shows: each option with its default, its check and its meaning.

Input: values from a caller. Output: ``TextOptions`` or ``PageOptions``. Knows no file format.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from distal.lang.render_options import checked_size, checked_time


@dataclass(frozen=True, slots=True, kw_only=True)
class TextOptions:
    """The options of every exported file.

    Attributes:
        params: Values of parameters at the start, by name.
        time: Seconds at the start.
        view: What is shown first.
    """

    params: Mapping[str, Any] | None = None
    time: float = 0.0
    view: str = "color"


@dataclass(frozen=True, slots=True, kw_only=True)
class PageOptions(TextOptions):
    """The options of a page, checked when they are made.

    Attributes:
        size: Width and height of the author's picture in pixels.
        duration: Seconds after which the time starts again; None: never.
        title: What a person reads; None for the scene's own name.
        embed: Whether it is the bare canvas: a fragment for other pages.
        panel: Whether there are controls beside it; never where it is embedded.
        poster: Whether a still picture is shown before the first frame.
        views: What can be looked at; None for all.
        device: What renders the poster, as for ``Scene.render``.

    Raises:
        TypeError: A value has the wrong type.
        ValueError: A value is out of range.
    """

    size: tuple[int, int] = (640, 480)
    duration: float | None = None
    title: str | None = None
    embed: bool = False
    panel: bool = True
    poster: bool = True
    views: Sequence[str] | None = None
    device: str = "cpu"

    def __post_init__(self) -> None:
        object.__setattr__(self, "size", checked_size(self.size))
        object.__setattr__(self, "time", checked_time(self.time))
        if self.duration is not None and not checked_time(self.duration) > 0.0:
            raise ValueError(f"a duration is more than 0 seconds, not {self.duration}")
        if self.title is not None and not isinstance(self.title, str):
            raise TypeError(f"a title is a text, not {self.title!r}")
        if isinstance(self.views, str):
            raise TypeError(f"views are names in a list, not {self.views!r}")
