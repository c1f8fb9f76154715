"""The CPU device: vector code on all processors, compiled once and stored in the cache.

Input: a module from the front end before any pass, then numbers. Output: pictures, and values at
points. If the cache has the kernel, no pass runs and nothing is compiled.

A new kernel runs code that LLVM generated without optimization, in half of the time; the optimized
code computes the same bits, is compiled beside, and takes over between two tiles.
"""

from __future__ import annotations

import importlib
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.backends.llvm import TARGET, emit_modules
from distal.backends.llvm.layout import (
    BATCH,
    FRAME,
    JOB_FIELDS,
    LEAVE,
    PIXELS,
    RENDER,
    RESOURCE_BYTES,
    TILE_BLOCKS,
    TILE_HEIGHT,
    TILE_WIDTH,
    kinds_in,
)
from distal.devices import cpu_memory, threads
from distal.devices.background import ONE_AT_A_TIME, UNINTERRUPTED, BackgroundWork
from distal.devices.base import Cancel, Progress, Values
from distal.devices.cache import Cache, default_folder
from distal.devices.executable import Executable
from distal.devices.features import chosen_level
from distal.devices.kernel_key import is_level_named, optimization
from distal.devices.memory_limit import is_limited
from distal.devices.object_files import ObjectFiles
from distal.devices.pool import PICTURES
from distal.devices.resources import load
from distal.ir.collection import paused_collection
from distal.ir.nodes import Module
from distal.ir.printer import print_identity
from distal.ir.target import Target
from distal.ir.types import Buffer, Texture, Type

RunPasses = Callable[[Module, Target, int], Module]

# Parts of a picture begin at multiples of so many rows.
ROWS: Final = TILE_HEIGHT
_PLAIN: Final = 0  # LLVM's level of code generation for a new kernel's first code
# A program that draws a few small pictures ends before, or has both processors until then.
_DELAY_S: Final = 1.0
# On two busy processors the optimizing process has a quarter of one.
_NICENESS: Final = 5
_LARGEST_SIDE: Final = 32768  # pixels; a picture's size in bytes fits 64 bits on all systems


def prepare(
    module: Module,
    passes: RunPasses | None = None,
    precision: int = 32,
    features: str | None = None,
    cache: Cache | None = None,
    *,
    is_long: bool = False,
) -> CpuKernel:
    """Compile a module, or load its kernel from the cache.

    Args:
        module: A module from the front end, before any pass.
        passes: Runs the passes for a target and a precision; None: ``compiler.run_passes``.
        precision: Bits of a float, 32 or 64.
        features: The name of a CPU feature level; None: the best one of this processor.
        cache: Where kernels are stored; None: the user's folder.
        is_long: Whether the first run takes longer than the compiler: optimized code runs at once.

    Raises:
        CompileError: The CPU cannot run the scene.
        ValueError: This processor does not have the feature level.
    """
    started = time.perf_counter()
    level = chosen_level(features)
    cache = Cache(default_folder()) if cache is None else cache
    files = ObjectFiles(level, precision, print_identity(module), cache)
    best = optimization()
    quick = _PLAIN if not is_long and _is_tiered() else best
    llvm_level, objects = best, files.load(best)
    if not objects and quick != best:
        llvm_level, objects = quick, files.load(quick, with_texts=True)
    hit = bool(objects)
    if not hit:
        passes = passes or importlib.import_module("distal.compiler.driver").run_passes
        shaped, lanes = passes(module, TARGET, precision), level.lanes(precision)
        with paused_collection():
            texts, interface = emit_modules(shaped, lanes, most=threads.usable_threads())
        files.texts, files.interface = texts, {**interface, "lanes": lanes.count}
        llvm_level, objects = _new(files, best, quick)
    lanes = files.interface["lanes"]
    stats = {
        "device": "cpu",
        "level": level.name,
        "lanes": lanes,
        "precision": precision,
        "cache_hit": hit,
        "optimization": llvm_level,
        "compile_s": time.perf_counter() - started,
    }
    types = {r.name: r.type for r in module.resources}
    code = _LoadedCode(Executable(*objects), llvm_level)
    kernel = CpuKernel(code, files.interface, precision, lanes, stats, types)
    if llvm_level != best:
        kernel.optimize(files, best, quick)
    return kernel


