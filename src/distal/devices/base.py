"""The interface of a device: a kernel that is ready to run.

Input: a module from the front end. Output: pictures, or values at points. Does not depend on any
implementation.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from distal.diagnostics import DeviceError as DeviceError

# Called in the calling thread with the fraction of the work that is done, 0 to 1.
Progress: TypeAlias = Callable[[float], None]
# Called in the calling thread; True stops the work. An event stops the work when it is set.
Cancel: TypeAlias = Callable[[], bool] | threading.Event
# An array with one row for each point; for a struct or tuple, a tuple of such arrays.
Values: TypeAlias = "NDArray[Any] | tuple[Values, ...]"


class Cancelled(Exception):  # noqa: N818 (nothing went wrong)
    """``cancel`` stopped the work; there is no result."""


class PartError(DeviceError):
    """One part of the work failed, such as a frame of a film; the others can be finished.

    Attributes:
        reason: Why, as the rest of a sentence that begins with the part.
        shared: Whether parts that were rendered at the same time may be the reason.
    """

    reason: str
    shared: bool


class Kernel(Protocol):
    """A compiled module.

    Attributes:
        stats: Statistics of the compilation and of the last run: ``compile_s``, ``cache_hit``,
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
        """Render an image module: float32 (height, width, 4), top row first.

        Args:
            width: Pixels across.
            height: Pixels down.
            uniforms: A value for every uniform, by name: a number or a sequence of numbers.
            resources: For every texture and buffer, by name, the declared resource, or an array
                (texels in the order of their indices: (height, width, 4), depth or face first).
            threads: Number of threads; None uses all that the process may use.
            progress: Called regularly with the fraction of the work that is done.
            cancel: Called regularly; True stops the work.

        Raises:
            Cancelled: ``cancel`` stopped the work.
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
        """Return the function's values at n points.

        Arrays have one row for each point: (n,) for scalars, (n, 3) for vec3, (n, 3, 3) for mat3 in
        NumPy's layout (row, column), (n, length, …) for arrays, a tuple of arrays for a struct. An
        argument with 1 row has the same value at every point.

        Args:
            args: The arguments, as arrays.
            uniforms: As for ``render``.
            resources: As for ``render``.
            threads: As for ``render``.
            progress: As for ``render``.
            cancel: As for ``render``.

        Raises:
            Cancelled: ``cancel`` stopped the work.
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
        """Apply a function from vec4 to vec4 to every pixel of a picture.

        Args:
            pixels: The picture, (height, width, 4).
            uniforms: As for ``render``.
            resources: As for ``render``.
            threads: As for ``render``.
            cancel: As for ``render``.

        Raises:
            Cancelled: ``cancel`` stopped the work.
        """
        ...


def cancel_test(cancel: Cancel | None) -> Callable[[], bool]:
    """Return a function that returns whether to stop the work."""
    match cancel:
        case None:
            return lambda: False
        case threading.Event():
            return cancel.is_set
        case _:
            return cancel
