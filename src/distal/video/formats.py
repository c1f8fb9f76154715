"""The video formats, and the codec settings of each.

Input: an output path, a quality, a size, a frame rate. Output: a ``Codec``, the settings for an
encoder, or an error of one line if the format cannot store them. Does not depend on scenes; PyAV is
imported when first needed.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any, Final

from distal.devices.features import host_features
from distal.file_writer import SaveError
from distal.packages import PackageError, imported

# Names for qualities; a quality is a number from 0 to 100.
QUALITIES: Final[Mapping[str, float]] = {"low": 60.0, "medium": 70.0, "high": 80.0}
LOSSLESS: Final = "lossless"
QUALITY: Final = "high"  # without another one
PACKAGE: Final = "av"
# GIF counts in hundredths of a second, and viewers show a delay of 1/100 s as 1/10 s.
GIF_FASTEST: Final = 50
_NUMBERED: Final = re.compile(r"%(0\d+|)d")


class VideoError(ValueError):
    """An option of a video is invalid or not supported by the format; the message is one line."""


@dataclass(frozen=True, slots=True)
class VideoFormat:
    """A video format.

    Attributes:
        name: Its suffix without the dot; "frames" for numbered pictures.
        encoded: Whether frames are encoded while rendering, in segments; otherwise they are first
            written as PNG files.
        loops: Whether the file stores how often it is played.
        lossy: Whether it has a quality option.
        largest: Maximum of width and height in pixels.
    """

    name: str
    encoded: bool = False
    loops: bool = False
    lossy: bool = False
    largest: int = 16384


FORMATS: Final[Mapping[str, VideoFormat]] = {
    ".mp4": VideoFormat("mp4", encoded=True, lossy=True),
    ".webm": VideoFormat("webm", encoded=True, lossy=True),
    ".gif": VideoFormat("gif", loops=True),
    ".apng": VideoFormat("apng", loops=True),
    ".webp": VideoFormat("webp", loops=True, lossy=True, largest=16383),
}
FRAMES: Final = VideoFormat("frames")


@dataclass(frozen=True, slots=True)
class Codec:
    """The settings for encoding pictures into a video stream.

    Attributes:
        encoder: FFmpeg's name of the encoder.
        pixels: The pixel format of the stream.
        options: Options of the encoder.
        exact: Whether the pixels are stored unchanged, in RGB.
    """

    encoder: str
    pixels: str
    options: Mapping[str, str]
    exact: bool = False


def format_of(path: Path) -> VideoFormat:
    """Return the format for a path.

    Raises:
        SaveError: The suffix is unknown, or the name of a sequence has no place for the number.
    """
    suffix = path.suffix.lower()
    if suffix == ".png":
        _check_pattern(path)
        return FRAMES
    if suffix not in FORMATS:
        known = ", ".join([*FORMATS, "or pictures named like frames/%05d.png"])
        named = f"the suffix '{path.suffix}'" if suffix else "no suffix"
        raise SaveError(f"cannot write {path}: it has {named}; videos end in {known}")
    return FORMATS[suffix]


def _check_pattern(path: Path) -> None:
    fields = _NUMBERED.findall(path.name)
    if len(fields) == 1 and path.name.count("%") == 1:
        return
    if "%" in path.name:
        raise SaveError(f"cannot write {path}: a name has one number, like %05d.png")
    better = path.with_name(f"{path.stem}-%05d.png")
    raise SaveError(f"cannot write {path}: every frame needs its number in the name: {better}")


def numbered(pattern: Path, index: int) -> Path:
    """Return the file of a frame."""
    name = _NUMBERED.sub(lambda field: f"{index:{field[1]}d}", pattern.name)
    return pattern.with_name(name)


def read_quality(quality: str | float, format: VideoFormat) -> float | str:
    """Return a quality as a number from 0 to 100, or "lossless".

    Raises:
        VideoError: There is no such quality, or the format does not support it.
    """
    if isinstance(quality, str) and quality == LOSSLESS:
        if format.name == "gif":
            raise VideoError("a gif has 256 colors: it is never lossless; choose webp or apng")
        return LOSSLESS
    if isinstance(quality, str) and quality in QUALITIES:
        value = QUALITIES[quality]
    else:
        try:
            value = float(quality)
        except (TypeError, ValueError):
            value = -1.0
        if not 0.0 <= value <= 100.0:
            names = ", ".join([*QUALITIES, LOSSLESS])
            raise VideoError(f"a quality is {names} or a number from 0 to 100, not {quality!r:.40}")
    return value


def check_size(size: tuple[int, int], format: VideoFormat, quality: float | str) -> None:
    """Check that the format supports a size.

    Args:
        size: Width and height in pixels.
        format: The format.
        quality: A number from 0 to 100, or "lossless".

    Raises:
        VideoError: It does not; the message has the nearest size that it supports.
    """
    width, height = size
    if max(size) > format.largest:
        raise VideoError(
            f"{format.name} has at most {format.largest} pixels a side, not {max(size)}"
        )
    if format.encoded and quality != LOSSLESS and (width % 2 or height % 2):
        # Common players support only 4:2:0, in which two pixels share a color.
        even = f"{width + width % 2}x{height + height % 2}"
        raise VideoError(
            f"{format.name} has even sides, {width}x{height} has not; the nearest is {even}, "
            "or the quality lossless"
        )


def check_rate(rate: Fraction, format: VideoFormat) -> None:
    """Check that the format supports a frame rate.

    Raises:
        VideoError: It is too high for the clock of the format.
    """
    if format.name == "gif" and rate > GIF_FASTEST:
        raise VideoError(
            f"a gif counts in hundredths of a second and has at most {GIF_FASTEST} frames in one, "
            f"not {float(rate):g}; webp and apng have more"
        )
    if format.name == "webp" and rate > 1000:
        raise VideoError("a webp counts in milliseconds and has at most 1000 frames in a second")
    largest = 65535 if format.name == "apng" else 10**6  # APNG holds a delay as two 16-bit numbers
    if max(rate.numerator, rate.denominator) > largest:
        raise VideoError(f"{format.name} cannot count {rate} frames a second exactly; round it")


def codec_of(format: VideoFormat, quality: float | str) -> Codec:
    """Return the codec settings for mp4 and webm."""
    if format.name == "mp4":
        if quality == LOSSLESS:
            options = {"preset": "veryfast", "qp": "0", "x264-params": _x264("")}
            return Codec("libx264rgb", "rgb24", options, exact=True)
        options = {"preset": "veryfast", "crf": _crf(quality, 58.0, 51.0)}
        return Codec("libx264", "yuv420p", {**options, "x264-params": _x264(_H264)})
    if quality == LOSSLESS:
        return Codec("libvpx-vp9", "gbrp", {"lossless": "1", **_VP9}, exact=True)
    return Codec("libvpx-vp9", "yuv420p", {"crf": _crf(quality, 64.0, 63.0), "b": "0", **_VP9})


# Rendering needs the processors too, so encoding must be cheap. Measured at 640x480 and crf 18 on
# one thread, the raymarcher and the sea, ms of processor time, kB and dB per frame:
# veryfast 3.4, 2.0, 48.1 and 4.0, 8.3, 40.3; superfast 2.0, 4.8, 51.7 and 2.5, 12.8, 42.2;
# this 1.2, 2.0, 46.8 and 1.6, 7.8, 39.8 (with partitions and a lookahead of 10: 1.6, 1.9, 47.6 and
# 1.9, 8.3, 40.2). Scenes move smoothly, so files are made small by the lookahead (mbtree), not by a
# thorough motion search.
_H264: Final = (
    "subme=0:me=dia:weightp=0:bframes=1:b-adapt=0:rc-lookahead=5:scenecut=0:partitions=none"
)
# realtime at 5: 4.5 ms, 254 kB, 49.6 dB; good at 5: 22 ms, 205 kB, 49.9 dB.
_VP9: Final = {"deadline": "realtime", "cpu-used": "5", "row-mt": "1"}


def _x264(params: str) -> str:
    """Return x264's own parameters for this processor."""
    said = ["open-gop=0"] + ([params] if params else [])
    if host_features() >= {"avx512f", "avx2"}:
        # x264's AVX-512 code gave other bytes for the same frames in 1 to 15 of 100 runs (x264 165,
        # 96x64), its AVX2 code never, and 8 % faster. A continued run must give the same bytes.
        said.append("asm=avx2")
    return ":".join(said)


def _crf(quality: float | str, worst: float, largest: float) -> str:
    """Return the constant rate factor: 1 per two steps of quality; quality 80 is 18 in H.264."""
    assert not isinstance(quality, str)
    return f"{min(largest, worst - quality / 2.0):g}"


def library() -> Any:
    """Import PyAV.

    Raises:
        SaveError: It is missing or broken.
    """
    try:
        return imported(PACKAGE)
    except PackageError as error:
        raise SaveError(f"videos need PyAV: {error}") from error
