"""What happens when Python calls scene code: ``f(points)`` and ``image.render()``.

What flows in: recorded functions and plain values. What flows out: arrays and Pictures. This room
joins the front end, the devices and the film; ``distal.lang`` reaches it through its one hook.
"""

from __future__ import annotations

import hashlib
import importlib
import math
import operator
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, TypeAlias
from weakref import WeakKeyDictionary

import numpy as np

from distal.call_values import (
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
from distal.devices.base import Kernel
from distal.film.picture import Picture, Provenance
from distal.frontend import lower, lower_captured
from distal.frontend.freshness import Captured
from distal.frontend.headers import read_header
from distal.frontend.matching import signature_of
from distal.ir.nodes import Module, Origin
from distal.ir.printer import print_module
from distal.ir.types import Type
from distal.lang.functions import Func, Image
from distal.lang.names import LangFunction
from distal.lang.parameter_values import LARGEST_FLOAT
from distal.lang.parameters import Parameter
from distal.passes.entry import renamed_parameters

LARGEST_SIDE_PX: Final = 16384
KERNELS_KEPT: Final = 128  # a scene that is edited for hours leaves no more than these behind
DEVICES: Final = {"cpu": "distal.devices.cpu", "reference": "distal.devices.reference"}


Types: TypeAlias = tuple[Type, ...] | None


@dataclass(frozen=True, slots=True)
class Lowered:
    """A lowered function.

    Attributes:
        module: The IR.
        digest: Hash of the printed IR: equal for functions that mean the same.
        source_hash: Hash of the text of every file that its functions stand in.
        captured: Tells whether the module still stands for the function.
    """

    module: Module
    digest: str
    source_hash: str
    captured: Captured

    @staticmethod
    def of(function: Func | LangFunction, types: Types) -> Lowered:
        """Lower a function for argument types."""
        module, captured = lower_captured(function, types)
        texts = sorted({"".join(o.source.lines) for o in captured.overloads})
        return Lowered(module, _hash(print_module(module)), _hash("\0".join(texts)), captured)


class PythonExecutor:
    """Runs scene code for Python; keeps compiled kernels for the life of the process.

    A function is lowered again when a constant it captured has changed; a kernel is found by what
    lowering gave.
    """

    def __init__(self) -> None:
        self._kernels: dict[tuple[str, str, int], Kernel] = {}
        self._lowered: WeakKeyDictionary[Func, dict[Types, Lowered]] = WeakKeyDictionary()

    def parameters(self, function: Func) -> list[Parameter]:
        """The parameters that a function and what it calls read, by first use."""
        uniforms = self._lower(function, None).module.uniforms
        return [u.source for u in uniforms if u.origin is Origin.PARAMETER]

    def render(
        self,
        image: Image,
        *,
        size: tuple[int, int],
        time: float,
        params: Mapping[str, Any] | None,
        device: str,
        threads: int | None,
        progress: Callable[[float], Any] | None,
        cancel: Any,
        mouse: Sequence[float],
        index: int,
        seed: int,
    ) -> Picture:
        """The picture of an image; see ``Image.render``."""
        width, height = _checked_size(size)
        seconds = _checked_time(time)
        begin = _now()
        lowered = self._lower(image, None)
        module = lowered.module
        values = parameter_values(module, params or {})
        kernel = self._kernel(lowered, device, 32)
        compiled = _now()
        frame = {
            "resolution": (float(width), float(height)),
            "time": seconds,
            "mouse": _checked_mouse(mouse),
            "index": (_checked_int("index", index) + 2**31) % 2**32 - 2**31,
            "seed": _checked_int("seed", seed) & 0xFFFFFFFF,
        }
        renamed = renamed_parameters(module.uniforms)
        pixels = kernel.render(
            width,
            height,
            {**frame, **{renamed.get(name, name): value for name, value in values.items()}},
            {r.name: r.source for r in module.resources},
            threads=threads,
            progress=progress,
            cancel=cancel,
        )
        stats = {
            "device": device,
            **kernel.stats,
            "compile_s": compiled - begin,
            "render_s": _now() - compiled,
        }
        origin = Provenance(
            source=image.name, source_hash=lowered.source_hash, parameters=values, time=seconds
        )
        return Picture(pixels, origin, stats)

    def call(
        self, function: Func | LangFunction, args: Sequence[Any], kwargs: Mapping[str, Any]
    ) -> Any:
        """The function's value for numbers, vectors, or arrays with one row for each point."""
        double = any(map(is_double, [*args, *kwargs.values()]))
        dtype = np.dtype(np.float64 if double else np.float32)
        types, values, rows = _arguments(function, args, kwargs, dtype)
        many = any(is_many(v, t) for v, t in zip(values, types, strict=True))
        points = count(rows)
        lowered = self._lower(function, types)
        module = lowered.module
        result_type = module.function(module.entry).result
        if points == 0:
            return with_names(empty(result_type, dtype), result_type)
        kernel = self._kernel(lowered, "cpu", 64 if double else 32)
        resources = {r.name: r.source for r in module.resources}
        result = kernel.evaluate(rows, parameter_values(module, {}), resources)
        return with_names(result, result_type) if many else single(result, result_type)

    def _lower(self, function: Func | LangFunction, types: Types) -> Lowered:
        """The lowered function, remembered while what it captured is the same."""
        if isinstance(function, LangFunction):
            return Lowered.of(function, types)
        known = self._lowered.setdefault(function, {})
        lowered = known.get(types)
        if lowered is None or not lowered.captured.is_fresh():
            lowered = known[types] = Lowered.of(function, types)
        return lowered

    def _kernel(self, lowered: Lowered, device: str, precision: int) -> Kernel:
        if device not in DEVICES:
            raise ValueError(f"there is no device '{device}'; devices: {', '.join(DEVICES)}")
        key = (lowered.digest, device, precision)
        kernel = self._kernels.pop(key, None)
        if kernel is None:
            room = importlib.import_module(DEVICES[device])
            kernel = room.prepare(lowered.module, precision=precision)
        self._kernels[key] = kernel  # the last used stands last
        if len(self._kernels) > KERNELS_KEPT:
            self._kernels.pop(next(iter(self._kernels)), None)
        return kernel


def _hash(text: str) -> str:
    return hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()


def parameter_values(module: Module, params: Mapping[str, Any]) -> dict[str, Any]:
    """The value of each parameter of a module: as given, checked, or its default.

    Keys are parameters' names or labels.

    Raises:
        ValueError: A name is unknown, or a value outside its range.
        TypeError: A value is of another kind.
    """
    if not isinstance(params, Mapping):
        raise TypeError(f"params are values by name, not {type(params).__name__}")
    declared = [u.source for u in module.uniforms if u.origin is Origin.PARAMETER]
    by_name = {key: p for p in declared for key in (p.label, p.name)}
    values = {p.name: p.default for p in declared}
    for key, value in params.items():
        if key not in by_name:
            known = ", ".join(values) or "none"
            raise ValueError(f"there is no parameter '{key}'; parameters: {known}")
        values[by_name[key].name] = by_name[key].check(value)
    return values


def _arguments(
    function: Func | LangFunction,
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
    else:
        mistake: TypeError | None = None
        for overload in function.overloads:
            header = read_header(overload)
            if header.problems:
                lower(function)  # raises with the author's lines
            try:
                values = bind(header, args, kwargs)
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
    raise TypeError(f"{function.__name__}() does not take ({given}); {_takes(function)}")


def _takes(function: Func | LangFunction) -> str:
    if isinstance(function, LangFunction):
        overloads = [
            f"({', '.join(map(str, types))})"
            for signature in function.row.signatures
            for types, _ in signature.instances()
        ]
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


def _checked_size(size: Any) -> tuple[int, int]:
    try:
        width, height = map(operator.index, size)
    except (TypeError, ValueError):
        raise TypeError(f"size is (width, height) in pixels, not {size!r}") from None
    if not (1 <= width <= LARGEST_SIDE_PX and 1 <= height <= LARGEST_SIDE_PX):
        raise ValueError(f"each side has 1 to {LARGEST_SIDE_PX} pixels, not {width}x{height}")
    return width, height


def _checked_time(seconds: Any) -> float:
    try:
        value = float(seconds)
    except (TypeError, ValueError):
        raise TypeError(f"time is a number of seconds, not {seconds!r}") from None
    except OverflowError:
        value = math.inf
    if not math.isfinite(value):
        raise ValueError(f"time is finite, not {value}")
    if abs(value) > LARGEST_FLOAT:
        raise ValueError(f"time fits 32 bits, {value} does not")
    return value


def _checked_mouse(mouse: Any) -> tuple[float, ...]:
    try:
        values = tuple(float(part) for part in mouse)
    except (TypeError, ValueError):
        values = ()
    if len(values) != 4 or not all(map(math.isfinite, values)):
        raise ValueError(f"mouse is four finite numbers, not {mouse!r}")
    return values


def _checked_int(name: str, value: Any) -> int:
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"{name} is a whole number, not {value!r}") from None
    return number


def _now() -> float:
    return time.perf_counter()
