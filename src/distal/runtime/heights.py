"""Find the first surface of a solid along parallel rays.

Input: a function of a point in space, its gradient, and where the rays are. Output: a
``HeightMap``. A function that can be a tape is evaluated by
the tape runtime; any other at every sample in front of a surface, by its ordinary kernel. Both ways
look at the same samples.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.devices.base import Cancelled, cancel_test
from distal.images.height_map import HeightMap
from distal.lang.composed import Composed
from distal.lang.render_options import RenderOptions
from distal.render.between_samples import surface_between
from distal.runtime.function_tapes import Drawing, Ready
from distal.tape.runtime import VolumeView

Floats = NDArray[np.float32]
_POINTS: Final = 2**18  # that the ordinary kernel evaluates at a time, to limit the memory


@dataclass(frozen=True, slots=True)
class RayView:
    """Where the rays of a picture are, in scene units; see ``VolumeView``.

    Attributes:
        corner: The upper left corner of the front.
        column: From one column to the next.
        row: From one row to the next, downwards.
        layer: From one sample of a ray to the next.
        layers: The number of samples of a ray.
        front: The height of the front.
        step: The change of height from one layer to the next.
    """

    corner: Sequence[float]
    column: Sequence[float]
    row: Sequence[float]
    layer: Sequence[float]
    layers: int
    front: float
    step: float


def heights(
    executor: Any,
    function: Composed,
    gradient: Composed,
    view: RayView,
    options: RenderOptions,
    ready: Ready | None = None,
) -> HeightMap:
    """Return the first surface along parallel rays.

    Args:
        executor: The executor that lowers and evaluates the function.
        function: The function.
        gradient: Its gradient.
        view: Where the rays are.
        options: Size, time, parameters, threads, progress and cancel.
        ready: Returns the function's tape, if it has one without compilation.
    """
    drawing = Drawing(executor, function, options, ready)
    program = drawing.program
    if program is not None:
        found = program.heights(
            (*options.size, view.layers),
            _volume(view),
            threads=options.threads,
            progress=options.progress,
            cancel=options.cancel,
        )
    else:
        found = _SampledRays(executor, view, options).found(function, gradient)
    origin = drawing.finished("heights", 1)
    return HeightMap(found[..., 3], found[..., :3], origin, drawing.stats)


def _volume(view: RayView) -> VolumeView:
    return VolumeView(view.corner, view.column, view.row, view.layer, view.front, view.step)


class _SampledRays:
    """Evaluates the ordinary kernel at the samples of rays, layer by layer.

    Args:
        executor: The executor.
        view: Where the rays are.
        options: The options.
    """

    def __init__(self, executor: Any, view: RayView, options: RenderOptions) -> None:
        self._executor, self._view, self._options = executor, view, options
        numbers = (view.corner, view.column, view.row, view.layer)
        self._corner, self._column, self._row, self._layer = np.array(numbers, np.float32)

    def found(self, function: Composed, gradient: Composed) -> Floats:
        """Return normals and heights, (height, width, 4).

        Args:
            function: The function.
            gradient: Its gradient.

        Raises:
            Cancelled: ``options.cancel`` stopped the work.
        """
        width, height = self._options.size
        result = np.zeros((height * width, 4), np.float32)
        result[:, 3] = np.nan
        rest = np.arange(height * width)
        is_cancelled = cancel_test(self._options.cancel)
        for layer in range(self._view.layers):
            if is_cancelled():
                raise Cancelled
            if len(rest) == 0:
                break
            place = np.float32(layer) + np.float32(0.5)
            values = self._evaluate(function, self._points(rest, place))
            inside = values < 0.0
            hits = rest[inside]
            if len(hits):
                slopes = self._evaluate(gradient, self._points(hits, place))
                along = np.broadcast_to(self._layer, slopes.shape)
                places = np.full(len(hits), place, np.float32)
                arguments = (values[inside], slopes, along, places)
                result[hits] = self._executor.call(surface_between, arguments, {})
            rest = rest[~inside]
            if self._options.progress is not None:
                self._options.progress((layer + 1) / self._view.layers)
        result[:, 3] = np.float32(self._view.front) + result[:, 3] * np.float32(self._view.step)
        return result.reshape(height, width, 4)

    def _points(self, pixels: NDArray[np.intp], place: np.float32) -> Floats:
        """Return the samples of some rays in a layer, as the tape runtime computes them."""
        rows, columns = np.divmod(pixels, self._options.size[0])
        half = np.float32(0.5)
        across = (columns.astype(np.float32) + half)[:, None] * self._column
        down = (rows.astype(np.float32) + half)[:, None] * self._row
        found: Floats = self._corner + across + down + place * self._layer
        return found

    def _evaluate(self, function: Composed, points: Floats) -> Floats:
        options = self._options
        parts = [
            self._executor.call(
                function, (points[at : at + _POINTS],), {}, params=options.params, time=options.time
            )
            for at in range(0, len(points), _POINTS)
        ]
        return np.concatenate(parts)
