"""What a look gives a scene: lights, background, camera, floor and material.

Input: a look, and the box of what the picture shows. Output: ordinary objects of the library, so a
look can do nothing that an author could not write. Angles of lights are relative to the camera,
positions and sizes to the box.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Final

from distal import Background, DistantLight, HemisphereLight, Plane, SpotLight, matte, pattern
from distal.at_once import cached_property
from distal.lang import cos, sin
from distal.render.backdrops import ruled
from distal.render.declarations import CAMERAS
from distal.render.framing import framed
from distal.scene.looks.boxes import SubjectBox, plain_number
from distal.scene.looks.look import Look
from distal.scene.objects.cameras import BaseCamera
from distal.scene.objects.declared import scene_call
from distal.scene.objects.field import BaseShape
from distal.scene.objects.lights import Light
from distal.scene.objects.lowest_point import lowest_of
from distal.scene.tree.arguments import slots_of

if TYPE_CHECKING:
    from distal.scene.objects.materials import Material

# The floor's depth below the box, in radii: less, and faces on the floor would flicker.
BELOW: Final = 1e-4
# The cone of a lamp, in radians; it fades from its axis on.
CONE: Final = 0.85
# Reach of ambient occlusion, in radii of the box.
REACH: Final = 0.5
# Width of a drawn line in radii; lines on the floor are darker than those on shapes.
LINE: Final = 0.009
INK, FLOOR_INK = (0.62, 0.80, 1.0), (0.07, 0.19, 0.43)


class FramingCamera(BaseCamera):
    """A camera that shows a whole box, whatever the picture's shape (``render.framing``).

    Args:
        look: The angles, the field of view and the margin.
        box: The box.
    """

    __slots__ = ()

    def __init__(self, look: Look, box: SubjectBox) -> None:
        given = {
            "target": box.middle,
            "half_size": tuple(max(half, 1e-3 * box.radius) for half in box.half_size),
            "azimuth": look["azimuth"],
            "elevation": look["elevation"],
            "fov": look["fov_deg"] * (math.pi / 180.0),
            "margin": look["margin"],
        }
        self._keep(call=scene_call(CAMERAS, framed, given, look.name, None), lens=None)


class Dressing:
    """The objects of a look for one scene, each made when it is first asked for.

    Args:
        look: The look.
        find_box: Returns the box of what the picture shows; called at most once.
        params: Values of parameters by name, for the floor; the others have their defaults.
        time: Time in seconds, for the floor.
    """

    def __init__(
        self,
        look: Look,
        find_box: Callable[[], SubjectBox],
        params: Mapping[str, Any],
        time: float,
    ) -> None:
        self.look = look
        self._params, self._time = params, time
        self._find_box = find_box
        self._azimuth: Any = look["azimuth"]
        self._eye_height = math.inf  # of the author's camera, where it is known

    @cached_property
    def box(self) -> SubjectBox:
        """The box of what the picture shows."""
        return self._find_box()

    def follow(self, camera: BaseCamera, params: Mapping[str, Any], time: float) -> None:
        """Put the lights around the author's camera as they are around the look's own.

        Args:
            camera: The author's camera. Where it stands at the start decides: lights do not move
                with a camera that moves.
            params: Values of parameters by name.
            time: Time in seconds.
        """
        values = camera.call.values
        if "position" in values:
            self._eye_height = plain_number(values["position"], params, time)[1]
        for name in ("azimuth", "yaw"):
            if name in values:
                self._azimuth = plain_number(values[name], params, time)
                return
        if "position" in values and "target" in values:
            eye = plain_number(values["position"], params, time)
            target = plain_number(values["target"], params, time)
            if math.hypot(eye[0] - target[0], eye[2] - target[2]) > 0.0:
                self._azimuth = math.atan2(eye[0] - target[0], eye[2] - target[2])

    @property
    def camera(self) -> BaseCamera:
        """The camera."""
        return FramingCamera(self.look, self.box)

    @property
    def lights(self) -> tuple[Light, ...]:
        """The lights: the main one, the second if it shines, and light from all sides."""
        look = self.look
        found = [self._light("light", look.row.main, look["light_angle"])]
        if look.numbers["rim_intensity"].may_exceed(0.0):
            found.append(self._light("rim", look.row.second, look.row.rim_angle))
        around = {"sky": look["sky"], "ground": look["ground"], "intensity": look["fill"]}
        return (*found, HemisphereLight(**around))

    def _light(self, which: str, shining: str, angle: Any) -> Light:
        look, box = self.look, self.box
        azimuth = self._azimuth + look[f"{which}_azimuth"]
        to = _direction(azimuth, look[f"{which}_elevation"])
        intensity, color = look[f"{which}_intensity"], look[f"{which}_color"]
        if shining == "sun":
            return DistantLight(to, intensity, color=color, angle=angle)
        away = look.row.distance * box.radius
        return SpotLight(
            tuple(m + away * c for m, c in zip(box.middle, to, strict=True)),
            target=box.middle,
            intensity=intensity * away * away,
            color=color,
            angle=CONE,
            softness=1.0,
            radius=0.5 * angle * away,
        )

    @property
    def background(self) -> Background:
        """The background."""
        row, look = self.look.row, self.look
        numbers = {name: look[name] for name in look.numbers} | {"azimuth": self._azimuth}
        numbers |= row.air
        taken = {slot.name for slot in slots_of(row.backdrop)} - {"direction"}
        return Background(row.backdrop, **{name: numbers[name] for name in taken})

    @property
    def fog_density(self) -> Any:
        """The density of the fog, whose color is ``horizon``."""
        return self.look["haze"] / self.box.radius if self._hazy else 0.0

    @property
    def _hazy(self) -> bool:
        return bool(self.look.numbers["haze"].may_exceed(0.0))

    @property
    def material(self) -> Material:
        """The material of shapes without ``paint``."""
        return self._painted(self.look["material"], INK)

    @property
    def is_seen_from_below(self) -> bool:
        """Whether the author's camera stands below the floor, and sees nothing else."""
        return self._eye_height < self._floor_height

    @cached_property
    def _floor_height(self) -> float:
        return self._lowest - BELOW * self.box.radius

    @property
    def _lowest(self) -> float:
        """The height of the lowest point of all parts, of which those in loose boxes are measured.

        A part whose box is above the lowest point found is not looked at.
        """
        if not self.box.parts:
            return self.box.low[1]
        lowest = self.box.high[1]
        for part, box in sorted(self.box.parts, key=lambda each: each[1][0][1]):
            if box[0][1] < lowest:
                lowest = min(lowest, lowest_of(part, box, self._params, self._time))
        return lowest

    @property
    def floor(self) -> BaseShape:
        """The floor, at the lowest point of what stands on it."""
        floor: BaseShape = Plane(y=self._floor_height).paint(self.ground).named("floor")
        return floor

    @property
    def ground(self) -> Material:
        """The material of the floor."""
        return self._painted(self.look["floor_color"], FLOOR_INK)

    def _painted(self, color: Any, ink: tuple[float, ...]) -> Material:
        if not self.look.row.lined:
            return matte(color)
        radius = self.box.radius
        spacing = round_step(radius / 8.0)
        lines = pattern(ruled, spacing=spacing, width=LINE * radius, paper=color, ink=ink)
        return matte(lines)

    @property
    def occlusion(self) -> float:
        """The reach of ambient occlusion."""
        return REACH * self.box.radius


def round_step(step: float) -> float:
    """Return the nearest of 1, 2 and 5 times a power of 10."""
    power = 10.0 ** math.floor(math.log10(step))
    share = step / power
    for limit, whole in ((1.5, 1.0), (3.5, 2.0), (7.5, 5.0)):
        if share < limit:
            return whole * power
    return 10.0 * power


def _direction(azimuth: Any, elevation: Any) -> tuple[Any, ...]:
    """Return a direction; the angles may be expressions."""
    level = cos(elevation)
    return (sin(azimuth) * level, sin(elevation), cos(azimuth) * level)
