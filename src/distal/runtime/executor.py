"""Run scene code for Python: ``f(points)`` and ``image.render()``.

Input: recorded functions, plain values and ``RenderOptions``. Output: arrays and pictures. Connects
the front end, the devices and the pictures; ``distal.lang`` calls it through ``runtime_access``.
"""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any, Final, cast

import numpy as np
from numpy.typing import NDArray

from distal.devices.base import Kernel
from distal.devices.memory_limit import require_of_machine
from distal.diagnostics import DeviceError
from distal.images.picture import Picture, Provenance
from distal.ir.collection import paused_collection
from distal.lang.composed import Composed
from distal.lang.expressions import Expression
from distal.lang.functions import Func, Image
from distal.lang.lazy_module import LazyModule
from distal.lang.names import LangFunction
from distal.lang.render_options import (
    PATH_SAMPLES,
    Refinement,
    RenderOptions,
    checked_time,
)
from distal.lang.runtime_access import cluster_kernels
from distal.lang.value_of import ValueOf
from distal.loading import loaded_from
from distal.render import film
from distal.runtime import accumulation, glow, sampling
from distal.runtime.call_arguments import call_arguments
from distal.runtime.call_values import count, empty, float_type, is_many, single, with_names
from distal.runtime.device_names import AUTO, CPU, GPU_FRAGMENT, REFERENCE
from distal.runtime.earlier_frames import EarlierFrames
from distal.runtime.frame_history import LiveFrames
from distal.runtime.kernels import KernelCache, automatic_device, is_software
from distal.runtime.lowered import Lowered
from distal.runtime.moving import moved_resources
from distal.runtime.passes import Passes, over_picture
from distal.runtime.photons import PhotonPasses, PhotonProgram
from distal.runtime.standard_executor import all_values
from distal.runtime.tape_executor import TapeExecutor
from distal.runtime.uniform_values import DeclaredUniforms, chosen_uniforms

if TYPE_CHECKING:
    from distal.devices.cpu import CpuKernel
    from distal.devices.gpu import GpuKernel
    from distal.runtime import sweeps
    from distal.tape.interval_rules import Ends
else:
    sweeps = LazyModule("distal.runtime.sweeps")


# The fewest rows of ``PythonExecutor.evaluate`` that several threads evaluate.
_ROWS_OF_A_THREAD: Final = 16384
# Pixels, times samples, that take about as long as LLVM's optimized code generation.
_PIXELS_OF_A_LONG_RUN: Final = 2**17
# Bytes for each pixel until a PNG is saved, measured, of direct light and of paths.
_PICTURE_BYTES: Final = 60
_FILM_BYTES: Final = 137
# Pictures of fewer pixels are rendered without a look at the memory.
_MANY_PIXELS: Final = 2**22


@dataclass(frozen=True, slots=True)
class DrawTarget:
    """The texture that ``PythonExecutor.draw`` draws into.

    Attributes:
        view: The view of the texture, on the device of ``distal.devices.adapters``.
        format: The format of the texture.
        adapter: The adapter that the texture is on; None for the best one.
    """

    view: Any
    format: str
    adapter: str | None = None


def _require_memory(width: int, height: int, bytes_per_pixel: int) -> None:
    """Refuse a picture before it is computed if there is no memory for it.

    Raises:
        MemoryError: There is not enough memory.
    """
    if width * height > _MANY_PIXELS:
        purpose = f"a picture of {width}x{height} pixels"
        require_of_machine(width * height * bytes_per_pixel, purpose)


