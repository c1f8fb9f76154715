"""Distances stored on a grid: scanned and simulated shapes, meshes sampled beforehand.

Input: a point, a volume of samples, the size of the box that they fill. Output: the interpolated
samples inside the box, and a lower bound of the distance outside. Texels are interpolated here and
not by the target's own filter: that of a graphics card has only 256 steps between two samples,
which is visible in normals, and has no gradient.
"""

from __future__ import annotations

from typing import Final

from distal.fields.guarantees import NOTHING, primitive
from distal.fields.solids.boxes import box_bounds
from distal.lang import (
    Texture3D,
    abs,
    clamp,
    floor,
    func,
    ivec3,
    length,
    max,
    min,
    mix,
    struct,
    texel,
    vec2,
    vec3,
    vec4,
)
from distal.lang import size as size_of

BOX_SIZE: Final = vec3(1.0)
# Interpolated samples that differ by at most their distance: each partial derivative is at most 1.
GRID_SLOPE: Final = 1.7320508075688772


@struct
class Eight:
    """The samples at the corners of a cell: at the lower y and z, along x; and so on.

    Attributes:
        near: Those of the lower z: (x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1).
        far: Those of the upper z.
    """

    near: vec4
    far: vec4


@func
def trilinear(samples: Eight, weight: vec3) -> float:
    """Interpolate between the corners of a cell."""
    near = mix(
        mix(samples.near.x, samples.near.y, weight.x),
        mix(samples.near.z, samples.near.w, weight.x),
        weight.y,
    )
    far = mix(
        mix(samples.far.x, samples.far.y, weight.x),
        mix(samples.far.z, samples.far.w, weight.x),
        weight.y,
    )
    return mix(near, far, weight.z)


@func
def interpolated(volume: Texture3D, place: vec3) -> float:
    """Interpolate the first channel trilinearly; ``place`` is in texels from the first centre."""
    last = size_of(volume) - 1
    lower = clamp(ivec3(floor(place)), ivec3(0), max(last - 1, ivec3(0)))
    upper = min(lower + 1, last)
    near = vec4(
        texel(volume, lower).x,
        texel(volume, ivec3(upper.x, lower.y, lower.z)).x,
        texel(volume, ivec3(lower.x, upper.y, lower.z)).x,
        texel(volume, ivec3(upper.x, upper.y, lower.z)).x,
    )
    far = vec4(
        texel(volume, ivec3(lower.x, lower.y, upper.z)).x,
        texel(volume, ivec3(upper.x, lower.y, upper.z)).x,
        texel(volume, ivec3(lower.x, upper.y, upper.z)).x,
        texel(volume, upper).x,
    )
    return trilinear(Eight(near, far), place - vec3(lower))


@func
def place_among(p: vec3, size: vec3, samples: vec3) -> vec3:
    """Return where a point lies among the samples of a box; outside of it, its nearest point.

    Args:
        p: Point.
        size: Size of the box, centred at the origin.
        samples: The number of samples along each axis; they are at the centres of equal cells.
    """
    held = clamp(p, -0.5 * size, 0.5 * size)
    return clamp((held / size + 0.5) * samples - 0.5, vec3(0.0), samples - 1.0)


@func
def within_box(p: vec3, size: vec3, inside: float) -> float:
    """Return the value of a field that is known in a box: cut at its walls, bounded outside.

    Args:
        p: Point.
        size: Size of the box, centred at the origin.
        inside: The field at the point of the box that is nearest to p.
    """
    half = 0.5 * size
    beyond = length(p - clamp(p, -half, half))
    past = abs(p) - half
    wall = max(max(past.x, past.y), past.z)
    # The vector to the box and the vector on to the surface make an angle of 90 degrees or more.
    return max(inside, wall) if wall < 0.0 else length(vec2(beyond, max(inside, 0.0)))


@primitive("VolumeField", NOTHING, slope=GRID_SLOPE, bounds=box_bounds, tier=2, growth=1.0)
@func
def volume_field(
    p: vec3, volume: Texture3D, size: vec3 = BOX_SIZE, value_scale: float = 1.0
) -> float:
    """Shape from a grid of distance samples, in the first channel of a volume texture.

    Neighboring samples must differ by at most the distance between them, as true distances do;
    ``value_scale`` is applied first. Then the surface is at most 0.87 of the samples' spacing from
    the sampled one, and much closer where that is smooth. A shape that extends beyond the box is
    cut off there.

    Args:
        p: Point.
        volume: The distances, negative inside; a sample is ``array[z, y, x]``, or as
            ``Texture3D(array, axes=...)`` says.
        size: Size of the box, which is centred at the origin; samples are at the centres of equal
            cells.
        value_scale: Distance of a sample of value 1.

    Source: trilinear interpolation.

    Measured:
        volume_field((0.25, 0.0, 0.0), Texture3D([[[0.5, 0.5]]]), (4.0, 4.0, 4.0)) = 0.5
        volume_field((0.0, 5.0, 0.0), Texture3D([[[4.0, 4.0]]]), (4.0, 4.0, 4.0)) = 5.0
        volume_field((0.5, 0.0, 0.0), Texture3D([[[0.0, 1.0]]]), (4.0, 4.0, 4.0), 2.0) = 1.5
    """
    inside = interpolated(volume, place_among(p, size, vec3(size_of(volume)))) * value_scale
    return within_box(p, size, inside)
