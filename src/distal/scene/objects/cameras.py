"""Cameras: where a picture is seen from.

Input: places, angles, all of which may be parameters or move with time. Output: the
call of a camera function of ``render`` that gives each point of the picture its ray. Space is
right-handed with y up; a camera looks along -z unless told otherwise.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any, Final

from distal.diagnostics import Span
from distal.fields.guarantees import Limit, Requirement
from distal.ir.nodes import Expr, Uniform
from distal.ir.types import FLOAT
from distal.lang import tan
from distal.lang.expressions import Expression
from distal.lang.functions import Func
from distal.lang.unchanging import Unchanging
from distal.render import camera as library
from distal.scene.tree.arguments import arguments
from distal.scene.tree.calls import Composer, FunctionCall
from distal.scene.tree.conversion import Asked, Number, number
from distal.scene.tree.errors import refuse, refuse_kind
from distal.scene.tree.source_places import author_place

# What the scene gives each ray: where in the picture it is, and the pixels of the picture.
_SITE: Final = frozenset(("uv", "resolution"))
_LIMITS: Final = dict.fromkeys(
    ("fov", "distance", "height", "screen_height", "screen_distance"), Limit.POSITIVE
)
_DEGREE: Final = math.pi / 180.0
# Two directions closer than this (the sine between them) tell no plane in 32 bits.
_PARALLEL: Final = 1e-5


class BaseCamera(Unchanging):
    """What all cameras share.

    Attributes:
        call: ``(uv) -> Ray``; uv is -1 to 1 from bottom to top, x by the same unit. A function may
            also ask for ``resolution``, the pixels of the picture.
    """

    __slots__ = ("__weakref__", "call")

    call: FunctionCall

    def _look(
        self,
        func: Func,
        given: Mapping[str, Any],
        place: Span | None,
        requires: Requirement | None = None,
    ) -> None:
        what = type(self).__name__
        values = arguments(
            func,
            (),
            given,
            what=what,
            limits=_LIMITS,
            requires=requires,
            place=place,
            reserved=_SITE,
        )
        object.__setattr__(self, "call", FunctionCall(what, func, values, place))

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"a {type(self).__name__} does not change; make another")

    def __repr__(self) -> str:
        return f"<camera {type(self).__name__}>"

    def emit(self, composer: Composer, site: Mapping[str, Expr]) -> Expr:
        """The ray of the point ``site["uv"]`` of the picture."""
        return self.call.emit(composer, site)

    def number(self, composer: Composer, name: str) -> Expr | None:
        """One of its values, such as its target; None for a camera that has no such."""
        return self.call.value(composer, name) if name in self.call.values else None

    def functions(self) -> Iterator[Func]:
        """The functions that it calls."""
        return self.call.functions()


class Camera(BaseCamera):
    """A camera that looks from one place at another, with perspective.

    Args:
        position: Where it is.
        target: What it looks at.
        up: Which way is up in the picture.
        fov: The angle from the picture's bottom to its top, in radians; below pi.
        fov_deg: The same in degrees.
        mirror: Left and right swapped, as left-handed systems see it.

    Raises:
        ValueError: Position and target agree, up points along the view, or the angle is no angle.
        TypeError: Something is of another kind.
    """

    __slots__ = ()

    def __init__(
        self,
        position: Any = (0.0, 0.0, 5.0),
        target: Any = (0.0, 0.0, 0.0),
        up: Any = (0.0, 1.0, 0.0),
        fov: Any = None,
        *,
        fov_deg: Any = None,
        mirror: bool = False,
    ) -> None:
        place = author_place()
        given = {
            "position": position,
            "target": target,
            "up": up,
            "fov": _angle("Camera", fov, fov_deg, place),
            "mirror": mirror,
        }
        self._look(library.look_at, given, place, _sees)

    @staticmethod
    def yaw_pitch_roll(
        position: Any = (0.0, 0.0, 5.0),
        yaw: Any = 0.0,
        pitch: Any = 0.0,
        roll: Any = 0.0,
        *,
        screen_height: Any = None,
        screen_distance: Any = None,
        fov: Any = None,
        fov_deg: Any = None,
        mirror: bool = False,
    ) -> TurnedCamera:
        """A camera turned by angles; see ``TurnedCamera``."""
        return TurnedCamera(
            position,
            yaw,
            pitch,
            roll,
            screen_height=screen_height,
            screen_distance=screen_distance,
            fov=fov,
            fov_deg=fov_deg,
            mirror=mirror,
        )


class TurnedCamera(BaseCamera):
    """A camera turned by angles, its picture a window of a physical size before the eye.

    Args:
        position: Where the eye is.
        yaw: To the left about the y axis, in radians; 0 looks along -z.
        pitch: Up, in radians.
        roll: About the view, in radians.
        screen_height: How high the window is (default 1).
        screen_distance: How far it is from the eye (default: as far as ``fov`` says).
        fov: The angle from the picture's bottom to its top, instead of the distance.
        fov_deg: The same in degrees.
        mirror: Left and right swapped, as left-handed systems see it.

    Raises:
        ValueError: The window has no size or distance, or the angle is no angle.
        TypeError: Something is of another kind, or both distance and angle are given.
    """

    __slots__ = ()

    def __init__(
        self,
        position: Any = (0.0, 0.0, 5.0),
        yaw: Any = 0.0,
        pitch: Any = 0.0,
        roll: Any = 0.0,
        *,
        screen_height: Any = None,
        screen_distance: Any = None,
        fov: Any = None,
        fov_deg: Any = None,
        mirror: bool = False,
    ) -> None:
        place = author_place()
        height = 1.0 if screen_height is None else screen_height
        distance = screen_distance
        if distance is None:
            opening = _angle("TurnedCamera", fov, fov_deg, place)
            half: Any = number(height, _asked("screen_height", place)).value
            distance = 0.5 * half / tan(0.5 * opening)
        elif fov is not None or fov_deg is not None:
            refuse_kind(
                "TurnedCamera takes screen_distance or an angle, not both",
                "each tells the other",
                place,
            )
        given = {
            "position": position,
            "yaw": yaw,
            "pitch": pitch,
            "roll": roll,
            "screen_height": height,
            "screen_distance": distance,
            "mirror": mirror,
        }
        self._look(library.turned, given, place)


class OrbitCamera(BaseCamera):
    """A camera on a sphere around what it looks at.

    Args:
        distance: From the target.
        azimuth: Around the y axis, in radians; 0 is on the side of +z, pi/2 on that of +x.
        elevation: Up, in radians.
        target: What it looks at.
        fov: The angle from the picture's bottom to its top, in radians; below pi.
        fov_deg: The same in degrees.
        mirror: Left and right swapped, as left-handed systems see it.

    Raises:
        ValueError: The distance is not above 0, or the angle is no angle.
        TypeError: Something is of another kind.
    """

    __slots__ = ()

    def __init__(
        self,
        distance: Any = 5.0,
        azimuth: Any = 0.0,
        elevation: Any = 0.0,
        target: Any = (0.0, 0.0, 0.0),
        fov: Any = None,
        *,
        fov_deg: Any = None,
        mirror: bool = False,
    ) -> None:
        place = author_place()
        given = {
            "distance": distance,
            "azimuth": azimuth,
            "elevation": elevation,
            "target": target,
            "fov": _angle("OrbitCamera", fov, fov_deg, place),
            "mirror": mirror,
        }
        self._look(library.orbit, given, place)


class OrthographicCamera(BaseCamera):
    """A camera without perspective: what is far is as large as what is near.

    Args:
        position: The middle of the picture; what lies behind it is not seen.
        target: What it looks at.
        up: Which way is up in the picture.
        height: What the picture shows from bottom to top, in scene units.
        mirror: Left and right swapped, as left-handed systems see it.

    Raises:
        ValueError: Position and target agree, up points along the view, or the height is none.
        TypeError: Something is of another kind.
    """

    __slots__ = ()

    def __init__(
        self,
        position: Any = (0.0, 0.0, 5.0),
        target: Any = (0.0, 0.0, 0.0),
        up: Any = (0.0, 1.0, 0.0),
        height: Any = 4.0,
        *,
        mirror: bool = False,
    ) -> None:
        given = {
            "position": position,
            "target": target,
            "up": up,
            "height": height,
            "mirror": mirror,
        }
        self._look(library.orthographic, given, author_place(), _sees)


class FisheyeCamera(BaseCamera):
    """A camera that sees half of the world around, or more, in a circle.

    Args:
        position: Where it is.
        target: What it looks at.
        up: Which way is up in the picture.
        fov: The angle from the picture's bottom to its top, in radians; up to 2 pi.
        fov_deg: The same in degrees.
        mirror: Left and right swapped, as left-handed systems see it.

    Raises:
        ValueError: Position and target agree, up points along the view, or the angle is no angle.
        TypeError: Something is of another kind.
    """

    __slots__ = ()

    def __init__(
        self,
        position: Any = (0.0, 0.0, 5.0),
        target: Any = (0.0, 0.0, 0.0),
        up: Any = (0.0, 1.0, 0.0),
        fov: Any = None,
        *,
        fov_deg: Any = None,
        mirror: bool = False,
    ) -> None:
        place = author_place()
        given = {
            "position": position,
            "target": target,
            "up": up,
            "fov": _angle("FisheyeCamera", fov, fov_deg, place, default_deg=180.0, whole=True),
            "mirror": mirror,
        }
        self._look(library.fisheye, given, place, _sees)


class PanoramaCamera(BaseCamera):
    """A camera that sees all around: longitude to the right, latitude up (equirectangular).

    Args:
        position: Where it is.
        target: What is in the middle of the picture.
        up: Which way is up in the picture.
        mirror: Left and right swapped, as left-handed systems see it.

    Raises:
        ValueError: Position and target agree, or up points along the view.
        TypeError: Something is of another kind.
    """

    __slots__ = ()

    def __init__(
        self,
        position: Any = (0.0, 0.0, 0.0),
        target: Any = (0.0, 0.0, -1.0),
        up: Any = (0.0, 1.0, 0.0),
        *,
        mirror: bool = False,
    ) -> None:
        given = {"position": position, "target": target, "up": up, "mirror": mirror}
        self._look(library.panorama, given, author_place(), _sees)


def _asked(name: str, place: Span | None) -> Asked:
    return Asked(name, "TurnedCamera", FLOAT, _LIMITS[name], place=place)


def _angle(
    what: str,
    fov: Any,
    fov_deg: Any,
    place: Span | None,
    *,
    default_deg: float = 40.0,
    whole: bool = False,
) -> Any:
    """The opening in radians, from whichever was given: below half a turn, or up to a whole."""
    if fov is not None and fov_deg is not None:
        refuse_kind(f"{what} takes fov or fov_deg, not both", "fov is in radians", place)
    in_degrees = fov is None
    given = fov_deg if in_degrees else fov
    if given is None:
        given = default_deg
    name = "fov_deg" if in_degrees else "fov"
    asked = Asked(name, what, FLOAT, Limit.POSITIVE, place=place)
    most = 180.0 if in_degrees else math.pi
    _check_opening(number(given, asked), asked, most * 2.0 if whole else most, whole=whole)
    return given * _DEGREE if in_degrees else given


def _check_opening(found: Number, asked: Asked, most: float, *, whole: bool) -> None:
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


def _sees(
    position: tuple[float, ...], target: tuple[float, ...], up: tuple[float, ...]
) -> str | None:
    """Why a view has no direction, or its picture no up."""
    ahead = [t - p for t, p in zip(target, position, strict=True)]
    length = math.hypot(*ahead)
    if length == 0.0:
        return "position and target are the same place"
    if math.hypot(*up) == 0.0:
        return "up is a vector of zeros, which has no direction"
    (ax, ay, az), (ux, uy, uz) = ahead, up
    across = math.hypot(ay * uz - az * uy, az * ux - ax * uz, ax * uy - ay * ux)
    if across <= _PARALLEL * length * math.hypot(*up):
        return "up points along the view; for a view straight down, give up=(0, 0, -1)"
    return None
