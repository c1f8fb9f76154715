"""Convert pixels for encoders.

Input: display-encoded levels, top row first. Output: 8-bit frames in RGB, or in BT.709's
Y'CbCr with its color tags. Does not depend on files.
"""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.video.formats import Codec, library

# ITU-T H.273: the codes for BT.709's primaries, transfer and matrix; for sRGB's transfer; for RGB.
BT709: Final = 1
SRGB: Final = 13
RGB: Final = 0
LIMITED, FULL = 1, 2  # FFmpeg's names for 16 to 235 and 0 to 255


class Converter:
    """Converts pictures to frames for an encoder; one for each thread, because it caches tables."""

    def __init__(self, codec: Codec) -> None:
        self._codec = codec
        self._av = library()
        reformatter = self._av.video.reformatter
        self._reformatter = reformatter.VideoReformatter()
        ways = reformatter.Interpolation
        # Chroma from all pixels. Exact rounding would take half as long again (0.71 ms instead of
        # 0.46 at 640x480) and change colors by 0.06 of a level; brightness would be the same.
        self._way = ways.BILINEAR | ways.FULL_CHR_H_INP

    def frame_of(self, levels: NDArray[np.uint8]) -> Any:
        """Return the frame of 8-bit red, green, blue and alpha, which is ignored."""
        made = self._av.VideoFrame.from_numpy_buffer(levels, "rgba")
        if self._codec.exact:
            return self._reformatter.reformat(made, format=self._codec.pixels, threads=1)
        return self._reformatter.reformat(
            made,
            format=self._codec.pixels,
            dst_colorspace=BT709,
            src_color_range=FULL,
            dst_color_range=LIMITED,
            dst_color_trc=BT709,
            dst_color_primaries=BT709,
            interpolation=self._way,
            threads=1,
        )


def tag(context: Any, codec: Codec) -> None:
    """Set the color tags of a stream."""
    context.color_primaries = BT709
    context.color_trc = SRGB if codec.exact else BT709
    context.colorspace = RGB if codec.exact else BT709
    context.color_range = FULL if codec.exact else LIMITED
