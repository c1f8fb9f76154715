"""The programs of a scene's photons, which run before each pass of a picture by paths.

Input: a scene. Output: a function from the number of a photon to where it ends, and one that
returns what they all depend on; for pages, both also as images that draw several pictures at once.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, ClassVar

from distal.frontend import Assembly
from distal.ir.build import field, swizzle
from distal.ir.nodes import EntryKind, Expr, Param, Read, Return
from distal.ir.types import FRAME, INT, VEC2, Type
from distal.lang.composed import Composed
from distal.lang.functions import Func
from distal.loading import copy_loaded_from
from distal.render import film, photon_aim, photons
from distal.render.paths import MOST_SEGMENTS
from distal.scene.lowering.photon_functions import PhotonFunctions, bundling_parts
from distal.scene.lowering.picture import SceneLowering
from distal.scene.lowering.shapes import ZERO_CELL
from distal.scene.tree.values import StatementList

if TYPE_CHECKING:
    from distal.scene.scene import Scene


class PlanFunction(Composed):
    """What the photons of a picture depend on, as a function of the frame."""

    kind: ClassVar[EntryKind] = EntryKind.FUNCTION
    signature = (("frame", FRAME),)

    def __init__(self, scene: Scene, *, steered: bool) -> None:
        copy_loaded_from(scene, self)
        self.name = f"{scene.name} (photons' plan)"
        self.scene, self._steered = scene, steered

    def compose(self, assembly: Assembly) -> str:
        """Add the function, and return its name."""
        body = StatementList(taken={"frame"})
        plan = self.plan(assembly, body)
        self.result = plan.type
        body.statements.append(Return(plan))
        params = (Param("frame", FRAME),)
        return assembly.define("plan", params, plan.type, body.statements, self.scene.place)

    def plan(self, assembly: Assembly, body: StatementList) -> Expr:
        """Add statements that compute the plan of a frame, and return it."""
        made = SceneLowering(assembly, self.scene, paths=True)
        composer = made.composer
        resolution = field(Read("frame", FRAME), "resolution")
        target = composer.call(photon_aim.no_target, {})
        for node in bundling_parts(self.scene):
            box = composer.bounds.of(body, node, composer.values.all(node)).bounds
            both = {"target": body.let("target", target), "bounds": box}
            target = composer.call(photon_aim.target_with, both)
        given: dict[str, Expr] = {
            "target": body.let("target", target),
            "camera": made.camera.ray(resolution, steered=self._steered),
            "resolution": resolution,
        }
        return composer.call(photons.photon_plan, given)

    def functions(self) -> Iterable[Func]:
        """Yield the scene functions that this object calls."""
        return self.scene.functions()


class DepositFunction(Composed):
    """The function from the number of a photon to where it ends."""

    kind: ClassVar[EntryKind] = EntryKind.FUNCTION
    signature: tuple[tuple[str, Type], ...] = (("number", INT),)

    def __init__(self, scene: Scene, *, steered: bool) -> None:
        copy_loaded_from(scene, self)
        self.name = f"{scene.name} (photons)"
        self.scene, self._steered = scene, steered

    def compose(self, assembly: Assembly) -> str:
        """Add the function, and return its name."""
        body = StatementList(taken={"number"})
        found = self.deposit(assembly, body, Read("number", INT))
        self.result = found.type
        body.statements.append(Return(found))
        params = (Param("number", INT),)
        return assembly.define("photon", params, found.type, body.statements, self.scene.place)

    def deposit(self, assembly: Assembly, body: StatementList, number: Expr) -> Expr:
        """Add statements that follow a photon with a given number, and return its deposit."""
        made = SceneLowering(assembly, self.scene, paths=True)
        # Of the picture that the paths see, which the ends of rays in infinite scenes depend on.
        resolution = assembly.number(film.PICTURE_SIZE, VEC2, (640.0, 480.0))
        known = made.given(body, resolution, steered=self._steered, paths=True)
        values = made.composer.values.all(made.node)
        functions = PhotonFunctions(made.composer, made._function)
        given: dict[str, Expr] = {
            **known,
            **made.given_at_hits(),
            "field": made.composer.safe_field(made.node, values, ZERO_CELL),
            "number": number,
            "target": functions.target(),
            "cells": functions.cells(),
            "seed": assembly.number(photons.SEED, INT, 0),
            "index": assembly.number(photons.FRAME_INDEX, INT, 0),
            "first_sample": assembly.number(film.FIRST_SAMPLE, INT, 0),
            "most": assembly.number(photons.MOST_FOLLOWED, INT, MOST_SEGMENTS),
        }
        return made.composer.call(photons.deposit, given)

    def functions(self) -> Iterable[Func]:
        """Yield the scene functions that this object calls."""
        return self.scene.functions()


class PlanPicture(PlanFunction):
    """What the photons of a pass depend on, as two pictures of equal pixels."""

    kind: ClassVar[EntryKind] = EntryKind.IMAGE

    def compose(self, assembly: Assembly) -> str:
        """Add the function that maps the frame to a pixel, and return its name."""
        body = StatementList(taken={"frame"})
        given = {
            "plan": self.plan(assembly, body),
            "first_sample": assembly.number(film.FIRST_SAMPLE, INT, 0),
        }
        return _as_image(self, assembly, body, photons.plan_image, given)


class DepositPicture(DepositFunction):
    """The photons of a pass as three pictures: each pixel follows a photon, only once."""

    kind: ClassVar[EntryKind] = EntryKind.IMAGE
    signature = (("frame", FRAME),)

    def compose(self, assembly: Assembly) -> str:
        """Add the function that maps the frame to a pixel, and return its name."""
        body = StatementList(taken={"frame"})
        frame = Read("frame", FRAME)
        place: dict[str, Expr] = {
            "coord": field(frame, "coord"),
            "width": swizzle(field(frame, "resolution"), "x"),
        }
        number = assembly.call(photons.photon_at, place)
        given = {"found": self.deposit(assembly, body, number)}
        return _as_image(self, assembly, body, photons.deposit_image, given)


def _as_image(
    owner: PlanFunction | DepositFunction,
    assembly: Assembly,
    body: StatementList,
    function: Func,
    given: Mapping[str, Expr],
) -> str:
    """Add the function that returns a pixel of several pictures, and return its name.

    Args:
        owner: The program.
        assembly: The functions of the program.
        body: The statements of the function so far.
        function: What makes the pixel.
        given: Its arguments by name.
    """
    made = assembly.call(function, given)
    owner.result = made.type
    body.statements.append(Return(made))
    params = (Param("frame", FRAME),)
    return assembly.define("picture", params, made.type, body.statements, owner.scene.place)


def photon_images(scene: Scene) -> tuple[PlanPicture, DepositPicture]:
    """Return the programs of the photons of a live picture, whose camera is steered."""
    return PlanPicture(scene, steered=True), DepositPicture(scene, steered=True)


def scene_photons(scene: Scene, *, steered: bool) -> tuple[PlanFunction, DepositFunction]:
    """Return the programs of a scene's photons.

    Args:
        scene: The scene.
        steered: Whether the camera is moved by the numbers of a ``Steering``.
    """
    return PlanFunction(scene, steered=steered), DepositFunction(scene, steered=steered)
