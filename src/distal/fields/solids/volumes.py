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
    texel,
    vec2,
    vec3,
)
from distal.lang import size as size_of

BOX_SIZE: Final = vec3(1.0)
# Interpolated samples that differ by at most their distance: each partial derivative is at most 1.
GRID_SLOPE: Final = 1.7320508075688772


@func
def interpolated(volume: Texture3D, place: vec3) -> float:
    """Interpolate the first channel trilinearly; ``place`` is in texels from the first centre."""
    last = size_of(volume) - 1
    lower = clamp(ivec3(floor(place)), ivec3(0), max(last - 1, ivec3(0)))
    upper = min(lower + 1, last)
    weight = place - vec3(lower)
    near = mix(
        mix(
            texel(volume, lower).x,
            texel(volume, ivec3(upper.x, lower.y, lower.z)).x,
            weight.x,
        ),
        mix(
            texel(volume, ivec3(lower.x, upper.y, lower.z)).x,
            texel(volume, ivec3(upper.x, upper.y, lower.z)).x,
            weight.x,
        ),
        weight.y,
    )
    far = mix(
        mix(
            texel(volume, ivec3(lower.x, lower.y, upper.z)).x,
            texel(volume, ivec3(upper.x, lower.y, upper.z)).x,
            weight.x,
        ),
        mix(
            texel(volume, ivec3(lower.x, upper.y, upper.z)).x,
            texel(volume, upper).x,
            weight.x,
        ),
        weight.y,
    )
    return mix(near, far, weight.z)


@primitive("VolumeField", NOTHING, slope=GRID_SLOPE, bounds=box_bounds, tier=2, growth=1.0)
@func
def volume_field(p: vec3, volume: Texture3D, size: vec3 = BOX_SIZE, scale: float = 1.0) -> float:
    """Shape from a grid of distance samples, in the first channel of a volume texture.

    Neighbouring samples must differ by at most the distance between them, as true distances do;
    ``scale`` is applied first. Then the surface is at most 0.87 of the samples' spacing from the
    sampled one, and much closer where that is smooth. A shape that extends beyond the box is cut
    off there.

    Args:
        p: Point.
        volume: The distances, negative inside.
        size: Size of the box, which is centred at the origin; samples are at the centres of equal
            cells.
        scale: Distance of a sample of value 1.

    Source: trilinear interpolation.

    Measured:
        volume_field((0.25, 0.0, 0.0), Texture3D([[[0.5, 0.5]]]), (4.0, 4.0, 4.0)) = 0.5
        volume_field((0.0, 5.0, 0.0), Texture3D([[[4.0, 4.0]]]), (4.0, 4.0, 4.0)) = 5.0
        volume_field((0.5, 0.0, 0.0), Texture3D([[[0.0, 1.0]]]), (4.0, 4.0, 4.0), 2.0) = 1.5
    """
    texels = vec3(size_of(volume))
    half = 0.5 * size
    held = clamp(p, -half, half)
    place = clamp((held / size + 0.5) * texels - 0.5, vec3(0.0), texels - 1.0)
    inside = interpolated(volume, place) * scale
    beyond = length(p - held)
    past = abs(p) - half
    wall = max(max(past.x, past.y), past.z)
    # The vector to the box and the vector on to the surface make an angle of 90 degrees or more.
    return max(inside, wall) if wall < 0.0 else length(vec2(beyond, max(inside, 0.0)))