def _new(files: ObjectFiles, best: int, quick: int) -> tuple[int, Sequence[bytes]]:
    """Return a level and the object files of new modules; those of the best level are stored."""
    objects = files.compiled(best)  # an unchanged module of a changed scene or compiler
    if not objects and quick != best:
        return quick, files.compile(quick)
    objects = objects or files.compile(best)
    files.store(best)
    return best, objects


def _is_tiered() -> bool:
    """Return whether a new kernel's first code is not optimized.

    With one processor, or little memory, the other code would wait for it; a frozen program cannot
    start Python.
    """
    can_start_python = bool(sys.executable) and not hasattr(sys, "frozen")
    several = threads.usable_threads() > 1
    return not is_level_named() and several and can_start_python and not is_limited()


# Kernels as callable functions


class _LoadedCode:
    """The functions of object files in memory.

    Attributes:
        llvm_level: LLVM's level of code generation that made them.
        is_pixelwise: Whether they map pixels in a picture's memory layout.
        main: The kernel.
        frame: The part that runs once for each frame.
    """

    def __init__(self, executable: Executable, llvm_level: int) -> None:
        self.llvm_level = llvm_level
        self.is_pixelwise = PIXELS in executable
        (main,) = (name for name in (RENDER, PIXELS, BATCH) if name in executable)
        self.main = executable.function(main)
        self.frame = executable.function(FRAME) if FRAME in executable else None


