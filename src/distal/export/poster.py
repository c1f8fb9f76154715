"""Render the picture that a page shows before its first frame, or if it cannot draw.

Input: a viewable object. Output: the bytes of a small file: WebP, or a picture as triangles.
"""

from __future__ import annotations

import io
from typing import Final

import numpy as np
from numpy.typing import NDArray
from PIL import Image as PillowImage

from distal.export.page_options import TRIANGLE_POSTER, PageOptions
from distal.images.png import quantise
from distal.lang.render_options import Refinement, RenderOptions
from distal.scene.viewing.viewable import Viewable
from distal.triangles.encoding import TriangleEncoding, within

WIDTH_PX: Final = 480
MOST_BYTES: Final = 10_000
# Tried in order until the file is small enough: below the last quality, blocks would be visible, so
# a smaller picture follows.
QUALITIES: Final = (82, 74, 66, 58, 50, 42, 34)
PARTS: Final = (1.0, 0.75, 0.5)
# Of triangles: what a bit is worth (decision 79), and how large the file may be.
PRICE: Final = 250.0
MOST_TRIANGLE_BYTES: Final = 6_000
# Of a picture by paths: as many samples as its size shows, within a time.
PATHS: Final = Refinement(samples=32, time_limit=30.0)


def poster(seen: Viewable, options: PageOptions) -> bytes:
    """Return a small picture with the aspect ratio of the page's picture."""
    width = min(WIDTH_PX, options.size[0])
    height = max(1, round(width * options.size[1] / options.size[0]))
    small = RenderOptions(
        size=(width, height),
        time=options.time,
        params=options.params or {},
        device=options.device,
        view=options.view,
        refinement=PATHS if seen.is_traced(options.view) else None,
    )
    picture = seen.render(small)
    levels = quantise(picture.array)[..., :3]
    if options.poster == TRIANGLE_POSTER:
        work = TriangleEncoding(levels)
        file = work.file(PRICE)
        return file if len(file) <= MOST_TRIANGLE_BYTES else within(work, MOST_TRIANGLE_BYTES)
    return _webp(levels)


def _webp(levels: NDArray[np.uint8]) -> bytes:
    """Return the finest WebP file that is small enough."""
    pixels = PillowImage.fromarray(levels)
    height, width, _ = levels.shape
    for part in PARTS:
        shown = pixels
        if part < 1.0:
            shown = pixels.resize((round(width * part), max(1, round(height * part))))
        for quality in QUALITIES:
            file = io.BytesIO()
            shown.save(file, "WEBP", quality=quality, method=6)
            if file.tell() <= MOST_BYTES:
                return file.getvalue()
    return file.getvalue()
