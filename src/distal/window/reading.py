"""What a person is to read over the picture, as plain values: equal readings look the same.

Input: a ``Session``, and words about frames and mistakes. Output: a ``Reading``.
Knows nothing of how it is drawn.
"""

from __future__ import annotations

from dataclasses import dataclass

from distal.window.session import Session


@dataclass(frozen=True, slots=True)
class Row:
    """A parameter's row.

    Attributes:
        label: Whose.
        words: Its value.
        share: Where its bar stands, or None.
        is_moved: Whether it is not at its default.
    """

    label: str
    words: str
    share: float | None
    is_moved: bool


@dataclass(frozen=True, slots=True)
class Reading:
    """All that is to be read over a picture.

    Attributes:
        status: One line about what is seen, and how fast it is.
        rows: The parameters; None while they are not asked for.
        chosen: Which row keys move.
        time: Seconds, and the ends of the strip; None where nothing depends on them.
        is_paused: Whether the time stands.
        help: Whether the keys are explained.
        trouble: A mistake's text, or "".
        note: A short message, or "".
    """

    status: str = ""
    rows: tuple[Row, ...] | None = None
    chosen: int = 0
    time: tuple[float, float, float] | None = None
    is_paused: bool = False
    help: bool = False
    trouble: str = ""
    note: str = ""


def reading(
    session: Session, now: float, *, status: str = "", trouble: str = "", note: str = ""
) -> Reading:
    """What is to be read now; a mistake is told even where nothing else is."""
    if not session.shows_overlay:
        return Reading(trouble=trouble, note=note)
    rows = None
    if session.shows_parameters:
        rows = tuple(
            Row(
                dial.label,
                dial.words(session.value(dial)),
                dial.share(session.value(dial)),
                dial.parameter.name in session.values,
            )
            for dial in session.dials
        )
    # Hundredths: what is written, and finer than a pixel of the strip.
    seconds = round(session.clock.time(now), 2)
    return Reading(
        status=status,
        rows=rows,
        chosen=session.chosen,
        time=(seconds, *session.time_range) if session.animated else None,
        is_paused=not session.playing,
        help=session.shows_help,
        trouble=trouble,
        note=note,
    )
