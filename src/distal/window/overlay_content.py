"""The text over the picture as plain values; equal values look the same.

Input: a ``Session``, and text about frames and errors. Output: an ``OverlayContent``. Does not
depend on how it is drawn.
"""

from __future__ import annotations

from dataclasses import dataclass

from distal.window.dials import Line
from distal.window.ruler_tool import ShownRuler
from distal.window.session import Session


@dataclass(frozen=True, slots=True)
class ParameterRow:
    """The row of a parameter.

    Attributes:
        label: The parameter's label.
        words: Its value as text.
        share: The position of its bar from 0 to 1, or None.
        is_moved: Whether it differs from its default.
        swatch: The color of which it is a component, as display codes, or None.
        is_heading: Whether the row is the name of a group.
    """

    label: str
    words: str
    share: float | None
    is_moved: bool
    swatch: tuple[int, int, int] | None = None
    is_heading: bool = False


@dataclass(frozen=True, slots=True)
class OverlayContent:
    """All text over a picture.

    Attributes:
        status: One line about the view and its speed.
        rows: The parameters; None while they are hidden.
        chosen: The index of the row that keys move.
        time: Seconds, and the ends of the time bar; None if the picture does not depend on time.
        is_paused: Whether the time is paused.
        help: Whether the help is shown.
        trouble: The text of an error, or "".
        note: A short message, or "".
        ruler: The ruler on the scene; None if there is none.
    """

    status: str = ""
    rows: tuple[ParameterRow, ...] | None = None
    chosen: int = 0
    time: tuple[float, float, float] | None = None
    is_paused: bool = False
    help: bool = False
    trouble: str = ""
    note: str = ""
    ruler: ShownRuler | None = None


def _row(session: Session, line: Line) -> ParameterRow:
    if isinstance(line, str):
        return ParameterRow(line, "", None, is_moved=False, is_heading=True)
    value = session.value(line)
    return ParameterRow(
        line.label,
        line.words(value),
        line.share(value),
        line.parameter.name in session.values,
        line.swatch(value),
    )


def overlay_content(
    session: Session, now: float, *, status: str = "", trouble: str = "", note: str = ""
) -> OverlayContent:
    """Return the text to show now; an error is shown even if the overlay is hidden.

    Args:
        session: The state of the interaction.
        now: The reading of a monotonic clock, in seconds.
        status: One line about the view and its speed.
        trouble: The text of an error, or "".
        note: A short message, or "".
    """
    if not session.shows_overlay:
        return OverlayContent(trouble=trouble, note=note)
    rows = None
    if session.shows_parameters:
        rows = tuple(_row(session, line) for line in session.lines)
    # Hundredths: the precision of the text, and finer than a pixel of the time bar.
    seconds = round(session.clock.time(now), 2)
    return OverlayContent(
        status=status,
        rows=rows,
        chosen=session.chosen_line,
        time=(seconds, *session.time_range) if session.animated else None,
        is_paused=not session.playing,
        help=session.shows_help,
        trouble=trouble,
        note=note or session.ruler.hint,
        ruler=session.ruler.shown(session.sight(now)),
    )
