"""The functions and numbers by which the photons of one scene are found and read.

Input: the scene's tree and materials. Output: which parts bundle light; the numbers of a pass,
which the runtime sets; the function that gathers photons at a vertex of a path.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Final, cast

from distal.fields.guarantees import Bounds
from distal.ir.build import boolean
from distal.ir.nodes import Construct, Expr, FunctionRef
from distal.ir.types import FLOAT, INT, VEC3
from distal.render import photon_aim, photons
from distal.render.material import glass, metal, mirror
from distal.render.named_materials import CLEAR, METALS
from distal.render.sampling.points import Stream
from distal.render.scatter import SHARPEST, Meeting
from distal.render.vertices import Vertex
from distal.scene.lowering.ray_functions import Define
from distal.scene.lowering.scattering import scattering_functions
from distal.scene.lowering.shapes import ShapeComposer
from distal.scene.lowering.union_parts import painted_parts_of
from distal.scene.tree.conversion import Number
from distal.scene.tree.node import Node
from distal.scene.tree.values import StatementList

if TYPE_CHECKING:
    from distal.scene.scene import Scene

# The most members whose boxes are joined one by one.
MOST_MEMBERS: Final = 64
_WITHOUT_DIFFUSE: Final = frozenset((glass.name, metal.name, mirror.name, *METALS, *CLEAR))


def casts_caustics(scene: Scene) -> bool:
    """Return whether a scene has lights that photons start from and parts that bundle light."""
    lit = any(light.sample is not None or light.directions for light in scene.lights)
    return lit and scene.shadows and bool(bundling_parts(scene))


def bundling_parts(scene: Scene) -> list[Node]:
    """Return the members of the scene's union whose material may bundle light."""
    parts = painted_parts_of(scene.shape.node)
    found = [node for node, outer in parts if _may_bundle(node, outer, scene.material)]
    return [scene.shape.node] if len(found) > MOST_MEMBERS else found


def _may_bundle(root: Node, around: Any, default: Any) -> bool:
    """Return whether a subtree has a material that may bundle light.

    Args:
        root: The subtree.
        around: The paint around it; None if there is none.
        default: The material of shapes without one.
    """
    stack: list[tuple[Node, Any]] = [(root, around)]
    while stack:
        node, outer = stack.pop()
        painted = node.material if outer is None else outer
        for material in (painted, node.cut_material):
            if material is not None and _bundles(material):
                return True
        if not node.children and painted is None and _bundles(default):
            return True
        stack.extend((child, painted) for child in node.children)
    return False


def _bundles(material: Any) -> bool:
    """Return whether a material may bundle light; its roughness may rule that out."""
    if not (material.reflects or material.refracts):
        return False
    values = material.call.values
    rough, diffuse = values.get("roughness"), values.get("diffuse")
    known = rough.plain if isinstance(rough, Number) else None
    if not isinstance(known, float):
        return True
    even = diffuse.plain != 0.0 if isinstance(diffuse, Number) else True
    only_mirrors = material.call.func.name in _WITHOUT_DIFFUSE
    widest = SHARPEST if even and not only_mirrors else photon_aim.WIDEST
    return bool(known * known <= widest)


class PhotonFunctions:
    """Makes the functions of photons in one program.

    Args:
        composer: Adds values to the program.
        define: Adds a function.
    """

    def __init__(self, composer: ShapeComposer, define: Define) -> None:
        self._composer = composer
        self._define = define
        self._numbers: dict[str, Expr] = {}

    def _number(self, name: str, type: Any, value: Any) -> Expr:
        if name not in self._numbers:
            self._numbers[name] = self._composer.assembly.number(name, type, value)
        return self._numbers[name]

    def target(self) -> Expr:
        """Return the box that photons cross."""
        corners = (
            self._number(photons.LOW, VEC3, (1.0, 1.0, 1.0)),
            self._number(photons.HIGH, VEC3, (-1.0, -1.0, -1.0)),
        )
        return Construct(corners, self._composer.assembly.struct(Bounds))

    def cells(self) -> Expr:
        """Return the grid of photons."""
        parts = (
            self._number(photons.RADIUS, FLOAT, 1.0),
            self._number(photons.SLOTS, INT, 1),
            self._number(photons.MAPS, INT, 1),
            self._number(photons.SHARE, FLOAT, 0.0),
        )
        return Construct(parts, self._composer.assembly.struct(photons.PhotonCells))

    def given(self, *, has_photons: bool) -> dict[str, Expr]:
        """Return what a path takes, by name of ``paths.path_light``."""
        if not has_photons:
            return {
                "target": self._composer.call(photon_aim.no_target, {}),
                "caustics": self._gather(None),
                "has_photons": boolean(False),
            }
        assembly = self._composer.assembly
        # Stubs describe a buffer by the type of its elements; here it is a resource.
        buffers = {
            "places": assembly.resource(cast(Any, photons.PLACES), "Photon_places"),
            "arrivals": assembly.resource(cast(Any, photons.ARRIVALS), "Photon_arrivals"),
            "starts": assembly.resource(cast(Any, photons.STARTS), "Photon_starts"),
        }
        return {
            "target": self.target(),
            "caustics": self._gather({**buffers, "cells": self.cells()}),
            "has_photons": boolean(True),
        }

    def _gather(self, tables: Mapping[str, Expr] | None) -> FunctionRef:
        """Return the function ``(vertex, meeting, stream) -> vec3``."""

        def make(body: StatementList, given: Mapping[str, Expr]) -> Expr:
            if tables is None:
                return self._composer.call(photons.none_gathered, given)
            respond = scattering_functions(self._composer, self._define)["respond"]
            return self._composer.call(photons.gathered, {**given, **tables, "respond": respond})

        struct = self._composer.assembly.struct
        params = [("vertex", struct(Vertex)), ("meeting", struct(Meeting))]
        params.append(("stream", struct(Stream)))
        return self._define("caustics", params, make, [])
