"""The options of rendering a picture: one table, which is the request that they become.

Input: values from a caller. Output: a checked ``RenderOptions``, which ``Image.render``,
``Scene.render``, videos, windows and the command line pass on. Whatever else names the options is
derived from its rows (``distal.lang.options``). Imports only the standard library.
"""

from __future__ import annotations

import math
import operator
import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, TypeAlias

from distal.ir.limits import FRAME_SECONDS, LARGEST_TIME
from distal.lang.live_textures import checked_keys
from distal.lang.options import Flag, checks, option
from distal.lang.runtime_access import filters, layers_of_scenes

if TYPE_CHECKING:
    from distributed import Client

    from distal.cluster.pool import WorkerPool
    from distal.images.picture import Picture
    from distal.scene.objects.argument_types import Vector
    from distal.scene.section import CutPlane
    from distal.scene.steering import Steering

MODES: Final = ("direct", "path")
LARGEST_SIDE_PX: Final = 16384
MOST_SAMPLES: Final = 65536
# Samples of a pixel in mode "path", if nothing else says when a picture is finished.
PATH_SAMPLES: Final = 64

# Called with the finished share, from 0 to 1.
Progress: TypeAlias = Callable[[float], Any]
# Called with the finished pictures of many, all pictures, and the kind of work.
FrameProgress: TypeAlias = Callable[[int, int, str], Any]
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


def _checked_index(value: Any) -> int | None:
    return None if value is None else _checked_int("index", value)


def _checked_mode(mode: str | None) -> str | None:
    if mode not in (None, *MODES):
        raise ValueError(f"there is no mode '{mode!s:.40}'; modes: {', '.join(MODES)}")
    return mode


def _checked_filter(name: str | None) -> str | None:
    if name is not None and name not in filters.NAMES:
        raise ValueError(f"there is no filter {name!r:.40}; filters: {', '.join(filters.NAMES)}")
    return name


def _checked_layers(names: Sequence[str]) -> Sequence[str]:
    return () if names == () else layers_of_scenes.checked_layers(names)


def _checked_limit(name: str, also: str = "") -> Callable[[Any], float | None]:
    """Return the check of a limit above 0; None is no limit.

    Args:
        name: The name of the option.
        also: "0 or " if 0 is allowed too.
    """

    def check(value: Any) -> float | None:
        if value is None or (also and value == 0.0):
            return value  # type: ignore[no-any-return]
        is_number = isinstance(value, int | float) and not isinstance(value, bool)
        if not is_number or not 0.0 < value < math.inf:
            raise ValueError(f"{name} is {also}a number above 0, not {value!r:.40}")
        return float(value)

    return check


