"""The cost of lines, measured natively: counts, and the slopes of repeated lines, for tests.

Input: scenes. Output: runs and operations a pixel, seconds of CPU a picture. The driver is the one
that EGL gives: llvmpipe on a machine without a graphics card, which computes on this process's
threads, so a loaded machine gives the same numbers.
"""

from __future__ import annotations

import statistics
import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from distal.editor.counting import counting, timing
from distal.editor.messages import Counting, LineTiming
from distal.scene.viewing.viewable import Viewable
from tests.egl import EglShader, context

ROUNDS = 7
MOST_REPEATS = 256
COUNTED = (64, 48)  # the size of the pictures that are counted
CLEAR_S = 0.004  # a picture that is measured takes this long
LARGEST = 512


@dataclass
class LineCost:
    """What a line costs: runs and operations a pixel, seconds a picture with their error."""

    line: int
    runs: float
    work: float
    seconds: float
    error: float

    @property
    def is_measured(self) -> bool:
        """Whether the error is smaller than the time."""
        return self.seconds > self.error


class Native:
    """A program of the studio, drawn natively."""

    def __init__(self, program: dict[str, Any], size: tuple[int, int], fragment: str = "") -> None:
        self.size = size
        self._shader = EglShader(fragment or program["fragment"], None, program["vertex"])
        frame = {"resolution": size, "time": 0.0, "mouse": (0.0, 0.0), "index": 0}
        texts = program["fragment"] + program["vertex"]
        self._values = {
            u["uniform"]: frame[u["name"]] if u["origin"] == "frame" else u["default"]
            for u in program["uniforms"]
            if u["uniform"] in texts
        }
        self._target = context().simple_framebuffer(size, components=4, dtype="f1")

    def draw(self, **numbers: int) -> None:
        """Draw a picture, and wait for it."""
        self._shader.draw(self._target, self._values | numbers)
        context().finish()

    def pixels(self, **numbers: int) -> np.ndarray:
        """Return the bytes of a picture, a row for each pixel."""
        self.draw(**numbers)
        return np.frombuffer(self._target.read(components=4), np.uint8).reshape(-1, 4)

    def seconds(self, **numbers: int) -> float:
        """Return the CPU time of a picture."""
        begin = time.process_time()
        self.draw(**numbers)
        return time.process_time() - begin

    def release(self) -> None:
        """Give the driver's objects back."""
        self._shader.release()
        self._target.release()


class Repeated:
    """A line of a picture, repeated; and its loop alone."""

    def __init__(self, times: LineTiming, number: int, size: tuple[int, int]) -> None:
        self._repeats = times.repeats
        self._evaluations = times.evaluations[number]
        self.full, self.bare = (
            Native(times.program, size, chosen(times, place)) for place in (number, -2 - number)
        )

    def pixels(self, repeats: int) -> tuple[np.ndarray, np.ndarray]:
        """Return the pictures of the line and of its loop alone, with some repetitions."""
        numbers = {self._repeats: repeats}
        return self.full.pixels(**numbers), self.bare.pixels(**numbers)

    def slope(self) -> tuple[float, float]:
        """Return the seconds of a repetition, and their error: the median of seven differences."""

        def more(program: Native) -> float:
            once = program.seconds(**{self._repeats: 1})
            return program.seconds(**{self._repeats: many}) - once

        self.pixels(1)  # compiles
        many = 4
        while many < MOST_REPEATS and more(self.full) < self.full.seconds(**{self._repeats: 1}):
            many *= 4
        done = (many - 1) * self._evaluations
        slopes = [(more(self.full) - more(self.bare)) / done for _ in range(ROUNDS)]
        slopes.sort()
        return statistics.median(slopes), (slopes[-2] - slopes[1]) / 2

    def release(self) -> None:
        """Give the programs back."""
        self.full.release()
        self.bare.release()


def chosen(times: LineTiming, number: int) -> str:
    """Return the text that measures a place: the line of the choice ends in its number."""
    assert times.choice in times.program["fragment"]
    return times.program["fragment"].replace(times.choice, f"{times.choice[:-2]}{number}")


def counted(counts: Counting, size: tuple[int, int]) -> dict[int, np.ndarray]:
    """Return the counts of the pixels by line, from the lower left."""
    program = Native(counts.program, size)
    found = {}
    for number, (_, line) in enumerate(counts.places):
        digits = program.pixels(**{counts.which: number})[:, :3].astype(np.int64)
        found[line] = digits @ (1, 256, 65536)
    program.release()
    return found


def scaled(times: LineTiming) -> tuple[float, tuple[int, int]]:
    """Return the seconds and the size of the smallest picture that takes long enough."""
    width, height = COUNTED
    while True:
        whole = Native(times.program, (width, height))
        whole.draw()
        frame = statistics.median(whole.seconds() for _ in range(ROUNDS))
        whole.release()
        if frame >= CLEAR_S or width >= LARGEST:
            return frame, (width, height)
        width, height = 2 * width, 2 * height


def line_costs(seen: Viewable, file: str) -> tuple[float, list[LineCost]]:
    """Return the seconds of a picture that takes long enough, and the costs of a file's lines."""
    counts = (counted(counting(seen, "color", (file,), work=w), COUNTED) for w in (False, True))
    runs, work = ({line: float(c.mean()) for line, c in by_line.items()} for by_line in counts)
    times = timing(seen, "color", (file,))
    frame, size = scaled(times)
    found = []
    for number, (_, line) in enumerate(times.places):
        repeated = Repeated(times, number, size)
        found.append(LineCost(line, runs[line], work[line], *repeated.slope()))
        repeated.release()
    return frame, found


def ranks(values: list[float]) -> np.ndarray:
    """Return the ranks of values; equal values share the mean of their ranks."""
    data = np.asarray(values)
    _, inverse, counts = np.unique(data, return_inverse=True, return_counts=True)
    ends = np.cumsum(counts)
    return ((ends - counts + ends - 1) / 2)[inverse]


def spearman(one: list[float], other: list[float]) -> float:
    """Return Spearman's rank correlation."""
    return float(np.corrcoef(ranks(one), ranks(other))[0, 1])
