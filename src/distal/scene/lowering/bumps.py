"""Lowering of bumps: the gradient of the height that is painted on a surface.

Input: the function of the material at a hit. Output: one that also gives the gradient of the
material's height with respect to the point in the scene's space: through all moves, repetitions and
blends on the way to the painted shape.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from distal.frontend import Assembly
from distal.ir.build import field
from distal.ir.nodes import Call, Expr, FunctionRef, Gradient
from distal.ir.types import FLOAT, VEC3, FunctionType, Type
from distal.render.bump import tilted_surface
from distal.render.material import Surface
from distal.scene.tree.node import Node
from distal.scene.tree.values import StatementList


def has_bump(root: Node, default: Any) -> bool:
    """Return whether a relief is painted on any part of a tree.

    Args:
        root: The tree.
        default: The material of what is not painted.
    """

    def found() -> bool:
        nodes = list(root.walk())
        materials = (m for n in nodes for m in (n.material, n.cut_material) if m is not None)
        return any(material.has_bump for material in materials)

    return bool(default.has_bump) or root.derived("has bump", found)


def tilted(
    assembly: Assembly,
    define: Callable[..., FunctionRef],
    surface: FunctionRef,
    params: Sequence[tuple[str, Type]],
) -> FunctionRef:
    """Return the function of a material with the gradient of its height.

    Args:
        assembly: The program.
        define: Adds a function: name, parameters, and how its result is made.
        surface: The function of the material.
        params: Its parameters: the point, then others.
    """
    result = assembly.struct(Surface)

    def at(given: Mapping[str, Expr]) -> Expr:
        return Call(surface.name, tuple(given[name] for name, _ in params), result)

    def height(body: StatementList, given: Mapping[str, Expr]) -> Expr:
        return field(at(given), "height")

    of_height = define("height_of_hit", params, height)

    def make(body: StatementList, given: Mapping[str, Expr]) -> Expr:
        others = tuple(given[name] for name, _ in params[1:])
        of_point = FunctionRef(of_height.name, others, FunctionType((VEC3,), FLOAT))
        tilt = Gradient(of_point, given["p"], False, VEC3)
        return assembly.call(tilted_surface, {"surface": at(given), "tilt": tilt})

    return define("bumped_surface_of_hit", params, make)
