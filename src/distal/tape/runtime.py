"""Run tapes: load the runtime's machine code, and call it.

Input: tapes. Output: filled pictures, values at points, intervals of boxes. The code is compiled
once for a machine and then comes from the cache; it does not depend on the tapes.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.devices import threads as pool
from distal.devices.base import Cancel, Progress
from distal.devices.cache import Cache, default_folder
from distal.devices.executable import Executable
from distal.devices.features import CpuLevel, chosen_level
from distal.devices.jit import compile_object
from distal.devices.kernel_key import kernel_key
from distal.devices.pool import PICTURES
from distal.forking import new_lock
from distal.tape.layout import (
    ALLOCATE,
    CELLS,
    FILL,
    FLOATS,
    GRADIENTS,
    HEIGHTS,
    INTERVAL_SLOT,
    INTERVALS,
    JOB_FIELDS,
    LANES,
    POINTS,
    PRUNE,
    TILE,
    TRACE,
    workspace,
)
from distal.tape.tape import Tape

Floats = NDArray[np.float32]
_KEY: Final = "tape runtime"
_LARGEST_SIDE: Final = 32768  # pixels
MOST_LAYERS: Final = 4096  # a column of first cells is at most 64 deep
_GROUPS: Final = 8  # for each thread


@dataclass(frozen=True, slots=True)
class PlaneView:
    """The part of the plane that a picture shows.

    Attributes:
        x: The left edge of the picture, in scene units.
        step_x: The width of a pixel.
        y: The upper edge of the picture.
        step_y: The height of a pixel; negative, if y points up.
        z: The third coordinate, the same in the whole picture.
    """

    x: float
    step_x: float
    y: float
    step_y: float
    z: float = 0.0


@dataclass(frozen=True, slots=True)
class VolumeView:
    """Parallel rays through a box of samples.

    The sample in column c, row r and layer l is at ``corner + (c + 0.5) column + (r + 0.5) row +
    (l + 0.5) layer``. Layers are numbered from the front; l = 0 is passed first.

    Attributes:
        corner: The upper left corner of the front, in scene units.
        column: From one column to the next.
        row: From one row to the next, downwards.
        layer: From one layer to the next.
        front: The height of the front: what is written there.
        step: The change of height from one layer to the next.
    """

    corner: Sequence[float]
    column: Sequence[float]
    row: Sequence[float]
    layer: Sequence[float]
    front: float = 0.0
    step: float = 1.0

    def numbers(self) -> Floats:
        """Return the numbers as the runtime reads them."""
        places = np.array([self.corner, self.column, self.row, self.layer], np.float32)
        rest = np.array([self.front, self.step, np.nan], np.float32)
        return np.concatenate([places.T.reshape(-1), rest])


class TapeProgram:
    """A tape that is ready to run, with the memory that its runs need.

    Attributes:
        tape: The tape.
        slots: The number of values that are in use at the same time, at most.
    """

    def __init__(self, tape: Tape, level: CpuLevel | None = None) -> None:
        self.tape = tape
        self._code = _code(level or chosen_level())
        self._operations = np.ascontiguousarray(tape.operations, np.uint16)
        self._allocated = np.empty_like(self._operations)
        constants = tape.constants if len(tape.constants) else np.zeros(1, np.float32)
        self._constants = np.ascontiguousarray(constants, np.float32)
        self._memory: NDArray[np.uint8] = np.empty(0, np.uint8)
        self._lock = new_lock()
        self.slots = self._allocate()
        offsets, self._bytes = workspace(len(tape), self.slots)
        self._offsets = np.array(list(offsets.values()), np.int64)

    def fill(
        self,
        width: int,
        height: int,
        view: PlaneView,
        *,
        colors: Any = ((0.0, 0.0, 0.0, 1.0), (1.0, 1.0, 1.0, 1.0)),
        threads: int | None = None,
        progress: Progress | None = None,
        cancel: Cancel | None = None,
    ) -> Floats:
        """Return a picture (height, width, 4) that shows where the tape is negative.

        Args:
            width: Pixels across, 1 to 32768.
            height: Pixels down, 1 to 32768.
            view: The part of the plane that is shown.
            colors: The color of a pixel for each number of its samples that are inside, (n + 1, 4).
                A pixel has n samples, a square number.
            threads: The number of threads; None uses all processors of this process.
            progress: Called regularly with the fraction of the work that is done.
            cancel: Called regularly; True stops the work.

        Raises:
            ValueError: A size or the number of colors is out of range.
            Cancelled: ``cancel`` stopped the work.
        """
        if not (0 < width <= _LARGEST_SIDE and 0 < height <= _LARGEST_SIDE):
            raise ValueError(f"a picture is 1x1 to {_LARGEST_SIDE}x{_LARGEST_SIDE} pixels")
        shades = np.ascontiguousarray(colors, np.float32).reshape(-1, 4)
        samples = math.isqrt(len(shades) - 1)
        if samples < 1 or samples**2 != len(shades) - 1:
            raise ValueError(f"the samples of a pixel are a square number, not {len(shades) - 1}")
        picture = PICTURES.take((height, width, 4))
        numbers = np.array([view.x, view.step_x, view.y, view.step_y, view.z], np.float32)
        groups = -(-(-(-width // TILE) * -(-height // TILE)) // LANES)
        count = min(threads or pool.usable_threads(), groups)
        with self._lock:
            job = _RuntimeJob(self, count)
            job.set(output=picture.ctypes.data, width=width, height=height, samples=samples)
            job.set(view=numbers.ctypes.data, colors=shades.ctypes.data)
            work = pool.Work(job.counter, job.stop, groups)
            fill = self._code.function(FILL)
            pool.run(work, lambda: fill(job.address()), count, progress, cancel)
        return picture

    def heights(
        self,
        size: tuple[int, int, int],
        view: VolumeView,
        *,
        threads: int | None = None,
        progress: Progress | None = None,
        cancel: Cancel | None = None,
    ) -> Floats:
        """Return the first surface along the rays of a picture, (height, width, 4).

        The surface is where the first sample with a negative value is. The four numbers of a pixel
        are its normal, of length 1 or 0, and its height; 0 and NaN where there is no surface.

        Args:
            size: Columns, rows and layers; 1 to 32768, the layers to 4096.
            view: Where the samples are.
            threads: The number of threads; None uses all processors of this process.
            progress: Called regularly with the fraction of the work that is done.
            cancel: Called regularly; True stops the work.

        Raises:
            ValueError: A size is out of range.
            Cancelled: ``cancel`` stopped the work.
        """
        width, height, depth = size
        if not (0 < width <= _LARGEST_SIDE and 0 < height <= _LARGEST_SIDE):
            raise ValueError(f"a picture is 1x1 to {_LARGEST_SIDE}x{_LARGEST_SIDE} pixels")
        if not 0 < depth <= MOST_LAYERS:
            raise ValueError(f"there are 1 to {MOST_LAYERS} layers, not {depth}")
        picture = PICTURES.take((height, width, 4))
        numbers = view.numbers()
        side = CELLS[0]
        columns, deep = -(-width // side) * -(-height // side), -(-depth // side)
        most = threads or pool.usable_threads()
        # Groups are small enough that every thread has several.
        together = max(1, min(LANES // deep, columns // (_GROUPS * most)))
        groups = -(-columns // together)
        count = min(most, groups)
        with self._lock:
            job = _RuntimeJob(self, count)
            job.set(output=picture.ctypes.data, width=width, height=height, depth=depth)
            job.set(view=numbers.ctypes.data, columns=together)
            work = pool.Work(job.counter, job.stop, groups)
            heights = self._code.function(HEIGHTS)
            pool.run(work, lambda: heights(job.address()), count, progress, cancel)
        return picture

    def gradients(self, points: NDArray[Any]) -> Floats:
        """Return the tape's values and gradients at points, (n, 4).

        Args:
            points: An array (n, 3).
        """
        rows = np.asarray(points, np.float32)
        passes = -(-len(rows) // POINTS)
        padded = np.zeros((passes * POINTS, 3), np.float32)
        padded[: len(rows)] = rows
        inputs = np.ascontiguousarray(padded.reshape(passes, POINTS, 3).transpose(0, 2, 1))
        found = np.empty((passes, 4, POINTS), np.float32)
        self._run(GRADIENTS, inputs, found, passes)
        return found.transpose(0, 2, 1).reshape(-1, 4)[: len(rows)]

    def values(self, points: NDArray[Any]) -> Floats:
        """Return the tape's values at points.

        Args:
            points: An array (n, 2) or (n, 3); without a third column, z is 0.
        """
        rows = np.asarray(points, np.float32)
        count = len(rows)
        if count == 0:
            return np.zeros(0, np.float32)
        passes = -(-count // LANES)
        inputs = np.zeros((passes, 3, LANES), np.float32)
        for axis in range(rows.shape[1]):
            padded = np.full(passes * LANES, rows[-1, axis], np.float32)
            padded[:count] = rows[:, axis]
            inputs[:, axis] = padded.reshape(passes, LANES)
        found = np.empty((passes, LANES), np.float32)
        self._run(FLOATS, inputs, found, passes)
        return found.reshape(-1)[:count]

    def intervals(self, low: NDArray[Any], high: NDArray[Any]) -> tuple[Floats, Floats]:
        """Return bounds of the tape's values in boxes; where an end is not finite, none is known.

        Args:
            low: The lower corners, (n, 3).
            high: The upper corners, (n, 3).
        """
        count = len(low)
        passes = -(-count // LANES)
        found = np.empty((passes, 2, LANES), np.float32)
        self._run(INTERVALS, _boxes(low, high), found, passes)
        ends = found.transpose(1, 0, 2).reshape(2, -1)[:, :count]
        return ends[0], ends[1]

    def traces(self, low: NDArray[Any], high: NDArray[Any]) -> NDArray[np.float64]:
        """Return the intervals of every operation in boxes, (operations, 2, n).

        Args:
            low: The lower corners, (n, 3).
            high: The upper corners, (n, 3); they are rounded outwards to 32 bits.
        """
        count = len(low)
        boxes = _boxes(_rounded(low, -np.inf), _rounded(high, np.inf))
        parts = []
        for box in boxes:
            found = _aligned(len(self.tape) * INTERVAL_SLOT).view(np.float32)
            self._run(TRACE, box, found, 1)
            parts.append(found.reshape(len(self.tape), 2, LANES).astype(np.float64))
        return np.concatenate(parts, axis=2)[..., :count]

    def pruned_values(
        self, low: NDArray[Any], high: NDArray[Any], points: NDArray[Any]
    ) -> tuple[Floats, NDArray[np.int64]]:
        """Return the values of the pruned tapes of 64 boxes, and the lengths of these tapes.

        Args:
            low: The lower corners, (64, 3).
            high: The upper corners, (64, 3).
            points: 64 points in each box, (64, 64, 3).
        """
        inputs = np.concatenate((
            _boxes(low, high).reshape(-1),
            np.ascontiguousarray(np.asarray(points, np.float32).transpose(0, 2, 1)).reshape(-1),
        ))  # fmt: skip
        found = np.empty(LANES * LANES + 2 * LANES, np.float32)
        self._run(PRUNE, inputs, found, 1)
        values = found[: LANES * LANES].reshape(LANES, LANES)
        return values, found[LANES * LANES :].view(np.int64)

    def _run(self, name: str, inputs: Floats, found: Floats, passes: int) -> None:
        with self._lock:
            job = _RuntimeJob(self, 1)
            aligned = _aligned(inputs.nbytes).view(np.float32)[: inputs.size]
            aligned[:] = inputs.reshape(-1)
            job.set(view=aligned.ctypes.data, output=found.ctypes.data, height=passes)
            self._code.function(name)(job.address())

    def _allocate(self) -> int:
        """Give the tape's values slots; return their number."""
        numbers = np.empty((3, len(self.tape)), np.uint16)
        found = np.zeros(1, np.int64)
        job = _RuntimeJob(self, 0)
        job.set(workspace=numbers.ctypes.data, workspace_bytes=numbers[0].nbytes)
        job.set(output=found.ctypes.data)
        self._code.function(ALLOCATE)(job.address())
        return int(found[0])


