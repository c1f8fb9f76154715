"""What happens when Python calls scene code: ``f(points)`` and ``image.render()``.

Input: recorded functions and plain values. Output: arrays and Pictures. This room
joins the front end, the devices and the film; ``distal.lang`` reaches it through its one hook.
"""

from __future__ import annotations

import importlib
import threading
import time
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final
from weakref import WeakKeyDictionary

import numpy as np

from distal.backends import get_target
from distal.compiler.driver import run_passes
from distal.devices.base import Kernel
from distal.diagnostics import DeviceError
from distal.frontend import lower
from distal.frontend.signatures.matching import signature_of
from distal.frontend.signatures.signatures import MISSING, read_header
from distal.images.picture import Picture, Provenance
from distal.ir.nodes import Origin, Return
from distal.ir.types import VEC4, Type
from distal.lang.composed import Composed
from distal.lang.expressions import Expression
from distal.lang.functions import Func, Image
from distal.lang.names import LangFunction
from distal.lang.parameters import Parameter
from distal.loading import loaded_from
from distal.runtime.call_values import (
    bind,
    choose_types,
    count,
    empty,
    is_double,
    is_many,
    rows_of,
    single,
    with_names,
)
from distal.runtime.device_names import AUTO, CPU, DEVICE_NAMES, GPU, GPU_FRAGMENT, REFERENCE
from distal.runtime.lowered import Lowered, Types
from distal.runtime.uniform_values import (
    LARGEST_SIDE_PX,
    Declared,
    checked_size,
    checked_time,
    frame_values,
)

KERNELS_KEPT: Final = 128  # a scene that is edited for hours leaves no more than these behind
# Name -> the module that prepares kernels for it, and what it is told besides.
DEVICES: Final[dict[str, tuple[str, dict[str, str]]]] = {
    CPU: ("distal.devices.cpu", {}),
    GPU: ("distal.devices.gpu", {"path": "compute"}),
    GPU_FRAGMENT: ("distal.devices.gpu", {"path": "fragment"}),
    REFERENCE: ("distal.devices.reference", {}),
}


@dataclass(frozen=True, slots=True)
class _Parts:
    """What is run one after the other: a function, and what encodes its pixels for display."""

    parts: tuple[Lowered, ...]
    declared: Declared


