"""The options of an exported file: their defaults and checks.

Input: values from a caller. Output: ``TextOptions`` or ``PageOptions``. Does not depend on file
formats.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

from distal.file_writer import SaveError
from distal.lang.render_options import checked_size, checked_time
from distal.lang.units import meters_of

# What a page shows before its first frame.
WEBP: Final = "webp"
TRIANGLE_POSTER: Final = "triangles"
NO_POSTER: Final = "none"
POSTERS: Final = (WEBP, TRIANGLE_POSTER, NO_POSTER)


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
        poster: The still picture before the first frame: "webp" (or True), "triangles" (smaller,
            and sharp at any size; drawn by a script, so that it needs WebGL 2), "none" (or False).
        views: The views to include; None for all.
        device: The device that renders the poster, as for ``Scene.render``.
        mode: How light is computed: "direct" or "path"; None: as the scene says.
        caustics: In mode "path": whether photons find caustics; None: if there are any.
        printable: Whether the page saves the part as 3MF and STL.
        inspect: Whether the page cuts the scene open and measures it.
        unit: Of a printable page or one to inspect: the length of one scene unit, "mm", "cm" ...
        tolerance: Of a printable page: how far the part may be from the surface, in scene units,
            before the page says so; None for 0.002 of the largest side of its box.

    Raises:
        TypeError: A value has the wrong type.
        ValueError: A value is out of range.
    """

    size: tuple[int, int] = (640, 480)
    duration: float | None = None
    title: str | None = None
    embed: bool = False
    panel: bool = True
    poster: bool | str = WEBP
    views: Sequence[str] | None = None
    device: str = "cpu"
    mode: str | None = None
    caustics: bool | None = None
    printable: bool = False
    inspect: bool = False
    unit: str = "mm"
    tolerance: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "size", checked_size(self.size))
        object.__setattr__(self, "time", checked_time(self.time))
        if self.duration is not None and not checked_time(self.duration) > 0.0:
            raise ValueError(f"a duration is more than 0 seconds, not {self.duration}")
        if self.title is not None and not isinstance(self.title, str):
            raise TypeError(f"a title is a text, not {self.title!r}")
        object.__setattr__(self, "poster", _checked_poster(self.poster))
        if isinstance(self.views, str):
            raise TypeError(f"views are names in a list, not {self.views!r}")


def _checked_poster(wanted: bool | str) -> str:
    """Return the name of a kind of poster.

    Raises:
        ValueError: There is no such kind.
    """
    if isinstance(wanted, bool):
        return WEBP if wanted else NO_POSTER
    if wanted not in POSTERS:
        names = ", ".join(f'"{name}"' for name in POSTERS)
        raise ValueError(f"a poster is one of {names}, not {wanted!r:.40}")
    return wanted


def check_buttons(options: PageOptions, page: str) -> None:
    """Check that a page has a known unit, and a panel for its buttons.

    Args:
        options: Its options.
        page: What it is, for messages.

    Raises:
        SaveError: The unit is unknown.
        ValueError: There is no panel.
    """
    meters_of(options.unit, SaveError)
    if options.embed or not options.panel:
        raise ValueError(f"{page} has its buttons in the panel, which this one lacks")
