"""Patterns: numbers and colors that vary over a surface.

Input: ``p``, the point in the coordinates of the painted shape, ``n``, the normal there, ``cell``,
the index of the repetition that contains the point, ``footprint``, the part of the surface that the
pixel shows, and the numbers of a pattern. Output: a weight
from 0 (the first color or material) to 1 (the second), or a linear color. Does not depend on
shapes or lights.
"""

from __future__ import annotations

from distal.fields.noise.lattice import fraction, lattice_hash, next_octave
from distal.fields.noise.space import gradient_noise
from distal.lang import (
    Texture2D,
    Texture3D,
    TextureCube,
    abs,
    atan2,
    clamp,
    cos,
    dot,
    floor,
    func,
    ivec3,
    length,
    max,
    normalize,
    pow,
    round,
    sample,
    sin,
    sqrt,
    vec2,
    vec3,
)
from distal.lang.srgb import decode_srgb
from distal.render.averages import noise_fade, ramp_mean, square_mean, wave_fade
from distal.render.declarations import ExtraParameter, pattern
from distal.render.footprint import POINT, TAPS, Footprint, extent, tap

PI = 3.14159265358979
CENTER = vec3(0.0)
# The parts into which the longer side of a footprint is divided for a checker. At the horizon of a
# floor (480x360), the error is 0.0071 with 8 parts and one sample, 0.032 with one part, and without
# footprints 0.080, or 0.0097 with 16 samples.
BOXES = 8
# A face on the border of two cubes of a checker would flicker between both, so all cubes are moved
# by these fractions of their size, in a direction that is not along any common face.
OFF_THE_BORDER = vec3(1.31e-4, 1.73e-4, 1.57e-4)
ALONG_X = vec3(1.0, 0.0, 0.0)
BELOW = vec3(0.0, -1.0, 0.0)
ABOVE = vec3(0.0, 1.0, 0.0)
HALF = vec3(0.5)
ONCE = vec3(1.0)
THIRDS = vec3(0.0, 0.33, 0.67)


def _sides(
    first: str = "A color, a pattern, or a material.", second: str = "The other."
) -> tuple[ExtraParameter, ExtraParameter]:
    """Return the parameters for the two colors or materials of a pattern that returns a weight."""
    annotation = "Color | Varying | Material"
    return (
        ExtraParameter("a", "#fff", annotation, first),
        ExtraParameter("b", "#222", annotation, second),
    )


def _has_layers(direction: tuple[float, ...]) -> str | None:
    return None if any(direction) else "direction is a vector of zeros, which points nowhere"


def _has_a_way(start: tuple[float, ...], end: tuple[float, ...]) -> str | None:
    return "start and end are the same place" if start == end else None


@func
def checker_mean(q: vec3, across: vec3, along: vec3) -> float:
    """Return the mean of a checker of unit cubes over a footprint, from 0 to 1.

    The longer side is divided into ``BOXES`` equal parts. Over the box of each, with the variance
    of the part along each axis, the mean is a product of three closed forms.

    Args:
        q: Point.
        across: Shorter side of the footprint.
        along: Longer side of the footprint.
    """
    part = along / float(BOXES)
    width = sqrt(across * across + part * part)
    total = 0.0
    for i in range(BOXES):
        wave = square_mean(q + (float(i) + 0.5 - 0.5 * float(BOXES)) * part, width)
        total += wave.x * wave.y * wave.z
    return 0.5 - 0.5 * total / float(BOXES)


@pattern("checker", extras=_sides())
@func
def checker(p: vec3, size: float = 1.0, footprint: Footprint = POINT) -> float:
    """Cubes of two alternating colors or materials; squares on a flat floor.

    Args:
        p: Point.
        size: The edge of one cube.
        footprint: The part of the surface over which the pattern is averaged.
    """
    q = p / size + OFF_THE_BORDER
    return checker_mean(q, footprint.across / size, footprint.along / size)


@func
def checker2(p: vec3, size: float = 1.0, footprint: Footprint = POINT) -> float:
    """Alternating squares in the xz plane; the height has no effect.

    Args:
        p: Point.
        size: Edge of one square.
        footprint: The part of the surface over which the pattern is averaged.
    """
    level = vec3(1.0, 0.0, 1.0) / size
    q = p * level + vec3(0.0, 0.5, 0.0)
    return checker_mean(q, footprint.across * level, footprint.along * level)


@pattern("stripes", extras=_sides(), requires=_has_layers)
@func
def stripes(
    p: vec3, size: float = 1.0, direction: vec3 = ALONG_X, footprint: Footprint = POINT
) -> float:
    """Layers of two alternating colors or materials.

    Args:
        p: Point.
        size: Thickness of one layer.
        direction: Direction perpendicular to the layers.
        footprint: The part of the surface over which the pattern is averaged.
    """
    way = normalize(direction) / size
    wave = square_mean(vec3(dot(p, way)), vec3(extent(footprint, way)))
    return 0.5 - 0.5 * wave.x


