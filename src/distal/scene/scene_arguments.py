"""Checks of the arguments of ``Scene``: shapes, lights, counts, choices and numbers.

Input: the arguments as the author passed them, and the author's line. Output: objects of the
library, or a ``CompileError`` at that line. Does not depend on how a scene is rendered.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import UnionType
from typing import Any, Final

from distal.diagnostics import Span
from distal.fields.guarantees import UNBOUNDED, Limit
from distal.ir.types import FLOAT, INT
from distal.lang import func, vec3
from distal.lang.composed import Composed
from distal.lang.functions import Func
from distal.render import tonemap
from distal.scene.groups import Group
from distal.scene.objects.cameras import BaseCamera
from distal.scene.objects.field import BaseShape
from distal.scene.objects.lights import Light
from distal.scene.scene_values import SceneValue
from distal.scene.tree.arguments import arguments
from distal.scene.tree.conversion import Asked, number, plain_choice
from distal.scene.tree.errors import refuse, refuse_kind
from distal.scene.tree.own_functions import TONE_MAP

_LIMITS: Final = {
    "exposure": Limit.NOT_NEGATIVE,
    "fog_density": Limit.NOT_NEGATIVE,
    "ambient_occlusion": Limit.NOT_NEGATIVE,
    "near": Limit.NOT_NEGATIVE,
    "far": Limit.POSITIVE,
    "stride": Limit.POSITIVE,
    "stride_growth": Limit.POSITIVE,
}


BLACK: Final = vec3(0.0)


@func
def scene_numbers(
    exposure: float,
    fog_density: float,
    ambient_occlusion: float,
    near: float,
    stride: float,
    stride_growth: float,
    far: float = UNBOUNDED,
    fog: vec3 = BLACK,
) -> float:
    """Declare the names, types and order of a scene's numbers; never called."""
    return exposure


def checked_numbers(place: Span | None, **given: Any) -> Mapping[str, Any]:
    """Return a scene's numbers by name; those that are None are left out.

    Args:
        place: The author's line.
        given: The arguments of ``scene_numbers``.
    """
    asked = {name: value for name, value in given.items() if value is not None}
    found = arguments(
        scene_numbers,
        (),
        asked,
        what="Scene",
        limits=_LIMITS,
        requires=_ends,
        colors=("fog",),
        place=place,
    )
    return {name: value for name, value in found.items() if name in asked}


def checked_exposure(exposure: Any, place: Span | None) -> Any:
    """Return the exposure as a checked number."""
    return number(exposure, Asked("exposure", "Scene", FLOAT, _LIMITS["exposure"], place=place))


def _ends(near: float, far: float) -> str | None:
    return None if near < far else f"rays begin at near {near:g} and end before it, at far {far:g}"


def checked_glow(glow: Any, place: Span | None) -> float:
    """Return the share of the halo as a checked constant."""
    plain = number(glow, Asked("glow", "Scene", FLOAT, Limit.FRACTION, place=place)).plain
    if not isinstance(plain, float):
        refuse_kind("glow is a constant: no parameter, and no expression", "glow=0.4", place)
    return plain


def checked_shutter(shutter: Any, place: Span | None) -> float:
    """Return the seconds that the shutter is open, as a checked constant."""
    asked = Asked("shutter", "Scene", FLOAT, Limit.NOT_NEGATIVE, place=place)
    plain = number(shutter, asked).plain
    if not isinstance(plain, float):
        refuse_kind("shutter is a constant: no parameter, and no expression", "shutter=0.02", place)
    return plain


def whole(name: str, value: Any, limit: Limit, place: Span | None) -> int:
    """Return a checked count of the scene.

    Args:
        name: Name of the parameter.
        value: The author's value.
        limit: The limit of the count.
        place: The author's line.
    """
    return plain_choice(value, Asked(name, "Scene", INT, limit, place=place))


def one_of(what: str, name: Any, known: Sequence[str], place: Span | None) -> str:
    """Check that a choice is one of the known names.

    Args:
        what: The kind of choice, for messages.
        name: The author's value.
        known: The allowed names.
        place: The author's line.
    """
    if name not in known:
        refuse(f"there is no {what} {name!r:.40}", ", ".join(known), place)
    return str(name)


