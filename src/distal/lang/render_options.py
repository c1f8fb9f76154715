"""The options of rendering a picture: their defaults and checks.

Input: values from a caller. Output: a ``RenderOptions`` that ``Image.render``, ``Scene.render``,
videos, windows and the command line pass unchanged to the executor. Imports only the standard
library.
"""

from __future__ import annotations

import math
import operator
import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final, TypeAlias

from distal.ir.limits import FRAME_SECONDS, LARGEST_TIME
from distal.lang.live_textures import checked_keys

LARGEST_SIDE_PX: Final = 16384
MOST_SAMPLES: Final = 65536
# Samples of a pixel in mode "path", if nothing else says when a picture is finished.
PATH_SAMPLES: Final = 64

# Called with the finished share, from 0 to 1.
Progress: TypeAlias = Callable[[float], Any]
# Rendering stops when the event is set or the function returns True.
Cancel: TypeAlias = Callable[[], bool] | threading.Event


@dataclass(frozen=True, slots=True, kw_only=True)
class Refinement:
    """When a picture that gets ever more samples is finished; the first reason counts.

    Attributes:
        samples: It has so many samples in each pixel.
        time_limit: So many seconds have passed; None has no limit. There is always one pass.
        noise: Its estimated error is at most this; None has no limit.
        film: A file that keeps the samples so far; they are taken from it if it exists.
        shutter: Seconds that the shutter is open, from the picture's time on.
        signed: Whether samples may have negative weights (``render.filters.SIGNED``).
        preview: Called with the picture so far, at most every few seconds.
        finish: Changes the finished linear light, before it is encoded for display.
    """

    samples: int
    time_limit: float | None = None
    noise: float | None = None
    film: Path | None = None
    shutter: float = 0.0
    signed: bool = False
    preview: Callable[[Any], Any] | None = None
    finish: Callable[[Any], Any] | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class RenderOptions:
    """The options of one rendering, checked on construction.

    Attributes:
        size: Width and height in pixels.
        time: Time in seconds; ``frame.time`` of an ``@image``.
        params: Values of parameters by name; the others have their defaults.
        device: The device to render on: "auto" (a hardware GPU if there is one, else the CPU),
            "cpu", "gpu", "gpu-fragment" or "reference"; "gpu:NAME" selects the adapter.
        threads: Number of CPU threads; None uses all that the process may use.
        progress: Called with the finished share, from 0 to 1.
        cancel: An event, or a function without arguments, that ends the work early.
        mouse: ``frame.mouse``: x and y in pixels from the lower left, then the click position
            as in Shadertoy.
        index: ``frame.index``, the frame number; wraps at 32 bits. A picture that reads
            earlier frames is rendered from frame 0 to this one. None: as many frames as ``time``
            has steps of ``delta`` for such a picture, else 0.
        seed: ``frame.seed``, the seed of random numbers; wraps at 32 bits.
        samples: Samples in each pixel, which are averaged. None: one of an ``@image``; one of a
            scene, and eight more where the pixel differs from its neighbours.
        freeze: Compile all numbers as constants: slower to compile, a little faster to run.
        settings: Values of a scene's numbers by name, for this picture only.
        refinement: When a picture in mode "path" is finished; None: when it has its samples.
        cluster: A ``dask.distributed.Client`` whose workers render it, with the same bits; None
            renders it in this process. Needs ``distal[cluster]``.
        keys: The codes of the keys that are down, or a ``Keys``.
        buttons: ``frame.buttons``: 1 for the left button of the mouse, 2 for the right one and
            4 for the middle one, added.
        delta: ``frame.delta``, the seconds between two frames.
        date: ``frame.date``; zeros, so that a file can be rendered again.
        history: Earlier frames to go on from; None: those with the same values as this one.

    Raises:
        TypeError: A value has the wrong type.
        ValueError: A value is out of range.
    """

    size: tuple[int, int] = (640, 480)
    time: float = 0.0
    params: Mapping[str, Any] = field(default_factory=dict)
    device: str = "cpu"
    threads: int | None = None
    progress: Progress | None = None
    cancel: Cancel | None = None
    mouse: Sequence[float] = (0.0, 0.0, 0.0, 0.0)
    index: int | None = None
    seed: int = 0
    samples: int | None = None
    freeze: bool = False
    settings: Mapping[str, Any] = field(default_factory=dict)
    refinement: Refinement | None = None
    cluster: Any = None
    keys: Any = ()
    buttons: int = 0
    delta: float = FRAME_SECONDS
    date: tuple[float, ...] = (0.0, 0.0, 0.0, 0.0)
    history: Any = None

    def __post_init__(self) -> None:
        for name, value in (
            ("size", checked_size(self.size)),
            ("time", checked_time(self.time)),
            ("mouse", _checked_mouse(self.mouse)),
            ("index", None if self.index is None else _checked_int("index", self.index)),
            ("keys", checked_keys(self.keys)),
            ("buttons", _checked_int("buttons", self.buttons)),
            ("delta", _checked_delta(self.delta)),
            ("seed", _checked_int("seed", self.seed)),
            ("samples", checked_samples(self.samples)),
        ):
            object.__setattr__(self, name, value)