class _RuntimeJob:
    """The memory of one run; it must exist as long as a thread may access it."""

    def __init__(self, program: TapeProgram, count: int) -> None:
        self._held = program
        self.words = np.zeros(len(JOB_FIELDS), np.int64)
        self.counter, self.stop, self.workers = (np.zeros(1, np.int32) for _ in range(3))
        self.set(
            counter=self.counter.ctypes.data,
            stop=self.stop.ctypes.data,
            workers=self.workers.ctypes.data,
            constants=program._constants.ctypes.data,
            operations=program._operations.ctypes.data,
            allocated=program._allocated.ctypes.data,
            length=len(program.tape),
        )
        if count:
            if len(program._memory) < count * program._bytes:
                program._memory = _aligned(count * program._bytes)
            self.set(
                workspace=program._memory.ctypes.data,
                workspace_bytes=program._bytes,
                offsets=program._offsets.ctypes.data,
            )

    def address(self) -> int:
        """Return the pointer that a function of the runtime is called with."""
        return int(self.words.ctypes.data)

    def set(self, **fields: int) -> None:
        """Set fields of the job."""
        for name, value in fields.items():
            self.words[JOB_FIELDS.index(name)] = value


def _aligned(size: int) -> NDArray[np.uint8]:
    """Return bytes that begin at a cache line."""
    memory = np.empty(size + 64, np.uint8)
    start = -memory.ctypes.data % 64
    return memory[start : start + size]


