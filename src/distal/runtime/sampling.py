"""Several samples in a pixel: of an ``@image``, and where neighboring pixels of a scene differ.

Input: an ``@image``; or the programs of a scene and the size of its picture. Output: a program that
averages samples; or linear light and display values, rendered in two passes. The formulas are scene
code (``render.film``).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Final

import numpy as np
from numpy.typing import NDArray

from distal.frontend import Assembly
from distal.ir.build import field
from distal.ir.nodes import Construct, EntryKind, Expr, FunctionRef, Param, Read, Return
from distal.ir.types import FRAME, INT, VEC2, VEC3, VEC4, FunctionType
from distal.lang import func, vec3, vec4
from distal.lang.composed import Composed
from distal.lang.functions import Func, Image
from distal.lang.render_options import Progress
from distal.loading import copy_loaded_from
from distal.render import film

# A list of pixels is sorted by squares of this side, so that neighbors are computed together.
_SQUARE_PX: Final = 8
_HIGHEST_PX: Final = 4096


@func
def opaque(color: vec3) -> vec4:
    """Return a color with alpha 1."""
    return vec4(color, 1.0)


class SampledImage(Composed):
    """An ``@image`` whose pixels are the mean of ``Samples`` samples."""

    kind: ClassVar[EntryKind] = EntryKind.IMAGE
    signature = (("frame", FRAME),)
    result = VEC4

    def __init__(self, image: Image) -> None:
        copy_loaded_from(image, self)
        self.name = image.name
        self._image = image

    def compose(self, assembly: Assembly) -> str:
        """Add the function that maps the frame to a pixel, and return its name."""
        frame = Read("frame", FRAME)
        samples = assembly.number(film.SAMPLES, INT, 1)
        given: dict[str, Expr] = {
            "coord": field(frame, "coord"),
            "color": self._color(assembly),
            "samples": samples,
            "step": assembly.call(film.lattice_step, {"count": samples}),
        }
        color = assembly.call(film.exposed_image, given)
        params = (Param("frame", FRAME),)
        return assembly.define("sampled", params, VEC4, (Return(color),))

    def _color(self, assembly: Assembly) -> FunctionRef:
        """Return the function of a place in the picture to its display value."""
        frame = Read("frame", FRAME)
        parts = [field(frame, name) for name, _ in FRAME.fields]
        parts[0] = Read("place", VEC2)  # coord
        (name,) = assembly.parameter_names(self._image)
        color = assembly.call(self._image, {name: Construct(tuple(parts), FRAME)})
        if color.type is VEC3:
            color = assembly.call(opaque, {"color": color})
        params = (Param("place", VEC2), Param("frame", FRAME))
        defined = assembly.define("color_at", params, VEC4, (Return(color),))
        return FunctionRef(defined, (frame,), FunctionType((VEC2,), VEC4))

    def functions(self) -> list[Func]:
        """Return the author's function."""
        return [self._image]


def sampled(image: Image) -> SampledImage:
    """Return an image with ``Samples`` samples in each pixel; always the same object."""
    found: SampledImage | None = image.__dict__.get("_sampled")
    if found is None:
        found = image.__dict__["_sampled"] = SampledImage(image)
    return found


@dataclass(frozen=True, slots=True)
class Programs:
    """The programs of a picture with adaptive sampling.

    Attributes:
        light: Renders linear light: of a size, with these uniforms and buffers (by their
            declarations in ``render.film``), and reports progress.
        shown: Encodes linear light for display.
        contrast: Returns the contrast of each pixel of display values.
    """

    light: Callable[
        [tuple[int, int], Mapping[str, Any], Mapping[Any, Any], Progress | None],
        NDArray[np.float32],
    ]
    shown: Callable[[NDArray[np.float32]], NDArray[np.float32]]
    contrast: Callable[[NDArray[np.float32]], NDArray[np.float32]]


def adaptive(
    programs: Programs, size: tuple[int, int], progress: Progress | None
) -> tuple[NDArray[np.float32], NDArray[np.float32], float]:
    """Render with one sample in each pixel, then with more where a pixel differs from neighbors.

    Args:
        programs: The programs.
        size: Width and height in pixels.
        progress: Called with the finished share, from 0 to 1.

    Returns:
        Linear light, display values, and the mean number of samples of a pixel.
    """
    picture_size = (float(size[0]), float(size[1]))
    numbers = {film.SAMPLES: 1, film.AGAIN: False, film.PICTURE_SIZE: picture_size}
    light = programs.light(size, numbers, {}, _part(progress, 0))
    shown = programs.shown(light)
    places = _in_squares(programs.contrast(shown) > film.CONTRAST)
    count = len(places)
    if count == 0:
        if progress is not None:
            progress(1.0)
        return light, shown, 1.0
    padded, grid = arranged(places)
    pixels = light.reshape(-1, 4)
    buffers = {film.PLACES: padded, film.FIRSTS: pixels[padded]}
    numbers = {film.SAMPLES: film.MORE_SAMPLES, film.AGAIN: True, film.PICTURE_SIZE: picture_size}
    finer = programs.light(grid, numbers, buffers, _part(progress, 1))
    pixels[places] = listed(finer)[:count]
    shown.reshape(-1, 4)[places] = listed(programs.shown(finer))[:count]
    return light, shown, 1.0 + film.MORE_SAMPLES * count / (size[0] * size[1])


def _in_squares(wanted: NDArray[np.bool_]) -> NDArray[np.int32]:
    """Return the indices of the pixels, sorted by squares of the picture."""
    rows, columns = np.nonzero(wanted)
    across = wanted.shape[1] // _SQUARE_PX + 1
    squares = rows // _SQUARE_PX * across + columns // _SQUARE_PX
    order = np.argsort(squares, kind="stable")
    return np.asarray((rows * wanted.shape[1] + columns)[order], np.int32)


def arranged(places: NDArray[np.int32]) -> tuple[NDArray[np.int32], tuple[int, int]]:
    """Return the list of pixels that fills a grid (``film.listed_place``), and the grid's size.

    The end of the list repeats the last pixel.
    """
    # As few strips as fit the height of a picture.
    strips = -(-len(places) // (film.STRIP_PX * _HIGHEST_PX))
    height = -(-len(places) // (film.STRIP_PX * strips))
    width = film.STRIP_PX * strips
    return np.pad(places, (0, width * height - len(places)), mode="edge"), (width, height)


def listed(grid: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the pixels of a grid in the order of the list: strip by strip."""
    height, width, channels = grid.shape
    strips = grid.reshape(height, width // film.STRIP_PX, film.STRIP_PX, channels)
    return strips.swapaxes(0, 1).reshape(-1, channels)


def _part(progress: Progress | None, done: int) -> Progress | None:
    """Return the progress callback of one of the two passes, each half of the work."""
    if progress is None:
        return None
    whole = progress
    return lambda share: whole(0.5 * (done + share))
