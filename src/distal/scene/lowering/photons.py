"""The programs of a scene's photons, which run before each pass of a picture by paths.

Input: a scene. Output: a function from the number of a photon to where it ends, and one that
returns what they all depend on.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, ClassVar

from distal.frontend import Assembly
from distal.ir.build import field
from distal.ir.nodes import EntryKind, Expr, Param, Read, Return
from distal.ir.types import FRAME, INT, VEC2
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
        self._scene, self._steered = scene, steered

    def compose(self, assembly: Assembly) -> str:
        """Add the function, and return its name."""
        made = SceneLowering(assembly, self._scene, paths=True)
        composer = made.composer
        body = StatementList(taken={"frame"})
        resolution = field(Read("frame", FRAME), "resolution")
        target = composer.call(photon_aim.no_target, {})
        for node in bundling_parts(self._scene):
            box = composer.bounds.of(body, node, composer.values.all(node)).bounds
            both = {"target": body.let("target", target), "bounds": box}
            target = composer.call(photon_aim.target_with, both)
        given: dict[str, Expr] = {
            "target": body.let("target", target),
            "camera": made.camera.ray(resolution, steered=self._steered),
            "resolution": resolution,
        }
        plan = composer.call(photons.photon_plan, given)
        self.result = plan.type
        body.statements.append(Return(plan))
        params = (Param("frame", FRAME),)
        return assembly.define("plan", params, plan.type, body.statements, self._scene.place)

    def functions(self) -> Iterable[Func]:
        """Yield the scene functions that this object calls."""
        return self._scene.functions()


class DepositFunction(Composed):
    """The function from the number of a photon to where it ends."""

    kind: ClassVar[EntryKind] = EntryKind.FUNCTION
    signature = (("number", INT),)

    def __init__(self, scene: Scene, *, steered: bool) -> None:
        copy_loaded_from(scene, self)
        self.name = f"{scene.name} (photons)"
        self._scene, self._steered = scene, steered

    def compose(self, assembly: Assembly) -> str:
        """Add the function, and return its name."""
        made = SceneLowering(assembly, self._scene, paths=True)
        body = StatementList(taken={"number"})
        # Of the picture that the paths see, which the ends of rays in infinite scenes depend on.
        resolution = assembly.number(film.PICTURE_SIZE, VEC2, (640.0, 480.0))
        known = made.given(body, resolution, steered=self._steered, paths=True)
        values = made.composer.values.all(made.node)
        functions = PhotonFunctions(made.composer, made._function)
        given: dict[str, Expr] = {
            **known,
            **made.given_at_hits(),
            "field": made.composer.safe_field(made.node, values, ZERO_CELL),
            "number": Read("number", INT),
            "target": functions.target(),
            "cells": functions.cells(),
            "seed": assembly.number(photons.SEED, INT, 0),
            "index": assembly.number(photons.FRAME_INDEX, INT, 0),
            "first_sample": assembly.number(film.FIRST_SAMPLE, INT, 0),
            "most": assembly.number(photons.MOST, INT, MOST_SEGMENTS),
        }
        found = made.composer.call(photons.deposit, given)
        self.result = found.type
        body.statements.append(Return(found))
        params = (Param("number", INT),)
        return assembly.define("photon", params, found.type, body.statements, self._scene.place)

    def functions(self) -> Iterable[Func]:
        """Yield the scene functions that this object calls."""
        return self._scene.functions()


def scene_photons(scene: Scene, *, steered: bool) -> tuple[PlanFunction, DepositFunction]:
    """Return the programs of a scene's photons.

    Args:
        scene: The scene.
        steered: Whether the camera is moved by the numbers of a ``Steering``.
    """
    return PlanFunction(scene, steered=steered), DepositFunction(scene, steered=steered)