def _rounded(corners: NDArray[Any], toward: float) -> Floats:
    """Round to 32 bits, away from the box."""
    near = np.asarray(corners).astype(np.float32)
    beyond = near > corners if toward < 0 else near < corners
    return np.where(beyond, np.nextafter(near, np.float32(toward)), near)


def _boxes(low: NDArray[Any], high: NDArray[Any]) -> Floats:
    """Return boxes as the runtime reads them: ends of x, y and z for 64 boxes after another."""
    count = len(low)
    passes = -(-count // LANES)
    boxes = np.empty((passes * LANES, 3, 2), np.float32)
    for i, corner in enumerate((low, high)):
        boxes[:count, :, i] = corner
        boxes[count:, :, i] = boxes[count - 1, :, i]
    shaped = boxes.reshape(passes, LANES, 3, 2).transpose(0, 2, 3, 1)
    return np.ascontiguousarray(shaped)


@cache
def _code(level: CpuLevel) -> Executable:
    kept = Cache(default_folder())
    key = kernel_key(level, 32, _KEY)
    found = kept.load(key)
    if found is None:
        # Imported here, because code from the cache needs none of it.
        from distal.tape.runtime_text import runtime_text  # noqa: PLC0415

        found = compile_object(runtime_text(level.lanes(32)), level)
        kept.store(key, found)
    return Executable(found)
