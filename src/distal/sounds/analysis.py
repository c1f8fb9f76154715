"""The texels that pictures read of a sound file: its spectrum and its wave at each time.

Input: samples. Output: a table of bytes, 60 rows a second, which is the same wherever it is read.
Source: Web Audio API, "AnalyserNode" (W3C, 2021), as Shadertoy uses it: a Blackman window on 2048
samples, magnitudes smoothed over time by 0.8, and -100 to -30 dB as 0 to 255.
"""

from __future__ import annotations

import math
from functools import lru_cache
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from distal.lang.live_textures import SOUND_COLUMNS, SoundFile
from distal.sounds.reading import Samples, read

# Rows of the table in each second.
RATE: Final = 60
_BLOCK: Final = 2048
_SMOOTHING: Final = np.float32(0.8)
_LOWEST_DB: Final = -100.0
_HIGHEST_DB: Final = -30.0
_AT_ONCE: Final = 512  # rows whose spectra are computed together


def table(samples: Samples) -> NDArray[np.uint8]:
    """Return the table of a sound, of shape (rows, 2, 512): spectrum and wave.

    Row i is what is heard at i / 60 s: of the 2048 samples before that time.
    """
    mono = samples.channels.mean(axis=0, dtype=np.float32)
    heard = np.concatenate([np.zeros(_BLOCK, np.float32), mono])
    rows = math.ceil(samples.seconds * RATE)
    ends = np.minimum(np.rint(np.arange(rows) * samples.rate / RATE).astype(np.int64), len(mono))
    blocks = np.lib.stride_tricks.sliding_window_view(heard, _BLOCK)
    made = np.empty((rows, 2, SOUND_COLUMNS), np.uint8)
    smooth = np.zeros(SOUND_COLUMNS, np.float32)
    for first in range(0, rows, _AT_ONCE):
        held = blocks[ends[first : first + _AT_ONCE]]
        magnitudes = np.abs(np.fft.rfft(held * _window(), axis=1))[:, :SOUND_COLUMNS] / _BLOCK
        for i, magnitude in enumerate(magnitudes.astype(np.float32)):
            smooth = _SMOOTHING * smooth + (np.float32(1.0) - _SMOOTHING) * magnitude
            made[first + i, 0] = _decibels(smooth)
        wave = np.floor(128.0 * (1.0 + held[:, :SOUND_COLUMNS]))
        made[first : first + len(held), 1] = np.clip(wave, 0.0, 255.0)
    return made


@lru_cache(maxsize=1)
def _window() -> NDArray[np.float32]:
    """Return Blackman's window, with alpha 0.16."""
    angle = 2.0 * math.pi * np.arange(_BLOCK) / _BLOCK
    return (0.42 - 0.5 * np.cos(angle) + 0.08 * np.cos(2.0 * angle)).astype(np.float32)


def _decibels(magnitudes: NDArray[np.float32]) -> NDArray[np.float64]:
    level = 20.0 * np.log10(np.maximum(magnitudes.astype(np.float64), 1e-30))
    share = (level - _LOWEST_DB) / (_HIGHEST_DB - _LOWEST_DB)
    return np.clip(np.floor(255.0 * share), 0.0, 255.0)


def table_of(sound: SoundFile) -> NDArray[np.uint8]:
    """Return the table of a file, read again only if the file has changed.

    Raises:
        LoadError: The file cannot be read.
    """
    try:
        state = Path(sound.path).stat()
        stamp = (state.st_mtime_ns, state.st_size)
    except OSError:
        stamp = (0, 0)  # reading reports the error
    return _kept(sound.path, stamp)


@lru_cache(maxsize=4)
def _kept(path: str, stamp: tuple[int, int]) -> NDArray[np.uint8]:
    return table(read(path))


def row_at(time: float, rows: int, *, loop: bool) -> int | None:
    """Return the row of a time in seconds; None where the sound is over, or has not begun."""
    row = math.floor(time * RATE + 0.5)
    if row < 0:
        return None
    if loop:
        return row % rows
    return row if row < rows else None


def texels_at(sound: SoundFile, time: float) -> NDArray[np.float32]:
    """Return the texels of a time in seconds, of shape (2, 512, 4).

    Raises:
        LoadError: The file cannot be read.
    """
    rows = table_of(sound)
    row = row_at(time, len(rows), loop=sound.loop)
    if row is None:
        return np.asarray(sound.data, np.float32)[::-1]
    texels = np.zeros((2, SOUND_COLUMNS, 4), np.float32)
    texels[..., 0] = rows[row] / np.float32(255.0)
    texels[..., 3] = 1.0
    return texels
