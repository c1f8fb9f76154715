"""The colors of a mesh, from the materials of its shape.

Input: a tree with materials, and places. Output: linear colors and finishes. ``borders`` cuts
triangles where these change abruptly.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, Final

import numpy as np

from distal.frontend import Assembly
from distal.ir.nodes import Expr, Param, Read, Return
from distal.ir.types import VEC3
from distal.lang.composed import Composed
from distal.lang.functions import Func
from distal.lang.runtime_access import executor
from distal.mesh import surface_arithmetic, triangle_arithmetic
from distal.mesh.files.parts import Finish, Finishes
from distal.mesh.jumps import DIFFERENT
from distal.mesh.kernels import rows_of
from distal.mesh.palette import nearest, palette_of
from distal.mesh.solid import Floats, Integers
from distal.scene.lowering.attributes import AttributePoint, SurfaceAttribute, attribute, paints
from distal.scene.lowering.parts.table import rolled_for
from distal.scene.lowering.shapes import ZERO_CELL, ShapeComposer
from distal.scene.objects.materials import as_material
from distal.scene.tree.node import Node
from distal.scene.tree.values import StatementList

# What is not painted in a shape that is painted elsewhere.
_UNPAINTED: Final = "#c0c0c0"
# Scattered light alone, in the terms of glTF.
_MATTE: Final = Finish(roughness=1.0)
# Finishes of triangles are rounded to this share, and more of them are averaged: patterns.
_STEP: Final = 1.0 / 64.0
_MOST_FINISHES: Final = 16
# Triangles are looked at in the middle, and at this share of the way to each corner.
_NEAR_CORNER: Final = 0.9
# Colors are often whole codes, which rounding must not divide.
_OFF_CODES: Final = 0.137


def surface_at(assembly: Assembly, body: StatementList, node: Node, p: Expr) -> Expr:
    """Add statements that find the surface of a tree at a point, and return it.

    Args:
        assembly: The functions of the program.
        body: The statements.
        node: The tree.
        p: The point.
    """
    composer = ShapeComposer(assembly, [node])
    kind = SurfaceAttribute(composer, as_material(_UNPAINTED))
    point = AttributePoint(p, ZERO_CELL, composer.values.all(node))
    return body.let("surface", attribute(body, kind, node, point))


class SurfaceAt(Composed):
    """A function of the surface at a point of a shape."""

    signature = (("p", VEC3),)

    def __init__(self, node: Node, function: Func) -> None:
        self._node = node
        self._function = function
        self.name = f"{function.name} of {node.name}"

    def compose(self, assembly: Assembly) -> str:
        """Add the function to the program, and return its name."""
        node, body = rolled_for(assembly, self._node), StatementList({"p"})
        surface = surface_at(assembly, body, node, Read("p", VEC3))
        found = assembly.call(self._function, {"surface": surface})
        body.statements.append(Return(found))
        params, name = (Param("p", VEC3),), self._function.name
        return assembly.define(f"{name}_at", params, found.type, body.statements, node.place)

    def functions(self) -> Iterable[Func]:
        """Yield the scene functions that the shape calls."""
        return self._node.functions()


class Painted:
    """The appearance of a tree with materials, at any places.

    Attributes:
        palette: The colors that are used, of shape (k, 3); None for all.
    """

    def __init__(self, node: Node, *, params: Mapping[str, Any], time: float) -> None:
        self._node = node
        self._params = params
        self._time = time
        self._functions: dict[Func, SurfaceAt] = {}
        given = [m for n in node.walk() for m in (n.material, n.cut_material) if m is not None]
        self._shines = any(m.reflects or m.refracts or m.emits for m in given)
        self._patterned = any(m.uses for m in given)
        self.palette: Floats | None = None

    @property
    def several(self) -> bool:
        """Whether there are several materials, or a palette."""
        return self.palette is not None or changes_abruptly(self._node)

    @property
    def varies(self) -> bool:
        """Whether the appearance may differ between places."""
        return self.several or self._patterned

    def colors(self, places: Floats) -> Floats:
        """Return the color at each place, of the palette if there is one."""
        found: Floats = self._values(surface_arithmetic.shown_color, places)
        return self._of_palette(found)

    def appearance(self, places: Floats) -> Floats:
        """Return the numbers that differ where materials do: of the color and of the finish."""
        if not self._shines:
            return self.colors(places)
        colors, *finishes = self._values(surface_arithmetic.appearance, places)
        return np.concatenate([self._of_palette(colors), *finishes], axis=1)

    def labels(self, points: Floats, triangles: Integers) -> Integers:
        """Return a number for each triangle: the same for the same appearance, -1 where it varies.

        Args:
            points: Of shape (n, 3).
            triangles: Of shape (m, 3).
        """
        corners = [points[triangles[:, i]] for i in range(3)]
        middles = middles_of(points, triangles)
        seen = self.appearance(middles)
        shares = np.full(len(triangles), _NEAR_CORNER)
        varies = np.zeros(len(triangles), np.bool_)
        for corner in corners:
            near = rows_of(triangle_arithmetic.along, middles, corner, shares)
            varies |= np.abs(self.appearance(near) - seen).max(axis=1) > DIFFERENT
        steps = np.rint(seen / DIFFERENT + _OFF_CODES)
        _, found = np.unique(steps, axis=0, return_inverse=True)
        return np.where(varies, -1, found.reshape(-1))

    def of_triangles(self, points: Floats, triangles: Integers) -> Floats:
        """Return the color of each triangle, at its middle."""
        return self.colors(middles_of(points, triangles))

    def finish(self, points: Floats, triangles: Integers) -> Finish | Finishes:
        """Return how the mesh reflects light: as a whole, or each triangle."""
        if not self._shines:
            return _MATTE
        middles = middles_of(points, triangles)
        _, *finishes = self._values(surface_arithmetic.appearance, middles)
        rows = np.rint(np.concatenate(finishes, axis=1) / _STEP) * _STEP
        found, which = np.unique(rows, axis=0, return_inverse=True)
        if len(found) > _MOST_FINISHES:
            return _finish(rows.mean(axis=0))
        kinds = tuple(_finish(row) for row in found)
        return kinds[0] if len(kinds) == 1 else Finishes(kinds, which.reshape(-1).astype(np.int64))

    def _of_palette(self, colors: Floats) -> Floats:
        return colors if self.palette is None else nearest(self.palette, colors)

    def _values(self, function: Func, places: Floats) -> Any:
        made = self._functions.get(function)
        if made is None:
            made = self._functions[function] = SurfaceAt(self._node, function)
        return executor().call(made, (places,), {}, params=self._params, time=self._time)


def painted(
    node: Node,
    points: Floats,
    triangles: Integers,
    *,
    params: Mapping[str, Any],
    time: float,
    most: int | None = None,
) -> Painted | None:
    """Return the appearance of a tree; None if nothing in it has a material.

    Args:
        node: The tree.
        points: Points of its mesh, of shape (n, 3).
        triangles: Of shape (m, 3).
        params: Values of parameters by name.
        time: Seconds.
        most: The most different colors; None for any number.
    """
    if not paints(node):
        return None
    found = Painted(node, params=params, time=time)
    if most is not None:
        found.palette = palette_of(found.of_triangles(points, triangles), most)
    return found


def middles_of(points: Floats, triangles: Integers) -> Floats:
    """Return the middles of triangles."""
    found: Floats = rows_of(
        triangle_arithmetic.middle, *(points[triangles[:, i]] for i in range(3))
    )
    return found


def _finish(row: Floats) -> Finish:
    metallic, roughness, transmission, ior, red, green, blue = row.tolist()
    return Finish(
        metallic=metallic,
        roughness=roughness,
        transmission=transmission,
        ior=ior,
        emission=(red, green, blue),
    )


def changes_abruptly(node: Node) -> bool:
    """Return whether the colors of a tree may change abruptly."""
    if node.material is not None:
        return False
    nodes = list(node.walk())
    materials = {id(m) for n in nodes for m in (n.material, n.cut_material) if m is not None}
    return len(materials) > 1 or any(not paints(n) for n in nodes)
