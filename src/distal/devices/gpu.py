"""The GPU device: a module as WGSL, which wgpu computes or draws.

Input: a module from the front end before any pass, then numbers. Output: pictures, values at
points, or a picture drawn into a given texture. Large pictures are rendered in parts, sized by
measured time. A lost GPU raises a ``DeviceError``; the next run opens it again.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any, Final
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from distal.backends import emit, get_target
from distal.backends.base import Artifact
from distal.backends.llvm.layout import kinds_in, shape_of
from distal.backends.wgsl.functions import leaf_count
from distal.compiler.driver import run_passes
from distal.devices import cpu_memory
from distal.devices.adapters import Adapter, Gpu, chosen, opened, require_unforked
from distal.devices.base import Cancel, Cancelled, DeviceError, Progress, Values, cancel_test
from distal.devices.driver_errors import rough_names, uses_rough
from distal.devices.gpu_program import LARGEST_DISPATCH, GpuProgram
from distal.devices.long_loops import warn_of_long_loops
from distal.devices.pool import PICTURES
from distal.devices.tiles import Tile, TileSizer, tiles
from distal.forking import new_lock
from distal.ir.nodes import EntryKind, Module
from distal.ir.target import Target
from distal.ir.types import VEC4

RunPasses = Callable[[Module, Target, int], Module]

_PIXEL_BYTES: Final = 16
_FORMAT: Final = "rgba32float"
_ROW_BYTES: Final = 256  # WebGPU's alignment of a texture's rows in a buffer
_LARGEST_PART: Final = 2**26  # bytes of a part's output; the buffer to read it back is as large


def prepare(
    module: Module,
    passes: RunPasses | None = None,
    precision: int = 32,
    path: str = "compute",
    adapter: str | None = None,
) -> GpuKernel:
    """Compile a module for a GPU.

    Args:
        module: A module from the front end, before any pass.
        passes: Runs the passes for a target and a precision; None: ``compiler.run_passes``.
        precision: Bits of a float; only 32 is supported.
        path: "compute", or "fragment", which draws images; functions always use compute.
        adapter: A number or a part of a name; None: the best one.

    Raises:
        CompileError: WGSL cannot express the scene.
        DeviceError: There is no such GPU, or it rejects the program.
        ValueError: There is no such path.
    """
    if path not in ("compute", "fragment"):
        raise ValueError(f"a GPU's path is compute or fragment, not '{path}'")
    if precision != 32:
        raise DeviceError(f"a GPU computes with 32 bits, not {precision}: --device cpu")
    started = time.perf_counter()
    row = chosen(adapter)
    is_image = module.kind is EntryKind.IMAGE
    name = "wgsl" if path == "fragment" and is_image else "wgsl-compute"
    target = get_target(name)
    if uses_rough(module):
        target = replace(target, rough=_rough_names(row))
    shaped = (passes or run_passes)(module, target, precision)
    warn_of_long_loops(shaped, row)
    artifact = emit(shaped, target)
    kernel = GpuKernel(shaped, artifact, lambda: opened(row))
    kernel.stats |= {
        "device": "gpu",
        "path": "compute" if name == "wgsl-compute" else "fragment",
        "adapter": row.name,
        "backend": row.backend,
        "precision": precision,
        "cache_hit": False,
        "compile_s": time.perf_counter() - started,
    }
    return kernel


_ROUGH: Final[WeakKeyDictionary[Gpu, frozenset[str]]] = WeakKeyDictionary()


def _rough_names(row: Adapter) -> frozenset[str]:
    """Return the built-ins that an adapter's driver computes inaccurately; measured once."""
    gpu = opened(row)
    found = _ROUGH.get(gpu)
    if found is None:
        found = _ROUGH[gpu] = rough_names(lambda module, points: _drivers_own(row, module, points))
    return found


def _drivers_own(row: Adapter, module: Module, points: list[NDArray[np.float32]]) -> Values:
    """Return a function's values, computed with the driver's built-ins."""
    target = get_target("wgsl-compute")
    shaped = run_passes(module, target)
    return GpuKernel(shaped, emit(shaped, target), lambda: opened(row)).evaluate(points, {}, {})


