"""The gallery on every way of drawing it, held against the CPU's pictures.

Input: an example's name and a way's. Output: a ``Measured``: how far the worst of
its pictures is off. ``tools/gen_parity.py`` writes all of them down, the tests look at some.
"""

from __future__ import annotations

import os
import re
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

import distal
from distal.backends import Artifact
from tests import webgl
from tests.buffer_data import buffers_of, text_of, textures_of
from tests.pictures.comparison import Difference, as_bytes, difference

TIMES: Final = (0.0, 2.9, 11.3)
LARGE: Final = (160, 120)
MIDDLE: Final = (96, 72)
SMALL: Final = (48, 36)


@dataclass(frozen=True, slots=True)
class Measured:
    """How far an example's pictures are off, each number the worst of all times.

    Attributes:
        size: Width and height.
        pictures: How many, at the first of ``TIMES``.
        mean: Mean difference in 1/255.
        far_off: Share of the pixels off by more than 2/255.
        worst: The largest difference, in 1/255.
    """

    size: tuple[int, int]
    pictures: int
    mean: float
    far_off: float
    worst: int

    def is_agreement_of(self, example: str) -> bool:
        """Within SEEDS' tolerance, as ``Difference.is_agreement_of``."""
        return Difference(self.mean, self.far_off).is_agreement_of(example)


@dataclass(frozen=True, slots=True)
class Way:
    """One way of drawing.

    Attributes:
        title: Its heading.
        draw: The picture of an example at a size and a time.
        runs_on: What draws, in words that are the same on every machine with that driver.
        size: Of a scene of objects' picture; functions of a pixel are drawn ``LARGE``.
        times: At how many of ``TIMES`` a scene that moves is drawn.
    """

    title: str
    draw: Callable[[str, tuple[int, int], float], NDArray[Any]]
    runs_on: Callable[[], str]
    size: tuple[int, int] = LARGE
    times: int = len(TIMES)


def measure(example: str, way: Way) -> Measured:
    """Draw an example on one way and on the CPU, at each of its times."""
    size = LARGE if is_function_of_a_pixel(example) else way.size
    times = TIMES[: way.times] if is_moving(example) else TIMES[:1]
    mean = far_off = worst = 0.0
    for seconds in times:
        picture, wanted = way.draw(example, size, seconds), cpu_picture(example, size, seconds)
        found = difference(picture, wanted)
        off = np.abs(as_bytes(picture).astype(int) - as_bytes(wanted)).max()
        mean, far_off = max(mean, found.mean), max(far_off, found.far_off)
        worst = max(worst, int(off))
    return Measured(size, len(times), mean, far_off, int(worst))


@cache
def image(example: str) -> Any:
    """The scene or ``@image``."""
    return distal.load(f"example:{example}")


def direct(example: str) -> dict[str, Any]:
    """The options by which an example shows what shader texts do, direct light."""
    return {"mode": "direct"} if isinstance(image(example), distal.Scene) else {}


def is_function_of_a_pixel(example: str) -> bool:
    """Whether it is an ``@image``: quick on every way of drawing."""
    return not isinstance(image(example), distal.Scene)


@cache
def program(example: str, target: str = "glsl-es300") -> Artifact:
    """The text for a target."""
    return text_of(image(example), target)


@cache
def buffers(example: str, seconds: float) -> dict[str, NDArray[Any]]:
    """The data that the text reads."""
    return buffers_of(image(example), seconds)


@cache
def textures(example: str) -> dict[str, NDArray[Any]]:
    """The textures that the text reads."""
    return textures_of(image(example))


def is_moving(example: str) -> bool:
    """Whether its picture reads the time."""
    return "time" in {u["name"] for u in program(example).interface["uniforms"]}


@cache
def cpu_picture(example: str, size: tuple[int, int], seconds: float) -> NDArray[Any]:
    """The middle that all ways are held against."""
    picture: NDArray[Any] = (
        image(example).render(size=size, samples=1, time=seconds, **direct(example)).array
    )
    return picture


def by_device(device: str) -> Callable[[str, tuple[int, int], float], NDArray[Any]]:
    """Draws on one of distal's own devices."""

    def draw(example: str, size: tuple[int, int], seconds: float) -> NDArray[Any]:
        picture: NDArray[Any]
        options: dict[str, Any] = {"samples": 1, "time": seconds, "device": device}
        picture = image(example).render(size=size, **options, **direct(example)).array
        return picture

    return draw


def by_browser(driver: str) -> Callable[[str, tuple[int, int], float], NDArray[Any]]:
    """Draws on WebGL 2 in Chromium."""

    def draw(example: str, size: tuple[int, int], seconds: float) -> NDArray[Any]:
        values = {"time": seconds} if is_moving(example) else {}
        given = {"buffers": buffers(example, seconds), "textures": textures(example)}
        return webgl.run_webgl(program(example), size, values, driver=driver, **given)

    return draw


def _gpu() -> str:
    # Mesa complains on stderr without one; any folder that exists will do.
    os.environ.setdefault("XDG_RUNTIME_DIR", tempfile.gettempdir())
    stats = image("course_1_rays").render(size=(8, 8), device="gpu").stats
    return f"{generic(stats['adapter'])}, {stats['backend']}"


def generic(driver: str) -> str:
    """A driver's name without what differs from machine to machine."""
    if "SwiftShader" in driver:
        return "SwiftShader"
    if known := re.search(r"llvmpipe \(LLVM (\d+)", driver):
        return f"llvmpipe (LLVM {known[1]})"
    return driver


WAYS: Final[dict[str, Way]] = {
    "reference": Way(
        "The NumPy reference", by_device("reference"), lambda: "NumPy", size=SMALL, times=1
    ),
    "gpu": Way("GPU, compute shader", by_device("gpu"), _gpu),
    "gpu-fragment": Way("GPU, fragment shader", by_device("gpu-fragment"), _gpu),
    "webgl2": Way(
        "WebGL 2 in Chromium, on Mesa",
        by_browser("mesa"),
        lambda: generic(webgl.renderer("mesa")),
    ),
    "webgl2-swiftshader": Way(
        "WebGL 2 in Chromium, on SwiftShader",
        by_browser("swiftshader"),
        lambda: generic(webgl.renderer("swiftshader")),
        size=MIDDLE,
    ),
}