class PythonExecutor:
    """Runs scene code for Python; keeps compiled kernels for the life of the process.

    A function is lowered again when a constant it captured has changed; a kernel is found by what
    lowering gave, so that scenes which differ in their numbers only share one.
    """

    def __init__(self) -> None:
        self._kernels: dict[tuple[str, str, int], Kernel] = {}
        self._lock = threading.RLock()  # frames of a film are rendered by several threads
        self._lowered: WeakKeyDictionary[Any, dict[Types, Lowered]] = WeakKeyDictionary()
        self._together: WeakKeyDictionary[Any, _Parts] = WeakKeyDictionary()

    def parameters(self, function: Func | Composed) -> list[Parameter]:
        """The parameters that a function and what it calls read, by first use."""
        return list(self._parts(function).declared.parameters)

    def reads_time(self, image: Image | Composed) -> bool:
        """Whether the picture depends on the time."""
        target = get_target("numpy")
        for part in self._parts(image).parts:
            entered = run_passes(part.module, target, after="entry")
            if any(u.origin is Origin.FRAME and u.name == "time" for u in entered.uniforms):
                return True
        return False

    def render(self, image: Image | Composed, *, device: str = "cpu", **options: Any) -> Picture:
        """The picture of an image; see ``Image.render`` for what is not said here.

        Args:
            image: An image, a scene, or a view of one.
            device: What renders: "auto" (a GPU in hardware, else the CPU), "cpu", "gpu",
                "gpu-fragment" or "reference"; "gpu:NAME" picks the adapter.
            options: Besides: ``settings``, values of a scene's numbers by name, for this picture
                only; ``freeze``: make constants of the numbers, for a picture that is worth its
                own compilation.

        Raises:
            DeviceError: The device is missing or was lost; never with "auto", which then warns.
        """
        if device != AUTO:
            return self._render_on(device, image, **options)
        found = _found()
        try:
            return self._render_on(found, image, **options)
        except DeviceError as error:
            if found == "cpu":
                raise
            warnings.warn(f"{error}; rendering on the CPU instead", stacklevel=2)
            return self._render_on("cpu", image, **options)

    def _render_on(
        self,
        device: str,
        image: Image | Composed,
        *,
        size: tuple[int, int],
        time: float = 0.0,
        params: Mapping[str, Any] | None = None,
        threads: int | None = None,
        progress: Callable[[float], Any] | None = None,
        cancel: Any = None,
        mouse: Sequence[float] = (0.0, 0.0, 0.0, 0.0),
        index: int = 0,
        seed: int = 0,
        settings: Mapping[str, Any] | None = None,
        freeze: bool = False,
    ) -> Picture:
        size, seconds = checked_size(size), checked_time(time)
        begin = _now()
        run = self._parts(image)
        parts, declared = run.parts, run.declared
        values = declared.parameter_values(params or {})
        numbers = declared.number_values(settings or {})
        if freeze:
            parts = tuple(part.frozen(numbers) for part in parts)
        kernels = [self._kernel(part, device, 32) for part in parts]
        compiled = _now()
        others = {**numbers, **frame_values(size, seconds, mouse, index, seed)}
        pixels = kernels[0].render(
            *size,
            declared.for_kernel(0, values, others),
            parts[0].resources,
            threads=threads,
            progress=progress,
            cancel=cancel,
        )
        stats = {"device": device, **kernels[0].stats, "compile_s": compiled - begin}
        linear = None
        if len(parts) > 1:
            linear = pixels
            uniforms = declared.for_kernel(1, values, others)
            pixels = kernels[1].map_pixels(
                linear, uniforms, parts[1].resources, threads=threads, cancel=cancel
            )
        stats["render_s"] = _now() - compiled
        known = loaded_from(image)
        origin = Provenance(
            source=image.name if known is None else known.source,
            source_hash=parts[0].source_hash if known is None else known.digest,
            neighbours=() if known is None else known.neighbours,
            parameters=values,
            time=seconds,
            index=others["index"],
            seed=others["seed"],
            mouse=others["mouse"],
            freeze=freeze,
            device=device,
        )
        return Picture(pixels, origin, stats, linear)

    def draw(
        self,
        image: Image | Composed,
        view: Any,
        *,
        format: str,
        size: tuple[int, int],
        time: float = 0.0,
        params: Mapping[str, Any] | None = None,
        mouse: Sequence[float] = (0.0, 0.0, 0.0, 0.0),
        index: int = 0,
        seed: int = 0,
        settings: Mapping[str, Any] | None = None,
        adapter: str | None = None,
    ) -> dict[str, Any]:
        """Draw an image of display values into a texture view of wgpu, and wait for nothing.

        Args:
            image: What is drawn; its pixels are display values.
            view: The texture's view, on the device of ``distal.devices.adapters``.
            format: The texture's format.
            size: Its width and height in pixels.
            time: Seconds; this and what follows as for ``render``.
            params: Values of parameters.
            mouse: The mouse.
            index: The frame's number.
            seed: What random numbers start from.
            settings: Values of a scene's numbers.
            adapter: Which adapter; the best when None.

        Returns:
            What is known of the kernel.

        Raises:
            DeviceError: The device is missing or was lost.
        """
        run = self._parts(image)
        assert len(run.parts) == 1, "a window shows display values"
        size, declared = checked_size(size), run.declared
        others = declared.number_values(settings or {})
        others |= frame_values(size, checked_time(time), mouse, index, seed)
        uniforms = declared.for_kernel(0, declared.parameter_values(params or {}), others)
        name = "gpu-fragment" if adapter is None else f"gpu-fragment:{adapter}"
        kernel = self._kernel(run.parts[0], name, 32)
        kernel.draw(view, format, *size, uniforms, run.parts[0].resources)  # type: ignore[attr-defined]
        return kernel.stats

    def call(
        self,
        function: Func | Composed | LangFunction,
        args: Sequence[Any],
        kwargs: Mapping[str, Any],
        params: Mapping[str, Any] | None = None,
        time: float = 0.0,
        device: str = "cpu",
    ) -> Any:
        """The function's value for numbers, vectors, or arrays with one row for each point."""
        seconds = checked_time(time)
        double = any(map(is_double, [*args, *kwargs.values()]))
        dtype = np.dtype(np.float64 if double else np.float32)
        types, values, rows = _arguments(function, args, kwargs, dtype)
        many = any(is_many(v, t) for v, t in zip(values, types, strict=True))
        points = count(rows)
        lowered = self._lower(function, types)
        module = lowered.module
        result_type = module.function(module.entry).result
        uniforms = _all_values(Declared([module]), params or {}, seconds)
        if points == 0:
            return with_names(empty(result_type, dtype), result_type)
        if rows:
            kernel = self._kernel(lowered, device, 64 if double else 32)
        else:  # one value of parameters alone is not worth machine code
            kernel = self._kernel(lowered, "reference", 64)
        result = kernel.evaluate(rows, uniforms, lowered.resources)
        return with_names(result, result_type) if many else single(result, result_type)

    def value(self, expression: Expression, params: Mapping[str, Any], time: float) -> Any:
        """The value of an expression of parameters and time."""
        lowered = Lowered.of(_ValueOf(expression), None)
        uniforms = _all_values(Declared([lowered.module]), params, checked_time(time))
        result = self._kernel(lowered, "reference", 64).evaluate([], uniforms, {})
        return single(result, expression.type)

    def _parts(self, function: Func | Composed) -> _Parts:
        """What is run for a function, remembered while it is the same."""
        with self._lock:
            first = self._lower(function, None)
            display = getattr(function, "display", None)
            parts = (first,) if display is None else (first, self._lower(display, (VEC4,)))
            known = self._together.get(function)
            if known is None or known.parts != parts:
                declared = Declared([p.module for p in parts])
                known = self._together[function] = _Parts(parts, declared)
            return known

    def _lower(self, function: Func | Composed | LangFunction, types: Types) -> Lowered:
        """The lowered function, remembered while what it captured is the same."""
        if isinstance(function, LangFunction):
            return Lowered.of(function, types)
        with self._lock:
            known = self._lowered.setdefault(function, {})
            lowered = known.get(types)
            if lowered is None or not lowered.captured.is_fresh():
                lowered = known[types] = Lowered.of(function, types)
            return lowered

    def _kernel(self, lowered: Lowered, device: str, precision: int) -> Kernel:
        name, _, adapter = device.partition(":")
        if name not in DEVICES or (adapter and not name.startswith("gpu")):
            known = ", ".join(DEVICE_NAMES)
            raise ValueError(f"there is no device '{device}'; devices: {known}")
        key = (lowered.digest, device, precision)
        with self._lock:
            kernel = self._kernels.pop(key, None)
            if kernel is None:
                room, options = DEVICES[name]
                is_gpu = name.startswith("gpu")
                told = {**options, "adapter": adapter or None} if is_gpu else options
                prepare = importlib.import_module(room).prepare
                kernel = prepare(lowered.module, precision=precision, **told)
            self._kernels[key] = kernel  # the last used stands last
            if len(self._kernels) > KERNELS_KEPT:
                self._kernels.pop(next(iter(self._kernels)), None)
            return kernel


