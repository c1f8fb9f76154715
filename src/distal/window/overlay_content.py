"""The text over the picture as plain values: equal ones look the same.

Input: a ``Session``, and text about frames and mistakes. Output: an ``OverlayContent``.
Knows nothing of how it is drawn.
"""

from __future__ import annotations

from dataclasses import dataclass

from distal.window.session import Session


@dataclass(frozen=True, slots=True)
class ParameterRow:
    """The line of a parameter.

    Attributes:
        label: The parameter's label.
        words: Its value.
        share: The position of its bar from 0 to 1, or None.
        is_moved: Whether it is not at its default.
    """

    label: str
    words: str
    share: float | None
    is_moved: bool


@dataclass(frozen=True, slots=True)
class OverlayContent:
    """All text over a picture.

    Attributes:
        status: One line about what is seen, and how fast it is.
        rows: The parameters; None while they are hidden.
        chosen: Which row keys move.
        time: Seconds, and the ends of the strip; None where nothing depends on them.
        is_paused: Whether the time is paused.
        help: Whether the keys are explained.
        trouble: A mistake's text, or "".
        note: A short message, or "".
    """

    status: str = ""
    rows: tuple[ParameterRow, ...] | None = None
    chosen: int = 0
    time: tuple[float, float, float] | None = None
    is_paused: bool = False
    help: bool = False
    trouble: str = ""
    note: str = ""


def overlay_content(
    session: Session, now: float, *, status: str = "", trouble: str = "", note: str = ""
) -> OverlayContent:
    """The text to show now; a mistake is shown even where the overlay is hidden.

    Args:
        session: What the person has done.
        now: The reading of a steady clock, in seconds.
        status: One line about what is seen, and how fast it is.
        trouble: A mistake's text, or "".
        note: A short message, or "".
    """
    if not session.shows_overlay:
        return OverlayContent(trouble=trouble, note=note)
    rows = None
    if session.shows_parameters:
        rows = tuple(
            ParameterRow(
                dial.label,
                dial.words(session.value(dial)),
                dial.share(session.value(dial)),
                dial.parameter.name in session.values,
            )
            for dial in session.dials
        )
    # Hundredths: what is written, and finer than a pixel of the strip.
    seconds = round(session.clock.time(now), 2)
    return OverlayContent(
        status=status,
        rows=rows,
        chosen=session.chosen,
        time=(seconds, *session.time_range) if session.animated else None,
        is_paused=not session.playing,
        help=session.shows_help,
        trouble=trouble,
        note=note,
    )
