"""The colors of a mesh, from the materials of its shape.

Input: a tree with materials, points and triangles. Output: linear colors. Where materials meet,
colors change from one triangle to the next.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, Final

import numpy as np

from distal.frontend import Assembly
from distal.ir.nodes import Param, Read, Return
from distal.ir.types import VEC3, VEC4, Type
from distal.lang.composed import Composed
from distal.lang.functions import Func
from distal.lang.runtime_access import executor
from distal.mesh import surface_arithmetic, triangle_arithmetic
from distal.mesh.files.parts import Finish, Finishes
from distal.mesh.kernels import rows_of
from distal.mesh.palette import reduced
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


class SurfaceAt(Composed):
    """A function of the surface at a point of a shape."""

    signature = (("p", VEC3),)

    def __init__(self, node: Node, function: Func, result: Type) -> None:
        self._node = node
        self._function = function
        self.result = result
        self.name = f"{function.name} of {node.name}"

    def compose(self, assembly: Assembly) -> str:
        """Add the function to the program, and return its name."""
        node = rolled_for(assembly, self._node)
        composer = ShapeComposer(assembly, [node])
        body = StatementList({"p"})
        kind = SurfaceAttribute(composer, as_material(_UNPAINTED))
        point = AttributePoint(Read("p", VEC3), ZERO_CELL, composer.values.all(node))
        surface = body.let("surface", attribute(body, kind, node, point))
        found = composer.call(self._function, {"surface": surface})
        body.statements.append(Return(found))
        params, name = (Param("p", VEC3),), self._function.name
        return assembly.define(f"{name}_at", params, self.result, body.statements, node.place)

    def functions(self) -> Iterable[Func]:
        """Yield the scene functions that the shape calls."""
        return self._node.functions()


def colors_of(
    node: Node,
    points: Floats,
    triangles: Integers,
    *,
    params: Mapping[str, Any],
    time: float,
    most: int | None = None,
) -> tuple[Floats | None, Floats | None]:
    """Return the color of each point and, if there are several materials, of each triangle.

    Args:
        node: The tree.
        points: Of shape (n, 3).
        triangles: Of shape (m, 3).
        params: Values of parameters by name.
        time: Seconds.
        most: The most different colors of triangles; None for any number.
    """
    if not paints(node):
        return None, None
    color = SurfaceAt(node, surface_arithmetic.shown_color, VEC3)
    at_points = executor().call(color, (points,), {}, params=params, time=time)
    if not _several(node) and most is None:
        return at_points, None
    middles = rows_of(triangle_arithmetic.middle, *(points[triangles[:, i]] for i in range(3)))
    shades = executor().call(color, (middles,), {}, params=params, time=time)
    return at_points, shades if most is None else reduced(shades, most)


def finish_of(
    node: Node, points: Floats, triangles: Integers, *, params: Mapping[str, Any], time: float
) -> Finish | Finishes | None:
    """Return how the mesh reflects light: as a whole, or each triangle.

    Args:
        node: The tree.
        points: Of shape (n, 3).
        triangles: Of shape (m, 3).
        params: Values of parameters by name.
        time: Seconds.
    """
    if not paints(node):
        return None
    given = (m for n in node.walk() for m in (n.material, n.cut_material) if m is not None)
    if not any(m.reflects or m.refracts or m.emits for m in given):
        return _MATTE
    middles = rows_of(triangle_arithmetic.middle, *(points[triangles[:, i]] for i in range(3)))

    def values(function: Func, result: Type) -> Any:
        surface = SurfaceAt(node, function, result)
        return executor().call(surface, (middles,), {}, params=params, time=time)

    numbers = values(surface_arithmetic.gltf_numbers, VEC4)
    lights = values(surface_arithmetic.emitted_light, VEC3)
    rows = np.rint(np.concatenate([numbers, lights], axis=1) / _STEP) * _STEP
    found, which = np.unique(rows, axis=0, return_inverse=True)
    if len(found) > _MOST_FINISHES:
        return _finish(rows.mean(axis=0))
    kinds = tuple(_finish(row) for row in found)
    return kinds[0] if len(kinds) == 1 else Finishes(kinds, which.reshape(-1).astype(np.int64))


def _finish(row: Floats) -> Finish:
    metallic, roughness, transmission, ior, red, green, blue = row.tolist()
    return Finish(
        metallic=metallic,
        roughness=roughness,
        transmission=transmission,
        ior=ior,
        emission=(red, green, blue),
    )


def _several(node: Node) -> bool:
    """Return whether the colors may change abruptly."""
    if node.material is not None:
        return False
    nodes = list(node.walk())
    materials = {id(m) for n in nodes for m in (n.material, n.cut_material) if m is not None}
    return len(materials) > 1 or any(not paints(n) for n in nodes)
