"""The shadows of one scene's glass in direct light.

Input: the tree of a scene, the function of the shadows of its opaque solids. Output: a function of
a point and a light that colors them. Glass in a table of parts keeps its full shadow.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final

from distal.ir.build import field, multiply, number
from distal.ir.nodes import Expr, FunctionRef
from distal.ir.types import FLOAT, INT, VEC3
from distal.render import glass_shadows, settings
from distal.render.camera import Ray
from distal.render.lights import LightSample
from distal.scene.lowering.bodies import materials_of, members_of
from distal.scene.lowering.captures import capturing
from distal.scene.lowering.chords import chord_of, has_chord
from distal.scene.lowering.parts.table import TableNode
from distal.scene.lowering.ray_functions import Define, Params
from distal.scene.lowering.shapes import ZERO_CELL, ShapeComposer
from distal.scene.tree.node import Node
from distal.scene.tree.values import StatementList

# More solids of glass keep their full shadows.
MOST: Final = 16


def split_glass(root: Node, material: Any) -> tuple[list[Node], list[Node]]:
    """Return the members of a scene's union that let light through, and the others.

    Args:
        root: The tree of the scene.
        material: The material of shapes that have none.
    """
    clear: list[Node] = []
    others: list[Node] = []
    for member in members_of(root):
        (clear if _is_clear(member, material) else others).append(member)
    return (clear, others) if len(clear) <= MOST else ([], clear + others)


def _is_clear(member: Node, material: Any) -> bool:
    """Return whether light passes through each shape of a member.

    Args:
        member: The member.
        material: The material of shapes that have none.
    """
    if isinstance(member, TableNode):
        return False
    return all(map(_is_glass, materials_of(member, material)))


def _is_glass(material: Any) -> bool:
    """Return whether a material lets light through; not if an author's function decides that."""
    if not material.refracts:
        return False
    inner = [v for v in material.call.values.values() if hasattr(v, "refracts")]
    if inner:
        return all(map(_is_glass, inner))
    return bool(material.call.func.python_function.__module__.startswith("distal."))


def colored_shadow(
    composer: ShapeComposer,
    clear: Sequence[Node],
    surface_of: Callable[[Node], FunctionRef],
    define: Define,
    shadow: FunctionRef,
) -> FunctionRef:
    """Return the function ``(origin, light, sample, samples) -> Opening`` with glass.

    Args:
        composer: Makes the functions of the program's shapes.
        clear: The solids of glass.
        surface_of: Returns the function of the material at a place of a tree.
        define: Adds a function.
        shadow: This function of the opaque solids.
    """
    light = composer.assembly.struct(LightSample)
    params: Params = [("origin", VEC3), ("light", light), ("sample", INT), ("samples", INT)]
    functions = {"shadow": shadow, "glass": _light_through(composer, clear, surface_of, define)}

    def make(body: StatementList, given: Mapping[str, Expr]) -> Expr:
        return composer.call(glass_shadows.shadow_with_glass, given)

    return capturing(define, "shadow_with_glass", params, functions, make)


def _light_through(
    composer: ShapeComposer,
    clear: Sequence[Node],
    surface_of: Callable[[Node], FunctionRef],
    define: Define,
) -> FunctionRef:
    """Return the function ``(ray, far) -> vec3``: the fraction of light that comes through glass.

    The arguments are those of ``colored_shadow``.
    """
    surfaces = [surface_of(node) for node in clear]

    def make(body: StatementList, given: Mapping[str, Expr]) -> Expr:
        tint: Expr = number(1.0, VEC3)
        for node, surface in zip(clear, surfaces, strict=True):
            values = composer.values.all(node)
            asked = {**given, "surface": surface, "field": composer.field(node, values, ZERO_CELL)}
            if has_chord(node):
                line = (field(given["ray"], "origin"), field(given["ray"], "direction"))
                asked["chord"] = chord_of(composer, body, node, line, ZERO_CELL, values)
            else:
                own = composer.bounds.of(body, node, values).bounds
                box = composer.call(settings.grown_bounds, {"bounds": own})
                asked["bounds"] = body.let("bounds", box)
                asked["chord"] = body.let("chord", composer.call(glass_shadows.way_through, asked))
            through = composer.call(glass_shadows.passing_light, asked)
            tint = body.let("tint", multiply(tint, through))
        return tint

    ray = composer.assembly.struct(Ray)
    return define("light_through_glass", [("ray", ray), ("far", FLOAT)], make, [])
