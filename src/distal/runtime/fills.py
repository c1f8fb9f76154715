"""Fill flat shapes: one color where the shape's function is negative, another elsewhere.

Input: a function of a point in the plane, a part of the plane, and colors. Output: a ``Picture``.
A function that can be a tape is filled by the tape runtime, which compiles nothing; any other is
evaluated at every sample by its ordinary kernel. Both ways look at the same points.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.devices.base import Cancelled, cancel_test
from distal.images.picture import Picture
from distal.lang.composed import Composed
from distal.lang.render_options import RenderOptions
from distal.runtime.function_tapes import Drawing, Ready
from distal.tape.runtime import PlaneView

Floats = NDArray[np.float32]
_ROWS: Final = 64  # of pixels that the ordinary kernel evaluates at a time, to limit the memory


def fill(
    executor: Any,
    function: Composed,
    edges: Sequence[float],
    colors: Floats,
    options: RenderOptions,
    ready: Ready | None = None,
) -> Picture:
    """Fill a function of a point in the plane.

    Args:
        executor: The executor that lowers and evaluates the function.
        function: The function.
        edges: The left edge, the width of a pixel, the upper edge, and the height of a pixel.
        colors: The color of a pixel for each number of its samples that are inside, from 0 to all.
        options: Size, time, parameters, threads, progress and cancel.
        ready: Returns the function's tape, if it has one without compilation.
    """
    view = PlaneView(*edges)
    drawing = Drawing(executor, function, options, ready)
    program = drawing.program
    if program is not None:
        pixels = program.fill(
            *options.size,
            view,
            colors=colors,
            threads=options.threads,
            progress=options.progress,
            cancel=options.cancel,
        )
    else:
        pixels = _by_kernel(executor, function, view, colors, options)
    origin = drawing.finished("fill", len(colors) - 1)
    return Picture(pixels, origin, drawing.stats)


def _by_kernel(
    executor: Any, function: Composed, view: PlaneView, colors: Floats, options: RenderOptions
) -> Floats:
    """Evaluate the ordinary kernel at every sample.

    Args:
        executor: The executor.
        function: The function.
        view: The part of the plane that is shown.
        colors: The color for each number of samples inside.
        options: The options.
    """
    width, height = options.size
    across = math.isqrt(len(colors) - 1)
    shifts = (np.arange(across, dtype=np.float32) + np.float32(0.5)) / np.float32(across)
    picture = np.empty((height, width, 4), np.float32)
    is_cancelled = cancel_test(options.cancel)
    columns = np.arange(width, dtype=np.float32)
    for top in range(0, height, _ROWS):
        if is_cancelled():
            raise Cancelled
        rows = np.arange(top, min(top + _ROWS, height), dtype=np.float32)
        inside = np.zeros((len(rows), width), np.intp)
        for down in shifts:
            for right in shifts:
                x = np.float32(view.x) + (columns + right) * np.float32(view.step_x)
                y = np.float32(view.y) + (rows + down) * np.float32(view.step_y)
                points = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
                found = executor.call(
                    function, (points,), {}, params=options.params, time=options.time
                )
                inside += (found < 0.0).reshape(inside.shape)
        picture[top : top + len(rows)] = colors[inside]
        if options.progress is not None:
            options.progress(min(1.0, (top + _ROWS) / height))
    return picture
