"""Table of metric screws: pitches, and sizes of hexagon bolts and nuts, in millimetres.

Input: the name of a size. Output: its row. Does not depend on shapes.

Source: ISO 261 (coarse pitches), ISO 4014 (heads of bolts), ISO 4032 (nuts, largest height), ISO
273 (holes for bolts, medium).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from distal.diagnostics import Span
from distal.frontend.problems import did_you_mean
from distal.scene.tree.errors import refuse


@dataclass(frozen=True, slots=True)
class MetricSize:
    """One size, in millimetres.

    Attributes:
        diameter: Nominal diameter of the thread.
        pitch: Coarse pitch.
        across: Width of the hexagon across its flats.
        head: Height of the head of a bolt.
        nut: Height of a nut.
        hole: Diameter of a hole that the bolt passes through.
    """

    diameter: float
    pitch: float
    across: float
    head: float
    nut: float
    hole: float


METRIC: Final = {
    "M2": MetricSize(2.0, 0.4, 4.0, 1.4, 1.6, 2.4),
    "M2.5": MetricSize(2.5, 0.45, 5.0, 1.7, 2.0, 2.9),
    "M3": MetricSize(3.0, 0.5, 5.5, 2.0, 2.4, 3.4),
    "M4": MetricSize(4.0, 0.7, 7.0, 2.8, 3.2, 4.5),
    "M5": MetricSize(5.0, 0.8, 8.0, 3.5, 4.7, 5.5),
    "M6": MetricSize(6.0, 1.0, 10.0, 4.0, 5.2, 6.6),
    "M8": MetricSize(8.0, 1.25, 13.0, 5.3, 6.8, 9.0),
    "M10": MetricSize(10.0, 1.5, 16.0, 6.4, 8.4, 11.0),
    "M12": MetricSize(12.0, 1.75, 18.0, 7.5, 10.8, 13.5),
    "M14": MetricSize(14.0, 2.0, 21.0, 8.8, 12.8, 15.5),
    "M16": MetricSize(16.0, 2.0, 24.0, 10.0, 14.8, 17.5),
    "M18": MetricSize(18.0, 2.5, 27.0, 11.5, 15.8, 20.0),
    "M20": MetricSize(20.0, 2.5, 30.0, 12.5, 18.0, 22.0),
}


def metric_size(name: object, what: str, place: Span | None) -> MetricSize:
    """Return the row of a size.

    Args:
        name: The author's word: "M6".
        what: The object that is made, in messages.
        place: The author's line.

    Raises:
        SceneValueError: There is no such size.
    """
    if isinstance(name, str) and name.upper() in METRIC:
        return METRIC[name.upper()]
    near = did_you_mean(name, METRIC) if isinstance(name, str) else None
    message = f"{what} takes a size from M2 to M20, not {name!r:.40}"
    hint = near or f"{', '.join(METRIC)}; Thread(diameter, pitch, length) has any other"
    refuse(message, hint, place)