class GpuKernel:
    """A compiled module on a GPU; see ``distal.devices.base.Kernel``.

    Attributes:
        stats: As for ``Kernel``, and ``adapter``, ``backend``, ``path``; after a run ``tiles``.
        tile_sizer: Determines the size of the parts.
    """

    def __init__(self, module: Module, artifact: Artifact, open_gpu: Callable[[], Gpu]) -> None:
        self.stats: dict[str, Any] = {"threads": 1}
        self._artifact = artifact
        self._open = open_gpu
        self._types = {r.name: r.type for r in module.resources}
        self._is_image = module.kind is EntryKind.IMAGE
        entry = module.function(module.entry)
        self._params = [] if self._is_image else [p.type for p in entry.params]
        self._result = entry.result
        leaves = max(sum(map(leaf_count, self._params)), leaf_count(self._result))
        self._point_bytes = _PIXEL_BYTES if self._is_image else 4 * max(1, leaves)
        self._lock = new_lock()
        self._program: GpuProgram | None = None
        self._ready()

    @property
    def program(self) -> GpuProgram:
        """The program on an open device; on a new device if the last one was lost."""
        return self._ready()

    def _ready(self) -> GpuProgram:
        require_unforked()
        if self._program is None or self._program.gpu.is_lost:
            gpu = self._open()
            with gpu.commands("compiling"):
                self._program = GpuProgram(gpu, self._artifact, self._types)
            most = min(
                gpu.limit("max-storage-buffer-binding-size"),
                gpu.limit("max-buffer-size"),
                _LARGEST_PART,
            )
            self.tile_sizer = TileSizer(most // self._point_bytes)
            self._memory: dict[str, Any] = {}
        return self._program

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
        """Render a picture; arguments as for ``Kernel.render``. ``threads`` is ignored.

        Raises:
            Cancelled: ``cancel`` stopped the work.
            DeviceError: The GPU was lost, or has too little memory.
        """
        assert self._is_image, "a function has no picture"
        with self._lock:
            program = self._ready()
            picture = PICTURES.take((height, width, 4))
            part = self._draw_part if "fragment" in program.interface["stages"] else self._part

            def run(encoder: Any, tile: Tile) -> None:
                program.set_uniforms(uniforms, (tile.x, tile.y, tile.width, tile.height))
                part(program, encoder, tile, picture)

            parts = tiles(width, height, self.tile_sizer)
            self._in_tiles(parts, width * height, resources, run, progress, cancel)
            return picture

    def _in_tiles(
        self,
        parts: Iterable[Tile],
        pixels: int,
        resources: Mapping[str, Any],
        run: Callable[[Any, Tile], None],
        progress: Progress | None,
        cancel: Cancel | None,
    ) -> None:
        """Render the parts of a picture one after the other, and measure the time of each.

        Args:
            parts: The parts.
            pixels: The number of pixels of all parts together.
            resources: As for ``render``.
            run: Adds the commands of a part to an encoder, submits them, and waits for the GPU.
            progress: As for ``render``.
            cancel: As for ``render``.
        """
        wanted, program, started = cancel_test(cancel), self._ready(), time.perf_counter()
        with program.gpu.commands():
            program.load(resources)
        done = count = 0
        for tile in parts:
            if wanted():
                raise Cancelled
            begin = time.perf_counter()
            with program.gpu.commands() as device:
                encoder = device.create_command_encoder()
                if count == 0:
                    program.start_frame()
                run(encoder, tile)
            self.tile_sizer.measured(tile, time.perf_counter() - begin)
            done, count = done + tile.pixels, count + 1
            if progress is not None:
                progress(done / pixels)
        if wanted():
            raise Cancelled
        self.stats["tiles"] = count
        self.stats["render_s"] = time.perf_counter() - started

    def _part(
        self, program: GpuProgram, encoder: Any, tile: Tile, picture: NDArray[np.float32]
    ) -> None:
        """Compute a part of a picture and read it back."""
        size = tile.pixels * _PIXEL_BYTES
        output = self._output(program, size)
        across, down = program.interface["workgroup"]
        groups = (-(-tile.width // across), -(-tile.height // down))
        binding = program.interface["output"]["binding"]
        # Bind the whole buffer, so that one bind group works for parts of any size.
        program.encode_compute(encoder, groups, {binding: (output, output.size)})
        rows = self._read(program, encoder, output, size)
        part = picture[tile.y : tile.y + tile.height, tile.x : tile.x + tile.width]
        part[...] = np.frombuffer(rows, np.float32).reshape(part.shape)
        self._memory["staging"].unmap()

    def _draw_part(
        self, program: GpuProgram, encoder: Any, tile: Tile, picture: NDArray[np.float32]
    ) -> None:
        """Draw a part of a picture and read it back."""
        texture, view = self._texture(program, tile)
        program.encode_draw(encoder, view, _FORMAT, (0, 0, tile.width, tile.height))
        stride = -(-tile.width * _PIXEL_BYTES // _ROW_BYTES) * _ROW_BYTES
        size = stride * tile.height
        staging = self._staging(program, size)
        encoder.copy_texture_to_buffer(
            {"texture": texture},
            {"buffer": staging, "bytes_per_row": stride, "rows_per_image": tile.height},
            (tile.width, tile.height, 1),
        )
        rows = np.frombuffer(self._mapped(program, encoder, staging, size), np.float32)
        part = picture[tile.y : tile.y + tile.height, tile.x : tile.x + tile.width]
        whole = rows.reshape(tile.height, stride // _PIXEL_BYTES, 4)
        part[...] = whole[:, : tile.width]
        staging.unmap()

    # Memory, reused between runs

    def _output(self, program: GpuProgram, size: int) -> Any:
        usage = program.gpu.wgpu.BufferUsage
        return self._buffer(program, "output", size, usage.STORAGE | usage.COPY_SRC)

    def _staging(self, program: GpuProgram, size: int) -> Any:
        usage = program.gpu.wgpu.BufferUsage
        return self._buffer(program, "staging", size, usage.COPY_DST | usage.MAP_READ)

    def _buffer(self, program: GpuProgram, name: str, size: int, usage: int) -> Any:
        """Return a buffer of at least this size; it grows by half, so that few are created."""
        buffer = self._memory.get(name)
        if buffer is None or buffer.size < size:
            room = size if buffer is None else max(size, buffer.size * 3 // 2)
            room = min(
                max(room, 16), max(size, program.gpu.limit("max-storage-buffer-binding-size"))
            )
            self._memory.pop(name, None)
            buffer = program.gpu.device.create_buffer(size=-(-room // 16) * 16, usage=usage)
            self._memory[name] = buffer
        return buffer

    def _texture(self, program: GpuProgram, tile: Tile) -> tuple[Any, Any]:
        known = self._memory.get("texture")
        if known is None or known[2] < tile.width or known[3] < tile.height:
            width, height = tile.width, tile.height
            if known is not None:
                width, height = max(width, known[2]), max(height, known[3])
            usage = program.gpu.wgpu.TextureUsage
            self._memory.pop("texture", None)
            texture = program.gpu.device.create_texture(
                size=(width, height, 1),
                format=_FORMAT,
                usage=usage.RENDER_ATTACHMENT | usage.COPY_SRC,
            )
            known = self._memory["texture"] = texture, texture.create_view(), width, height
        return known[0], known[1]

    def _read(self, program: GpuProgram, encoder: Any, output: Any, size: int) -> Any:
        staging = self._staging(program, size)
        encoder.copy_buffer_to_buffer(output, 0, staging, 0, size)
        return self._mapped(program, encoder, staging, size)

    def _mapped(self, program: GpuProgram, encoder: Any, staging: Any, size: int) -> Any:
        """Submit the commands, wait, and return the mapped bytes; the caller unmaps them."""
        program.gpu.device.queue.submit([encoder.finish()])
        staging.map_async(program.gpu.wgpu.MapMode.READ, 0, size).sync_wait()
        return staging.read_mapped(0, size, copy=False)

    # Functions

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
        """Return values at points; arguments as for ``Kernel.evaluate``."""
        assert not self._is_image, "an image has no points"
        points = cpu_memory.shared_length(args)
        if self._params == [VEC4] and self._result is VEC4:
            pixels = np.ascontiguousarray(args[0], np.float32).reshape(points, 4)
            return self._mapped_pixels(pixels, uniforms, resources, progress, cancel)
        stages = self._artifact.interface["stages"]
        if "compute" not in stages:
            raise DeviceError("this function's values do not fit a GPU's buffers: --device cpu")
        shapes, shape = [shape_of(t) for t in self._params], shape_of(self._result)
        # The text reads and writes the same layout as cpu_memory's runs of 32-bit slots.
        source = cpu_memory.pack_points(shapes, args, points, points, 32).reshape(-1, points)
        leaves = len(kinds_in(shape))
        target = np.empty((max(1, leaves), points), np.float32)

        def run(first: int, last: int) -> None:
            given = np.ascontiguousarray(source[:, first:last]) if shapes else None
            words = self._call(given, (last - first) * leaves * 4, last - first)
            target[:, first:last] = words.reshape(leaves, last - first)

        self._in_parts(points, run, uniforms, resources, progress, cancel)
        return cpu_memory.unpack_points(shape, target.reshape(-1), points, points)

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
        flat = np.ascontiguousarray(pixels, np.float32).reshape(-1, 4)
        return self._mapped_pixels(flat, uniforms, resources, None, cancel).reshape(pixels.shape)

    def _mapped_pixels(
        self,
        pixels: NDArray[np.float32],
        uniforms: Mapping[str, Any],
        resources: Mapping[str, Any],
        progress: Progress | None,
        cancel: Cancel | None,
    ) -> NDArray[np.float32]:
        assert self._params == [VEC4], "pixels are mapped by a function from vec4 to vec4"
        target = PICTURES.take(pixels.shape)

        def run(first: int, last: int) -> None:
            words = self._call(pixels[first:last], (last - first) * _PIXEL_BYTES, last - first)
            target[first:last] = words.reshape(-1, 4)

        self._in_parts(len(pixels), run, uniforms, resources, progress, cancel)
        return target

    def _in_parts(
        self,
        count: int,
        run: Callable[[int, int], None],
        uniforms: Mapping[str, Any],
        resources: Mapping[str, Any],
        progress: Progress | None,
        cancel: Cancel | None,
    ) -> None:
        """Run a function on parts of the points, which are sized by measured time."""
        wanted = cancel_test(cancel)
        with self._lock:
            program, started = self._ready(), time.perf_counter()
            with program.gpu.commands():
                program.load(resources)
                program.set_uniforms(uniforms)
            first = 0
            budget = self.tile_sizer.start(count)
            while first < count:
                if wanted():
                    raise Cancelled
                last, begin = min(first + budget, count), time.perf_counter()
                with program.gpu.commands():
                    run(first, last)
                self.tile_sizer.measured(Tile(0, 0, last - first, 1), time.perf_counter() - begin)
                first, budget = last, self.tile_sizer.next()
                if progress is not None:
                    progress(first / count)
            self.stats["render_s"] = time.perf_counter() - started

    def _call(self, given: NDArray[Any] | None, size: int, count: int) -> NDArray[np.float32]:
        """Call the function for some points, and return a copy of the words that it wrote."""
        program = self._ready()
        usage, interface = program.gpu.wgpu.BufferUsage, program.interface
        output = self._output(program, size)
        extra = {interface["output"]["binding"]: (output, size)}
        if given is not None and "input" in interface:
            source = self._buffer(program, "input", given.nbytes, usage.STORAGE | usage.COPY_DST)
            program.gpu.device.queue.write_buffer(source, 0, given)
            extra[interface["input"]["binding"]] = source, given.nbytes
        groups = -(-count // interface["workgroup"][0])
        across = min(groups, LARGEST_DISPATCH)
        encoder = program.gpu.device.create_command_encoder()
        program.start_frame()
        program.encode_compute(encoder, (across, -(-groups // across)), extra)
        words = np.frombuffer(self._read(program, encoder, output, size), np.float32).copy()
        self._memory["staging"].unmap()
        return words

    # Windows

    def draw(
        self,
        view: Any,
        format: str,
        width: int,
        height: int,
        uniforms: Mapping[str, Any],
        resources: Mapping[str, Any],
        *,
        samples: int = 1,
        progress: Progress | None = None,
        cancel: Cancel | None = None,
    ) -> None:
        """Draw the picture into a texture view of this device, and wait until it is drawn.

        Args:
            view: A view of a texture of at least this size that can be rendered to.
            format: The texture's format.
            width: Pixels across.
            height: Pixels down.
            uniforms: As for ``render``.
            resources: As for ``render``.
            samples: The number of samples in each pixel, for the size of the parts.
            progress: As for ``render``.
            cancel: As for ``render``; then the texture has some parts of the picture.

        Raises:
            Cancelled: ``cancel`` stopped the work.
            DeviceError: The GPU was lost.
        """
        with self._lock:
            program = self._ready()
            assert "fragment" in program.interface["stages"], "only the fragment path draws"

            def run(encoder: Any, tile: Tile) -> None:
                program.set_uniforms(uniforms)
                place = (tile.x, tile.y, tile.width, tile.height)
                program.encode_draw(encoder, view, format, place, keeps=(tile.x, tile.y) != (0, 0))
                # In wgpu 0.32 for Python, waiting for the queue fails; reading a buffer does not.
                self._read(program, encoder, self._output(program, _PIXEL_BYTES), _PIXEL_BYTES)
                self._memory["staging"].unmap()

            parts = tiles(width, height, self.tile_sizer, samples)
            self._in_tiles(parts, width * height, resources, run, progress, cancel)