@dataclass(frozen=True, slots=True, kw_only=True)
class RenderOptions:
    """The request of one rendering, checked on construction.

    Each field is the row of an option (``distal.lang.options``). Those with methods are options of
    authors; what a method does not take keeps its default.

    Raises:
        TypeError: A value has the wrong type.
        ValueError: A value is out of range, or there is no such mode, filter or layer.
    """

    size: tuple[int, int] = option(
        (640, 480),
        "Width and height in pixels.",
        "scene image shape video sweep",
        positional=True,
        check=checked_size,
        flag=Flag(metavar="WxH", form="size", helps={"sweep": "Of each picture, in pixels."}),
        docs={
            "video": "Width and height in pixels; even for mp4 and webm unless they are lossless.",
            "sweep": "Width and height of each picture in pixels.",
        },
        defaults={"sweep": (160, 120)},
    )
    time: float = option(
        0.0,
        "Time in seconds; ``frame.time`` of an ``@image``.",
        "scene image shape sweep window",
        positional=True,
        check=checked_time,
        docs={"shape": "Time in seconds.", "sweep": "Seconds, if it is none of the values."},
        flag=Flag("Seconds.", metavar="S", form="seconds"),
    )
    params: Mapping[str, Any] = option(
        dict,
        "Values of parameters by name; the others have their defaults.",
        "scene image shape video sweep",
        positional=True,
        taken="ParameterValues | None",
        docs={"sweep": "Values of the other parameters by name."},
    )
    device: str = option(
        "cpu",
        'The device to render on: "auto" (a hardware GPU if there is one, else the CPU), "cpu", '
        '"gpu", "gpu-fragment" or "reference"; "gpu:NAME" selects the adapter.',
        "scene image shape video sweep",
        positional=True,
        flag=Flag("What renders; auto: a GPU, else the CPU."),
    )
    threads: int | None = option(
        None,
        "Number of CPU threads; None uses all that the process may use.",
        "scene image video sweep",
        positional=True,
        flag=Flag("CPU threads; one per core if not given.", limits=(1, 1024)),
    )
    progress: Progress | None = option(
        None, "Called with the finished share, from 0 to 1.", "scene image", positional=True
    )
    cancel: Cancel | None = option(
        None,
        "An event, or a function without arguments, that ends the work early.",
        "scene image video sweep",
        positional=True,
        docs={
            "video": "An event, or a function without arguments, that ends the work early; it is "
            "called by the threads that render."
        },
    )
    mouse: Sequence[float] = option(
        (0.0, 0.0, 0.0, 0.0),
        "``frame.mouse``: x and y in pixels from the lower left, then the click position as in "
        "Shadertoy.",
        "scene image",
        positional=True,
        check=_checked_mouse,
    )
    index: int | None = option(
        None,
        "``frame.index``, the frame number; wraps at 32 bits. A picture that reads earlier frames "
        "is rendered from frame 0 to this one. None: as many frames as ``time`` has steps of "
        "``delta`` for such a picture, else 0.",
        "scene image",
        positional=True,
        check=_checked_index,
    )
    seed: int = option(
        0,
        "``frame.seed``, the seed of random numbers; wraps at 32 bits.",
        "scene image",
        positional=True,
        check=partial(_checked_int, "seed"),
    )
    samples: int | None = option(
        None,
        "Samples in each pixel, which are averaged. None: one of an ``@image``; one of a scene, "
        "and eight more where the pixel differs from its neighbors.",
        "scene image shape video sweep",
        check=checked_samples,
        flag=Flag(
            "Samples in each pixel; if not given, one of an @image; one of a scene, and eight "
            "more where the pixel differs from its neighbors; 64 in mode path.",
            names=("--samples", "--spp"),
            limits=(1, MOST_SAMPLES),
        ),
    )
    mode: str | None = option(
        None,
        'How light is computed: "direct" or "path"; None: as the scene says.',
        "scene shape video sweep window",
        check=_checked_mode,
        flag=Flag(
            "direct: from each light to the first surface; path: exact, by many random paths."
        ),
        docs={"shape": 'How light is computed: "direct" or "path"; None: directly.'},
    )
    caustics: bool = option(
        True,
        "Whether light that glass, mirrors and metals bundle is found by photons: much faster, "
        "with a small error that goes to 0. False: by paths alone.",
        "scene window",
        of_paths=True,
        recorded=True,
        flag=Flag(
            "Whether photons find the light that glass and mirrors bundle.",
            names=("--caustics/--no-caustics",),
        ),
    )
    spp: int | None = option(
        None,
        "Samples in each pixel, the same as ``samples``. None: 64, or as many as a limit of time "
        "or noise takes.",
        "scene",
        of_paths=True,
        check=checked_samples,
    )
    time_limit: float | None = option(
        None,
        "Seconds after which no more samples are begun.",
        "scene",
        of_paths=True,
        check=_checked_limit("time_limit"),
        flag=Flag("Begin no more samples after S seconds.", metavar="S"),
    )
    noise: float | None = option(
        None,
        "The estimated error at which the picture is finished: the standard error of a pixel's "
        "light, as a root mean square (1 is white).",
        "scene",
        of_paths=True,
        recorded=True,
        check=_checked_limit("noise"),
        flag=Flag("Stop when the estimated error is below E.", metavar="E"),
    )
    film: str | Path | None = option(
        None,
        "A file that keeps the samples so far; if it exists, rendering goes on from them.",
        "scene",
        of_paths=True,
    )
    filter: str | None = option(
        None,
        'The reconstruction filter, "tent", "box", "gaussian", "blackman-harris" or "mitchell"; '
        'None: "tent".',
        "scene",
        of_paths=True,
        recorded=True,
        check=_checked_filter,
        flag=Flag(
            "The reconstruction filter: tent, box, gaussian, blackman-harris or mitchell.",
            shown="tent",
        ),
    )
    shutter: float | None = option(
        None,
        "Seconds that the shutter is open, from ``time`` on; what moves is blurred. None: as the "
        "scene says.",
        "scene video",
        of_paths=True,
        recorded=True,
        check=_checked_limit("shutter", "0 or "),
        flag=Flag(
            "The shutter is open for S seconds.",
            metavar="S",
            helps={"video": "The shutter is open for S seconds in each frame."},
        ),
        docs={
            "video": "Seconds that the shutter is open in each frame, from its time on; "
            "``0.5 / fps`` is a shutter of 180 degrees. None: as the scene says."
        },
    )
    clamp: float | None = option(
        None,
        "The largest light of a sample; brighter ones are scaled to it. That removes single bright "
        "pixels, and some light: the picture is biased. None has no limit.",
        "scene",
        of_paths=True,
        recorded=True,
        check=_checked_limit("clamp"),
        flag=Flag(
            "No sample is brighter than X (1 is white). Removes single bright pixels, and some "
            "light.",
            metavar="X",
        ),
    )
    denoise: bool = option(
        False,
        "Whether Open Image Denoise removes the noise that is left, guided by albedo and normal; "
        "needs ``distal[denoise]``. It may remove fine detail.",
        "scene",
        of_paths=True,
        recorded=True,
        flag=Flag("Remove the noise that is left."),
    )
    preview: Callable[[Picture], object] | None = option(
        None,
        "Called with the picture so far, at most every few seconds, and when the work is broken "
        "off.",
        "scene",
        of_paths=True,
    )
    view: str = option(
        "color",
        'What to show: "color", "coordinate", "signal", "distance", "normal", "depth", "steps", '
        '"material", "slope" or "slice".',
        "scene shape video sweep window",
        flag=Flag(
            "color, coordinate, signal, distance, normal, depth, steps, material, slope, slice; of "
            "an @image color, coordinate, signal, local:NAME.",
            helps={
                **dict.fromkeys(("video", "sweep"), "What to show, as in distal render."),
                "window": "The first view; V shows the others.",
            },
        ),
    )
    transparent: bool = option(
        False,
        "Whether alpha is 0 where a ray hits nothing.",
        "scene shape",
        flag=Flag("Leave out what is behind everything."),
    )
    plane: tuple[Vector, float] = option(
        ((0.0, 0.0, 1.0), 0.0),
        'The plane that the view "slice" shows: its normal, of length 1, and its distance from the '
        "origin along the normal.",
        "scene",
        flag=Flag(
            "The plane of the view slice.",
            names=("--slice",),
            metavar="AXIS=OFFSET",
            form="plane",
        ),
    )
    freeze: bool = option(
        False,
        "Compile all numbers as constants: slower to compile, a little faster to run.",
        "scene",
    )
    steering: Steering | None = option(
        None,
        "How a person has moved the camera; None if it was not moved.",
        "scene shape video",
        flag=Flag(
            "How the camera is moved, like yaw=0.3,pitch=0.1,zoom=0.8,pan_x=0,pan_y=0.",
            metavar="NAME=X,…",
            form="steering",
        ),
    )
    layers: Sequence[str] = option(
        (),
        'Layers to compute for ``Picture.layers``: "depth", "normal", "albedo", "material"; in '
        'mode "path" also "samples" and "variance".',
        "scene",
        check=_checked_layers,
        flag=Flag(
            "What an EXR holds besides color: depth,normal,albedo,material, in mode path also "
            "samples,variance; or none; all without it.",
            metavar="NAMES",
        ),
    )
    cluster: Client | WorkerPool | None = option(
        None,
        "A ``dask.distributed.Client`` whose workers render it, with the same bits; None renders "
        "it in this process. Needs ``distal[cluster]``.",
        "scene image video sweep",
        flag=Flag(
            "Render on the workers of Dask: local, local:N, tcp://HOST:PORT or a scheduler's file.",
            metavar="WHERE",
        ),
        docs={
            "sweep": "A ``dask.distributed.Client`` whose workers render the pictures and measure "
            "the solids, with the same bits; None does that in this process. Needs "
            "``distal[cluster]``."
        },
    )
    keys: Any = option(
        (), "The codes of the keys that are down, or a ``Keys``.", "image", check=checked_keys
    )
    buttons: int = option(
        0,
        "``frame.buttons``: 1 for the left button of the mouse, 2 for the right one and 4 for the "
        "middle one, added.",
        "image",
        check=partial(_checked_int, "buttons"),
    )
    delta: float = option(
        FRAME_SECONDS,
        "``frame.delta``, the seconds between two frames.",
        "image",
        check=_checked_delta,
    )
    settings: Mapping[str, Any] = option(
        dict, "Values of a scene's numbers by name, for this picture only."
    )
    refinement: Refinement | None = option(
        None, 'When a picture in mode "path" is finished; None: when it has its samples.'
    )
    section: CutPlane | None = option(
        None, "The plane of a scene that is cut open (``Scene.sectioned``); None if it is whole."
    )
    date: tuple[float, ...] = option(
        (0.0, 0.0, 0.0, 0.0), "``frame.date``; zeros, so that a file can be rendered again."
    )
    history: Any = option(
        None, "Earlier frames to go on from; None: those with the same values as this one."
    )

    def __post_init__(self) -> None:
        for name, check in _CHECKS:
            object.__setattr__(self, name, check(getattr(self, name)))
        if self.transparent and self.filter in filters.SIGNED:
            raise ValueError(
                f"the negative weights of filter '{self.filter}' leave noise in alpha: give "
                "another filter to a transparent picture"
            )


_CHECKS: Final = checks(RenderOptions)
