"""Lights: what makes a scene visible.

Input: places, directions, colours, intensities; all may be parameters or move with time.
Output: calls of light functions of ``render``: how a light reaches a point (``sample``),
and how light from everywhere reaches a surface that faces some way (``ambient``). A point light of
intensity 1 at distance 1, square on a white matte surface, shows it as white (radiance 1).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any, Final

from distal.diagnostics import Span
from distal.fields.guarantees import Limit, Requirement
from distal.lang.functions import Func
from distal.lang.unchanging import Unchanging
from distal.render import ambient
from distal.render import lights as library
from distal.scene.tree.arguments import arguments
from distal.scene.tree.calls import FunctionCall
from distal.scene.tree.errors import refuse_kind
from distal.scene.tree.source_places import author_place

_SITE: Final = frozenset(("p", "n"))
_LIMITS: Final = {
    "intensity": Limit.NOT_NEGATIVE,
    "radius": Limit.NOT_NEGATIVE,
    "angle": Limit.NOT_NEGATIVE,
    "softness": Limit.FRACTION,
}


class Light(Unchanging):
    """What all lights share. A light never changes once it is made.

    Attributes:
        sample: ``(p) -> LightSample``, how it reaches a point; None for light from everywhere.
        ambient: ``(n) -> vec3``, what a surface facing n gets from everywhere; else None.
    """

    __slots__ = ("__weakref__", "ambient", "sample")

    sample: FunctionCall | None
    ambient: FunctionCall | None

    def _shine(
        self, sample: FunctionCall | None = None, ambient: FunctionCall | None = None
    ) -> None:
        object.__setattr__(self, "sample", sample)
        object.__setattr__(self, "ambient", ambient)

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError("a light does not change; make another")

    def __repr__(self) -> str:
        return f"<light {type(self).__name__}>"

    def functions(self) -> Iterator[Func]:
        """The functions that it calls."""
        for call in (self.sample, self.ambient):
            if call is not None:
                yield from call.functions()


class AmbientLight(Light):
    """The same light from everywhere.

    Args:
        intensity: How bright; a white matte surface shows this much.
        color: Its colour.
    """

    __slots__ = ()

    def __init__(self, intensity: Any = 0.1, color: Any = "#fff") -> None:
        given = {"intensity": intensity, "color": color}
        self._shine(ambient=light_call(type(self).__name__, ambient.ambient_light, given))


class HemisphereLight(Light):
    """Light of one colour from the upper half of space, of another from the lower.

    Args:
        sky: Colour of the upper half.
        ground: Colour of the lower half.
        intensity: A factor on both.
        up: Where the upper half is, of any length.
    """

    __slots__ = ()

    def __init__(
        self,
        sky: Any = (0.6, 0.75, 1.0),
        ground: Any = (0.3, 0.25, 0.2),
        intensity: Any = 0.5,
        up: Any = (0.0, 1.0, 0.0),
    ) -> None:
        given = {"sky": sky, "ground": ground, "intensity": intensity, "up": up}
        call = light_call(type(self).__name__, ambient.hemisphere_light, given, _up)
        self._shine(ambient=call)


class DistantLight(Light):
    """Light from one side, equally bright everywhere: the sun.

    Args:
        direction: Towards the light, of any length.
        intensity: How bright a white matte surface shows that faces it.
        color: Its colour.
        angle: How wide it looks, in radians: what softens its shadows (the sun: 0.0093).
    """

    __slots__ = ()

    def __init__(
        self,
        direction: Any = (1.0, 2.0, 1.0),
        intensity: Any = 1.0,
        color: Any = "#fff",
        angle: Any = 0.0,
    ) -> None:
        given = {"direction": direction, "intensity": intensity, "color": color, "angle": angle}
        call = light_call(type(self).__name__, library.distant_light, given, _direction)
        self._shine(sample=call)


class PointLight(Light):
    """Light from one point, fading with the square of the distance.

    Args:
        position: Where it is.
        intensity: How bright a white matte surface shows that faces it at distance 1.
        color: Its colour.
        radius: How large it is: what softens its shadows.
    """

    __slots__ = ()

    def __init__(
        self,
        position: Any,
        intensity: Any = 1.0,
        color: Any = "#fff",
        radius: Any = 0.0,
    ) -> None:
        given = {"position": position, "intensity": intensity, "color": color, "radius": radius}
        self._shine(sample=light_call(type(self).__name__, library.point_light, given))


class SpotLight(Light):
    """A point light that shines in a cone.

    Args:
        position: Where it is.
        target: What it points at.
        intensity: As for a point light.
        color: Its colour.
        angle: The whole cone's opening, in radians; below pi.
        softness: Share of half the angle over which the rim fades: 0 sharp, 1 from the axis on.
        radius: How large it is: what softens its shadows.
    """

    __slots__ = ()

    def __init__(
        self,
        position: Any,
        target: Any = (0.0, 0.0, 0.0),
        intensity: Any = 1.0,
        color: Any = "#fff",
        angle: Any = math.pi / 4,
        softness: Any = 0.2,
        radius: Any = 0.0,
    ) -> None:
        given = {
            "position": position,
            "target": target,
            "intensity": intensity,
            "color": color,
            "angle": angle,
            "softness": softness,
            "radius": radius,
        }
        call = light_call(type(self).__name__, library.spot_light, given, _aim)
        self._shine(sample=call)


def light_call(
    what: str,
    function: Func,
    given: Mapping[str, Any],
    requires: Requirement | None = None,
) -> FunctionCall:
    """A light's function with its checked numbers."""
    place = author_place()
    values = arguments(
        function,
        (),
        given,
        what=what,
        limits=_LIMITS,
        requires=requires,
        place=place,
        reserved=_SITE,
        colors=("sky", "ground"),
    )
    return FunctionCall(what, function, values, place)


def as_light(value: Any, place: Span | None = None) -> Light:
    """A light.

    Raises:
        TypeError: It is none.
    """
    if isinstance(value, Light):
        return value
    given = f"the class {value.__name__}" if isinstance(value, type) else f"{value!r:.40}"
    hint = "write PointLight((2, 4, 3)), DistantLight((1, 2, 1)) or AmbientLight(0.1)"
    refuse_kind(f"a light is wanted, not {given}", hint, place)


def _up(up: tuple[float, ...]) -> str | None:
    return None if any(up) else "up is a vector of zeros, which points nowhere"


def _direction(direction: tuple[float, ...]) -> str | None:
    return None if any(direction) else "direction is a vector of zeros, which points nowhere"


def _aim(position: tuple[float, ...], target: tuple[float, ...], angle: float) -> str | None:
    if position == target:
        return "position and target are the same place"
    if angle < math.pi:
        return None
    return "angle is the cone's opening in radians, below pi; np.radians makes it of degrees"
