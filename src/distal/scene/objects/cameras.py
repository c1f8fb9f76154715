"""Cameras of a scene.

Input: positions and angles, which may be parameters or change with time. Output: the call of a
camera function of ``render`` that maps a point of the picture to a ray. Space is right-handed with
y up; by default a camera looks along -z.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Final, Self

from distal.diagnostics import Span
from distal.fields.guarantees import Limit
from distal.ir.nodes import Expr, Uniform
from distal.ir.types import FLOAT
from distal.lang import atan, tan
from distal.lang.expressions import Expression
from distal.lang.functions import Func
from distal.lang.source_places import author_place
from distal.render import camera as library
from distal.render.declarations import CAMERAS, Declaration, Family
from distal.scene.objects.declared import (
    declared_call,
    declared_class,
    given_arguments,
    scene_call,
)
from distal.scene.objects.scene_object import CalledObject, PlacedObject
from distal.scene.tree.calls import FunctionCall
from distal.scene.tree.conversion import Asked, number
from distal.scene.tree.conversion import Number as CheckedNumber
from distal.scene.tree.errors import refuse, refuse_kind
from distal.scene.tree.placement import AffinePlacement
from distal.scene.tree.value import recorded, value_of
from distal.scene.tree.varying import Composer

if TYPE_CHECKING:
    from distal.scene.objects.argument_types import Number, Vector

_DEGREE: Final = math.pi / 180.0


@recorded
class BaseCamera(PlacedObject, CalledObject):
    """The base class of cameras.

    Its methods place it as those of a shape. A camera of angles becomes a ``Camera`` by them.

    Attributes:
        call: ``(uv) -> Ray``. uv.y is -1 to 1 from bottom to top; uv.x has the same unit. The
            function may also take ``resolution``, the size of the picture in pixels.
        lens: ``() -> vec2``, the numbers of ``camera.thin_lens``; None for a pinhole.
    """

    __slots__ = ("lens",)

    noun: ClassVar[str] = "camera"
    family: ClassVar[Family] = CAMERAS
    alternatives: ClassVar[tuple[tuple[str, ...], ...]] = (("fov", "fov_deg"),)
    lens: FunctionCall | None

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        place, what, declaration = author_place(), type(self).__name__, self.declaration
        given = given_arguments(declaration, args, kwargs, what, place)
        angle = _angle(what, given.get("fov"), given.get("fov_deg"), place, declaration.widest)
        if angle is not None:
            given["fov"] = angle
        lens = _lens(what, given.get("aperture", 0.0), given.get("focus_distance"), place)
        self._keep(call=declared_call(declaration, given, place, what=what), lens=lens)

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"a {type(self).__name__} does not change; make another")

    def number(self, composer: Composer, name: str) -> Expr | None:
        """Emit one of the camera's values, such as its target; None if it has no such value."""
        return self.call.value(composer, name) if name in self.call.values else None

    def _checked(self) -> Iterator[Mapping[str, Any]]:
        yield from (call.values for call in (self.call, self.lens) if call is not None)

    def _compared(self) -> tuple[Any, ...]:
        return self.noun, self.call, self.lens

    @property
    def _pose(self) -> Self:
        """The same camera by its position, target and direction up; itself, if it has them."""
        declaration: Declaration | None = getattr(type(self), "declaration", None)
        if declaration is None or declaration.pose is None:
            return self
        same: Self = declaration.pose(CLASSES["Camera"], **self.arguments)
        return same

    def _placed(self, placement: AffinePlacement) -> Self:
        pose = self._pose
        return super()._placed(placement) if pose is self else pose._placed(placement)

    def functions(self) -> Iterator[Func]:
        """Yield the scene functions that the camera calls."""
        yield from self.call.functions()
        if self.lens is not None:
            yield from self.lens.functions()


