"""Backgrounds: what rays show that meet nothing; skies and surroundings that are lights too.

Input: a colour, the numbers of a sky, a picture of surroundings, the author's own function
of a direction. Output: a ``Background``, which gives the light from a direction. Only the
camera and mirrors see it, unless it is declared a light (``light=True``, or put among the lights):
no light counts twice.
"""

from __future__ import annotations

import importlib
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, Final

from distal.diagnostics import Span
from distal.fields.guarantees import Limit, Requirement
from distal.ir.nodes import Expr
from distal.ir.types import VEC3
from distal.lang import Buffer, func, vec3
from distal.lang.expressions import Symbolic
from distal.lang.functions import Func
from distal.lang.resources import Buffer as BufferData
from distal.lang.resources import Texture2D
from distal.lang.unchanging import Unchanging
from distal.render import ambient as ambient_library
from distal.render import environment as environment_library
from distal.render import sky as library
from distal.scene.objects.lights import Light
from distal.scene.tree.arguments import arguments, slots_of
from distal.scene.tree.calls import Composer, FunctionCall
from distal.scene.tree.conversion import unwrapped
from distal.scene.tree.errors import refuse_kind
from distal.scene.tree.source_places import author_place

_SITE: Final = frozenset(("direction", "p", "n"))
_COLORS: Final = ("bottom", "top", "zenith", "horizon", "ground")
_LIMITS: Final = {
    "intensity": Limit.NOT_NEGATIVE,
    "sun_intensity": Limit.NOT_NEGATIVE,
    "sun_angle": Limit.POSITIVE,
}


class Background(Unchanging):
    """What rays show that meet nothing. It never changes once it is made.

    Args:
        what: A colour, or a ``@func`` of ``direction: vec3`` (a unit vector) and of numbers, that
            gives linear light.
        numbers: The function's numbers, by name.

    Raises:
        TypeError: It is neither, or something is of another kind.

    Attributes:
        call: ``(direction) -> vec3``.
        light: The light that it is besides, or None.
    """

    __slots__ = ("__weakref__", "call", "light")

    call: FunctionCall
    light: Light | None

    def __init__(self, what: Any, **numbers: Any) -> None:
        place = author_place()
        if isinstance(what, Func):
            self._show(_own(what, numbers, place))
            return
        given = {"color": what, **numbers}
        self._show(_call("Background", library.plain_background, given, place))

    def _show(self, call: FunctionCall, light: Light | None = None) -> None:
        object.__setattr__(self, "call", call)
        object.__setattr__(self, "light", light)

    @classmethod
    def of(cls, call: FunctionCall, light: Light | None = None) -> Background:
        """A background of a scene function of a direction."""
        made = Background.__new__(Background)
        made._show(call, light)
        return made

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError("a background does not change; make another")

    def __repr__(self) -> str:
        return f"<background {self.call.what}>"

    def emit(self, composer: Composer, site: Mapping[str, Expr]) -> Expr:
        """The light from ``site["direction"]``."""
        return self.call.emit(composer, site)

    def functions(self) -> Iterator[Func]:
        """The functions that it calls."""
        return self.call.functions()


class GradientBackground(Background):
    """One colour straight down, another straight up, evenly between by height.

    Args:
        bottom: Colour straight down.
        top: Colour straight up.
    """

    __slots__ = ()

    def __init__(self, bottom: Any = (0.9, 0.9, 0.9), top: Any = (0.35, 0.5, 0.75)) -> None:
        given = {"bottom": bottom, "top": top}
        self._show(_call(type(self).__name__, library.gradient_background, given, author_place()))


class Surroundings(Light):
    """A light that is a background too: a sky, a picture of surroundings.

    Attributes:
        background: ``(direction) -> vec3``, what rays show that meet nothing.
        light: Whether it is a light where it stands as a background.
    """

    __slots__ = ("background", "light")

    background: FunctionCall
    light: bool

    def _surround(self, background: FunctionCall, *, light: bool) -> None:
        object.__setattr__(self, "background", background)
        object.__setattr__(self, "light", light)


class Sky(Surroundings):
    """A clear sky with a sun, and ground below the horizon.

    Args:
        sun: To the sun; of any length.
        sun_color: The sun's colour.
        sun_intensity: How bright a white matte surface shows that faces the sun.
        sun_angle: How wide the sun looks, in radians.
        zenith: Colour overhead.
        horizon: Colour along the horizon.
        ground: Colour below.
        intensity: Brightness of all but the sun.
        light: Whether it lights the scene where it is its background. Among a scene's lights it
            always does.

    Raises:
        ValueError: A number is out of its range, or the sun is nowhere.
        TypeError: Something is of another kind.
    """

    __slots__ = ()

    def __init__(
        self,
        sun: Any = (1.0, 1.0, 1.0),
        sun_color: Any = (1.0, 0.9, 0.75),
        sun_intensity: Any = 1.0,
        sun_angle: Any = 0.05,
        zenith: Any = (0.2, 0.4, 0.8),
        horizon: Any = (0.8, 0.85, 0.9),
        ground: Any = (0.25, 0.22, 0.2),
        intensity: Any = 1.0,
        *,
        light: bool = False,
    ) -> None:
        given = {
            "sun": sun,
            "sun_color": sun_color,
            "sun_intensity": sun_intensity,
            "sun_angle": sun_angle,
            "zenith": zenith,
            "horizon": horizon,
            "ground": ground,
            "intensity": intensity,
        }
        place = author_place()
        whole = _call("Sky", library.sky, given, place, _sun)
        self._surround(whole, light=bool(light))
        self._shine(
            sample=_part(whole, library.sky_sun),
            ambient=_part(whole, ambient_library.sky_ambient),
        )


