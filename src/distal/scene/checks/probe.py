"""A report about one pixel of a scene: its ray, the march, the shape and the material that it hit.

Input: a scene and a pixel. Output: a ``Probed``: plain values and nodes of the tree. It is computed
by a small program that calls the scene's functions and the same march as the picture.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from distal.diagnostics import place_json
from distal.frontend import Assembly
from distal.ir.nodes import Param, Read, Return
from distal.ir.types import VEC2
from distal.lang.composed import Composed
from distal.lang.functions import Func
from distal.lang.render_options import place_of_pixel
from distal.lang.runtime_access import executor
from distal.render.look_along import Seen, look_along
from distal.render.march import OUT_OF_STEPS, PASSED
from distal.scene.checks.validation import guarantee_names
from distal.scene.lowering.attributes import ListedMaterial, Part
from distal.scene.lowering.part_map import path_in
from distal.scene.lowering.picture import SceneLowering
from distal.scene.scene import Scene
from distal.scene.steering import Steering
from distal.scene.tree.node import Node
from distal.scene.tree.values import StatementList

# The numbers of a material, fields of ``render.material.Surface``.
_NUMBERS = ("diffuse", "specular", "transmission", "ior", "roughness", "metal", "fresnel")
_COLORS = ("color", "emission", "absorption")


@dataclass(frozen=True, slots=True)
class Probed:
    """The ray, the hit and the shading of a pixel.

    Attributes:
        pixel: Column and row, from the upper left.
        size: Size of the picture in pixels.
        seen: The numbers of ``render.look_along.Seen``.
        ended: How the march ended: "hit", "left the box", "left the scene", "passed the box" or
            "ran out of steps".
        path: The shape that was hit and the shapes that contain it, outermost first; empty if
            nothing was hit.
        material: The material of the hit, or None.
        slope: Bound on the slope of the whole shape.
    """

    pixel: tuple[int, int]
    size: tuple[int, int]
    seen: Any
    ended: str
    path: tuple[Node, ...]
    material: Any
    slope: float

    @property
    def hit(self) -> bool:
        """Whether a surface was hit."""
        return bool(self.seen.found)

    def as_json(self) -> dict[str, Any]:
        """Return plain values in the schema of ``docs/guide/checking.md``."""
        seen = self.seen
        made: dict[str, Any] = {
            "version": 1,
            "pixel": list(self.pixel),
            "size": list(self.size),
            "ray": {"origin": _plain(seen.origin), "direction": _plain(seen.direction)},
            "steps": int(seen.steps),
            "hit": self.hit,
            "ended": self.ended,
            "shape": None,
            "material": None,
        }
        if self.hit:
            made |= {
                "distance": float(seen.t),
                "inside": bool(seen.side < 0.0),
                "point": _plain(seen.p),
                "value": float(seen.value),
                "normal": _plain(seen.normal),
                "gradient": float(seen.steepness),
                "slope": self.slope,
                "shape": _shape_json(self.path),
                "material": _material_json(self.material, seen.surface),
            }
        return made


def probe(
    scene: Scene,
    pixel: tuple[int, int],
    size: tuple[int, int] = (640, 480),
    params: Mapping[str, Any] | None = None,
    time: float = 0.0,
    steering: Steering | None = None,
) -> Probed:
    """Return the ray, the hit and the shading of a pixel.

    Args:
        scene: The scene.
        pixel: Column and row from 0; rows count from the top, as in a picture's array.
        size: Width and height of the picture in pixels.
        params: Values of parameters by name; the others have their defaults.
        time: Time in seconds.
        steering: How a person has moved the camera; None if it was not moved.

    Raises:
        ValueError: The picture has no such pixel.
    """
    place = array("f", place_of_pixel(pixel, size))  # a picture's numbers have 32 bits
    program = _Program(scene, steered=steering is not None)
    resolution = array("f", size)
    settings = steering.settings if steering is not None else None
    seen = executor().call(
        program, (place, resolution), {}, params=params, time=time, settings=settings
    )
    slope = float(
        executor().call(scene.shape._bounds_function, (), {}, params=params, time=time)[0]
    )
    path: tuple[Node, ...] = ()
    material = None
    if seen.found:
        path = path_in(scene.shape.node, program.parts[round(seen.part)])
        material = program.paints[round(seen.paint)]
    return Probed(pixel, size, seen, _ended(seen), path, material, slope)


def _ended(seen: Any) -> str:
    if seen.found:
        return "hit"
    if seen.lost != PASSED:
        return "ran out of steps" if seen.lost == OUT_OF_STEPS else "ended at far"
    if seen.span.x > seen.span.y or seen.span.y < 0.0:
        return "passed the box"
    return "left the box" if seen.span.y < 1e9 else "left the scene"


class _Program(Composed):
    """The function that evaluates one place of a picture; lists shapes and materials by number."""

    def __init__(self, scene: Scene, *, steered: bool) -> None:
        self._scene, self._steered = scene, steered
        self.name = f"probe of {scene.name}"
        self.signature = (("coord", VEC2), ("resolution", VEC2))
        self.parts: Sequence[tuple[Node, ...]] = ()
        self.paints: Sequence[Any] = ()

    def compose(self, assembly: Assembly) -> str:
        """Add the function that returns a ``Seen``, and return its name."""
        body = StatementList(taken={"coord", "resolution"})
        made = SceneLowering(assembly, self._scene)
        resolution = Read("resolution", VEC2)
        given = made.given(body, resolution, steered=self._steered)
        given |= {"coord": Read("coord", VEC2), "resolution": resolution}
        part, paint = Part(made.composer), ListedMaterial(made.composer, self._scene.material)
        given["part"] = made.known_of_place("part", part)
        given["paint"] = made.known_of_place("paint", paint)
        self.parts, self.paints = part.paths, paint.materials
        self.result = assembly.struct(Seen)
        body.statements.append(Return(made.composer.call(look_along, given)))
        params = tuple(Param(name, type) for name, type in self.signature)
        return assembly.define("probe", params, self.result, body.statements)

    def functions(self) -> Iterable[Func]:
        """Yield the scene functions that the scene calls."""
        return self._scene.functions()


# Plain values


def _plain(value: Iterable[float]) -> list[float]:
    return [float(c) for c in value]


def _shape_json(path: Sequence[Node]) -> dict[str, Any]:
    leaf = path[-1]
    return {
        "name": leaf.name,
        "kind": leaf.rule.name,
        "claims": guarantee_names(leaf),
        "path": [node.name for node in path],
        "place": place_json(leaf.place),
    }


def _material_json(material: Any, surface: Any) -> dict[str, Any]:
    made: dict[str, Any] = {"name": material.call.what, "place": place_json(material.call.place)}
    made |= {name: _plain(getattr(surface, name)) for name in _COLORS}
    return made | {name: float(getattr(surface, name)) for name in _NUMBERS}
