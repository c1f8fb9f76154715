"""Hosts of pictures that keep frames, written from Shadertoy's rules alone.

Input: the images of a piece in the order in which a frame draws them, and a function that draws one
with textures. Output: the picture of a frame. Nothing here is shared with the package.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from distal.lang.live_textures import Keyboard, Keys, SoundFile
from distal.sounds.analysis import texels_at

Texels: TypeAlias = NDArray[np.float32]
# Draws an image: its textures by source, and the values of the frame. The top row comes first.
Draw: TypeAlias = Callable[[Any, Callable[[Any], Texels], Mapping[str, Any]], Texels]

SIZE = (24, 18)
STEP = 1.0 / 60.0
COUNT = 7


def frame_values(index: int, size: tuple[int, int] = SIZE) -> dict[str, Any]:
    """The frame's values, with a pen that is drawn and the left button held."""
    return {
        "resolution": (float(size[0]), float(size[1])),
        "time": index * STEP,
        "index": index,
        "delta": STEP,
        "mouse": MOUSE,
        "buttons": 1,
    }


MOUSE = (7.0, 9.0, 7.0, 9.0)
KEYS = Keys.of({39, 32})


def keyboard(keys: Keys) -> Texels:
    """Shadertoy's texture: rows of what is down, what went down, what is toggled."""
    texels = np.zeros((3, 256, 4), np.float32)
    for row, codes in enumerate((keys.held, keys.pressed, keys.toggled)):
        for code in codes:
            texels[row, code, 0] = 1.0
    return texels


def shown(images: Sequence[Any], picture: Any, draw: Draw, count: int = COUNT) -> Texels:
    """The last one of so many frames."""
    width, height = SIZE
    known = {image: np.zeros((height, width, 4), np.float32) for image in (*images, picture)}
    pixels = known[picture]
    for index in range(count):
        last = dict(known)

        def texels(source: Any, last: dict[Any, Texels] = last, index: int = index) -> Texels:
            if isinstance(source, SoundFile):  # its bytes are checked by ``test_sounds``
                return texels_at(source, index * STEP)
            return keyboard(KEYS) if isinstance(source, Keyboard) else known[source.image]

        for image in images:
            known[image] = draw(image, texels, frame_values(index))[::-1]
        pixels = draw(picture, texels, frame_values(index))
        known[picture] = pixels[::-1]
    return pixels