class PythonExecutor(TapeExecutor):
    """Runs scene code for Python; keeps compiled kernels until the process ends."""

    def __init__(self) -> None:
        super().__init__()
        self.kernels = KernelCache()
        self.frames = EarlierFrames(self)

    def render(self, image: Image | Composed, options: RenderOptions) -> Picture:
        """Render an image, a scene, or a view of a scene.

        Raises:
            DeviceError: The device is missing or was lost; never with "auto", which then warns.
        """
        if options.cluster is not None and options.device not in (AUTO, CPU):
            raise ValueError(f"workers render on their CPU, not on '{options.device}'")
        if options.cluster is not None:
            return self._render_on(CPU, image, options)
        if options.device != AUTO:
            return self._render_on(options.device, image, options)
        found = automatic_device()
        try:
            return self._render_on(found, image, options)
        except DeviceError as error:
            if found == CPU:
                raise
            warnings.warn(f"{error}; rendering on the CPU instead", stacklevel=2)
            return self._render_on(CPU, image, options)

    def _render_on(self, device: str, image: Image | Composed, options: RenderOptions) -> Picture:
        begin = time.perf_counter()
        options = replace(options, device=device)
        image, options = self.as_rendered(image, options)
        adaptive = isinstance(image, Composed) and image.adaptive
        refined = isinstance(image, Composed) and image.refined
        _require_memory(*options.size, _FILM_BYTES if refined else _PICTURE_BYTES)
        passes = self.passes(image, options)
        parts, kernels = passes.parts, passes.kernels
        values, others = passes.values
        contrast = self._contrast(device) if adaptive else None
        compiled = time.perf_counter()
        linear: NDArray[np.float32] | None = None
        samples = 1.0
        exposed: accumulation.Film | None = None
        if refined:
            samples_only = Refinement(samples=options.samples or PATH_SAMPLES)
            refinement = options.refinement or samples_only
            exposed = passes.accumulated(refinement, _preview_of(refinement, passes))
            linear = exposed.light
            if refinement.finish is not None:
                linear = refinement.finish(linear)
            pixels = passes.shown(linear) if len(parts) > 1 else linear
        elif contrast is not None:
            seen = partial(passes.contrast, *contrast)
            programs = sampling.Programs(passes.light, passes.shown, seen)
            linear, pixels, samples = sampling.adaptive(programs, options.size, options.progress)
        else:
            pixels = passes.light(options.size, {}, {}, options.progress)
            if len(parts) > 1:
                linear, pixels = pixels, passes.shown(pixels)
        if linear is not None and isinstance(image, Composed) and image.glow > 0.0:
            step = partial(self._step, device, options)
            linear += np.float32(image.glow) * glow.halo(linear, step)
            pixels = passes.shown(linear)
        stats = {
            "device": device,
            **kernels[0].stats,
            "compile_s": compiled - begin - passes.earlier_s,
        }
        stats["render_s"] = time.perf_counter() - compiled + passes.earlier_s
        stats["lost"] = passes.lost.shares
        if exposed is not None:
            stats |= exposed.figures()
        elif contrast is not None:
            stats["samples"] = samples
        origin = self.origin(image, options, (values, others), _samples(options, adaptive, exposed))
        return Picture(pixels, origin, stats, linear, {} if exposed is None else _layers(exposed))

    def origin(
        self,
        image: Image | Composed,
        options: RenderOptions,
        values: tuple[Mapping[str, Any], Mapping[str, Any]],
        samples: int | None,
    ) -> Provenance:
        """Return what a picture's file says of how it was rendered.

        Args:
            image: What was rendered.
            options: Its options.
            values: The values of ``chosen_uniforms``.
            samples: The samples in each pixel; None for adaptive sampling.
        """
        known = loaded_from(image)
        parameters, others = values
        return Provenance(
            source=image.name if known is None else known.source,
            source_hash=self.parts(image).parts[0].source_hash if known is None else known.digest,
            neighbors=() if known is None else known.neighbors,
            parameters=parameters,
            time=options.time,
            index=others["index"],
            seed=others["seed"],
            mouse=others["mouse"],
            buttons=options.buttons,
            keys=options.keys,
            delta=options.delta,
            date=options.date,
            live=isinstance(options.history, LiveFrames) and bool(self.parts(image).read.all),
            freeze=options.freeze,
            samples=samples,
            device=options.device,
        )

    def as_rendered(
        self, image: Image | Composed, options: RenderOptions
    ) -> tuple[Image | Composed, RenderOptions]:
        """Return the program that is rendered, and its options: for samples of an ``@image``.

        Raises:
            DeviceError: Workers of a cluster cannot render it.
        """
        if options.cluster is not None and self.parts(image).frames:
            raise DeviceError(f"'{image.name}' reads its last frames: one machine renders it")
        if isinstance(image, Image) and options.samples is not None and options.samples > 1:
            settings = {film.SAMPLES: options.samples}
            return sampling.sampled(image), replace(options, settings=settings)
        return image, options

    def passes(self, image: Image | Composed, options: RenderOptions) -> Passes:
        """Return the compiled kernels of a picture, which renders its passes one by one.

        Args:
            image: The picture.
            options: As for ``render``; the device is not "auto".

        Raises:
            DeviceError: The device is missing.
        """
        is_in_passes = isinstance(image, Composed) and (image.adaptive or image.refined)
        with paused_collection():
            run = self.parts(image)
            parts = run.parts
            options = self.frames.numbered(run, options)
            values, others = chosen_uniforms(run.declared, options)
            if options.freeze:
                numbers = run.declared.number_values(options.settings)
                kept = film.PASS_NUMBERS if is_in_passes else ()
                parts = tuple(part.frozen(numbers, kept) for part in parts)
            if options.cluster is None:
                is_long = _computed_pixels(image, options) > _PIXELS_OF_A_LONG_RUN
                kernels = [
                    self.kernels.kernel(part, options.device, 32, is_long=is_long) for part in parts
                ]
            else:
                # What follows the first program is fast: it is not worth sending pixels there.
                kernels = [cast("Kernel", cluster_kernels.kernel(options.cluster, parts[0]))]
                kernels += [self.kernels.kernel(part, CPU, 32) for part in parts[1:]]
        moved = moved_resources(parts[0].resources, values, options.time)
        begin = time.perf_counter()
        moved |= self.frames.texels(run, options)
        earlier_s = time.perf_counter() - begin
        photons = None
        if isinstance(image, Composed) and image.photons is not None:
            photons = self._photons(image.photons, options.device, options)
        found = (values, others)
        return Passes(
            kernels,
            parts,
            run.declared,
            found,
            options,
            moved,
            photons=photons,
            earlier_s=earlier_s,
        )

    def _photons(
        self, programs: tuple[Composed, Composed], device: str, options: RenderOptions
    ) -> PhotonPasses:
        """Return the photons of a picture.

        They are traced on its device, or by the workers of its cluster; drivers in software compile
        them too slowly (llvmpipe: 15 s).
        """
        plan, deposits = (self.lower(program, None) for program in programs)
        if options.cluster is None:
            on = CPU if is_software(device) else device
            kernel = self.kernels.kernel(deposits, on, 32)
        else:
            kernel = cast("Kernel", cluster_kernels.kernel(options.cluster, deposits))
        return PhotonPasses(
            PhotonProgram(self.kernels.kernel(plan, REFERENCE, 32), plan, options),
            PhotonProgram(kernel, deposits, options),
        )

    def _contrast(self, device: str) -> tuple[Kernel, Mapping[str, Any]]:
        """Return the kernel of ``film.contrast``, and its buffer by name."""
        lowered = self.lower(film.contrast, None)
        return self.kernels.kernel(lowered, device, 32), lowered.resources

    def _step(
        self,
        device: str,
        options: RenderOptions,
        step: Composed,
        size: tuple[int, int],
        numbers: Mapping[str, Any],
        light: NDArray[np.float32],
    ) -> NDArray[np.float32]:
        """Render a step of ``runtime.glow``; the first two are those of the whole picture."""
        lowered = self.lower(step, None)
        kernel = self.kernels.kernel(lowered, device, 32)
        return over_picture(kernel, lowered.resources, size, numbers, light, options)

    def draw(
        self, image: Image | Composed, target: DrawTarget, options: RenderOptions
    ) -> dict[str, Any]:
        """Draw an image of display values into a texture of wgpu, and wait until it is drawn.

        Args:
            image: The image to draw; its pixels are display values.
            target: The texture.
            options: As for ``render``; ``size`` is the size of the texture, ``device`` is ignored.

        Returns:
            The statistics of the kernel.

        Raises:
            Cancelled: ``options.cancel`` stopped the work.
            DeviceError: The device is missing or was lost.
        """
        run = self.parts(image)
        assert len(run.parts) == 1, "a window shows display values"
        options = self.frames.numbered(run, options)
        values, others = chosen_uniforms(run.declared, options)
        uniforms = run.declared.for_kernel(0, values, others)
        resources = moved_resources(run.parts[0].resources, values, options.time)
        device = GPU_FRAGMENT if target.adapter is None else f"{GPU_FRAGMENT}:{target.adapter}"
        kernel = cast("GpuKernel", self.kernels.kernel(run.parts[0], device, 32))
        kernel.draw(
            target.view,
            target.format,
            *options.size,
            uniforms,
            resources | self.frames.texels(run, replace(options, device=device)),
            samples=(options.settings or {}).get(film.SAMPLES, 1),
            progress=options.progress,
            cancel=options.cancel,
        )
        return kernel.stats

    def call(
        self,
        function: Func | Composed | LangFunction,
        args: Sequence[Any],
        kwargs: Mapping[str, Any],
        params: Mapping[str, Any] | None = None,
        time: float = 0.0,
        device: str = CPU,
        settings: Mapping[str, Any] | None = None,
        here: bool = False,
    ) -> Any:
        """Evaluate the function for numbers, vectors, or arrays with one row per point.

        Args:
            function: The function to call.
            args: Values by position.
            kwargs: Values by name.
            params: Values of parameters by name; the others have their defaults.
            time: Seconds.
            device: The name of a device, as for ``render``.
            settings: Values of the scene's numbers by name; the others have their defaults.
            here: Whether the calling thread computes them, on the CPU: for few rows.

        Raises:
            TypeError: No overload accepts the values.
        """
        seconds = checked_time(time)
        types, values, rows = call_arguments(function, args, kwargs)
        dtype = float_type(values, types)
        many = any(is_many(v, t) for v, t in zip(values, types, strict=True))
        points = count(rows)
        lowered = self.lower(function, types)
        module = lowered.module
        result_type = module.function(module.entry).result
        uniforms = all_values(DeclaredUniforms([module]), params or {}, seconds, settings)
        if points == 0:
            return with_names(empty(result_type, dtype), result_type)
        kernel: Kernel
        if rows:
            kernel = self.kernels.kernel(lowered, device, 8 * dtype.itemsize)
        else:  # compiling for a single value would take longer than the reference needs
            kernel = self.kernels.kernel(lowered, REFERENCE, 64)
        if here and rows and device == CPU:
            cpu_kernel = cast("CpuKernel", kernel)
            result = cpu_kernel.evaluate(rows, uniforms, lowered.resources, here=True)
        else:
            result = kernel.evaluate(rows, uniforms, lowered.resources)
        return with_names(result, result_type) if many else single(result, result_type)

    def evaluate(
        self,
        function: Composed,
        columns: Sequence[NDArray[Any]],
        params: Mapping[str, Any],
        time: float,
    ) -> Any:
        """Return the values of a function for many rows, by compiled code of the CPU.

        Args:
            function: The function.
            columns: The values of each of its parameters, one row each.
            params: Values of parameters by name; those that it does not read are left out.
            time: Seconds.
        """
        lowered = self.lower(function, None)
        kernel = cast("CpuKernel", self.kernels.kernel(lowered, CPU, 32))
        declared = DeclaredUniforms([lowered.module])
        known = {p.name: params[p.name] for p in declared.parameters if p.name in params}
        values = all_values(declared, known, time)
        # To start a thread takes longer than to evaluate a few rows.
        few = len(columns) > 0 and len(columns[0]) < _ROWS_OF_A_THREAD
        return kernel.evaluate(columns, values, lowered.resources, here=few)

    def sweep(self, function: Composed, columns: Sequence[sweeps.Column]) -> list[Ends]:
        """Return the ends of each float of a function's result at all times.

        They hold for all values of parameters in their declared ranges, too; an end that is not
        known is infinite.

        Args:
            function: The function.
            columns: The values of each of its parameters, one row each; or the two ends of these.
        """
        return sweeps.sweep(self.lower(function, None), columns)

    def steepest(
        self, gradient: Composed, points: Sequence[Sequence[float]]
    ) -> tuple[float, tuple[float, ...]]:
        """Return the largest length of a gradient at some points, and the point where it is.

        A gradient that is not finite is left out.
        """
        rows = np.array(points, np.float64)
        lengths = np.linalg.norm(self.call(gradient, (rows,), {}, device=REFERENCE), axis=1)
        lengths = np.where(np.isfinite(lengths), lengths, 0.0)
        at = int(np.argmax(lengths))
        return float(lengths[at]), tuple(rows[at].tolist())

    def at_pixel(
        self, function: Composed, place: tuple[float, float], options: RenderOptions
    ) -> Any:
        """Evaluate a function of a ``Frame`` at one place of a picture, by the reference.

        Args:
            function: A function whose only parameter is a ``Frame``.
            place: The place in pixels, from the lower left.
            options: The size of the picture, the time and the parameters.
        """
        lowered = self.lower(function, None)
        declared = DeclaredUniforms([lowered.module])
        uniforms = declared.for_kernel(0, *chosen_uniforms(declared, options))
        kernel = self.kernels.kernel(lowered, REFERENCE, 32)
        at = np.array([place], np.float32)
        result = kernel.evaluate([at], uniforms, lowered.resources)
        return single(result, lowered.module.function(lowered.module.entry).result)

    def value(self, expression: Expression, params: Mapping[str, Any], time: float) -> Any:
        """Return the value of an expression for values of its parameters and a time in seconds.

        Args:
            expression: The expression.
            params: Values of parameters by name; the others have their defaults.
            time: Seconds.
        """
        lowered = Lowered.of(ValueOf(expression), None)
        uniforms = all_values(DeclaredUniforms([lowered.module]), params, checked_time(time))
        result = self.kernels.kernel(lowered, REFERENCE, 64).evaluate([], uniforms, {})
        return single(result, expression.type)


