"""Patterns: colours and amounts that differ from place to place on a surface.

Input: colours, materials, numbers, pictures, other patterns, the author's own functions of
a place. Output: a ``Pattern``, which stands wherever a material takes a colour or a number;
a ``Material`` where one of its two sides is one, an amount where both are numbers. A place is told
by ``p`` (the point in the painted shape's own space), ``n`` (the normal there) and ``cell`` (the
index of the repetition it lies in). The formulas are scene code of ``render.patterns``.
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from typing import Any, Final

from distal.diagnostics import Span
from distal.fields.guarantees import Limit
from distal.ir.types import FLOAT
from distal.lang import func, mix, vec3
from distal.lang.functions import Func
from distal.render import patterns as library
from distal.scene.objects.materials import Material, accept, as_material, mixed, own_pattern
from distal.scene.tree.arguments import arguments
from distal.scene.tree.calls import PLACE_NAMES, Pattern
from distal.scene.tree.conversion import is_scalar
from distal.scene.tree.errors import refuse, refuse_kind
from distal.scene.tree.source_places import author_place

_LIMITS: Final = {
    "size": Limit.POSITIVE,
    "octaves": Limit.POSITIVE,
    "radius": Limit.POSITIVE,
}
_MAPPINGS: Final[Mapping[str, Func]] = {
    "planar": library.image_planar,
    "triplanar": library.image_triplanar,
    "spherical": library.image_spherical,
    "cylindrical": library.image_cylindrical,
}


@func
def mix_colors(a: vec3, b: vec3, t: float) -> vec3:
    """One colour where t is 0, another where it is 1."""
    return mix(a, b, t)


@func
def mix_amounts(a: float, b: float, t: float) -> float:
    """One amount where t is 0, another where it is 1."""
    return mix(a, b, t)


def pattern(function: Func, *args: Any, **kwargs: Any) -> Pattern | Material:
    """An author's own ``@func`` of a place.

    Args:
        function: Of any of ``p: vec3``, ``n: vec3``, ``cell: vec3``, and of numbers. It gives a
            float, a vec3 (a linear colour) or a ``Surface``; the last makes a material.
        args: Its numbers by position.
        kwargs: Its numbers by name.

    Raises:
        TypeError: It is no ``@func``, or gives something else.
    """
    place = author_place()
    if not isinstance(function, Func):
        refuse_kind(
            f"a pattern is made from a @func, not from {function!r:.60}",
            "write @func above it",
            place,
        )
    return own_pattern(function, args, kwargs, place)


def checker(a: Any = "#fff", b: Any = "#222", size: Any = 1.0) -> Pattern | Material:
    """Cubes of two colours or materials in turn; on a flat floor, squares.

    Args:
        a: A colour, a pattern, or a material.
        b: The other.
        size: The edge of one cube.
    """
    return _between("checker", a, b, library.checker, {"size": size})


def stripes(
    a: Any = "#fff",
    b: Any = "#222",
    size: Any = 1.0,
    direction: Any = (1.0, 0.0, 0.0),
) -> Pattern | Material:
    """Layers of two colours or materials in turn.

    Args:
        a: A colour, a pattern, or a material.
        b: The other.
        size: How thick one layer is.
        direction: Across the layers.
    """
    given = {"size": size, "direction": direction}
    return _between("stripes", a, b, library.stripes, given)


def waves(
    a: Any = "#fff",
    b: Any = "#222",
    size: Any = 1.0,
    direction: Any = (1.0, 0.0, 0.0),
) -> Pattern | Material:
    """Two colours or materials going smoothly from one to the other and back.

    Args:
        a: A colour, a pattern, or a material.
        b: The other.
        size: From one crest to the next.
        direction: Across the waves.
    """
    given = {"size": size, "direction": direction}
    return _between("waves", a, b, library.waves, given)


def gradient(
    a: Any = "#fff",
    b: Any = "#222",
    start: Any = (0.0, -1.0, 0.0),
    end: Any = (0.0, 1.0, 0.0),
) -> Pattern | Material:
    """One colour or material that becomes another along a line.

    Args:
        a: A colour, a pattern, or a material: up to ``start``.
        b: The other: from ``end`` on.
        start: Where the change begins.
        end: Where it is complete.
    """
    given = {"start": start, "end": end}
    return _between("gradient", a, b, library.linear_gradient, given)


def radial_gradient(
    a: Any = "#fff",
    b: Any = "#222",
    center: Any = (0.0, 0.0, 0.0),
    radius: Any = 1.0,
) -> Pattern | Material:
    """One colour or material that becomes another with the distance from a point.

    Args:
        a: A colour, a pattern, or a material: at the centre.
        b: The other: from ``radius`` on.
        center: Where it begins.
        radius: Where the change is complete.
    """
    given = {"center": center, "radius": radius}
    return _between("radial_gradient", a, b, library.radial_gradient, given)


def noise(
    a: Any = "#fff", b: Any = "#222", size: Any = 1.0, octaves: int = 4
) -> Pattern | Material:
    """Clouds of two colours or materials.

    Args:
        a: A colour, a pattern, or a material.
        b: The other.
        size: How large the largest clouds are.
        octaves: How many times finer clouds are laid over, each half as large; fixed when compiled.
    """
    return _between("noise", a, b, library.clouds, {"size": size, "octaves": octaves})


def palette(
    t: Any,
    base: Any = (0.5, 0.5, 0.5),
    amplitude: Any = (0.5, 0.5, 0.5),
    frequency: Any = (1.0, 1.0, 1.0),
    phase: Any = (0.0, 0.33, 0.67),
) -> Pattern:
    """Colours along a number: ``base + amplitude * cos(2 pi (frequency * t + phase))``.

    Args:
        t: A pattern that gives a number, or a number.
        base: The colour in the middle.
        amplitude: How far each part swings.
        frequency: How often each part swings as t goes from 0 to 1.
        phase: Where in its swing each part begins.
    """
    given = {"t": t, "base": base, "amplitude": amplitude, "frequency": frequency, "phase": phase}
    return _pattern("palette", library.palette, given)


def by_cell(seed: Any = 0.0) -> Pattern:
    """A colour of its own for each repetition of a shape that is painted, then repeated.

    Args:
        seed: Any number; another gives other colours.
    """
    return _pattern("by_cell", library.by_cell, {"seed": seed})


def image_pattern(image: Any, mapping: str = "planar", size: Any = 1.0) -> Pattern:
    """A picture on a surface.

    Args:
        image: A picture's file, looked for beside the scene (then in the working folder); an array
            (height, width, 3 or 4); a ``Picture``; a ``Texture2D`` of linear light.
        mapping: "planar" (along z), "triplanar" (from all three sides, blended), "spherical" or
            "cylindrical" (around the y axis).
        size: How large the picture is, in scene units; around an axis, the share of the turn.

    Raises:
        ValueError: The picture cannot be read, or there is no such mapping.
        TypeError: Something is of another kind.
    """
    place = author_place()
    if mapping not in _MAPPINGS:
        hint = f"one of {', '.join(_MAPPINGS)}"
        refuse(f"there is no mapping {mapping!r:.40} for an image_pattern", hint, place)
    texture = _images().light_texture(image, "image_pattern", place)
    given = {"image": texture, "size": size}
    return _pattern("image_pattern", _MAPPINGS[mapping], given, place)


def cube_map(images: Any) -> Pattern:
    """Six pictures, seen from the shape's centre.

    Args:
        images: Six pictures as for ``image_pattern``, in the order +x, -x, +y, -y, +z, -z; or a
            ``TextureCube`` of linear light.

    Raises:
        ValueError: There are not six, or one cannot be read.
        TypeError: Something is of another kind.
    """
    place = author_place()
    texture = _images().cube_texture(images, "cube_map", place)
    return _pattern("cube_map", library.cube_map, {"image": texture}, place)


def _pattern(
    what: str, function: Func, given: Mapping[str, Any], place: Span | None = None
) -> Pattern:
    place = place or author_place()
    values = arguments(
        function,
        (),
        given,
        what=what,
        limits=_LIMITS,
        requires=_goes_somewhere,
        place=place,
        reserved=PLACE_NAMES,
        colors=("a", "b"),
        accept=accept,
    )
    return Pattern(what, function, values, place)


def _between(
    what: str, a: Any, b: Any, function: Func, given: Mapping[str, Any]
) -> Pattern | Material:
    """Two sides, joined by the share of b that ``function`` gives; two numbers make an amount."""
    place = author_place()
    share = _pattern(what, function, given, place)
    a, b = (own_pattern(x, (), {}, place) if isinstance(x, Func) else x for x in (a, b))
    if isinstance(a, Material) or isinstance(b, Material):
        return mixed(as_material(a, place), as_material(b, place), share, what, place)
    amounts = is_amount(a) and is_amount(b)
    mixing = mix_amounts if amounts else mix_colors
    return _pattern(what, mixing, {"a": a, "b": b, "t": share}, place)


def is_amount(value: Any) -> bool:
    """Whether a side of a pattern is a number, or a pattern of numbers, and no colour."""
    return value.result is FLOAT if isinstance(value, Pattern) else is_scalar(value)


def _goes_somewhere(**given: Any) -> str | None:
    if "direction" in given and not any(given["direction"]):
        return "direction is a vector of zeros, which points nowhere"
    if "start" in given and given["start"] == given["end"]:
        return "start and end are the same place"
    return None


def _images() -> Any:
    """What decodes pictures, loaded when there is one: the compile path needs no NumPy."""
    return importlib.import_module("distal.scene.objects.images")