class Environment(Surroundings):
    """Surroundings from a picture of all around (equirectangular: -z in its middle, up on top).

    Args:
        image: A picture's file, looked for beside the scene (then in the working folder); an array
            (height, width, 3 or 4) of linear light; a ``Picture``; a ``Texture2D``.
        intensity: A factor on its light.
        turn: The surroundings turned to the left about the upright axis, in radians.
        light: Whether it lights the scene where it is its background. Among a scene's lights it
            always does.

    Raises:
        ValueError: The picture cannot be read, or a number is out of its range.
        TypeError: Something is of another kind.
    """

    __slots__ = ("_ambient", "_texture")

    _ambient: FunctionCall | None
    _texture: Texture2D

    def __init__(
        self, image: Any, intensity: Any = 1.0, turn: Any = 0.0, *, light: bool = False
    ) -> None:
        place = author_place()
        texture = _images().light_texture(image, "Environment", place)
        given = {"image": texture, "intensity": intensity, "turn": turn}
        whole = _call("Environment", environment_library.environment, given, place)
        self._surround(whole, light=bool(light))
        object.__setattr__(self, "sample", None)
        object.__setattr__(self, "_texture", texture)
        object.__setattr__(self, "_ambient", None)

    @property
    def ambient(self) -> FunctionCall:  # type: ignore[override]  # computed when it is first asked
        """``(n) -> vec3``, what a surface facing n gets of its light."""
        if self._ambient is None:
            whole = self.background
            pixels = _images().texture_light(self._texture, "Environment", whole.place)
            harmonics = BufferData(environment_library.harmonics(pixels))
            values = {**whole.values, "harmonics": harmonics}
            call = FunctionCall(whole.what, environment_light, values, whole.place)
            object.__setattr__(self, "_ambient", call)
        assert self._ambient is not None
        return self._ambient


@func
def environment_light(
    n: vec3, harmonics: Buffer[vec3], intensity: float = 1.0, turn: float = 0.0
) -> vec3:
    """The diffuse light of turned surroundings."""
    facing = environment_library.turned_by(n, turn)
    return ambient_library.environment_ambient(facing, harmonics, intensity)


def as_background(
    value: Any, lights: Iterable[Light] = (), place: Span | None = None
) -> Background:
    """A background, or what stands for one: a colour, a sky, a ``@func`` of a direction.

    Args:
        value: What the author gave; None for the sky among the lights, else a plain gradient.
        lights: The scene's lights.
        place: The author's line.

    Raises:
        TypeError: It is none of these.
        ValueError: It is no colour.
    """
    place = place or author_place()
    if value is None:
        skies = (light for light in lights if isinstance(light, Surroundings))
        value = next(skies, None) or GradientBackground()
    if isinstance(value, Background):
        return value
    if isinstance(value, Surroundings):
        return Background.of(value.background, value if value.light else None)
    if isinstance(value, Func):
        return Background.of(_own(value, {}, place))
    if not isinstance(unwrapped(value), str | tuple | list | Symbolic):
        refuse_kind(
            f"a background is wanted, not {type(value).__name__} {value!r:.40}",
            'write "#rrggbb", Sky(), Environment(image) or a @func of the direction',
            place,
        )
    return Background.of(_call("Background", library.plain_background, {"color": value}, place))


def _own(function: Func, numbers: Mapping[str, Any], place: Span | None) -> FunctionCall:
    """An author's function of a direction."""
    call = _call(function.name, function, numbers, place)
    asks = {slot.name for slot in slots_of(function)}
    if "direction" not in asks or call.result is not VEC3:
        refuse_kind(
            f"'{function.name}' is no background: it is no function of a direction to a color",
            f"def {function.name}(direction: vec3) -> vec3",
            place,
        )
    return call


def _part(whole: FunctionCall, function: Func) -> FunctionCall:
    """A function of some of another call's values."""
    asks = {slot.name for slot in slots_of(function)}
    values = {name: value for name, value in whole.values.items() if name in asks}
    return FunctionCall(whole.what, function, values, whole.place)


def _call(
    what: str,
    function: Func,
    given: Mapping[str, Any],
    place: Span | None,
    requires: Requirement | None = None,
) -> FunctionCall:
    values = arguments(
        function,
        (),
        given,
        what=what,
        limits=_LIMITS,
        requires=requires,
        place=place,
        reserved=_SITE,
        colors=_COLORS,
    )
    return FunctionCall(what, function, values, place)


def _sun(sun: tuple[float, ...]) -> str | None:
    return None if any(sun) else "sun is a vector of zeros, which points nowhere"


def _images() -> Any:
    """What decodes pictures, loaded when there is one: the compile path needs no NumPy."""
    return importlib.import_module("distal.scene.objects.images")
