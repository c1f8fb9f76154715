"""The colors of a mesh, from the materials of its shape.

Input: a tree with materials, points and triangles. Output: linear colors. Where materials meet,
colors change from one triangle to the next.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from distal.frontend import Assembly
from distal.ir.build import field
from distal.ir.nodes import Param, Read, Return
from distal.ir.types import VEC3
from distal.lang.composed import Composed
from distal.lang.functions import Func
from distal.lang.runtime_access import executor
from distal.mesh import triangle_arithmetic
from distal.mesh.kernels import rows_of
from distal.mesh.solid import Floats, Integers
from distal.scene.lowering.attributes import AttributePoint, SurfaceAttribute, attribute, paints
from distal.scene.lowering.parts.table import rolled_for
from distal.scene.lowering.shapes import ZERO_CELL, ShapeComposer
from distal.scene.objects.materials import as_material
from distal.scene.tree.node import Node
from distal.scene.tree.values import StatementList

# What is not painted in a shape that is painted elsewhere.
_UNPAINTED = "#c0c0c0"


class ColorAt(Composed):
    """The color of a shape's surface, as a function of a point."""

    signature = (("p", VEC3),)
    result = VEC3

    def __init__(self, node: Node) -> None:
        self._node = node
        self.name = f"colors of {node.name}"

    def compose(self, assembly: Assembly) -> str:
        """Add the function to the program, and return its name."""
        node = rolled_for(assembly, self._node)
        composer = ShapeComposer(assembly, [node])
        body = StatementList({"p"})
        kind = SurfaceAttribute(composer, as_material(_UNPAINTED))
        point = AttributePoint(Read("p", VEC3), ZERO_CELL, composer.values.all(node))
        surface = body.let("surface", attribute(body, kind, node, point))
        shown = composer.call(triangle_arithmetic.shown_color, {"color": field(surface, "color")})
        body.statements.append(Return(shown))
        return assembly.define("color_at", (Param("p", VEC3),), VEC3, body.statements, node.place)

    def functions(self) -> Iterable[Func]:
        """Yield the scene functions that the shape calls."""
        return self._node.functions()


def colors_of(
    node: Node, points: Floats, triangles: Integers, *, params: Mapping[str, Any], time: float
) -> tuple[Floats | None, Floats | None]:
    """Return the color of each point and, if there are several materials, of each triangle.

    Args:
        node: The tree.
        points: Of shape (n, 3).
        triangles: Of shape (m, 3).
        params: Values of parameters by name.
        time: Seconds.
    """
    if not paints(node):
        return None, None
    color = ColorAt(node)
    at_points = executor().call(color, (points,), {}, params=params, time=time)
    if not _several(node):
        return at_points, None
    middles = rows_of(triangle_arithmetic.middle, *(points[triangles[:, i]] for i in range(3)))
    return at_points, executor().call(color, (middles,), {}, params=params, time=time)


def _several(node: Node) -> bool:
    """Return whether the colors may change abruptly."""
    if node.material is not None:
        return False
    nodes = list(node.walk())
    materials = {id(m) for n in nodes for m in (n.material, n.cut_material) if m is not None}
    return len(materials) > 1 or any(not paints(n) for n in nodes)
