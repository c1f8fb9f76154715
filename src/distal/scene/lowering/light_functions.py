"""The functions of one scene's lights, its background and its fog.

Input: a scene. Output: functions in a program: the light with a number at a point, ambient light on
a surface and from a direction, random directions to it, where shapes emit light, what is behind
everything.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from distal.ir.build import add, boolean, compare, integer, number
from distal.ir.nodes import CompareOp, Expr, FunctionRef, If, Return
from distal.ir.types import INT, VEC3
from distal.render import lamps, shade, surroundings
from distal.render.lights import no_light
from distal.render.shadows import SHARPEST
from distal.scene.lowering.lamps import is_ball, lamps_of
from distal.scene.lowering.ray_functions import Define
from distal.scene.lowering.shapes import ShapeComposer
from distal.scene.tree.node import Node
from distal.scene.tree.values import StatementList

if TYPE_CHECKING:
    from distal.scene.scene import Scene


class LightFunctions:
    """Makes the functions of a scene's lights.

    Args:
        composer: Adds values to the program.
        scene: The scene.
        numbers: The scene's numbers, by name.
        define: Adds a function.
    """

    def __init__(
        self, composer: ShapeComposer, scene: Scene, numbers: Mapping[str, Expr], define: Define
    ) -> None:
        self._composer = composer
        self._scene = scene
        self._numbers = numbers
        self._define = define

    @property
    def count(self) -> int:
        """How many lights have a position or a direction."""
        return len(self._samples())

    @property
    def some_sharp(self) -> bool:
        """Whether a light may be so sharp that its shadows need no second march."""
        return any(_may_be_sharp(sample) for sample in self._samples())

    def _samples(self) -> list[Any]:
        return [light.sample for light in self._scene.lights if light.sample is not None]

    def lights(self) -> FunctionRef:
        """Return the function of a light's number to its light at a place; called in one loop."""

        def make(body: StatementList, given: Mapping[str, Expr]) -> Expr:
            site = {"p": given["p"]}
            calls = [light.emit(self._composer, site) for light in self._samples()]
            if not calls:
                return self._composer.call(no_light, {})
            for i, call in enumerate(calls[:-1]):
                chosen = compare(CompareOp.EQ, given["i"], integer(i))
                body.statements.append(If(chosen, (Return(call),), ()))
            last: Expr = calls[-1]
            return last

        return self._define("light", [("i", INT), ("p", VEC3)], make, [])

    def ambient(self, of: str) -> FunctionRef:
        """Return the ambient light on a surface by its normal ``n``, or from a ``direction``."""

        def make(body: StatementList, given: Mapping[str, Expr]) -> Expr:
            total: Expr = number(0.0, VEC3)
            for light in self._scene.lights:
                call = light.ambient if of == "n" else light.radiance
                if call is not None:
                    total = body.let("total", add(total, call.emit(self._composer, given)))
            return total

        return self._define("ambient" if of == "n" else "around", [(of, VEC3)], make, [])

    def directions(self) -> dict[str, Expr]:
        """Return random directions for ambient light, by name of ``paths.path_light``."""
        known = next((d for light in self._scene.lights if (d := light.directions)), None)

        def make(body: StatementList, given: Mapping[str, Expr]) -> Expr:
            if known is None:
                return self._composer.call(surroundings.no_direction, {})
            return known[0].emit(self._composer, given)

        def density(body: StatementList, given: Mapping[str, Expr]) -> Expr:
            return number(0.0) if known is None else known[1].emit(self._composer, given)

        return {
            "directions": self._define("directions", [("u", VEC3)], make, []),
            "directions_density": self._define(
                "directions_density", [("direction", VEC3)], density, []
            ),
            "has_directions": boolean(known is not None),
        }

    def lamps(self, node: Node) -> dict[str, Expr]:
        """Return where shapes that emit light are, by name of ``paths.path_light``.

        Args:
            node: The tree of the scene, without a table.
        """
        composer = self._composer
        found = lamps_of(node, self._scene.material)

        def make(body: StatementList, given: Mapping[str, Expr]) -> Expr:
            for i, lamp in enumerate(found):
                inside = StatementList(taken=body.taken)
                box = composer.bounds.of(inside, lamp, composer.values.all(lamp)).bounds
                asked = {"bounds": box, "round": boolean(is_ball(lamp))}
                inside.statements.append(Return(composer.call(lamps.lamp_in, asked)))
                chosen = compare(CompareOp.EQ, given["i"], integer(i))
                body.statements.append(If(chosen, tuple(inside.statements), ()))
            return composer.call(lamps.no_lamp, {})

        return {
            "lamps": self._define("lamp", [("i", INT)], make, []),
            "lamp_count": integer(len(found)),
        }

    def background(self) -> FunctionRef:
        """Return the function of a direction to the light without a surface."""

        def make(body: StatementList, given: Mapping[str, Expr]) -> Expr:
            return self._scene.background.emit(self._composer, given)

        return self._define("background", [("direction", VEC3)], make, [])

    def fog(self) -> FunctionRef:
        """Return the function of a direction to the fog's color: the author's, or the horizon's."""
        scene = self._scene

        def make(body: StatementList, given: Mapping[str, Expr]) -> Expr:
            if "fog" in self._numbers:
                return self._numbers["fog"]
            density = scene.numbers["fog_density"]
            if not density.may_exceed(0.0):
                return number(0.0, VEC3)
            level = self._composer.call(shade.at_horizon, given)
            return scene.background.emit(self._composer, {"direction": body.let("level", level)})

        return self._define("fog", [("direction", VEC3)], make, [])


def _may_be_sharp(sample: Any) -> bool:
    """Return whether a light may be as sharp as ``SHARPEST``."""
    values = getattr(sample.values.get("light"), "values", sample.values)  # below a falloff
    sizes = [values[name].plain for name in ("angle", "radius") if name in values]
    return not any(isinstance(size, float) and size > 2.0 * SHARPEST for size in sizes)
