"""Patterns: colors and amounts that vary over a surface.

Input: the patterns declared in ``render.patterns``; colors, materials, numbers, pictures, other
patterns, authors' own functions of a place. Output: a ``Pattern``, which a material accepts instead
of a color or a number; a ``Material`` if one of a pattern's two sides is a material; an amount if
both are numbers. A place is ``p`` (the point in the local space of the painted shape), ``n`` (the
normal there), ``cell`` (the index of the repetition that contains it), ``footprint`` (the part of
the surface that the pixel shows) and ``facing`` (how much it faces the eye). The formulas are scene
code.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Final

from distal.diagnostics import Span
from distal.ir.types import FLOAT
from distal.lang import func, mix, vec3
from distal.lang.functions import Func
from distal.lang.lazy_module import LazyModule
from distal.lang.resources import Texture3D
from distal.lang.source_places import author_place
from distal.render import patterns as library
from distal.render.declarations import PATTERNS, Declaration
from distal.scene.objects.declared import declared_call, declared_function, scene_call
from distal.scene.objects.materials import Material, accept, as_material, mixed, own_pattern
from distal.scene.tree.calls import FunctionCall, Pattern
from distal.scene.tree.conversion import is_scalar
from distal.scene.tree.errors import refuse, refuse_kind
from distal.scene.tree.value import recorded

if TYPE_CHECKING:
    from distal.scene.objects import images as image_files
    from distal.scene.objects.argument_types import Argument, Image, Images, Number, Varying
else:
    image_files = LazyModule("distal.scene.objects.images")  # needs NumPy

_MAPPINGS: Final[Mapping[str, Func]] = {
    "planar": library.image_planar,
    "triplanar": library.image_triplanar,
    "spherical": library.image_spherical,
    "cylindrical": library.image_cylindrical,
}


@func
def mix_colors(a: vec3, b: vec3, t: float) -> vec3:
    """Interpolate two colors: ``a`` at t = 0, ``b`` at t = 1."""
    return mix(a, b, t)


@func
def mix_amounts(a: float, b: float, t: float) -> float:
    """Interpolate two amounts: ``a`` at t = 0, ``b`` at t = 1."""
    return mix(a, b, t)


def pattern(function: Func, *args: Argument, **kwargs: Argument) -> Any:
    """Make a pattern from an author's own ``@func`` of a place.

    Args:
        function: A function of any of ``p: vec3``, ``n: vec3``, ``cell: vec3``, ``footprint:
            float`` (the width of the pixel on the surface, in the coordinates of p), ``facing:
            float`` (the cosine of the angle between the normal and the direction to the eye), and
            of numbers. It returns a float, a vec3 (a linear color) or a ``Surface``, which makes a
            material.
        args: The function's numbers by position.
        kwargs: The function's numbers by name.

    Raises:
        TypeError: ``function`` is not a ``@func``, or returns another type.

    Returns:
        A ``Pattern``, or a ``Material`` if the function gives a ``Surface``.
    """
    place = author_place()
    if not isinstance(function, Func):
        refuse_kind(
            f"a pattern is made from a @func, not from {function!r:.60}",
            "write @func above it",
            place,
        )
    return own_pattern(function, args, kwargs, place)


@recorded
def image_pattern(image: Image, mapping: str = "planar", size: Number | Varying = 1.0) -> Pattern:
    """Project a picture onto a surface.

    Args:
        image: A picture's file, searched beside the scene, then in the working folder; an array
            (height, width, 3 or 4); a ``Picture``; a ``Texture2D`` of linear light.
        mapping: "planar" (along z), "triplanar" (along all three axes, blended), "spherical" or
            "cylindrical" (around the y axis).
        size: Size of the picture in scene units; with "spherical" and "cylindrical", as a fraction
            of the full turn.

    Raises:
        ValueError: The picture cannot be read, or there is no such mapping.
        TypeError: An argument has the wrong type.
    """
    place = author_place()
    if mapping not in _MAPPINGS:
        hint = f"one of {', '.join(_MAPPINGS)}"
        refuse(f"there is no mapping {mapping!r:.40} for an image_pattern", hint, place)
    texture = image_files.light_texture(image, "image_pattern", place)
    given = {"image": texture, "size": size}
    return _pattern("image_pattern", _MAPPINGS[mapping], given, place)


@recorded
def cube_map(images: Images) -> Pattern:
    """Project six pictures onto a surface from the shape's centre.

    Args:
        images: Six pictures as for ``image_pattern``, in the order +x, -x, +y, -y, +z, -z; or a
            ``TextureCube`` of linear light.

    Raises:
        ValueError: There are not six pictures, or one cannot be read.
        TypeError: An argument has the wrong type.
    """
    place = author_place()
    texture = image_files.cube_texture(images, "cube_map", place)
    return _pattern("cube_map", library.cube_map, {"image": texture}, place)


def volume_colors(
    colors: Texture3D,
    middle: tuple[float, float, float],
    size: tuple[float, float, float],
    place: Span | None,
) -> Pattern:
    """Return the colors of a volume.

    Args:
        colors: The colors, as they are displayed.
        middle: The middle of the volume.
        size: Its size.
        place: The author's line.
    """
    given = {"colors": colors, "middle": middle, "size": size}
    return _pattern("volume_colors", library.volume_colors, given, place)


def _pattern(what: str, function: Func, given: Mapping[str, Any], place: Span | None) -> Pattern:
    return _as_pattern(scene_call(PATTERNS, function, given, what, place, accept=accept))


def _as_pattern(call: FunctionCall) -> Pattern:
    return Pattern(call.what, call.func, call.values, call.place)


def _declared(
    declaration: Declaration, given: dict[str, Any], place: Span | None
) -> Pattern | Material:
    """Return a declared pattern. If it has two sides, mix them by the share it computes."""
    share = _as_pattern(declared_call(declaration, given, place, accept=accept))
    if not declaration.extras:
        return share
    what = declaration.name
    sides = (given.get(side.name, side.default) for side in declaration.extras)
    a, b = (own_pattern(x, (), {}, place) if isinstance(x, Func) else x for x in sides)
    if isinstance(a, Material) or isinstance(b, Material):
        return mixed(as_material(a, place), as_material(b, place), share, what, place)
    mixing = mix_amounts if is_amount(a) and is_amount(b) else mix_colors
    return _pattern(what, mixing, {"a": a, "b": b, "t": share}, place)


FUNCTIONS: Final = {
    name: declared_function(
        found, _declared, __name__, "Pattern | Material" if found.extras else "Pattern"
    )
    for name, found in PATTERNS.members.items()
}
globals().update(FUNCTIONS)


def is_amount(value: Any) -> bool:
    """Return whether a side of a pattern is a number or a pattern of numbers, not a color."""
    return value.result is FLOAT if isinstance(value, Pattern) else is_scalar(value)
