"""A ruler on a scene: places on its surface, and their distance, for windows.

Input: a place in the picture, the movement of the camera, the scene's parameters and time. Output:
the place on the surface; of two places, the measures and where they are seen. The arithmetic is
scene code (``render/ruler.py``); pages run the same programs by WebGL.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from distal.lang.number_text import shown
from distal.render.ruler import KINDS, NOTHING, PLACE_NUMBERS, POINTS, RULER_NUMBERS, UNSEEN
from distal.scene.lowering import ruler as uniforms
from distal.scene.lowering.ruler import PlaceImage, RulerImage
from distal.scene.section import CutPlane
from distal.scene.steering import STILL, Steering
from distal.scene.viewing import measuring
from distal.scene.viewing.number_rows import NumberRow

if TYPE_CHECKING:
    from distal.scene.scene import Scene
    from distal.scene.viewing.guide import Moment

MINUS: Final = "\N{MINUS SIGN}"
_PLACES: Final = tuple(f"{axis}{i}" for i in range(POINTS) for axis in ("right", "up"))


@dataclass(frozen=True, slots=True)
class RulerEnd:
    """An end of a ruler.

    Attributes:
        point: Its place, in scene units.
        kind: What it is on: "surface", "edge" or "corner".
        pixel: The size of a pixel there when it was chosen, in scene units.
    """

    point: tuple[float, float, float]
    kind: str
    pixel: float


@dataclass(frozen=True, slots=True)
class SeenRuler:
    """A ruler in a picture.

    Attributes:
        distance: The distance of its ends, in scene units.
        differences: The second end less the first, along x, y and z.
        places: Where points along it are seen, the ends among them: fractions of the picture's
            width and height from its upper left; None for a point that is not seen.
    """

    distance: float
    differences: tuple[float, float, float]
    places: tuple[tuple[float, float] | None, ...]


class Ruler:
    """Measures one scene, whole or cut open."""

    def __init__(self, scene: Scene) -> None:
        self._place = NumberRow(PlaceImage(scene), PLACE_NUMBERS)
        self._ruler = NumberRow(RulerImage(scene), (*RULER_NUMBERS, *_PLACES))

    @property
    def finds(self) -> bool:
        """Whether the program that finds places is compiled."""
        return self._place.is_ready

    @property
    def shows(self) -> bool:
        """Whether the program that shows rulers is compiled."""
        return self._ruler.is_ready

    def prepare_places(self, moment: Moment, section: CutPlane | None) -> None:
        """Compile the program that finds places, which takes up to a few seconds."""
        self.place_at(0.5, 0.5, moment, STILL, section)

    def prepare_seen(self, moment: Moment) -> None:
        """Compile the program that shows rulers."""
        nowhere = RulerEnd((0.0, 0.0, 0.0), KINDS[NOTHING], 1.0)
        self.seen(nowhere, nowhere, moment, STILL)

    def place_at(
        self, x: float, y: float, moment: Moment, steering: Steering, section: CutPlane | None
    ) -> RulerEnd | None:
        """Return the place on the surface at a place in the picture; None if nothing is there.

        Args:
            x: Fraction of the picture's width, from its left.
            y: Fraction of the picture's height, from its top.
            moment: Size of the picture, time and parameters.
            steering: How a person has moved the camera.
            section: The plane of a scene that is cut open.
        """
        size = _size(moment)
        given = {uniforms.POINTER: (x * size[0], (1.0 - y) * size[1])}
        found = self._read(self._place, given, moment, steering, section)
        is_finite = all(map(math.isfinite, found.values())) and found["pixel"] > 0.0
        kind = KINDS[round(found["kind"])] if is_finite else KINDS[NOTHING]
        if kind == KINDS[NOTHING]:
            return None
        return RulerEnd((found["x"], found["y"], found["z"]), kind, found["pixel"])

    def seen(self, start: RulerEnd, end: RulerEnd, moment: Moment, steering: Steering) -> SeenRuler:
        """Return a ruler's measures, and where it is seen.

        Args:
            start: Its first end.
            end: Its second end.
            moment: Size of the picture, time and parameters.
            steering: How a person has moved the camera.
        """
        size = _size(moment)
        given = {uniforms.START: start.point, uniforms.END: end.point}
        found = self._read(self._ruler, given, moment, steering, None)
        distance, x, y, z = (found[name] for name in RULER_NUMBERS)
        places = []
        for i in range(POINTS):
            right, up = found[f"right{i}"], found[f"up{i}"]
            place = (right / size[0], 1.0 - up / size[1])
            places.append(place if right < UNSEEN else None)
        return SeenRuler(distance, (x, y, z), tuple(places))

    def _read(
        self,
        row: NumberRow,
        given: dict[str, Any],
        moment: Moment,
        steering: Steering,
        section: CutPlane | None,
    ) -> dict[str, float]:
        plane = {} if section is None else section.settings
        settings = {**steering.settings, **plane, **given, uniforms.SIZE: _size(moment)}
        return row.read(settings, time=moment.time, params=moment.params)


def _size(moment: Moment) -> tuple[float, float]:
    width, height = moment.size
    return max(width, 1.0), max(height, 1.0)


def measures_text(start: RulerEnd, end: RulerEnd, seen: SeenRuler, unit: str) -> tuple[str, ...]:
    """Return the lines of a ruler's label: its length, the differences, its two ends.

    Numbers are rounded to about a hundredth of a pixel.

    Args:
        start: Its first end.
        end: Its second end.
        seen: Its measures.
        unit: The unit of length, such as "mm".
    """
    pixel = min(start.pixel, end.pixel)
    axes = "   ".join(
        f"Δ{axis} {_number(n, pixel)}" for axis, n in zip("xyz", seen.differences, strict=True)
    )
    return (
        f"{_number(seen.distance, pixel)} {unit}",
        axes,
        f"from {end_text(start)}",
        f"to {end_text(end)}",
    )


def end_text(end: RulerEnd) -> str:
    """Return an end as a person reads it: "(0, 10, 20), corner"."""
    point = ", ".join(_number(n, end.pixel) for n in end.point)
    return f"({point}), {end.kind}"


def _number(value: float, pixel: float) -> str:
    return shown(measuring.measured(value, pixel)).replace("-", MINUS)
