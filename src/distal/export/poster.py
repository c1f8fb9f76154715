"""The picture that a page shows before its first frame, and where it cannot draw.

Input: something to be seen. Output: a small WebP file's bytes.
"""

from __future__ import annotations

import io
from collections.abc import Mapping
from typing import Any, Final

from PIL import Image as PillowImage

from distal.images.png import quantise
from distal.scene.viewing.viewable import Viewable

WIDTH_PX: Final = 480
MOST_BYTES: Final = 10_000
# Tried in turn until the file is small enough: below the last the blocks are seen.
QUALITIES: Final = (82, 74, 66, 58, 50, 42, 34)


def poster(
    seen: Viewable,
    *,
    size: tuple[int, int],
    time: float = 0.0,
    params: Mapping[str, Any] | None = None,
    view: str = "color",
    device: str = "cpu",
) -> bytes:
    """A small picture in the aspect of ``size``, as WebP."""
    width = min(WIDTH_PX, size[0])
    height = max(1, round(width * size[1] / size[0]))
    picture = seen.render(view=view, size=(width, height), time=time, params=params, device=device)
    pixels = PillowImage.fromarray(quantise(picture.array)[..., :3])
    data = b""
    for quality in QUALITIES:
        file = io.BytesIO()
        pixels.save(file, "WEBP", quality=quality, method=6)
        data = file.getvalue()
        if len(data) <= MOST_BYTES:
            break
    return data
