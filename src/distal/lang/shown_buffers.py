"""The picture that shows a buffer, where a buffer is rendered like any other image.

A buffer reads its own last frame, so it cannot be drawn once more in the same frame: the picture
copies what it drew. Imported when the first buffer is shown.
"""

from __future__ import annotations

from typing import Any

from distal.lang import Frame, image, ivec2, texel, vec4


def picture_of(buffer: Any) -> Any:
    """Return the ``Image`` that shows what a ``FrameBuffer`` drew in the same frame."""

    @image
    def shown(frame: Frame) -> vec4:
        return texel(buffer, ivec2(frame.coord))

    shown.__name__ = buffer.name
    shown.__doc__ = buffer.__doc__
    return shown
