"""Guidance of a scene's camera on the CPU, for windows: gestures and keys to a ``Steering``.

Input: the numbers that a camera has, those that a gesture asks for, the scene's parameters and
time. Output: the numbers that it gets, and where it then is. The rules are scene code
(``render/guide.py``); pages run the same program by WebGL.
"""

from __future__ import annotations

import inspect
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final

from distal.lang.number_text import shown
from distal.render.guide import ACTIONS, NUMBERS
from distal.scene import steering as uniforms
from distal.scene.lowering.guide import GuideImage
from distal.scene.objects.cameras import CLASSES
from distal.scene.steering import STILL, Steering
from distal.scene.viewing import interaction
from distal.scene.viewing.number_rows import NumberRow

if TYPE_CHECKING:
    from distal.scene.scene import Scene

_PERSPECTIVE: Final = "Camera"
# The argument that sets how much a camera sees, if it has one.
_ANGLE: Final = "fov_deg"
_HEIGHT: Final = "height"


@dataclass(frozen=True, slots=True)
class Moment:
    """What a camera's surroundings depend on.

    Attributes:
        size: Width and height of the picture, in any unit.
        time: Seconds.
        params: Values of parameters by name; the others have their defaults.
    """

    size: tuple[float, float] = (4.0, 3.0)
    time: float = 0.0
    params: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class CameraPlace:
    """Where a camera is, in scene units.

    Attributes:
        position: Its position.
        target: The point that it looks at.
        up: The direction that is up in its picture.
        opening_deg: The angle from the bottom of its picture to the top, in degrees.
        height: Height of what it sees without perspective; 0 in perspective.
        clearance: Distance from the nearest surface, at least; negative inside a solid.
    """

    position: tuple[float, float, float]
    target: tuple[float, float, float]
    up: tuple[float, float, float]
    opening_deg: float
    height: float
    clearance: float


class Guide:
    """Guides the camera of one scene.

    Attributes:
        image: Its program; each pixel holds the bits of one of ``NUMBERS``.
        form: How the camera is written.
    """

    def __init__(self, scene: Scene) -> None:
        self.image = GuideImage(scene)
        self._row = NumberRow(self.image, NUMBERS)
        self.form = camera_form(scene)

    @property
    def is_ready(self) -> bool:
        """Whether it is compiled."""
        return self._row.is_ready

    def prepare(self, moment: Moment) -> None:
        """Compile the program, which takes up to a few seconds."""
        self._numbers("go", STILL, STILL, moment)

    def go(self, now: Steering, goal: Steering, moment: Moment) -> Steering:
        """Return where a gesture leads: to its goal, or as far as no solid is entered.

        Args:
            now: The numbers that the camera has.
            goal: The numbers that the gesture asks for.
            moment: Size of the picture, time and parameters.
        """
        found = self._numbers("go", now, goal, moment)
        return goal if found["arrived"] else _steering(found)

    def show(self, action: str, now: Steering, moment: Moment) -> Steering:
        """Return the camera that shows the whole scene.

        Args:
            action: "frame" to keep the direction; or the side to look from: "front", "back",
                "right", "left", "top", "bottom".
            now: The numbers that the camera has.
            moment: Size of the picture, time and parameters.
        """
        return _steering(self._numbers(action, now, now, moment))

    def place(self, now: Steering, moment: Moment) -> CameraPlace:
        """Return where the camera is."""
        found = self._numbers("go", now, now, moment)

        def point(name: str) -> tuple[float, float, float]:
            return found[f"{name}_x"], found[f"{name}_y"], found[f"{name}_z"]

        flat = found["opening"], found["height"], found["clearance"]
        return CameraPlace(point("eye"), point("target"), point("up"), *flat)

    def text(self, place: CameraPlace) -> str:
        """Return a camera at a place as Python, as an author writes it."""
        return camera_text(self.form, place)

    def _numbers(
        self, action: str, now: Steering, goal: Steering, moment: Moment
    ) -> dict[str, float]:
        aimed = {f"{uniforms.GOAL_PREFIX}{n}": getattr(goal, n) for n, _, _ in uniforms.NUMBERS}
        settings = {
            **now.settings,
            **aimed,
            uniforms.ACTION: ACTIONS.index(action),
            uniforms.SIZE: tuple(max(side, 1.0) for side in moment.size),
        }
        return self._row.read(settings, time=moment.time, params=moment.params)


def _steering(found: Mapping[str, float]) -> Steering:
    pan = (found["pan_x"], found["pan_y"])
    return Steering(found["yaw"], found["pitch"], found["zoom"], pan)


@dataclass(frozen=True, slots=True)
class CameraForm:
    """How a scene's camera is written.

    Attributes:
        name: The class that has a position and a target.
        mirror: Whether it swaps left and right.
        extent: The argument that sets how much it sees: "fov_deg", "height" or "" for none.
    """

    name: str
    mirror: bool
    extent: str


def camera_form(scene: Scene) -> CameraForm:
    """Return how a camera at another place is written so that it shows the scene the same way."""
    kind = type(scene.camera).__name__
    values = scene.camera.call.values
    named = kind if kind in CLASSES and "target" in values and "position" in values else ""
    name = named or _PERSPECTIVE
    parameters = inspect.signature(CLASSES[name]).parameters
    extent = next((n for n in (_ANGLE, _HEIGHT) if n in parameters), "")
    mirror = values.get("mirrored")
    return CameraForm(name, bool(getattr(mirror, "plain", mirror)), extent)


def camera_text(form: CameraForm, place: CameraPlace) -> str:
    """Return a camera as Python, rounded to a ten-thousandth of its distance from the target.

    Args:
        form: How the scene's camera is written.
        place: Where the camera is.
    """
    arguments = [point_text(place.position, place), point_text(place.target, place)]
    if place.up != (0.0, 1.0, 0.0):
        arguments.append(f"up={_rounded(place.up, 0.1)}")
    if form.extent == _ANGLE:
        arguments.append(f"{_ANGLE}={shown(interaction.rounded(place.opening_deg, 10.0))}")
    if form.extent == _HEIGHT:
        unit = 0.1 * max(place.height, 1e-6)
        arguments.append(f"{_HEIGHT}={shown(interaction.rounded(place.height, unit))}")
    if form.mirror:
        arguments.append("mirrored=True")
    return f"{form.name}({', '.join(arguments)})"


def point_text(point: tuple[float, float, float], place: CameraPlace) -> str:
    """Return a point as Python, as exact as it can be seen from a place."""
    return _rounded(point, 0.1 * max(math.dist(place.position, place.target), 1e-6))


def _rounded(numbers: tuple[float, ...], unit: float) -> str:
    return f"({', '.join(shown(interaction.rounded(n, unit)) for n in numbers)})"
