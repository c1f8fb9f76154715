"""Backgrounds: the light of rays that hit nothing. Skies and environments can also be lights.

Input: a color, the numbers of a sky, a picture of an environment, or the author's own function of
a direction. Output: a ``Background``, which computes the light from a direction. Only the camera
and mirrors see it, unless it is declared a light (by ``light=True``, or by adding it to the
lights): no light is counted twice.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Final

from distal.diagnostics import Span
from distal.ir.types import VEC3
from distal.lang import Buffer, func, vec3
from distal.lang.expressions import Symbolic
from distal.lang.functions import Func
from distal.lang.lazy_module import LazyModule
from distal.lang.resources import Buffer as BufferData
from distal.lang.resources import Texture2D
from distal.lang.source_places import author_place
from distal.render import ambient as ambient_library
from distal.render import environment as environment_library
from distal.render import sky as library
from distal.render import surroundings
from distal.render.brightness import brightness_table
from distal.render.declarations import BACKGROUNDS, Family
from distal.scene.objects.declared import (
    declared_call,
    declared_class,
    given_arguments,
    scene_call,
)
from distal.scene.objects.lights import Light, call_of_part
from distal.scene.objects.scene_object import CalledObject
from distal.scene.tree.arguments import slots_of
from distal.scene.tree.calls import FunctionCall
from distal.scene.tree.conversion import unwrapped
from distal.scene.tree.errors import refuse_kind
from distal.scene.tree.value import CallRecord, recorded

if TYPE_CHECKING:
    from distal.scene.objects import images as image_files
    from distal.scene.objects.argument_types import Argument, Color, Image, Number
else:
    image_files = LazyModule("distal.scene.objects.images")  # needs NumPy


@recorded
class Background(CalledObject):
    """The light of rays that hit nothing.

    A background never changes after construction.

    Args:
        what: A color, or a ``@func`` of ``direction: vec3`` (a unit vector) and of numbers that
            returns linear light.
        numbers: The function's numbers, by name.

    Raises:
        TypeError: ``what`` is neither, or an argument has the wrong type.

    Attributes:
        call: ``(direction) -> vec3``.
        light: The light that belongs to it, or None.
    """

    __slots__ = ("light",)

    noun: ClassVar[str] = "background"
    light: Light | None

    def __init__(self, what: Color | Func, **numbers: Argument) -> None:
        place = author_place()
        if isinstance(what, Func):
            call = _own(what, numbers, place)
        else:
            call = _plain({"color": what, **numbers}, place)
        self._keep(call=call, light=None)

    def _compared(self) -> tuple[Any, ...]:
        return self.noun, self.call, self.light

    @classmethod
    def of(cls, call: FunctionCall, light: Light | None = None) -> Background:
        """Return the background of a scene function of a direction."""
        made = Background.__new__(Background)
        made._keep(call=call, light=light)
        return made


@recorded
class DeclaredBackground(Background):
    """A background of a declared scene function."""

    __slots__ = ()

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        place, what = author_place(), type(self).__name__
        given = given_arguments(self.declaration, args, kwargs, what, place)
        call = declared_call(self.declaration, given, place, what=what)
        self._keep(call=call, light=None)


class Surroundings(Light):
    """A light that is also a background: a sky or an environment.

    Attributes:
        background: ``(direction) -> vec3``, the light of rays that hit nothing.
        light: Whether it also lights the scene when it is used as the background.
    """

    __slots__ = ("background", "light")

    family: ClassVar[Family] = BACKGROUNDS
    background: FunctionCall
    light: bool

    def _checked(self) -> Iterator[Mapping[str, Any]]:
        yield self.background.values

    def _compared(self) -> tuple[Any, ...]:
        # What they are as a light follows from the background.
        return self.noun, self.background, self.light


@recorded
class DeclaredSurroundings(Surroundings):
    """Surroundings from a declared scene function and its functions as a light."""

    __slots__ = ()

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        place, declaration = author_place(), self.declaration
        given = given_arguments(declaration, args, kwargs, declaration.name, place)
        whole = declared_call(declaration, given, place)
        self._keep(
            background=whole,
            light=bool(given.get("light", False)),
            sample=call_of_part(whole, declaration.sample),
            ambient=call_of_part(whole, declaration.ambient),
            radiance=call_of_part(whole, declaration.radiance),
        )


@recorded
class Environment(Surroundings):
    """Surroundings from a panorama picture (equirectangular: -z in the middle, y up).

    Args:
        image: A picture's file, searched beside the scene, then in the working folder; an array
            (height, width, 3 or 4) of linear light; a ``Picture``; a ``Texture2D``.
        intensity: Factor on the light.
        turn: Rotation to the left about the y axis, in radians.
        light: Whether it also lights the scene when it is used as the background. In a list of
            lights it always does.

    Raises:
        ValueError: The picture cannot be read, or a number is out of its range.
        TypeError: An argument has the wrong type.
    """

    __slots__ = ("_ambient", "_directions", "_texture")

    _ambient: FunctionCall | None
    _directions: tuple[FunctionCall, FunctionCall] | None
    _texture: Texture2D

    def __init__(
        self, image: Image, intensity: Number = 1.0, turn: Number = 0.0, *, light: bool = False
    ) -> None:
        place = author_place()
        texture = image_files.light_texture(image, "Environment", place)
        given = {"image": texture, "intensity": intensity, "turn": turn}
        environment = environment_library.environment
        whole = scene_call(BACKGROUNDS, environment, given, "Environment", place)
        self._keep(
            background=whole,
            light=bool(light),
            sample=None,
            radiance=whole,
            _texture=texture,
            _ambient=None,
            _directions=None,
        )

    @property
    def ambient(self) -> FunctionCall:  # type: ignore[override]  # computed when it is first read
        """``(n) -> vec3``, the diffuse light that a surface with normal n receives."""
        if self._ambient is None:
            whole = self.background
            harmonics = BufferData(environment_library.harmonics(self._pixels()))
            values = {**whole.values, "harmonics": harmonics}
            call = FunctionCall(whole.what, environment_light, values, whole.place)
            self._keep(_ambient=call)
        assert self._ambient is not None
        return self._ambient

    @property
    def directions(self) -> tuple[FunctionCall, FunctionCall]:
        """Random directions, denser where the picture is brighter, and their density."""
        if self._directions is None:
            whole = self.background
            rows, columns, cells = brightness_table(self._pixels())
            table = BufferData(image_files.rows_of(cells))
            values = {"rows": rows, "columns": columns, "table": table}
            calls = tuple(
                FunctionCall(whole.what, f, {**values, "turn": whole.values["turn"]}, whole.place)
                for f in (surroundings.sample_surroundings, surroundings.surroundings_density)
            )
            self._keep(_directions=calls)
        assert self._directions is not None
        return self._directions

    def _pixels(self) -> Any:
        found = image_files.texture_light(self._texture, "Environment", self.background.place)
        return found.astype("float32", copy=False)


CLASSES: Final = {
    name: declared_class(found, DeclaredSurroundings if found.sample else DeclaredBackground)
    for name, found in BACKGROUNDS.members.items()
}
globals().update(CLASSES)


@func
def environment_light(
    n: vec3, harmonics: Buffer[vec3], intensity: float = 1.0, turn: float = 0.0
) -> vec3:
    """Compute the diffuse light of a rotated environment."""
    facing = environment_library.turned_by(n, turn)
    return ambient_library.environment_ambient(facing, harmonics, intensity)


def as_background(
    value: Any, lights: Iterable[Light] = (), place: Span | None = None
) -> Background:
    """Return the background of a value: a color, a sky, a ``@func`` of a direction.

    Args:
        value: The author's value. None selects a sky among the lights, else a plain gradient.
        lights: The scene's lights.
        place: The author's line.

    Raises:
        TypeError: The value is none of these.
        ValueError: The value is not a valid color.
    """
    place = place or author_place()
    if value is None:
        skies = (light for light in lights if isinstance(light, Surroundings))
        value = next(skies, None) or CLASSES["GradientBackground"]()
    if isinstance(value, Background):
        return value
    if isinstance(value, Surroundings):
        made = Background.of(value.background, value if value.light else None)
        return made._with_origin_of(value)
    if isinstance(value, Func):
        made = Background.of(_own(value, {}, place))
        made._record(CallRecord(Background, (value,), {}, Background))
        return made
    if not isinstance(unwrapped(value), str | tuple | list | Symbolic):
        refuse_kind(
            f"a background is wanted, not {type(value).__name__} {value!r:.40}",
            'write "#rrggbb", Sky(), Environment(image) or a @func of the direction',
            place,
        )
    made = Background.of(_plain({"color": value}, place))
    made._record(CallRecord(Background, (value,), {}, Background))
    return made


def _plain(given: Mapping[str, Any], place: Span | None) -> FunctionCall:
    return scene_call(BACKGROUNDS, library.plain_background, given, "Background", place)


def _own(function: Func, numbers: Mapping[str, Any], place: Span | None) -> FunctionCall:
    """Return the call of an author's function of a direction."""
    call = scene_call(BACKGROUNDS, function, numbers, function.name, place)
    asks = {slot.name for slot in slots_of(function)}
    if "direction" not in asks or call.result is not VEC3:
        refuse_kind(
            f"'{function.name}' is no background: it is no function of a direction to a color",
            f"def {function.name}(direction: vec3) -> vec3",
            place,
        )
    return call