class CpuKernel:
    """A compiled module in memory; see ``distal.devices.base.Kernel``."""

    def __init__(
        self,
        code: _LoadedCode,
        interface: dict[str, Any],
        precision: int,
        lanes: int,
        stats: dict[str, Any],
        resource_types: dict[str, Type],
    ) -> None:
        self.stats = stats
        self._resource_types = resource_types
        self._code = code
        self._optimizing: BackgroundWork | None = None
        self._running: set[_KernelCall] = set()
        self._interface = interface
        self._precision = precision
        self._lanes = lanes
        self._image = interface["kind"] == "image"
        self._uniforms = cpu_memory.UniformSlots(
            interface["uniforms"], interface["uniform_slots"], precision
        )

    def optimize(self, files: ObjectFiles, best: int, plain: int) -> None:
        """Compile optimized code in the background; it is stored, and then takes over.

        Args:
            files: The kernel's object files.
            best: LLVM's level of the optimized code.
            plain: That of the code that runs until then.
        """

        def work() -> None:
            files.store(plain, with_texts=True)  # for a process that begins before the end
            time.sleep(_DELAY_S)
            with ONE_AT_A_TIME:
                objects = files.compile(best, niceness=_NICENESS)
            with UNINTERRUPTED:
                code = _LoadedCode(Executable(*objects), best)
            files.store(best)
            files.discard(plain)
            self.take(code)

        self._optimizing = BackgroundWork(work, "optimizing a kernel")

    def take(self, code: _LoadedCode) -> None:
        """Run other code of the same kernel from the next tile on."""
        self._code = code
        for call in list(self._running):
            call.leave()

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
        """Render a picture; arguments as for ``Kernel.render``."""
        return self.render_rows(
            (width, height),
            (0, height),
            uniforms,
            resources,
            threads=threads,
            progress=progress,
            cancel=cancel,
        )

    def render_rows(
        self,
        size: tuple[int, int],
        rows: tuple[int, int],
        uniforms: Mapping[str, Any],
        resources: Mapping[str, Any],
        *,
        threads: int | None = None,
        progress: Progress | None = None,
        cancel: Cancel | None = None,
    ) -> NDArray[np.float32]:
        """Render some rows of a picture, with the same bits as in the whole picture.

        Args:
            size: Width and height of the whole picture in pixels.
            rows: The first row, a multiple of ``ROWS``, and the row after the last one, another
                multiple or the height.
            uniforms: As for ``Kernel.render``.
            resources: As for ``Kernel.render``.
            threads: As for ``Kernel.render``.
            progress: As for ``Kernel.render``.
            cancel: As for ``Kernel.render``.
        """
        assert self._image, "a function has no picture"
        (width, height), (top, bottom) = size, rows
        if not (0 < width <= _LARGEST_SIDE and 0 < height <= _LARGEST_SIDE):
            raise ValueError(f"a picture is 1x1 to {_LARGEST_SIDE}x{_LARGEST_SIDE} pixels")
        assert top % ROWS == 0 and (bottom % ROWS == 0 or bottom == height)
        picture = PICTURES.take((bottom - top, width, 4))
        across = -(-width // TILE_WIDTH)
        first, end = across * (top // TILE_HEIGHT), across * -(-bottom // TILE_HEIGHT)
        job = _KernelCall(self, uniforms, resources, picture)
        job.counter[0] = first
        # The kernel writes where the rows would be in the whole picture.
        job.set(output=picture.ctypes.data - top * width * 16, width=width, height=height)
        job.set(tiles_across=across, tiles=end)
        self._run(job, end, threads, progress, cancel)
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
        here: bool = False,
    ) -> Values:
        """Return values at points; arguments as for ``Kernel.evaluate``.

        With ``here``, the calling thread computes them: it is faster for short functions at a few
        thousand points, and cannot be stopped.
        """
        assert not self._image, "an image has no points"
        points = cpu_memory.shared_length(args)
        if self._code.is_pixelwise and points:
            rows = np.asarray(args[0], np.float32)
            return self._mapped(rows, uniforms, resources, threads, progress, cancel)
        stride = -(-points // self._lanes) * self._lanes
        shapes = [shape for _, shape in self._interface["params"]]
        source = cpu_memory.pack_points(shapes, args, points, stride, self._precision)
        shape = self._interface["result"]
        runs = max(1, len(kinds_in(shape)))
        target = np.empty(runs * stride, cpu_memory.float_type(self._precision))
        tiles = -(-stride // (TILE_BLOCKS * self._lanes))
        job = _KernelCall(self, uniforms, resources, source, target)
        job.set(input=source.ctypes.data, output=target.ctypes.data, width=stride)
        job.set(tiles=tiles, stride=stride)
        if here and stride:
            code = self._code
            if code.frame is not None:
                code.frame(job.address())
            code.main(job.address())
        elif stride:
            self._run(job, tiles, threads, progress, cancel)
        return cpu_memory.unpack_points(shape, target, points, stride)

    def map_pixels(
        self,
        pixels: NDArray[np.float32],
        uniforms: Mapping[str, Any],
        resources: Mapping[str, Any],
        *,
        threads: int | None = None,
        cancel: Cancel | None = None,
    ) -> NDArray[np.float32]:
        """Apply the function to every pixel; arguments as for ``Kernel.map_pixels``."""
        values = self.evaluate(
            [pixels.reshape(-1, 4)], uniforms, resources, threads=threads, cancel=cancel
        )
        return np.asarray(values, np.float32).reshape(pixels.shape)

    def _mapped(
        self,
        pixels: NDArray[np.float32],
        uniforms: Mapping[str, Any],
        resources: Mapping[str, Any],
        count: int | None,
        progress: Progress | None,
        cancel: Cancel | None,
    ) -> NDArray[np.float32]:
        """Map rows of four floats to rows of four floats, without a change of layout."""
        short = self._lanes - len(pixels)
        if short > 0:  # a kernel computes at least one block
            pixels = np.pad(pixels, ((0, short), (0, 0)), mode="edge")
        source, target = np.ascontiguousarray(pixels), PICTURES.take(pixels.shape)
        tiles = -(-len(pixels) // (TILE_BLOCKS * self._lanes))
        job = _KernelCall(self, uniforms, resources, source, target)
        job.set(input=source.ctypes.data, output=target.ctypes.data)
        job.set(width=len(pixels), tiles=tiles)
        self._run(job, tiles, count, progress, cancel)
        return target[:-short] if short > 0 else target

    def _run(
        self,
        job: _KernelCall,
        pieces: int,
        count: int | None,
        progress: Progress | None,
        cancel: Cancel | None,
    ) -> None:
        started = time.perf_counter()
        if self._optimizing is not None:
            self._optimizing.check()
        self._run_frame(job, cancel)
        work = threads.Work(job.counter, job.stop, pieces)

        levels: list[int] = []  # of the code that each thread ended with

        def compute() -> None:
            code = self._code
            code.main(job.address())
            if job.stop[0] == LEAVE:
                code = self._code
                code.main(job.address(1))
            levels.append(code.llvm_level)

        self._running.add(job)
        try:
            used = threads.run(work, compute, count, progress, cancel)
        finally:
            self._running.discard(job)
        self.stats["threads"] = used
        self.stats["optimization"] = max(levels)
        self.stats["render_s"] = time.perf_counter() - started

    def _run_frame(self, job: _KernelCall, cancel: Cancel | None) -> None:
        """Run the per-frame part: directly, or in a watched thread if it may be long or large."""
        frame = self._code.frame
        if frame is None:
            return
        if self._interface["frame_apart"]:
            work = threads.Work(job.counter, job.stop, 1)
            threads.run(work, lambda: frame(job.address()), 1, None, cancel)
        else:
            frame(job.address())


class _KernelCall:
    """The memory of one run; it must exist as long as a thread may access it.

    It is two jobs that differ in their stop flags: the second one is for the code that takes over.
    """

    def __init__(
        self,
        kernel: CpuKernel,
        uniforms: Mapping[str, Any],
        resources: Mapping[str, Any],
        *held: NDArray[Any],
    ) -> None:
        self._held = held
        interface, precision = kernel._interface, kernel._precision
        self.words = np.zeros((2, len(JOB_FIELDS)), np.int64)
        self.counter = np.zeros(1, np.int32)
        self.stop = np.zeros(2, np.int32)
        self._uniforms = kernel._uniforms.packed(uniforms)
        self._frame = np.zeros(max(1, interface["frame_slots"]), cpu_memory.float_type(precision))
        rows = interface["resources"]
        self._resources = np.zeros((max(1, len(rows)), RESOURCE_BYTES // 8), np.int64)
        self._data = []
        for i, row in enumerate(rows):
            array = _array(resources[row[0]], kernel._resource_types[row[0]])
            slots, sizes = cpu_memory.pack_resource(row, array, precision)
            self._data.append(slots)
            self._resources[i] = (slots.ctypes.data, *sizes)
        self.set(
            counter=self.counter.ctypes.data,
            stop=self.stop.ctypes.data,
            uniforms=self._uniforms.ctypes.data,
            frame=self._frame.ctypes.data,
            resources=self._resources.ctypes.data,
        )
        self.words[1, JOB_FIELDS.index("stop")] += self.stop.itemsize

    def address(self, job: int = 0) -> int:
        """Return the pointer that a kernel is called with, of the first or the second job."""
        return int(self.words[job].ctypes.data)

    def leave(self) -> None:
        """End the first job after its current tiles, unless it is stopped."""
        if self.stop[0] == 0:
            self.stop[0] = LEAVE

    def set(self, **fields: int) -> None:
        """Set fields of the job."""
        for name, value in fields.items():
            self.words[:, JOB_FIELDS.index(name)] = value


def _array(source: Any, type: Type) -> NDArray[Any]:
    """Return a resource's array; an array is returned unchanged (texels in index order)."""
    if isinstance(source, np.ndarray):
        return source
    assert isinstance(type, Texture | Buffer)
    return load(source, type)
