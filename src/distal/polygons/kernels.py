"""Runs the scene code of ``arithmetic`` for many rows, with the buffers of a mesh.

Input: a function, the columns of its rows, arrays for its buffers by name. Output: its results.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from distal.ir.types import INT, VEC3, Type
from distal.lang.resources import Buffer
from distal.lang.runtime_access import executor

_DEVICE = "cpu"


def run(
    function: Callable[..., Any],
    points: NDArray[Any],
    numbers: NDArray[np.int32] | None,
    buffers: Mapping[str, NDArray[Any]],
    *,
    double: bool = False,
) -> Any:
    """Return the results of a function of a point, and of a whole number if there is one.

    Args:
        function: A function of ``arithmetic``.
        points: (n, 3).
        numbers: (n,), or None.
        buffers: The data of the module's buffers by name; those that it does not read are ignored.
        double: Whether to compute in 64 bits; the buffers' floats have 32.
    """
    types: tuple[Type, ...] = (VEC3,) if numbers is None else (VEC3, INT)
    runner = executor()
    lowered = runner.lower(function, types)  # type: ignore[arg-type]  # a Func to Python
    kernel = runner.kernels.kernel(lowered, _DEVICE, 64 if double else 32)
    resources = {name: Buffer(buffers[name]) for name in lowered.resources}
    columns = [points.astype(np.float64 if double else np.float32)]
    return kernel.evaluate(columns + ([] if numbers is None else [numbers]), {}, resources)
