"""Run shapes as tapes: fills, heights of solids, and what can be proved of slopes.

Input: composed functions, plain values, ``RenderOptions``. Output: pictures, height maps, bounds.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from distal.at_once import cached_property
from distal.images.picture import Picture
from distal.lang.composed import Composed
from distal.lang.lazy_module import LazyModule
from distal.lang.render_options import RenderOptions
from distal.runtime.standard_executor import StandardExecutor

if TYPE_CHECKING:
    from distal.images.height_map import HeightMap
    from distal.runtime import fills, function_tapes, heights, number_slopes
    from distal.tape import box_tape, proofs
    from distal.tape.proofs import Proof, Refutation
else:
    fills = LazyModule("distal.runtime.fills")
    function_tapes = LazyModule("distal.runtime.function_tapes")
    heights = LazyModule("distal.runtime.heights")
    number_slopes = LazyModule("distal.runtime.number_slopes")
    box_tape = LazyModule("distal.tape.box_tape")
    proofs = LazyModule("distal.tape.proofs")


class TapeExecutor(StandardExecutor):
    """Runs shapes as tapes; keeps the tapes until the process ends."""

    @cached_property
    def tapes(self) -> function_tapes.FunctionTapes:
        """The tapes of shapes."""
        return function_tapes.FunctionTapes()

    def fill(
        self,
        shape: Composed,
        view: Sequence[float],
        colors: Sequence[Sequence[float]],
        options: RenderOptions,
        ready: function_tapes.Ready | None = None,
    ) -> Picture:
        """Fill a flat shape with one color, and what is around it with another.

        Args:
            shape: The shape.
            view: The left edge of the picture, the width of a pixel, the upper edge, and the height
                of a pixel, which is negative.
            colors: The display values of a pixel for each number of samples inside, 0 to all.
            options: Size, time, parameters, threads, progress and cancel.
            ready: Returns the shape's tape, if it has one without compilation.
        """
        shades = np.array(colors, np.float32)
        return fills.fill(self, shape, view, shades, options, ready)

    def heights(
        self,
        shape: Composed,
        gradient: Composed,
        view: heights.RayView,
        options: RenderOptions,
        ready: function_tapes.Ready | None = None,
    ) -> HeightMap:
        """Return the first surface of a solid along parallel rays.

        Args:
            shape: The shape.
            gradient: Its gradient.
            view: Where the rays are.
            options: Size, time, parameters, threads, progress and cancel.
            ready: Returns the shape's tape, if it has one without compilation.
        """
        return heights.heights(self, shape, gradient, view, options, ready)

    def prove(
        self,
        function: Composed,
        low: Sequence[float],
        high: Sequence[float],
        params: Mapping[str, Any] | None = None,
        time: float = 0.0,
        most: int | None = None,
    ) -> Proof:
        """Return a bound on the slope of a function of a point, and a box, within a region.

        Args:
            function: The function; its numbers have their defaults.
            low: The lower corner of the region.
            high: Its upper corner.
            params: Values of parameters by name. None: the function may depend on none, nor on the
                time.
            time: The time in seconds.
            most: The largest number of operations of the function; None has no limit.

        Raises:
            TapeError: Nothing can be proved; the message says why.
        """
        tape = function_tapes.tape_for(self.lowered(function), params, time)
        return proofs.prove(tape, low, high, most)

    def added_slope(
        self,
        numbers: Composed,
        shape: Composed,
        changes: Sequence[float | None],
        unknown: number_slopes.Unknown,
        inner: Sequence[number_slopes.Inner],
        region: tuple[Sequence[float], Sequence[float]],
        *,
        own: bool,
    ) -> float:
        """Return by how much a shape is steeper at most because its numbers differ by place.

        Args:
            numbers: The numbers, as a function of the point and of unknown values.
            shape: The shape, as a function of the point, the numbers, the unknown values, and the
                values of the shapes below it.
            changes: How much the value changes for each unit of each number, where that is known.
            unknown: The ends of the components of the unknown values.
            inner: What is known of the shapes below it.
            region: The corners of the region.
            own: Whether the shape is a function of the author.

        Raises:
            TapeError: No bound is known; the message says why.
        """
        lowered = self.lower(numbers, None), self.lower(shape, None)
        what = number_slopes.VaryingShape(*lowered, changes, unknown, inner, own)
        return number_slopes.added_slope(what, *region)

    def box_tape(
        self, function: Composed, params: Mapping[str, Any] | None = None, time: float = 0.0
    ) -> box_tape.BoxTape:
        """Return a function of a point as a tape that is evaluated over boxes, in 64 bits.

        Args:
            function: The function; its numbers have their defaults.
            params: Values of parameters by name; the others have their defaults.
            time: The time in seconds.

        Raises:
            TapeError: The function cannot be a tape; the message says why.
        """
        lowered = self.lowered(function)
        tape = function_tapes.tape_for(lowered, params or {}, time, precision=64)
        return box_tape.BoxTape.of(tape)

    def refute(
        self,
        function: Composed,
        slope: float,
        region: tuple[Sequence[float], Sequence[float]],
        params: Mapping[str, Any] | None = None,
        time: float = 0.0,
    ) -> Refutation | None:
        """Return a place where a function is certainly steeper than a slope, if one is found.

        Args:
            function: The function; its numbers have their defaults.
            slope: The slope.
            region: The corners of the region.
            params: Values of parameters by name, as for ``prove``.
            time: The time in seconds.

        Raises:
            TapeError: Nothing can be said of the function's slope; the message says why.
        """
        tape = function_tapes.tape_for(self.lowered(function), params, time)
        return proofs.refute(tape, slope, *region)
