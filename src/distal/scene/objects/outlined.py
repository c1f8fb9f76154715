"""The method of flat shapes that traces their edge.

Input: the author's numbers. Output: an ``Outline``.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from distal.lang.render_options import Cancel, Progress
from distal.lang.runtime_access import outlining
from distal.scene.objects.placed import Placed

if TYPE_CHECKING:
    from distal.mesh.outlines.outline import Outline


class Outlined(Placed):
    """A flat shape with an outline."""

    def outline(
        self,
        tolerance: float | None = None,
        params: Mapping[str, Any] | None = None,
        time: float = 0.0,
        progress: Progress | None = None,
        cancel: Cancel | None = None,
    ) -> Outline:
        """Return closed polylines around the inside, with sharp corners, which never cross.

        ``save`` of the result writes SVG or DXF; its ``report`` says how exact it is and what is
        missing. Always on the CPU.

        Args:
            tolerance: How far the outline may be from the edge, in scene units; it is measured.
                None: 0.0002 of the largest side of the shape's box.
            params: Values of parameters by name; the others have their defaults.
            time: Time in seconds.
            progress: Called with the finished share, from 0 to 1.
            cancel: An event, or a function without arguments, that ends the work early.

        Raises:
            CompileError: The shape's scene code has mistakes.
            SceneValueError: The shape has no end or no inside, its values are not numbers, or it
                needs too many points; the message says what to change.
        """
        request = outlining.OutlineRequest(
            tolerance=tolerance,
            params=params or {},
            time=time,
            progress=progress,
            cancel=cancel,
        )
        return outlining.outline_of(self, request)
