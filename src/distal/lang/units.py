"""Lengths in millimetres: write ``8 * inch`` and ``2 * cm`` in a scene whose unit is 1 mm.

Input: nothing. Output: numbers. A scene has no unit of its own; parts for printing use millimetres,
as the sizes of ``Bolt``, ``Nut`` and ``MetricThread`` do.
"""

from __future__ import annotations

from typing import Final

mm: Final = 1.0
cm: Final = 10.0
metre: Final = 1000.0
inch: Final = 25.4
foot: Final = 304.8