def checked_tone_map(value: Any, place: Span | None) -> str | Func:
    """Return the name of a tone map, or the author's function."""
    if callable(value):  # a ``Func``, or what is refused because it is none
        return TONE_MAP.checked(value, place)
    return one_of("tone map", value, tonemap.NAMES, place)


@dataclass(frozen=True, slots=True)
class SceneContents:
    """What the first argument of a scene holds.

    Attributes:
        given: The shape or the group.
        shape: The one solid.
        lights: The lights of groups.
        camera: The camera of groups, or None.
    """

    given: BaseShape | Group
    shape: BaseShape
    lights: tuple[Light, ...] = ()
    camera: BaseCamera | None = None


def contents_of(given: Any, place: Span | None, *, alone: bool) -> SceneContents:
    """Return what the author gave: a shape, a group, a scene, or several, which are united.

    Args:
        given: The author's argument.
        place: The author's line.
        alone: Whether the scene has no camera besides.
    """
    parts = listed(given)
    if not any(isinstance(part, Group | SceneValue) for part in parts):
        shape = _one_shape(parts, place)
        return SceneContents(shape, shape)
    whole = parts[0] if len(parts) == 1 and isinstance(parts[0], Group) else Group(*parts)
    cameras = whole.cameras
    if alone and len(cameras) > 1:
        hint = "choose one: Scene(group, camera=…)"
        refuse(f"the group has {len(cameras)} cameras, and a picture has one", hint, place)
    solid = whole.shape
    shape = _one_shape([] if solid is None else [solid], place)
    return SceneContents(whole, shape, whole.lights, cameras[0] if cameras else None)


def _one_shape(shapes: Sequence[Any], place: Span | None) -> BaseShape:
    """Return the union of the author's shapes."""
    if not shapes:
        refuse("a scene without shapes shows nothing", "give it a shape: Scene(Sphere())", place)
    for one in shapes:
        if not isinstance(one, BaseShape):
            refuse_kind(f"a scene shows shapes, not {_described(one)}", _shape_hint(one), place)
        if one.flat:
            hint = "make it solid: .extrude(height) or .revolve()"
            refuse(f"'{one.name}' is a flat shape; a scene shows solids", hint, place)
    first: BaseShape = shapes[0]
    return first.union(*shapes[1:]) if len(shapes) > 1 else first


def _described(given: Any) -> str:
    """Return how a message names what is no shape."""
    return f"the class {given.__name__}" if isinstance(given, type) else f"{given!r:.60}"


def _shape_hint(given: Any) -> str | None:
    """Return what to write instead of something that is no shape."""
    if given is None:
        return "a function without return gives None"
    if isinstance(given, type) and issubclass(given, BaseShape):
        return f"call it: {given.__name__}(…)"
    if isinstance(given, UnionType):
        return "call the classes: Sphere(1.0) | Box(1.0)"
    if isinstance(given, Light | BaseCamera):
        return "group(shape, light, camera) groups them"
    return "a scene is given shapes: Scene(shape)" if isinstance(given, Composed) else None


def listed(given: Any) -> list[Any]:
    """Return the argument as a list: of a list, a generator, an array of objects, or one object."""
    return list(given) if isinstance(given, Iterable) and not isinstance(given, str) else [given]


def checked_camera(camera: Any, place: Span | None) -> BaseCamera:
    """Return the author's camera."""
    if not isinstance(camera, BaseCamera):
        refuse_kind(f"a camera is wanted, not {camera!r:.60}", "Camera(position=…)", place)
    return camera


def checked_lights(lights: Any, place: Span | None) -> tuple[Light, ...]:
    """Return the author's lights as a tuple; one light is a tuple of one."""
    if lights is None:
        return ()
    given = tuple(listed(lights))
    for light in given:
        if not isinstance(light, Light):
            refuse_kind(f"a light is wanted, not {light!r:.60}", "PointLight((2, 3, 4))", place)
    return given


def with_surroundings(given: Sequence[Light], around: Light | None) -> tuple[Light, ...]:
    """Return lights and the light of the background, which counts once if it is among them."""
    if around is None or any(around is light for light in given):
        return tuple(given)
    return (*given, around)
