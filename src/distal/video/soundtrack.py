"""The sound of a video: what a picture hears from a file, from its first frame to its last.

Input: samples and the times of a video. Output: packets of an audio stream. Does not depend on
pictures.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.sounds.reading import Samples
from distal.video.formats import VideoFormat, library

# Opus has this rate alone; AAC has it too.
_RATE: Final = 48_000
_CODECS: Final = {"mp4": "aac", "webm": "libopus"}
_BITS_PER_S: Final = 192_000
_AT_ONCE: Final = _RATE  # samples that are passed to the encoder together


def cut(samples: Samples, start: Fraction, duration: Fraction, *, loop: bool) -> Samples:
    """Return what is heard in a part of the time; silence where there is none.

    Args:
        samples: The sound, which begins at 0 s.
        start: Seconds.
        duration: Seconds.
        loop: Whether the sound begins again at its end.
    """
    count = samples.channels.shape[1]
    first, wanted = round(start * samples.rate), round(duration * samples.rate)
    places = np.arange(first, first + wanted)
    heard = samples.channels[:, places % count]
    if not loop:
        heard = np.where((places >= 0) & (places < count), heard, np.float32(0.0))
    return Samples(samples.rate, heard)


def mixed(sounds: Sequence[Samples]) -> Samples:
    """Return what is heard of sounds at once, as a page plays them: their sum, cut off at full.

    Args:
        sounds: One or more; those of other rates are converted.
    """
    if len(sounds) == 1:
        return sounds[0]
    parts = [_at_rate(each) for each in sounds]
    count = max(part.shape[1] for part in parts)
    total = np.zeros((max(len(part) for part in parts), count), np.float32)
    for part in parts:
        total[:, : part.shape[1]] += part  # one channel is heard on both sides
    return Samples(_RATE, np.clip(total, -1.0, 1.0))


class Soundtrack:
    """An audio stream of a container that is being written.

    Args:
        out: PyAV's container, nothing of which has been written yet.
        format: mp4 or webm.
        samples: The sound of the whole video.
    """

    def __init__(self, out: Any, format: VideoFormat, samples: Samples) -> None:
        self._out, self._done = out, 0
        self._samples = _at_rate(samples)
        stream = out.add_stream(_CODECS[format.name], rate=_RATE)
        stream.layout = "mono" if len(self._samples) == 1 else "stereo"
        stream.bit_rate = _BITS_PER_S
        self._stream = stream

    def write(self, until: Fraction | None) -> None:
        """Encode the sound up to a time of the video in seconds; None: all that is left."""
        total = self._samples.shape[1]
        end = total if until is None else min(round(until * _RATE), total)
        while self._done < end:
            part = self._samples[:, self._done : min(self._done + _AT_ONCE, end)]
            frame = library().AudioFrame.from_ndarray(
                np.ascontiguousarray(part), format="fltp", layout=self._stream.layout.name
            )
            frame.sample_rate, frame.pts = _RATE, self._done
            frame.time_base = Fraction(1, _RATE)
            self._done += part.shape[1]
            self._out.mux(self._stream.encode(frame))
        if until is None:
            self._out.mux(self._stream.encode(None))


def _at_rate(samples: Samples) -> NDArray[np.float32]:
    """Return the samples, one or two channels, at the rate of the stream."""
    channels = samples.channels[:2]
    if samples.rate == _RATE:
        return channels
    layout = "mono" if len(channels) == 1 else "stereo"
    change = library().AudioResampler(format="fltp", layout=layout, rate=_RATE)
    frame = library().AudioFrame.from_ndarray(
        np.ascontiguousarray(channels), format="fltp", layout=layout
    )
    frame.sample_rate = samples.rate
    parts = [each.to_ndarray() for each in (*change.resample(frame), *change.resample(None))]
    made: NDArray[np.float32] = np.concatenate(parts, axis=1)
    return made
