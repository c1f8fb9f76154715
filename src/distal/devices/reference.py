"""The reference device: the NumPy backend as a kernel. Slow, and correct by definition.

Input: a lowered module, then plain arrays. Output: pictures and results. Nothing is compiled, so a
kernel is ready immediately; threads are not used.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeAlias, assert_never

import numpy as np
from numpy.typing import NDArray

from distal.backends import get_target
from distal.backends.numpy import interpreter as reference
from distal.backends.numpy.operations import Value
from distal.compiler.driver import run_passes
from distal.devices.base import Cancel, Cancelled, Progress, Values, cancel_test
from distal.devices.resources import load
from distal.ir.nodes import Module
from distal.ir.target import Target
from distal.ir.types import (
    Array,
    Buffer,
    FunctionType,
    Matrix,
    Scalar,
    Struct,
    Texture,
    Type,
    Vector,
)

RunPasses: TypeAlias = Callable[[Module, Target, int], Module]


def prepare(
    module: Module, passes: RunPasses | None = None, precision: int = 32
) -> ReferenceKernel:
    """Return the kernel of a module.

    Args:
        module: A module from the front end, before any pass.
        passes: Runs the passes for a target and a precision; None: ``compiler.run_passes``.
        precision: Bits of a float, 32 or 64.
    """
    shaped = (passes or run_passes)(module, get_target("numpy"), precision)
    return ReferenceKernel(shaped, precision)


class ReferenceKernel:
    """A kernel that interprets one module; see ``distal.devices.base.Kernel``.

    Attributes:
        stats: The statistics that ``--stats`` prints.
    """

    def __init__(self, module: Module, precision: int) -> None:
        self._module = module
        self._precision = precision
        self.stats: dict[str, Any] = {"cache_hit": False, "lanes": 1, "threads": 1}

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
        """
        return reference.render(
            self._module,
            width,
            height,
            uniforms,
            self._arrays(resources),
            self._precision,
            _poll(cancel),
            progress,
        )

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
        """Return the function's values at points; arguments as for ``Kernel.evaluate``."""
        entry = self._module.function(self._module.entry)
        values = [to_lanes(arg, param.type) for arg, param in zip(args, entry.params, strict=True)]
        result = reference.evaluate(
            self._module,
            values,
            uniforms,
            self._arrays(resources),
            self._precision,
            _poll(cancel),
        )
        points = max((len(leaf) for arg in args for leaf in _leaves(arg)), default=1)
        return from_lanes(result, entry.result, points)

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
        values = self.evaluate([pixels.reshape(-1, 4)], uniforms, resources, cancel=cancel)
        return np.asarray(values, np.float32).reshape(pixels.shape)

    def _arrays(self, resources: Mapping[str, Any]) -> dict[str, NDArray[Any]]:
        """Return the arrays of the resources; arrays are unchanged (texels in index order)."""
        arrays = {}
        for declaration in self._module.resources:
            source, type = resources[declaration.name], declaration.type
            assert isinstance(type, Texture | Buffer)
            arrays[declaration.name] = (
                source if isinstance(source, np.ndarray) else load(source, type)
            )
        return arrays


def _leaves(arg: Values) -> list[NDArray[Any]]:
    if isinstance(arg, tuple):
        return [leaf for part in arg for leaf in _leaves(part)]
    return [np.asarray(arg)]


def _poll(cancel: Cancel | None) -> Callable[[], None]:
    wanted = cancel_test(cancel)

    def poll() -> None:
        if wanted():
            raise Cancelled

    return poll


def to_lanes(data: Values, type: Type) -> Value:
    """Convert rows of points to values of the reference, whose last axis is the points."""
    match type:
        case Scalar() | Vector() | Matrix():
            # The axis of components moves from last to first; (row, column) becomes (column, row).
            return np.asarray(data).T
        case Array(element, length):
            # An array of structs is given as a tuple of its fields' arrays, like a single struct.
            return tuple(to_lanes(_item(data, i), element) for i in range(length))
        case Struct(_, fields):
            return tuple(to_lanes(v, t) for v, (_, t) in zip(data, fields, strict=True))
        case Texture() | Buffer() | FunctionType():
            raise AssertionError(f"{type} is no argument")
        case _:
            assert_never(type)


def _item(data: Values, position: int) -> Values:
    """Return one element of the array that every row contains."""
    if isinstance(data, tuple):
        return tuple(_item(part, position) for part in data)
    return data[:, position]


def _stacked(parts: Sequence[Values]) -> Values:
    """Return the array that every row contains, from its elements."""
    if isinstance(parts[0], tuple):
        return tuple(_stacked(fields) for fields in zip(*parts, strict=True))
    return np.stack([np.asarray(part) for part in parts], axis=1)


def from_lanes(value: Value, type: Type, points: int) -> Values:
    """Convert values of the reference to rows of points.

    Args:
        value: The value; its last axis is the points.
        type: The type of the value.
        points: The number of points; a value that is the same at all points is repeated.
    """
    match type:
        case Scalar() | Vector() | Matrix():
            assert isinstance(value, np.ndarray)
            whole = np.broadcast_to(value, (*value.shape[:-1], points))
            return np.ascontiguousarray(whole.T)
        case Array(element):
            return _stacked([from_lanes(part, element, points) for part in value])
        case Struct(_, fields):
            parts = zip(value, fields, strict=True)
            return tuple(from_lanes(part, t, points) for part, (_, t) in parts)
        case Texture() | Buffer() | FunctionType():
            raise AssertionError(f"{type} is no result")
        case _:
            assert_never(type)
