"""Methods of solids that make one from a mesh, a volume or points.

Input: files or arrays. Output: new shapes, and what is known of the meshes in a shape.
"""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from typing import TYPE_CHECKING

from distal.lang.source_places import author_place
from distal.scene.objects.mesh_shapes import mesh_node, reports_of
from distal.scene.objects.placed import Placed
from distal.scene.objects.point_shapes import points_node
from distal.scene.objects.volume_shapes import volume_node
from distal.scene.tree.value import recorded

if TYPE_CHECKING:
    from distal.polygons.importing import ImportReport
    from distal.polygons.importing_points import PointsReport
    from distal.scene.objects.argument_types import ArrayLike, AxisOrder, Columns, Points, Rows
    from distal.scene.objects.shape import Shape


class FromData(Placed):
    """The methods of ``Shape`` that read meshes, volumes and points."""

    @recorded
    @classmethod
    def from_mesh(
        cls,
        source: str | PathLike[str] | Points,
        triangles: Rows | None = None,
        *,
        spacing: float | None = None,
        sign: str = "auto",
        unit: str | None = None,
        up: str | None = None,
        colors: bool | Columns = False,
        max_memory: int | str | None = None,
    ) -> Shape:
        """Make a solid from a mesh of triangles: STL, OBJ, PLY, GLB, 3MF, or two arrays.

        The distances to the mesh are sampled on a grid and interpolated, so edges are rounded by
        less than the distance of two samples; ``imported`` says by how much. A closed mesh is
        needed for an inside; holes are closed with a warning.

        Args:
            source: The path of a file, beside the author's file or in the working folder; or
                points, an array (n, 3).
            triangles: With points, three indices for each triangle, an array (m, 3),
                counterclockwise seen from outside.
            spacing: The distance of two samples in scene units. None: a 64th of the longest side.
            sign: How the inside is found. "normals": by the nearest triangle, if the mesh is
                closed. "winding": by winding numbers, for holes and for bodies that overlap.
                "unsigned": there is no inside; ``round`` makes a sheet. "auto": "normals" where
                they agree, else "winding".
            unit: The length of one scene unit: "um", "mm", "cm", "m", "inch" or "ft"; GLB and 3MF
                name their unit, other files are in millimeters. None keeps the numbers.
            up: The axis that points up in the mesh, "y" or "z"; z becomes y. None: "z" for STL and
                3MF, which printers use, else "y".
            colors: True paints the shape with the colors of a file: those of points in PLY, OBJ and
                GLB, of triangles in PLY and 3MF, of materials in GLB and 3MF. With arrays, linear
                colors of points, an array (n, 3). They are sampled on a grid, too.
            max_memory: The most memory that a file may become, as "4 GB" or in bytes. None: by its
                size, 0.8 GB for a small one; this lifts the limit of time, too.

        Raises:
            SceneValueError: The file cannot be read, is no mesh, is too large or encloses nothing,
                or the spacing needs too many samples: of them, those near the surface are stored,
                32 million numbers at most; a mesh with holes needs all, 16 million at most.
            SceneTypeError: ``source`` is neither a path nor an array.

        Source: the signs are those of Baerentzen and Aanaes 2005, and of Barill et al. 2018.
        """
        place = author_place()
        node, center = mesh_node(
            source,
            triangles,
            place,
            spacing=spacing,
            sign=sign,
            unit=unit,
            up=up,
            colors=colors,
            max_memory=max_memory,
        )
        made: Shape = cls._of(node)
        return made.translate(center)

    @recorded
    @classmethod
    def from_points(
        cls,
        source: str | PathLike[str] | Points,
        normals: Points | None = None,
        *,
        spacing: float | None = None,
        radius: float | None = None,
        unit: str | None = None,
        up: str | None = None,
        max_memory: int | str | None = None,
    ) -> Shape:
        """Make a solid from points on its surface with outward normals: PLY, OBJ, XYZ, or arrays.

        The surface is smoothed over the points within ``radius``, which takes noise away and
        rounds edges; ``imported`` says how far the points are off it. Holes are closed. Points
        whose normals disagree with those about them are left out, with a warning.

        Args:
            source: The path of a file, beside the author's file or in the working folder; or
                points, an array (n, 3).
            normals: With points, their normals, an array (n, 3), of any length.
            spacing: The distance of two samples in scene units. None: a 64th of the longest side,
                or the distance of points if that is more.
            radius: Within which points count. None: three times the distance of points, or 2.5
                times ``spacing`` if that is more. Parts thinner than it may be missing.
            unit: The length of one scene unit: "um", "mm", "cm", "m", "inch" or "ft"; files are in
                millimeters. None keeps the numbers.
            up: The axis that points up in the file, "y" or "z"; z becomes y. None: "y".
            max_memory: The most memory that a file may become, as "4 GB" or in bytes. None: by its
                size, 0.8 GB for a small one; this lifts the limit of time, too.

        Raises:
            SceneValueError: The file cannot be read, is too large or has no normals, there are
                fewer than 10 points, a number is invalid, or the points enclose nothing.
            SceneTypeError: ``source`` is neither a path nor an array with normals.

        Source: moving least squares of Kolluri 2005; winding numbers of Barill et al. 2018.
        """
        place = author_place()
        node, center = points_node(
            source,
            normals,
            place,
            spacing=spacing,
            radius=radius,
            unit=unit,
            up=up,
            max_memory=max_memory,
        )
        made: Shape = cls._of(node)
        return made.translate(center)

    @recorded
    @classmethod
    def from_volume(
        cls,
        source: str | PathLike[str] | ArrayLike | Rows,
        *,
        spacing: float | Sequence[float] | None = None,
        axes: AxisOrder = "zyx",
        level: float | None = None,
        max_memory: int | str | None = None,
    ) -> Shape:
        """Make a solid from a volume of samples: .npy, .nrrd, .nhdr, .nii, .nii.gz, or an array.

        The middle of an array is the origin. A file with an orientation is placed where it says, in
        the coordinates of patients: x to the right, y to the front, z up; lengths with a unit are
        in millimeters. A solid that goes on beyond the volume is cut off there.

        Args:
            source: The path of a file, beside the author's file or in the working folder; or an
                array of three axes.
            spacing: The distance of two samples in scene units, or three along x, y and z, in place
                of that of the file, whose middle then is the origin. None: that of the file, else
                1.
            axes: What the axes of an array or a .npy file are, from the outermost to the innermost.
                "zyx": a sample is ``array[z, y, x]``, as scanners store slices; "xyz":
                ``array[x, y, z]``, as ``numpy.meshgrid(..., indexing="ij")`` makes it. NRRD and
                NIfTI files say it themselves.
            level: The value at the surface; more is inside. The field is then about the distance
                only near the surface and where samples change fastest. None: samples are distances,
                negative inside; a mask of bools is inside where it is True.
            max_memory: The most memory that a file may become, as "4 GB" or in bytes. None: by its
                size, 0.8 GB for a small one; this lifts the limit of time, too.

        Raises:
            SceneValueError: The file cannot be read, is too large or is no volume, or nothing is
                inside.
        """
        place = author_place()
        node, matrix = volume_node(
            source, place, spacing=spacing, axes=axes, level=level, max_memory=max_memory
        )
        made: Shape = cls._of(node)
        return made if matrix is None else made.transform(matrix)

    @property
    def imported(self) -> tuple[ImportReport | PointsReport, ...]:
        """What is known of the meshes and points in the shape: how closed, how far off."""
        return reports_of(self.node)