def checked_size(size: Any) -> tuple[int, int]:
    """Return width and height in pixels, checked.

    Raises:
        TypeError: ``size`` is not a pair of whole numbers.
        ValueError: A side is out of range.
    """
    try:
        width, height = map(operator.index, size)
    except (TypeError, ValueError):
        raise TypeError(f"size is (width, height) in pixels, not {size!r}") from None
    if not (1 <= width <= LARGEST_SIDE_PX and 1 <= height <= LARGEST_SIDE_PX):
        raise ValueError(f"each side has 1 to {LARGEST_SIDE_PX} pixels, not {width}x{height}")
    return width, height


def place_of_pixel(pixel: tuple[int, int], size: tuple[int, int]) -> tuple[float, float]:
    """Return the middle of a pixel, in pixels from the lower left.

    Args:
        pixel: Column and row from 0; rows count from the top, as in a picture's array.
        size: Width and height of the picture in pixels.

    Raises:
        ValueError: The picture has no such pixel.
    """
    (x, y), (width, height) = pixel, size
    if not (0 <= x < width and 0 <= y < height):
        raise ValueError(f"a picture of {width}x{height} has no pixel {x},{y}")
    return x + 0.5, height - y - 0.5


def checked_time(seconds: Any) -> float:
    """Return a time in seconds, checked to be in the range where 32-bit floats are precise enough.

    Raises:
        TypeError: It is not a number.
        ValueError: It is not finite, or its magnitude is above ``LARGEST_TIME``.
    """
    try:
        value = float(seconds)
    except (TypeError, ValueError):
        raise TypeError(f"time is a number of seconds, not {seconds!r}") from None
    except OverflowError:
        value = math.inf
    if not math.isfinite(value):
        raise ValueError(f"time is finite, not {value}")
    if abs(value) > LARGEST_TIME:
        raise ValueError(
            f"time is within {LARGEST_TIME:.0f} seconds (12 days) of 0, not {value:g}: floats of "
            "32 bits are too far apart there"
        )
    return value


def checked_samples(samples: object) -> int | None:
    """Return the checked number of samples in each pixel, or None.

    Raises:
        ValueError: It is no whole number in this range.
    """
    if samples is None:
        return None
    if not isinstance(samples, int) or not 1 <= samples <= MOST_SAMPLES:
        raise ValueError(f"a pixel has 1 to {MOST_SAMPLES} samples, not {samples!r}")
    return samples


def _checked_delta(seconds: Any) -> float:
    """Return the seconds between two frames, checked."""
    value = checked_time(seconds)
    if value <= 0.0:
        raise ValueError(f"delta is the seconds between two frames, more than 0, not {value:g}")
    return value


def _checked_mouse(mouse: Any) -> tuple[float, float, float, float]:
    """Return the four numbers of ``frame.mouse``, checked."""
    try:
        x, y, click_x, click_y = (float(part) for part in mouse)
    except (TypeError, ValueError):
        x = y = click_x = click_y = math.nan
    values = (x, y, click_x, click_y)
    if not all(map(math.isfinite, values)):
        raise ValueError(f"mouse is four finite numbers, not {mouse!r}")
    return values


def _checked_int(name: str, value: Any) -> int:
    try:
        return operator.index(value)
    except TypeError:
        raise TypeError(f"{name} is a whole number, not {value!r}") from None
