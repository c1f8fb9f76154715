"""A scene's arguments completed by a look: what the author gives replaces that part alone.

Input: the arguments of a ``Scene`` as the author passed them, and a look. Output: shapes, lights,
camera, background, material and numbers of the scene. Does not depend on rendering.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from distal.at_once import cached_property
from distal.diagnostics import Span
from distal.fields.combine import joins
from distal.lang.functions import Func
from distal.scene.looks.boxes import subject_box
from distal.scene.looks.dressing import Dressing
from distal.scene.looks.look import Look
from distal.scene.lowering.parts.table import keep_table
from distal.scene.lowering.union_parts import placed_parts_of
from distal.scene.objects.backgrounds import Background, Surroundings, as_background
from distal.scene.objects.cameras import BaseCamera
from distal.scene.objects.field import BaseShape
from distal.scene.objects.lights import Light
from distal.scene.objects.materials import Material, as_material
from distal.scene.scene_arguments import (
    checked_camera,
    checked_lights,
    contents_of,
    with_surroundings,
)
from distal.scene.tree.node import Node
from distal.scene.tree.placement import is_placement


@dataclass(frozen=True, slots=True)
class GivenArguments:
    """The arguments of a ``Scene`` that a look may replace; None for those not given."""

    shape: Any
    lights: Any
    camera: Any
    background: Any
    material: Any
    tone_map: str | Func | None
    numbers: Mapping[str, Any]


class Dressed:
    """The parts of a scene: the author's, else the look's.

    Args:
        given: The author's arguments.
        look: The look.
        place: The author's line.
        staged: Values of parameters and the time that decide the box of the picture; None for
            defaults and 0.
    """

    def __init__(
        self,
        given: GivenArguments,
        look: Look,
        place: Span | None,
        staged: tuple[Mapping[str, Any], float] | None,
    ) -> None:
        self._given, self._place = given, place
        self.contents = contents_of(given.shape, place, alone=given.camera is None)
        self.shape = self.contents.shape
        params, time = staged or ({}, 0.0)
        self._dressing = Dressing(
            look, lambda: subject_box(self.shape.node, params, time), params, time
        )
        self.given_lights = checked_lights(given.lights, place)
        self._own_lights = (*self.given_lights, *self.contents.lights)
        self._has_lights = given.lights is not None or bool(self.contents.lights)
        skies = any(isinstance(light, Surroundings) for light in self._own_lights)
        self._own_background = given.background is not None or skies
        self._own_camera = self.contents.camera
        if given.camera is not None:
            self._own_camera = checked_camera(given.camera, place)
        if self._own_camera is not None:
            self._dressing.follow(self._own_camera, params, time)

    def wants_floor(self, *, named: bool) -> bool:
        """Return whether the scene stands on the look's floor if its author does not say.

        Args:
            named: Whether the author named a look.
        """
        bare = not self._has_lights and self._given.background is None
        box = self._dressing.box
        fits = not box.endless and not box.cut and not self._dressing.is_seen_from_below
        return (named or bare) and fits

    def shown_shape(self, *, floor: bool) -> BaseShape:
        """Return the shape, and the floor if it stands on it.

        Infinite parts around finite ones are the ground: if their author painted nothing, they have
        the floor's material.

        Args:
            floor: Whether to add the look's floor.
        """
        shape = self.shape
        ground = self._unpainted_ground() if self._given.material is None else set()
        if ground:
            painted = _painted(shape.node, ground, self._dressing.ground)
            keep_table(shape.node, painted)
            shape = BaseShape._of(painted)
        return shape.union(self._dressing.floor) if floor else shape

    def _unpainted_ground(self) -> set[int]:
        """Return the ids of the infinite parts without a material, around finite ones."""
        if all(_is_painted(placed) for placed, _ in placed_parts_of(self.shape.node)):
            return set()
        box = self._dressing.box
        found = {id(node) for placed, node in box.endless if not _is_painted(placed)}
        return set() if box.cut else found

    @cached_property
    def background(self) -> Background:
        """The background."""
        if self._own_background:
            return as_background(self._given.background, self._own_lights, self._place)
        return self._dressing.background

    @property
    def lights(self) -> tuple[Light, ...]:
        """The lights, and that of the background."""
        around = self.background.light
        if not self._has_lights and around is None:
            return self._dressing.lights
        return with_surroundings(self._own_lights, around)

    @property
    def camera(self) -> BaseCamera:
        """The camera."""
        return self._own_camera or self._dressing.camera

    @property
    def material(self) -> Material:
        """The material of shapes without ``paint``."""
        given = self._given.material
        return self._dressing.material if given is None else as_material(given)

    @property
    def tone_map(self) -> str | Func:
        """The name of the tone map, or the author's function."""
        given = self._given.tone_map
        return self._dressing.look.row.tone_map if given is None else given

    @property
    def numbers(self) -> dict[str, Any]:
        """The numbers of the scene; None for a far end that follows from the scene's boxes."""
        found = dict(self._given.numbers)
        for name, value in found.items():
            if value is None and name != "far":
                found[name] = getattr(self, f"_{name}")
        return found

    @property
    def _exposure(self) -> Any:
        return self._dressing.look["exposure"]

    @property
    def _fog(self) -> Any:
        """The color of the fog; None for that of the author's background at the horizon."""
        return None if self._own_background else self._dressing.look["horizon"]

    @property
    def _fog_density(self) -> Any:
        return 0.0 if self._own_background else self._dressing.fog_density

    @property
    def _ambient_occlusion(self) -> float:
        return self._dressing.occlusion


def _is_painted(root: Node) -> bool:
    return root.material is not None or any(node.material is not None for node in root.walk())


def _painted(node: Node, parts: set[int], material: Material) -> Node:
    """Return a tree of unions and placements with a material on some of its parts.

    Args:
        node: The root.
        parts: The ids of the parts.
        material: The material.
    """
    if id(node) in parts:
        return replace(node, material=material)
    passes = node.rule is joins.UNION or is_placement(node.rule)
    if not passes or node.material is not None:
        return node
    children = tuple(_painted(c, parts, material) for c in node.children)
    changes = any(new is not old for new, old in zip(children, node.children, strict=True))
    return replace(node, children=children) if changes else node