@recorded
class TurnedCamera(BaseCamera):
    """A camera rotated by angles; its screen is a rectangle of a physical size.

    Args:
        position: Position of the eye.
        yaw: Rotation to the left about the y axis, in radians; 0 looks along -z.
        pitch: Rotation upwards, in radians.
        roll: Rotation about the viewing direction, in radians.
        screen_height: Height of the screen, in scene units (default 1).
        screen_distance: Distance of the screen from the eye; computed from ``fov`` by default.
        fov: Vertical field of view in radians, instead of ``screen_distance``.
        fov_deg: The same in degrees.
        aperture: Diameter of the lens, in scene units; 0 for a pinhole, which shows everything
            sharp. In mode "path" only.
        focus_distance: The distance along the viewing direction at which everything is sharp, in
            scene units; required if there is an aperture.
        mirrored: Whether left and right are swapped, as in left-handed coordinate systems.

    Raises:
        ValueError: The screen's size or distance is not above 0, or the angle is invalid.
        TypeError: An argument has the wrong type, or both distance and angle are given.
    """

    __slots__ = ()

    alternatives: ClassVar = (("screen_distance", "fov", "fov_deg"),)
    written_as: ClassVar = "Camera.yaw_pitch_roll"

    def __init__(
        self,
        position: Vector = (0.0, 0.0, 5.0),
        yaw: Number = 0.0,
        pitch: Number = 0.0,
        roll: Number = 0.0,
        *,
        screen_height: Number | None = None,
        screen_distance: Number | None = None,
        fov: Number | None = None,
        fov_deg: Number | None = None,
        aperture: Number = 0.0,
        focus_distance: Number | None = None,
        mirrored: bool = False,
    ) -> None:
        place = author_place()
        height = 1.0 if screen_height is None else screen_height
        distance: Any = screen_distance
        if distance is None:
            opening = _angle("TurnedCamera", fov, fov_deg, place)
            opening = library.OPENING if opening is None else opening
            half: Any = number(height, _asked("screen_height", place)).value
            distance = 0.5 * half / tan(0.5 * opening)
        elif fov is not None or fov_deg is not None:
            refuse_kind(
                "TurnedCamera takes screen_distance or an angle, not both",
                "each follows from the other",
                place,
            )
        given = {
            "position": position,
            "yaw": yaw,
            "pitch": pitch,
            "roll": roll,
            "screen_height": height,
            "screen_distance": distance,
            "mirrored": mirrored,
        }
        lens = _lens("TurnedCamera", aperture, focus_distance, place)
        if lens is not None and focus_distance is None:
            refuse_kind(
                "TurnedCamera has no target to focus on",
                "give the distance that is sharp: focus_distance=4.0",
                place,
            )
        call = scene_call(CAMERAS, library.turned, given, "TurnedCamera", place)
        self._keep(call=call, lens=lens)

    @property
    def _pose(self) -> Any:
        turns, screen = self.arguments, {n: value_of(v) for n, v in self.call.values.items()}
        fov = 2.0 * atan(0.5 * screen["screen_height"] / screen["screen_distance"])
        same = {name: turns[name] for name in ("aperture", "focus_distance", "mirrored")}
        level = CLASSES["Camera"]((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), fov=fov, **same)
        ahead = level.rotate(z=turns["roll"]).rotate(x=turns["pitch"]).rotate(y=turns["yaw"])
        return ahead.translate(turns["position"])


class PlacedCamera(BaseCamera):
    """The class of ``Camera``; ``Camera.yaw_pitch_roll`` is a camera rotated by angles."""

    __slots__ = ()

    yaw_pitch_roll = TurnedCamera


CLASSES: Final = {
    name: declared_class(found, PlacedCamera if name == "Camera" else BaseCamera)
    for name, found in CAMERAS.members.items()
}
globals().update(CLASSES)


def _lens(what: str, aperture: Any, focus: Any, place: Span | None) -> FunctionCall | None:
    """Return the call of ``thin_lens``; None for a pinhole.

    Args:
        what: The name of the camera in messages.
        aperture: The author's diameter of the lens.
        focus: The author's distance of focus, or None.
        place: The author's line.
    """
    given = {"aperture": aperture} | ({} if focus is None else {"focus_distance": focus})
    call = scene_call(CAMERAS, library.thin_lens, given, what, place)
    return None if call.values["aperture"].plain == 0.0 else call


def _asked(name: str, place: Span | None) -> Asked:
    return Asked(name, "TurnedCamera", FLOAT, CAMERAS.limits[name], place=place)


def _angle(what: str, fov: Any, fov_deg: Any, place: Span | None, widest: float = math.pi) -> Any:
    """Return the field of view in radians, from whichever is given; None if neither is."""
    if fov is not None and fov_deg is not None:
        refuse_kind(f"{what} takes fov or fov_deg, not both", "fov is in radians", place)
    if fov is None and fov_deg is None:
        return None
    name, given, unit = ("fov_deg", fov_deg, _DEGREE) if fov is None else ("fov", fov, 1.0)
    asked = Asked(name, what, FLOAT, Limit.POSITIVE, place=place)
    _check_opening(number(given, asked), asked, widest / unit, whole=widest > math.pi)
    return given * unit if fov is None else given


def _check_opening(found: CheckedNumber, asked: Asked, most: float, *, whole: bool) -> None:
    largest: Any = found.plain
    if isinstance(found.value, Expression):
        parameters = found.value.parameters
        alone = len(parameters) == 1 and isinstance(found.value.node, Uniform)
        largest = parameters[0].high if alone else None
    if largest is None or largest < most or (whole and largest == most):
        return
    limit = f"{'at most' if whole else 'below'} {most:.6g}"
    hint = "fov is in radians; fov_deg= takes degrees" if asked.name == "fov" else None
    refuse(f"'{asked.label}' must be {limit}, not {largest:g}", hint, asked.place)