@pattern(
    "linear_gradient",
    extras=_sides(
        "A color, a pattern, or a material: up to ``start``.", "The other: from ``end`` on."
    ),
    requires=_has_a_way,
)
@func
def linear_gradient(
    p: vec3, start: vec3 = BELOW, end: vec3 = ABOVE, footprint: Footprint = POINT
) -> float:
    """A blend from one color or material to another along a line.

    Args:
        p: Point.
        start: Where the blend starts.
        end: Where the blend is complete.
        footprint: The part of the surface over which the pattern is averaged.
    """
    way = (end - start) / max(dot(end - start, end - start), 1e-12)
    return ramp_mean(dot(p - start, way), extent(footprint, way))


@pattern(
    "radial_gradient",
    extras=_sides(
        "A color, a pattern, or a material: at the centre.", "The other: from ``radius`` on."
    ),
)
@func
def radial_gradient(
    p: vec3, center: vec3 = CENTER, radius: float = 1.0, footprint: Footprint = POINT
) -> float:
    """A blend from one color or material to another with the distance from a point.

    Args:
        p: Point.
        center: Where the blend starts.
        radius: Distance at which the blend is complete.
        footprint: The part of the surface over which the pattern is averaged.
    """
    away = length(p - center)
    way = (p - center) / (radius * max(away, 1e-6))
    return ramp_mean(away / radius, extent(footprint, way))


@func
def cell_number(cell: vec3, seed: float, salt: int) -> float:
    """Return a number from 0 to 1 for a cell by an integer hash, the same on every target."""
    place = ivec3(int(round(cell.x)), int(round(cell.y)), int(round(cell.z)))
    return fraction(lattice_hash(place, int(floor(16.0 * seed)) + salt))


@pattern("noise", extras=_sides())
@func
def clouds(p: vec3, size: float = 1.0, octaves: int = 4, footprint: Footprint = POINT) -> float:
    """Clouds of two colors or materials.

    Args:
        p: Point.
        size: Size of the largest clouds.
        octaves: Number of layers of clouds, each half as large and half as strong as the one
            before; a constant at compile time.
        footprint: The part of the surface over which the pattern is averaged: each layer fades to
            its mean where the footprint is larger than its clouds.
    """
    q = p / size
    across = length(footprint.across) / size
    along = length(footprint.along) / size
    total = 0.0
    weight = 1.0
    weights = 0.0
    for i in range(octaves):
        fade = noise_fade(across) * noise_fade(along)
        total += weight * fade * gradient_noise(q, i)
        weights += weight
        weight *= 0.5
        q = next_octave(q * 2.0)
        across *= 2.0
        along *= 2.0
    return 0.5 + 0.5 * total / max(weights, 0.5)


@pattern("palette")
@func
def palette(
    t: float,
    base: vec3 = HALF,
    amplitude: vec3 = HALF,
    frequency: vec3 = ONCE,
    phase: vec3 = THIRDS,
) -> vec3:
    """Colors along a number: ``base + amplitude * cos(2 pi (frequency * t + phase))``.

    Args:
        t: A pattern that gives a number, or a number.
        base: The mean color.
        amplitude: Amplitude of each component.
        frequency: Number of periods of each component as t goes from 0 to 1.
        phase: Phase of each component, as a fraction of a period.

    Source: Inigo Quilez, "Procedural color palette" (https://iquilezles.org/articles/palettes/).
    """
    return max(base + amplitude * cos(2.0 * PI * (frequency * t + phase)), vec3(0.0))


@pattern("by_cell")
@func
def by_cell(cell: vec3, seed: float = 0.0) -> vec3:
    """A different color for each repetition of a shape that is painted first, then repeated.

    The color has any hue, and is neither pale nor dark.

    Args:
        cell: Index of the repetition.
        seed: Any number; another seed selects other colors.
    """
    hue = cell_number(cell, seed, 0)
    depth = cell_number(cell, seed, 1)
    pure = palette(hue, vec3(0.5), vec3(0.45), vec3(1.0), vec3(0.0, 0.33, 0.67))
    return pure * (0.55 + 0.45 * depth)


@func
def limb_darkening(n: vec3, view: vec3, amount: float = 0.6) -> float:
    """Return the brightness of a glowing ball like the sun: 1 in the middle, less at the rim.

    Args:
        n: Unit normal.
        view: Unit direction to the eye.
        amount: By how much the rim is darker (the sun: about 0.6).

    Source: the linear law of Schwarzschild (1906).
    """
    return 1.0 - amount * (1.0 - clamp(dot(n, view), 0.0, 1.0))


