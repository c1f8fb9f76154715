"""Numbers that a program of a scene computes for a host, as the bits of a row of pixels.

Input: an image whose pixels hold the bits of one number each (``render.guide.bytes_of``). Output:
the numbers by name. Pages read the same programs by WebGL.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping, Sequence
from typing import Any, Final

from distal.lang.composed import Composed
from distal.lang.render_options import RenderOptions
from distal.lang.runtime_access import executor

_BYTE: Final = 255.0


class NumberRow:
    """The row of numbers of one program.

    Attributes:
        image: The program.
        names: The names of its numbers, in the order of the pixels.
        is_ready: Whether it is compiled.
    """

    def __init__(self, image: Composed, names: Sequence[str]) -> None:
        self.image, self.names = image, tuple(names)
        self.is_ready = False

    def read(
        self, settings: Mapping[str, Any], *, time: float, params: Mapping[str, Any]
    ) -> dict[str, float]:
        """Return the numbers by name.

        Args:
            settings: The values of the program's uniforms by name.
            time: Time in seconds.
            params: Values of parameters by name; the others have their defaults.
        """
        options = RenderOptions(
            size=(len(self.names), 1), time=time, params=params, threads=1, settings=settings
        )
        pixels = executor().render(self.image, options).array[0]
        self.is_ready = True
        bits = bytes(round(float(value) * _BYTE) for value in pixels.reshape(-1))
        return dict(zip(self.names, struct.unpack(f"<{len(self.names)}f", bits), strict=True))
