"""What requests for meshes, measures and outlines share: their progress and end, and a shape's box.

Input: what was asked for. Output: a function to call while working; slope, divisor and box.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Final, Protocol

import numpy as np

from distal.devices.base import Cancelled, cancel_test
from distal.fields.guarantees import ended
from distal.lang.render_options import Cancel, Progress
from distal.lang.runtime_access import executor
from distal.mesh.solid import Floats
from distal.scene.lowering.derived import BoundsOf
from distal.scene.tree.node import Node

# The name under which a tree keeps the function of its bounds.
BOUNDS: Final = "bounds"
DISTANCE: Final = "distance"


class Watched(Protocol):
    """A request that reports its progress and can be cancelled."""

    @property
    def progress(self) -> Progress | None:
        """Called with the finished share."""

    @property
    def cancel(self) -> Cancel | None:
        """Ends the work."""


def watch_of(request: Watched) -> Callable[[float], None]:
    """Return what is called with the finished share: it reports it, and ends cancelled work."""
    stopped = cancel_test(request.cancel)
    shown = 0.0

    def watch(share: float) -> None:
        nonlocal shown
        if stopped():
            raise Cancelled
        shown = max(shown, share)
        if request.progress is not None:
            request.progress(shown)

    return watch


def box_of(
    node: Node, params: Mapping[str, Any], time: float
) -> tuple[tuple[float, float], Floats, Floats]:
    """Return slope and divisor of a tree, and the corners of its box, which may be infinite.

    Args:
        node: The tree.
        params: Values of parameters by name.
        time: Seconds.
    """
    asked: BoundsOf = node.derived(BOUNDS, lambda: BoundsOf(node))
    bounds = executor().call(asked, (), {}, params=params, time=time)
    low, high = (np.array([ended(c) for c in corner]) for corner in bounds[2:4])
    return (float(bounds[0]), float(bounds[1])), low, high
