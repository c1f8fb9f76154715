"""Pictures that move, and videos decoded again.

In: nothing, or a video's path. Out: scene files, and what a decoder finds: frames in RGB and times.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

# A soft spot on a ramp, going round once in a second; a parameter and a part that follows no time.
SCENE = """
from distal.lang import Frame, cos, image, length, sin, slider, smoothstep, vec2, vec3

glow = slider("glow", 0.5, 0.0, 1.0)


@image
def picture(frame: Frame) -> vec3:
    turn = 6.2831853 * frame.time
    spot = vec2(0.5 + 0.25 * cos(turn), 0.5 + 0.25 * sin(turn))
    uv = frame.coord / frame.resolution
    bright = 1.0 - smoothstep(0.1, 0.3, length(uv - spot))
    return vec3(uv.x, glow, 0.2) * (0.2 + 0.8 * bright)
"""

# Red, green, blue, white, black, grey, orange: each fills a column, and nothing moves.
PATCHES = [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1), (0, 0, 0), (0.5, 0.5, 0.5), (1, 0.5, 0)]
_COLUMNS = "".join(
    f"    if i == {i}:\n        color = vec3{color!r}\n" for i, color in enumerate(PATCHES)
)
PATCHES_SCENE = f"""
from distal.lang import Frame, floor, image, vec3


@image
def picture(frame: Frame) -> vec3:
    i = int(floor(frame.coord.x / 16.0))
    color = vec3(0.0)
{_COLUMNS}    return color
"""


def scene_file(folder: Path, text: str = SCENE) -> Path:
    path = folder / "moving.py"
    path.write_text(text, encoding="utf-8")
    return path


@dataclass(frozen=True)
class Decoded:
    """A video as a player sees it."""

    frames: list[NDArray[np.uint8]]
    times: list[Fraction]
    rate: Fraction
    metadata: dict[str, str]
    context: Any

    @property
    def size(self) -> tuple[int, int]:
        return self.frames[0].shape[1], self.frames[0].shape[0]


def decode(path: Path) -> Decoded:
    av = pytest.importorskip("av")
    frames, times = [], []
    with av.open(str(path)) as file:
        stream = file.streams.video[0]
        context = stream.codec_context
        for frame in file.decode(stream):
            frames.append(rgb(frame))
            times.append(frame.pts * frame.time_base)
        tags = {name.lower(): text for name, text in file.metadata.items()}
        colors = (
            context.color_primaries,
            context.color_trc,
            context.colorspace,
            context.color_range,
        )
        return Decoded(frames, times, stream.average_rate, tags, (colors, context.pix_fmt))


def rgb(frame: Any) -> NDArray[np.uint8]:
    """A frame in RGB by BT.709, written out here: no conversion of FFmpeg's is trusted with it."""
    if frame.format.name == "gbrp":
        return frame.to_ndarray(format="rgb24")
    assert frame.format.name == "yuv420p"
    planes = frame.to_ndarray().astype(np.float64)
    height, width = frame.height, frame.width
    y = (planes[:height] - 16.0) / 219.0
    quarter = height * width // 4
    chroma = planes[height:].reshape(-1)
    u, v = (
        (chroma[i * quarter : (i + 1) * quarter].reshape(height // 2, width // 2) - 128.0) / 224.0
        for i in (0, 1)
    )
    u, v = (np.repeat(np.repeat(c, 2, 0), 2, 1) for c in (u, v))
    red, blue = y + 1.5748 * v, y + 1.8556 * u
    green = (y - 0.2126 * red - 0.0722 * blue) / 0.7152
    return np.rint(np.clip(np.stack([red, green, blue], 2), 0.0, 1.0) * 255.0).astype(np.uint8)


def still(image: Any, size: tuple[int, int], time: float, **options: Any) -> NDArray[np.uint8]:
    """The picture of a time, in 8 bits."""
    # In doubles: ties are told from their neighbors.
    array = image.render(size=size, time=time, **options).array[..., :3].astype(np.float64)
    return np.floor(np.clip(array, 0.0, 1.0) * 255.0 + 0.5).astype(np.uint8)


def psnr(a: NDArray[np.uint8], b: NDArray[np.uint8]) -> float:
    """Decibels."""
    error = np.mean((a.astype(np.float64) - b) ** 2)
    return float(10.0 * np.log10(255.0**2 / max(error, 1e-9)))
