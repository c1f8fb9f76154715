"""The functions of one scene's camera, at rest and moved by a person.

Input: a scene. Output: functions in a program: the ray of a place in the picture, what a movement
has to know of the camera. A program has one camera of each kind, and one set of numbers that move
it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

from distal.ir.build import field, integer, number
from distal.ir.nodes import Call, Construct, Expr, FunctionRef, Return
from distal.ir.types import FLOAT, VEC2, VEC3, Type
from distal.render import camera, path_film, steer
from distal.render.camera import Ray
from distal.render.sampling import points
from distal.scene import steering
from distal.scene.lowering.ray_functions import Define
from distal.scene.lowering.shapes import ShapeComposer
from distal.scene.tree.node import Node
from distal.scene.tree.values import StatementList

if TYPE_CHECKING:
    from distal.scene.scene import Scene


class CameraFunctions:
    """Makes the functions of a scene's camera.

    Args:
        composer: Adds values to the program.
        scene: The scene.
        node: The scene's tree.
        define: Adds a function.
    """

    def __init__(self, composer: ShapeComposer, scene: Scene, node: Node, define: Define) -> None:
        self._composer = composer
        self._scene = scene
        self._node = node
        self._define = define
        self._cameras: dict[str, FunctionRef] = {}
        self._steers: dict[str, tuple[Expr, ...]] = {}

    def ray(self, resolution: Expr, *, steered: bool) -> FunctionRef:
        """Return the function of a place in a picture of this size to its ray.

        Args:
            resolution: Size of the picture in pixels.
            steered: Whether the camera is moved by the numbers of a ``Steering``.
        """
        return self._steered(resolution) if steered else self._camera(resolution)

    def exposed(self, resolution: Expr, *, steered: bool) -> FunctionRef:
        """Return the function of a place in the picture and random numbers to a ray of the lens.

        Args:
            resolution: Size of the picture in pixels.
            steered: Whether the camera is moved by the numbers of a ``Steering``.
        """
        composer, lens = self._composer, self._scene.camera.lens

        def make(body: StatementList, given: Mapping[str, Expr]) -> Expr:
            ray = self.ray(given["resolution"], steered=steered)
            if lens is None:
                return Call(ray.name, (given["uv"], *ray.captures), composer.assembly.struct(Ray))
            decision = {**given, "decision": integer(path_film.PLACE_ON_LENS)}
            target = self._scene.camera.number(composer, "target")
            asked = {
                **given,
                "camera": ray,
                "still": self._camera(given["resolution"]),
                "target": number(0.0, VEC3) if target is None else target,
                "zoom": field(self.steer(body, steering.PREFIX), "zoom")
                if steered
                else number(1.0),
                "lens": lens.emit(composer, {}),
                "u": composer.call(points.pair, decision),
            }
            return composer.call(camera.through_lens, asked)

        name = "exposed_ray"
        stream = composer.assembly.struct(points.Stream)
        params = [("uv", VEC2), ("stream", stream), ("resolution", VEC2)]
        return self._camera_function(name, make, resolution, params)

    def _steered(self, resolution: Expr) -> FunctionRef:
        """Return the camera moved by the numbers of a ``Steering``."""

        def make(body: StatementList, given: Mapping[str, Expr]) -> Expr:
            asked = {**given, "camera": self._camera(given["resolution"])}
            asked["lens"] = self.lens(body, given["resolution"])
            asked["steer"] = self.steer(body, steering.PREFIX)
            asked["rig"] = body.let("rig", self._composer.call(steer.rig, asked))
            return self._composer.call(steer.steered_ray, asked)

        return self._camera_function("steered_ray", make, resolution)

    def lens(self, body: StatementList, resolution: Expr) -> Expr:
        """Return what a movement has to know of the camera, for a picture of some pixels."""
        own = self._scene.camera
        given = {"camera": self._camera(resolution), "up": self._up()}
        given["pivot"] = own.number(self._composer, "target") or self._pivot(body, given)
        return body.let("lens", self._composer.call(steer.lens, given))

    def steer(self, body: StatementList, prefix: str) -> Expr:
        """Return the five numbers of a ``Steering``, which are uniforms with this prefix."""
        if prefix not in self._steers:
            self._steers[prefix] = tuple(
                self._composer.assembly.number(f"{prefix}{n}", t, v) for n, t, v in steering.NUMBERS
            )
        steered = Construct(self._steers[prefix], self._composer.assembly.struct(steer.Steer))
        return body.let("steer", steered)

    def elevation(self) -> str:
        """Add the function that returns the camera's elevation above its target."""
        given = {
            "camera": self._camera(self._composer.assembly.constant((1.0, 1.0), VEC2)),
            "up": self._up(),
        }
        value = self._composer.call(steer.elevation, given)
        return self._composer.assembly.define("elevation", (), FLOAT, (Return(value),))

    def _up(self) -> Expr:
        """Return the camera's vertical axis."""
        found = self._scene.camera.number(self._composer, "up")
        return self._composer.assembly.constant((0.0, 1.0, 0.0), VEC3) if found is None else found

    def _pivot(self, body: StatementList, given: Mapping[str, Expr]) -> Expr:
        """Return the point that a camera without a target is rotated about."""
        values = self._composer.values.all(self._node)
        bounds = self._composer.bounds.of(body, self._node, values).bounds
        return self._composer.call(steer.pivot_within, {**given, "bounds": bounds})

    def _camera(self, resolution: Expr) -> FunctionRef:
        def make(body: StatementList, given: Mapping[str, Expr]) -> Expr:
            return self._scene.camera.emit(self._composer, given)

        return self._camera_function("camera_ray", make, resolution)

    def _camera_function(
        self,
        name: str,
        make: Callable[[StatementList, Mapping[str, Expr]], Expr],
        resolution: Expr,
        params: Sequence[tuple[str, Type]] = (("uv", VEC2), ("resolution", VEC2)),
    ) -> FunctionRef:
        """Return a camera for a picture of this size; its function is defined once.

        Args:
            name: The name of the function.
            make: Makes its value.
            resolution: Size of the picture in pixels.
            params: Its parameters; the last one is the resolution.
        """
        if name not in self._cameras:
            self._cameras[name] = self._define(name, params, make, [resolution])
        known = self._cameras[name]
        return FunctionRef(known.name, (resolution,), known.type)
