"""Methods of flat shapes that trace their edge, and that make one from a picture.

Input: the author's numbers; a picture. Output: an ``Outline``; a shape.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from distal.lang.lazy_module import LazyModule
from distal.lang.render_options import Cancel, Progress
from distal.lang.runtime_access import outlining
from distal.lang.source_places import author_place
from distal.scene.objects.placed import Placed
from distal.scene.tree.value import recorded

if TYPE_CHECKING:
    from distal.mesh.outlines.outline import Outline
    from distal.scene.objects import picture_shapes
    from distal.scene.objects.argument_types import Image, ParameterValues
    from distal.scene.objects.shape import Shape2D
else:
    picture_shapes = LazyModule("distal.scene.objects.picture_shapes")  # needs NumPy


class Outlined(Placed):
    """A flat shape with an outline."""

    @recorded
    @classmethod
    def from_image(
        cls,
        source: Image,
        *,
        width: float = 1.0,
        inside: str = "auto",
        level: float = 0.5,
        samples: int = 512,
        max_memory: int | str | None = None,
    ) -> Shape2D:
        """Make a flat shape of what a picture shows: a logo, a drawing, a map.

        The distances from the middles of pixels to the edge are exact; between them they are
        interpolated. Soft edges place it more exactly than pixels are wide. The middle of the
        picture is the origin; what touches its border ends there. Pixels count by their display
        values, as programs that draw mix them; those of a ``Picture`` by their light.

        Args:
            source: The path of a file, beside the author's file or in the working folder; an array
                (height, width) or (height, width, 3 or 4), or a ``Picture``.
            width: The width of the picture in scene units.
            inside: What is inside: "dark", "bright" or "opaque". "auto": "opaque" if the picture
                has transparent pixels, else "dark".
            level: How much of a pixel must be so at the edge, between 0 and 1.
            samples: The most distances along the longest side, up to 4096; of a larger picture,
                means of pixels are taken.
            max_memory: The most memory that a file may become, as "4 GB" or in bytes. None: by its
                size, 0.8 GB for a small one; this lifts the limit of time, too.

        Raises:
            SceneValueError: The picture cannot be read or is too large, a number is beyond its
                limit, or nothing is inside.
            SceneTypeError: ``source`` is no picture.
        """
        made: Shape2D = cls._of(
            picture_shapes.picture_node(
                source,
                author_place(),
                width=width,
                inside=inside,
                level=level,
                samples=samples,
                max_memory=max_memory,
            )
        )
        return made

    def outline(
        self,
        tolerance: float | None = None,
        params: ParameterValues | None = None,
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
