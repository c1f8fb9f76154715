"""The options of an exported file: their defaults and checks.

Input: values from a caller. Output: ``TextOptions`` or ``PageOptions``. Does not depend on file
formats.
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
        params: Initial values of parameters by name.
        time: Initial time in seconds.
        view: The initial view.
    """

    params: Mapping[str, Any] | None = None
    time: float = 0.0
    view: str = "color"


@dataclass(frozen=True, slots=True, kw_only=True)
class PageOptions(TextOptions):
    """The options of a page, checked on construction.

    Attributes:
        size: Width and height of the author's picture in pixels.
        duration: Seconds after which the time starts again; None for never.
        title: The title of the page; None for the scene's name.
        embed: Whether to write only the canvas, as a fragment for other pages.
        panel: Whether to show controls; an embedded page has none.
        poster: Whether to show a still picture before the first frame.
        views: The views to include; None for all.
        device: The device that renders the poster, as for ``Scene.render``.
        mode: How light is computed: "direct" or "path"; None: as the scene says.
        caustics: In mode "path": whether photons find caustics; None: if there are any.

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
    mode: str | None = None
    caustics: bool | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "size", checked_size(self.size))
        object.__setattr__(self, "time", checked_time(self.time))
        if self.duration is not None and not checked_time(self.duration) > 0.0:
            raise ValueError(f"a duration is more than 0 seconds, not {self.duration}")
        if self.title is not None and not isinstance(self.title, str):
            raise TypeError(f"a title is a text, not {self.title!r}")
        if isinstance(self.views, str):
            raise TypeError(f"views are names in a list, not {self.views!r}")
