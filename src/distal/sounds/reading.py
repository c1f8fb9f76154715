"""Read the samples of a sound file: WAV without another package, other formats by PyAV.

Input: a path. Output: ``Samples``. Does not depend on pictures.
"""

from __future__ import annotations

import io
import wave
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.diagnostics import LoadError
from distal.foreign_files import check_time, need, opened
from distal.packages import PackageError, imported

# A page holds 61 kB for each second; the samples of ten minutes take 200 MB here.
MOST_SECONDS: Final = 600
_RATES: Final = range(1000, 384_001)
_WAVE_ENDS: Final = (".wav", ".wave")
# Bytes of a sample while they are joined and resampled.
_SAMPLE_BYTES: Final = 12
# Lists of other files are no sounds: FFmpeg would open what they name.
_OPTIONS: Final = {
    "protocol_whitelist": "",
    "format_whitelist": "aac,ac3,aiff,amr,ape,asf,au,avi,caf,eac3,flac,flv,matroska,webm,mov,mp4,"
    "m4a,3gp,3g2,mj2,mp3,mpeg,mpegts,ogg,tta,voc,w64,wav,wv",
}
_FULL: Final = {1: 128.0, 2: 32768.0, 3: 8388608.0, 4: 2147483648.0}


@dataclass(frozen=True, slots=True)
class Samples:
    """A sound.

    Attributes:
        rate: Samples per second.
        channels: The samples of each channel, of shape (channels, samples), from -1 to 1.
    """

    rate: int
    channels: NDArray[np.float32]

    @property
    def seconds(self) -> float:
        """How long it is."""
        return float(self.channels.shape[1] / self.rate)


def read(path: str | PathLike[str]) -> Samples:
    """Read a sound file.

    Raises:
        LoadError: The file is missing, is no sound, is too long, or its format needs PyAV, which is
            missing.
    """
    place = Path(path)
    with opened("sound", place, name=place.name) as data:
        found = _found(data, is_wave=place.suffix.lower() in _WAVE_ENDS)
        if found.channels.shape[1] == 0:
            raise LoadError("it has no samples")
    return found


def _found(data: bytes, *, is_wave: bool) -> Samples:
    if not is_wave:
        return _by_pyav(data)
    try:
        return _by_wave(data)
    except wave.Error as error:
        if "unknown format" not in str(error):
            raise
        return _by_pyav(data)  # samples that are floats, for example
    except EOFError:
        raise LoadError("it ends early") from None


def _check(rate: int, count: int) -> None:
    if rate not in _RATES:
        raise ValueError(f"it has {rate} samples per second; {_RATES[0]} to {_RATES[-1]} can be")
    if count > MOST_SECONDS * rate:
        raise ValueError(f"it is {count / rate:.0f} s long; {MOST_SECONDS} s at most")


def _by_wave(data: bytes) -> Samples:
    with wave.open(io.BytesIO(data), "rb") as file:
        width, channels, count = file.getsampwidth(), file.getnchannels(), file.getnframes()
        rate = file.getframerate()
        _check(rate, count)
        if width not in _FULL:
            raise ValueError(f"it has {8 * width} bits a sample; 8, 16, 24 and 32 can be")
        frames = file.readframes(count)
    whole = len(frames) // (width * channels) * (width * channels)
    values = _numbers(frames[:whole], width) / np.float32(_FULL[width])
    return Samples(rate, np.ascontiguousarray(values.reshape(-1, channels).T))


def _numbers(data: bytes, width: int) -> NDArray[np.float32]:
    """Return PCM samples: bytes are offset by 128, wider numbers are signed and little-endian."""
    if width == 1:
        return np.frombuffer(data, np.uint8).astype(np.float32) - 128.0
    if width == 3:
        parts = np.frombuffer(data, np.uint8).reshape(-1, 3).astype(np.int32)
        value = parts[:, 0] | parts[:, 1] << 8 | parts[:, 2] << 16
        return (value - ((value & 0x800000) << 1)).astype(np.float32)
    return np.frombuffer(data, f"<i{width}").astype(np.float32)


def _by_pyav(data: bytes) -> Samples:
    try:
        av: Any = imported("av")
    except PackageError as error:
        raise LoadError(f"a sound other than .wav with whole numbers needs PyAV: {error}") from None
    try:
        with av.open(io.BytesIO(data), options=_OPTIONS) as container:
            if not container.streams.audio:
                raise ValueError("it has no sound")
            stream = container.streams.audio[0]
            layout = "mono" if stream.codec_context.channels == 1 else "stereo"
            rate = int(stream.codec_context.sample_rate)
            to_floats = av.AudioResampler(format="fltp", layout=layout, rate=rate)
            parts, count = [], 0
            for frame in container.decode(stream):
                made = [each.to_ndarray() for each in to_floats.resample(frame)]
                count += sum(part.shape[1] for part in made)
                _check(rate, count)
                need(count * len(made[0]) * _SAMPLE_BYTES if made else 0, f"{count:,} samples")
                check_time()
                parts += made
            parts += [each.to_ndarray() for each in to_floats.resample(None)]
    except av.FFmpegError as error:
        raise LoadError(getattr(error, "strerror", None) or str(error)) from None
    if not parts:
        raise ValueError("it has no samples")
    return Samples(rate, np.concatenate(parts, axis=1).astype(np.float32))
