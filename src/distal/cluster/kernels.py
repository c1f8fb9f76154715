"""A kernel whose pictures are rendered by many workers, rows by rows, and values part by part.

Input: a pool, a lowered program, uniforms and arrays. Output: the pixels or values that the CPU
device of this machine would compute.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.cluster import whole_pictures, work
from distal.cluster.errors import ClusterError
from distal.cluster.parts import SentParts
from distal.cluster.pool import SUBMITTED, WorkerPool, pool_of
from distal.cluster.programs import Plain, Sent, lowered_as_sent
from distal.cluster.sizes import PartSizes, Range
from distal.devices.base import Cancel, PartError, Progress, Values, cancel_test
from distal.devices.cpu import ROWS
from distal.images.picture import Picture
from distal.lang.composed import Composed
from distal.lang.functions import Image
from distal.lang.render_options import RenderOptions
from distal.runtime.lowered import Lowered

# The smallest parts while nothing is known of a program: a task costs about a millisecond, and so
# do as many pixels of the fastest pictures, and as many photons that end at once.
_LEAST_PIXELS: Final = 2**14
_LEAST_POINTS: Final = 2**13


class ClusterKernel:
    """A program's kernel; see ``distal.devices.base.Kernel``."""

    def __init__(self, pool: WorkerPool, lowered: Lowered) -> None:
        self.stats: dict[str, Any] = {"device": "cluster", "workers": pool.slots}
        self._pool = pool
        self._sent: Sent = lowered_as_sent(lowered)
        self._own = lowered.resources

    def render(
        self,
        width: int,
        height: int,
        uniforms: Mapping[str, Any],
        resources: Mapping[str, Any],
        *,
        threads: int | None = None,
        progress: Progress | None = None,
        cancel: Cancel | None = None,
    ) -> NDArray[np.float32]:
        """Render a picture; arguments as for ``Kernel.render``; ``threads`` is not used."""
        begin = time.perf_counter()
        least = max(1, -(-_LEAST_PIXELS // width))
        sizes = self._pool.sizes((self._sent.digest, width, height), least, ROWS)
        begun = self._submitting(work.rows, uniforms, resources, size=(width, height))
        ranges = sizes.ranges(height, self._pool.slots)
        parts = SentParts(self._pool, begun, ranges, _rows)
        picture = np.empty((height, width, 4), np.float32)
        for numbers, found in self._made(parts, sizes, cancel):
            top, bottom = numbers
            if found.shape[0] != bottom - top:
                raise ClusterError(f"{_rows(numbers)} has another size")
            picture[top:bottom] = found
            if progress is not None:
                progress(1.0 - len(parts.waiting) / parts.count)
        self.stats["render_s"] = time.perf_counter() - begin
        return picture

    def evaluate(
        self,
        args: Sequence[Values],
        uniforms: Mapping[str, Any],
        resources: Mapping[str, Any],
        *,
        threads: int | None = None,
        progress: Progress | None = None,
        cancel: Cancel | None = None,
    ) -> Values:
        """Return values at points; arguments as for ``Kernel.evaluate``, each of them an array."""
        arrays = [np.asarray(each) for each in args]
        count = max(len(array) for array in arrays)
        sizes = self._pool.sizes((self._sent.digest,), _LEAST_POINTS, 1)

        def given(numbers: Range) -> Plain:
            first, end = numbers
            return {"args": [a if len(a) == 1 else a[first:end] for a in arrays]}

        begun = self._submitting(work.values, uniforms, resources, of_part=given)
        parts = SentParts(self._pool, begun, sizes.ranges(count, self._pool.slots), _points)
        found = dict(self._made(parts, sizes, cancel))
        values: Values = _joined([found[numbers] for numbers in sorted(found)])
        return values

    def _submitting(
        self,
        function: Callable[..., Any],
        uniforms: Mapping[str, Any],
        resources: Mapping[str, Any],
        of_part: Callable[[Range], Plain] = lambda numbers: {"rows": numbers},
        **of_all: Any,
    ) -> Callable[[Range], Any]:
        """Return a function that submits the task of a range.

        Args:
            function: What workers do.
            uniforms: As for ``Kernel.render``.
            resources: As for ``Kernel.render``.
            of_part: Returns what the task of a range gets besides.
            of_all: What each task gets.
        """
        pool = self._pool
        program = pool.constant(self._sent.digest, self._sent.program)
        data = pool.data_of(self._sent)
        # What is not the program's own belongs to this pass.
        arrays = {
            name: pool.array(np.asarray(found))
            for name, found in resources.items()
            if found is not self._own[name]
        }
        of_all["uniforms"] = {name: _plain(value) for name, value in uniforms.items()}

        def begun(numbers: Range) -> Any:
            call = pool.call(**of_all, **of_part(numbers))
            return pool.client.submit(
                function, program, self._sent.digest, data, arrays, call, **SUBMITTED
            )

        return begun

    def _made(
        self, parts: SentParts, sizes: PartSizes, cancel: Cancel | None
    ) -> Iterator[tuple[Range, Any]]:
        """Return the range and the values of each part as it is finished."""
        for numbers, (found, seconds, level) in parts.finished(cancel_test(cancel)):
            self._pool.saw_level(level)
            sizes.saw(numbers, seconds)
            yield numbers, found


def _rows(numbers: Range) -> str:
    return f"the part of the picture from row {numbers[0]} to {numbers[1]}"


def _points(numbers: Range) -> str:
    return f"the photons from {numbers[0]} to {numbers[1]}"


def _joined(parts: Sequence[Any]) -> Any:
    """Return the values of all parts, in order, as arrays or tuples of arrays."""
    if isinstance(parts[0], tuple):
        return tuple(_joined(each) for each in zip(*parts, strict=True))
    return np.concatenate(parts)


def kernel(cluster: Any, lowered: Lowered) -> ClusterKernel:
    """Return the kernel of a picture on the workers of a client or a pool."""
    pool = pool_of(cluster)
    pool.check()
    return ClusterKernel(pool, lowered)


def pictures(
    cluster: Any, image: Image | Composed, asked: Sequence[RenderOptions]
) -> list[Picture | PartError]:
    """Return whole pictures in 8 bits, or why they failed: see ``whole_pictures``."""
    return whole_pictures.pictures(pool_of(cluster), image, asked)


def pictures_of_task(
    cluster: Any, image: Image | Composed, options: RenderOptions, left: int
) -> int:
    """Return how many pictures are rendered together: see ``whole_pictures``."""
    return whole_pictures.of_task(pool_of(cluster), image, options, left)


def at_once(cluster: Any) -> int:
    """Return how many pictures keep the workers of a client or a pool busy."""
    return 2 * pool_of(cluster).slots


def _plain(value: Any) -> Any:
    """Return the value of a uniform as numbers and tuples."""
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, bool | int | float):
        return value
    return tuple(_plain(part) for part in value)
