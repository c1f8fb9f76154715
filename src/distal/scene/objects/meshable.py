"""The methods of solids that need triangles: meshes and measures.

Input: the author's numbers. Output: a ``Mesh``, or measures of the solid with their errors.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from distal.lang.render_options import Cancel, Progress
from distal.lang.runtime_access import measuring, meshing
from distal.scene.objects.placed import Placed

if TYPE_CHECKING:
    from distal.mesh.measuring import Measures
    from distal.mesh.solid import Mesh
    from distal.scene.objects.argument_types import ParameterValues


class Meshable(Placed):
    """A shape with a mesh."""

    def mesh(
        self,
        tolerance: float | None = None,
        feature: float | None = None,
        params: ParameterValues | None = None,
        time: float = 0.0,
        progress: Progress | None = None,
        cancel: Cancel | None = None,
        *,
        check: bool = False,
        colors: bool | int = True,
        angle: float | None = None,
    ) -> Mesh:
        """Return triangles of the surface: closed, without self-intersections, with sharp edges.

        ``save`` of the result writes a file; its ``report`` says how exact it is and what is
        missing. Always on the CPU.

        Args:
            tolerance: How far the mesh may be from the surface, in scene units; it is measured.
                None: 0.002 of the largest side of the shape's box.
            feature: The diameter of the smallest parts and gaps that must be found, in scene
                units. None: the mesh becomes finer where it is seen to miss thin parts.
            params: Values of parameters by name; the others have their defaults.
            time: Time in seconds.
            progress: Called with the finished share, from 0 to 1.
            cancel: An event, or a function without arguments, that ends the work early.
            check: Count open edges, pinched points and intersecting triangles for the report,
                which takes longer.
            colors: Whether the mesh has the colors of the shape's materials; a number reduces them
                to at most so many.
            angle: How much the surface may turn within a triangle, in radians: holes and shafts
                have their size. Where the radius of the surface is below 1.5 tolerances it may be
                any, as without this option.

        Raises:
            CompileError: The shape's scene code has mistakes.
            SceneValueError: The shape has no end or no inside, its values are not numbers, or it
                needs too many triangles; the message says what to change.
        """
        request = meshing.MeshRequest(
            tolerance=tolerance,
            feature=feature,
            params=params or {},
            time=time,
            progress=progress,
            cancel=cancel,
            check=check,
            colors=colors,
            angle=angle,
        )
        return meshing.mesh_of(self, request)

    def measure(
        self,
        density: float = 1.0,
        tolerance: float | None = None,
        params: ParameterValues | None = None,
        time: float = 0.0,
        progress: Progress | None = None,
        cancel: Cancel | None = None,
        *,
        feature: float | None = None,
        overhang_deg: float = 45.0,
        proved: bool = False,
        width: float | None = None,
        work: int | None = None,
        volume_tolerance: float | None = None,
    ) -> Measures:
        """Return volume, area, mass, center of mass, inertia and box, each with its error.

        They are those of meshes of ever finer cells, whose differences give the errors. The volume
        is never outside the bounds that intervals prove; parts that the meshes miss are named in
        ``warnings``. The thinnest wall, the narrowest gap and what hangs over are there too, with
        place, shape and line.

        Args:
            density: Mass of a unit of volume.
            tolerance: Cells are at least as fine as those of ``mesh`` with this tolerance. A finer
                one never enlarges the error of the volume.
            params: Values of parameters by name; the others have their defaults.
            time: Time in seconds.
            progress: Called with the finished share, from 0 to 1.
            cancel: An event, or a function without arguments, that ends the work early.
            overhang_deg: The angle between a face that looks down (along -y) and the horizontal,
                in degrees, up to which it needs support when printed.
            feature: The diameter of the smallest parts and gaps that must be found, as for
                ``mesh``.
            proved: Prove bounds of volume, mass, center and box too, by interval arithmetic
                (``brackets`` of the result).
            width: With ``proved``: stop when the bounds of the volume are this close, as a share.
            work: With ``proved``: how many boxes are looked at, at most; None: a million.
            volume_tolerance: How large the error of the volume may be, in scene units cubed; cells
                become finer until it is reached. None: the usual work.

        Raises:
            CompileError: The shape's scene code has mistakes.
            SceneValueError: The shape has no mesh, a number is out of range, or the tolerance of
                the volume needs too many cells; the message says which error is reached.
        """
        request = meshing.MeshRequest(
            tolerance=tolerance,
            feature=feature,
            params=params or {},
            time=time,
            progress=progress,
            cancel=cancel,
            colors=False,
        )
        effort = measuring.effort_of(width, work, proved=proved)
        return measuring.measures_of(self, density, request, overhang_deg, effort, volume_tolerance)
