"""The interface of a device: a kernel, ready to run.

Input: a module from the front end. Output: pictures, or values at points.
Knows nothing of how the work is done.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from distal.diagnostics import DeviceError as DeviceError

# Called with the finished share, 0 to 1, in the calling thread.
Progress: TypeAlias = Callable[[float], None]
# Called in the calling thread: whether to stop. An event stops the work when it is set.
Cancel: TypeAlias = Callable[[], bool] | threading.Event
# An array with one row for each point (a struct or tuple: a tuple of them).
Values: TypeAlias = "NDArray[Any] | tuple[Values, ...]"


class Cancelled(Exception):  # noqa: N818 (nothing went wrong)
    """The work was ended because ``cancel`` said so; there is no result."""


class Kernel(Protocol):
    """A compiled module.

    Attributes:
        stats: What is known of the compilation and of the last run: ``compile_s``, ``cache_hit``,
            ``level``, ``lanes``, ``precision``; after a run ``render_s`` and ``threads``.
    """

    stats: dict[str, Any]

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
        """The picture of an image module: (height, width, 4), the top row first.

        Args:
            width: Pixels across.
            height: Pixels down.
            uniforms: A value for every uniform, by name: numbers, or their sequence.
            resources: For every texture and buffer, by name, what the author declared, or an array
                (texels in the order of their indices: (height, width, 4), depth or face first).
            threads: How many to use; as many as the process may use when None.
            progress: Called now and then with the finished share.
            cancel: Called now and then: whether to stop.

        Raises:
            Cancelled: ``cancel`` said so.
        """
        ...

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
        """The function's values at n points.

        Arrays have one row for each point: (n,) for scalars, (n, 3) for vec3, (n, 3, 3) for mat3 in
        NumPy's layout (row, column), (n, length, …) for arrays, a tuple of arrays for a struct. A
        row count of 1 means the same value at every point.

        Raises:
            Cancelled: ``cancel`` said so.
        """
        ...

    def map_pixels(
        self,
        pixels: NDArray[np.float32],
        uniforms: Mapping[str, Any],
        resources: Mapping[str, Any],
        *,
        threads: int | None = None,
        cancel: Cancel | None = None,
    ) -> NDArray[np.float32]:
        """The picture that a function from vec4 to vec4 makes of a picture (height, width, 4).

        Raises:
            Cancelled: ``cancel`` said so.
        """
        ...


def cancel_test(cancel: Cancel | None) -> Callable[[], bool]:
    """A function to call now and then: whether the caller wants the work to stop."""
    match cancel:
        case None:
            return lambda: False
        case threading.Event():
            return cancel.is_set
        case _:
            return cancel