def _found() -> str:
    """What "auto" means on this machine."""
    found = importlib.import_module("distal.devices.adapters").resolve(AUTO)
    return f"{found.device}:{found.adapter}" if found.adapter else str(found.device)


class _ValueOf(Composed):
    """An expression as a function of nothing."""

    def __init__(self, expression: Expression) -> None:
        self._expression = expression
        self.name, self.signature, self.result = "value", (), expression.type

    def compose(self, assembly: Any) -> str:
        """The function whose result it is."""
        value = assembly.expression(self._expression)
        name: str = assembly.define("value", (), self.result, (Return(value),))
        return name


def _all_values(declared: Declared, params: Mapping[str, Any], seconds: float) -> dict[str, Any]:
    """The uniforms of a function that is called from Python."""
    others = {**declared.numbers, "time": seconds}
    return declared.for_kernel(0, declared.parameter_values(params), others)


def _arguments(
    function: Func | Composed | LangFunction,
    args: Sequence[Any],
    kwargs: Mapping[str, Any],
    dtype: np.dtype[Any],
) -> tuple[tuple[Type, ...], list[Any], list[Any]]:
    """The types of the overload that takes the arguments; these in its order, also as rows."""
    if isinstance(function, LangFunction):
        if kwargs:
            raise TypeError(f"{function.row.name}() takes no keyword arguments")
        for signature in function.row.signatures:
            for types, _ in signature.instances():
                rows = rows_of(args, types, dtype) if len(types) == len(args) else None
                if rows is not None:
                    return types, list(args), rows
    elif isinstance(function, Composed):
        types = tuple(type for _, type in function.signature)
        names = dict.fromkeys((name for name, _ in function.signature), MISSING)
        values = bind(function.name, names, args, kwargs)
        rows = rows_of(values, types, dtype)
        if rows is not None:
            return types, values, rows
    else:
        mistake: TypeError | None = None
        for overload in function.overloads:
            header = read_header(overload)
            if header.problems:
                lower(function)  # raises with the author's lines
            try:
                defaults = {slot.name: slot.default for slot in header.slots}
                values = bind(header.name, defaults, args, kwargs)
            except TypeError as error:
                mistake = error
                continue
            found = choose_types(header, values, dtype)
            if found is not None:
                types, rows = found
                return types, values, rows
        if mistake is not None and len(function.overloads) == 1:
            raise mistake
    given = ", ".join(map(_described, [*args, *kwargs.values()]))
    raise TypeError(f"{_name(function)}() does not take ({given}); {_takes(function)}")


def _name(function: Func | Composed | LangFunction) -> str:
    return function.row.name if isinstance(function, LangFunction) else function.name


def _takes(function: Func | Composed | LangFunction) -> str:
    if isinstance(function, LangFunction):
        overloads = [
            f"({', '.join(map(str, types))})"
            for signature in function.row.signatures
            for types, _ in signature.instances()
        ]
    elif isinstance(function, Composed):
        params = ", ".join(f"{name}: {type}" for name, type in function.signature)
        overloads = [f"({params}) -> {function.result}"]
    else:
        overloads = [signature_of(read_header(o)) for o in function.overloads]
    return f"it takes {' or '.join(overloads)}, or arrays with a row for each point"


def _described(value: Any) -> str:
    try:
        shape = np.shape(value) if not isinstance(value, str) else ()
    except ValueError:
        return f"a {type(value).__name__} whose parts differ in length"
    if shape:
        return f"an array of shape {shape}"
    return repr(value) if isinstance(value, int | float | str) else type(value).__name__


def _now() -> float:
    return time.perf_counter()


__all__ = ["LARGEST_SIDE_PX", "PythonExecutor"]