@func
def image_planar(
    p: vec3, image: Texture2D, size: float = 1.0, footprint: Footprint = POINT
) -> vec3:
    """A picture projected along z; its middle is at the origin, ``size`` wide and high.

    Args:
        p: Point.
        image: Picture.
        size: Size of the picture, in scene units.
        footprint: The part of the surface over which the picture is averaged, by ``TAPS`` samples.
    """
    total = vec3(0.0)
    for i in range(TAPS):
        q = p + tap(footprint, i)
        total += sample(image, q.xy / size + 0.5).rgb
    return total / float(TAPS)


@func
def image_triplanar(
    p: vec3, n: vec3, image: Texture2D, size: float = 1.0, footprint: Footprint = POINT
) -> vec3:
    """A picture projected along all three axes, blended by the direction of the normal.

    Args:
        p: Point.
        n: Unit normal.
        image: Picture.
        size: Size of the picture, in scene units.
        footprint: As for ``image_planar``.
    """
    weight = abs(n)
    weight = weight * weight * weight * weight
    weight = weight / max(weight.x + weight.y + weight.z, 1e-6)
    total = vec3(0.0)
    for i in range(TAPS):
        q = (p + tap(footprint, i)) / size + 0.5
        along_x = sample(image, q.zy).rgb * weight.x
        along_y = sample(image, q.xz).rgb * weight.y
        total += along_x + along_y + sample(image, q.xy).rgb * weight.z
    return total / float(TAPS)


@func
def image_spherical(
    p: vec3, image: Texture2D, size: float = 1.0, footprint: Footprint = POINT
) -> vec3:
    """A picture around the upright axis, from pole to pole.

    Args:
        p: Point.
        image: Picture.
        size: Fraction of the full turn that it covers, and of the angle from pole to pole.
        footprint: As for ``image_planar``.
    """
    total = vec3(0.0)
    for i in range(TAPS):
        q = p + tap(footprint, i)
        around = atan2(q.x, q.z) / (2.0 * PI)
        height = atan2(q.y, length(q.xz)) / PI
        total += sample(image, vec2(around, height) / size + 0.5).rgb
    return total / float(TAPS)


@func
def image_cylindrical(
    p: vec3, image: Texture2D, size: float = 1.0, footprint: Footprint = POINT
) -> vec3:
    """A picture around the upright axis, like a label on a tin.

    Args:
        p: Point.
        image: Picture.
        size: Fraction of the full turn that it covers; also its height in scene units.
        footprint: As for ``image_planar``.
    """
    total = vec3(0.0)
    for i in range(TAPS):
        q = p + tap(footprint, i)
        around = atan2(q.x, q.z) / (2.0 * PI)
        total += sample(image, vec2(around, q.y) / size + 0.5).rgb
    return total / float(TAPS)


@func
def cube_map(p: vec3, image: TextureCube, footprint: Footprint = POINT) -> vec3:
    """Six pictures, seen from the centre of the shape.

    Args:
        p: Point.
        image: Cube map.
        footprint: As for ``image_planar``.
    """
    total = vec3(0.0)
    for i in range(TAPS):
        total += sample(image, p + tap(footprint, i)).rgb
    return total / float(TAPS)


@func
def volume_colors(p: vec3, colors: Texture3D, middle: vec3, size: vec3) -> vec3:
    """Colors from a volume, as they are displayed: those of a mesh.

    Args:
        p: Point.
        colors: The colors, at the centres of equal cells.
        middle: The middle of the volume.
        size: Its size.
    """
    return decode_srgb(sample(colors, (p - middle) / size + 0.5).rgb)


@pattern("waves", extras=_sides(), requires=_has_layers)
@func
def waves(
    p: vec3, size: float = 1.0, direction: vec3 = ALONG_X, footprint: Footprint = POINT
) -> float:
    """A smooth alternation between two colors or materials.

    Args:
        p: Point.
        size: Distance from one crest to the next.
        direction: Direction across the crests.
        footprint: The part of the surface over which the pattern is averaged.
    """
    way = normalize(direction) / size
    fade = wave_fade(dot(footprint.across, way)) * wave_fade(dot(footprint.along, way))
    return 0.5 + 0.5 * fade * sin(2.0 * PI * dot(p, way))


@pattern(
    "facing",
    extras=_sides(
        "A color, a pattern, or a material: where the surface faces the eye.",
        "The other: at outlines.",
    ),
)
@func
def facing_share(facing: float, power: float = 1.0) -> float:
    """A blend by the angle under which the eye sees the surface: rims, velvet, the sun's limb.

    Limb darkening by a coefficient u is ``facing(bright, (1 - u) * bright)``.

    Args:
        facing: The cosine of the angle between the normal and the direction to the eye.
        power: Above 1 the rim grows broader, below 1 narrower.

    Source: the linear law of limb darkening, Karl Schwarzschild (1906).
    """
    return 1.0 - pow(max(facing, 0.0), power)