def _preview_of(
    refinement: Refinement, passes: Passes
) -> Callable[[accumulation.Film], None] | None:
    """Return what shows the samples so far as a picture; None if nobody asks for it."""
    preview = refinement.preview
    if preview is None:
        return None
    # It is also shown when the work was cancelled.
    passes = replace(passes, options=replace(passes.options, cancel=None))

    def show(exposed: accumulation.Film) -> None:
        linear = exposed.light
        preview(Picture(passes.shown(linear), stats=exposed.figures(), light=linear))

    return show


def _computed_pixels(image: Image | Composed, options: RenderOptions) -> int:
    """Return how often the function of a picture is computed, roughly."""
    width, height = options.size
    refined = isinstance(image, Composed) and image.refined
    return width * height * (options.samples or (PATH_SAMPLES if refined else 1))


def _layers(exposed: accumulation.Film) -> dict[str, NDArray[Any]]:
    """Return what a picture knows of its samples, by names of layers."""
    samples, variance = exposed.samples.astype(np.uint32), exposed.variance.astype(np.float32)
    return {"samples": samples, "variance": variance}


def _samples(
    options: RenderOptions, adaptive: bool, exposed: accumulation.Film | None
) -> int | None:
    """Return the number of samples to record; None for adaptive sampling."""
    if exposed is not None:
        return int(exposed.samples.max())
    return None if adaptive else options.samples or 1
