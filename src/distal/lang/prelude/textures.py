"""Texture filtering computed from single texels, for targets without it.

Texel (0, 0) is the lower left texel of a picture; texel centres are at half coordinates. ``wrap``
is 0 to repeat and 1 to clamp, as declared for the texture. There are no mip maps.
"""

from __future__ import annotations

from distal.lang import (
    Texture2D,
    Texture3D,
    TextureCube,
    abs,
    floor,
    func,
    ivec2,
    ivec3,
    mix,
    select,
    size,
    struct,
    texel,
    vec2,
    vec3,
    vec4,
)


@func
def wrapped(index: int, count: int, wrap: int) -> int:
    """Return a texel index along one axis; not clamped, because reading a texel clamps it."""
    return select(wrap == 0, index % count, index)


@func
def sample_2d(texture: Texture2D, coord: vec2, wrap: int) -> vec4:
    """Interpolate bilinearly between the four texels around ``coord``."""
    extent = size(texture)
    place = coord * vec2(extent) - 0.5
    corner = floor(place)
    weight = place - corner
    lower = ivec2(corner)
    x0 = wrapped(lower.x, extent.x, wrap)
    x1 = wrapped(lower.x + 1, extent.x, wrap)
    y0 = wrapped(lower.y, extent.y, wrap)
    y1 = wrapped(lower.y + 1, extent.y, wrap)
    bottom = mix(texel(texture, ivec2(x0, y0)), texel(texture, ivec2(x1, y0)), weight.x)
    top = mix(texel(texture, ivec2(x0, y1)), texel(texture, ivec2(x1, y1)), weight.x)
    return mix(bottom, top, weight.y)


@func
def sample_3d(texture: Texture3D, coord: vec3, wrap: int) -> vec4:
    """Interpolate trilinearly between the eight texels around ``coord``."""
    extent = size(texture)
    place = coord * vec3(extent) - 0.5
    corner = floor(place)
    weight = place - corner
    lower = ivec3(corner)
    x0 = wrapped(lower.x, extent.x, wrap)
    x1 = wrapped(lower.x + 1, extent.x, wrap)
    y0 = wrapped(lower.y, extent.y, wrap)
    y1 = wrapped(lower.y + 1, extent.y, wrap)
    z0 = wrapped(lower.z, extent.z, wrap)
    z1 = wrapped(lower.z + 1, extent.z, wrap)
    near_bottom = mix(
        texel(texture, ivec3(x0, y0, z0)), texel(texture, ivec3(x1, y0, z0)), weight.x
    )
    near_top = mix(texel(texture, ivec3(x0, y1, z0)), texel(texture, ivec3(x1, y1, z0)), weight.x)
    far_bottom = mix(texel(texture, ivec3(x0, y0, z1)), texel(texture, ivec3(x1, y0, z1)), weight.x)
    far_top = mix(texel(texture, ivec3(x0, y1, z1)), texel(texture, ivec3(x1, y1, z1)), weight.x)
    near = mix(near_bottom, near_top, weight.y)
    far = mix(far_bottom, far_top, weight.y)
    return mix(near, far, weight.z)


@struct
class CubePlace:
    """A point of a cube map: the face, and its position there from (-1, -1) to (1, 1)."""

    face: int
    along: vec2


@func
def cube_place(direction: vec3) -> CubePlace:
    """Return the point of a cube map that a direction points at.

    Faces and their axes are those of OpenGL's cube maps (OpenGL ES 3.0 specification, table 3.21):
    +x, -x, +y, -y, +z, -z.
    """
    reach = abs(direction)
    face = 0
    axis = reach.x
    along = vec2(select(direction.x < 0.0, direction.z, -direction.z), -direction.y)
    if reach.x >= reach.y and reach.x >= reach.z:
        face = select(direction.x < 0.0, 1, 0)
    elif reach.y >= reach.z:
        face = select(direction.y < 0.0, 3, 2)
        axis = reach.y
        along = vec2(direction.x, select(direction.y < 0.0, -direction.z, direction.z))
    else:
        face = select(direction.z < 0.0, 5, 4)
        axis = reach.z
        along = vec2(select(direction.z < 0.0, -direction.x, direction.x), -direction.y)
    return CubePlace(face, along / axis)


@func
def cube_direction(place: CubePlace) -> vec3:
    """Return the direction of a point; beyond the edge of a face it points at the next face."""
    side = select(place.face % 2 == 0, 1.0, -1.0)
    if place.face < 2:
        return vec3(side, -place.along.y, -side * place.along.x)
    if place.face < 4:
        return vec3(place.along.x, side, side * place.along.y)
    return vec3(side * place.along.x, -place.along.y, side)


@func
def cube_texel(texture: TextureCube, face: int, index: ivec2, extent: int) -> vec4:
    """Return a texel of a face; an index beyond the edge reads the neighboring face."""
    place = CubePlace(face, (2.0 * vec2(index) + 1.0) / float(extent) - 1.0)
    if max(abs(place.along.x), abs(place.along.y)) > 1.0:
        place = cube_place(cube_direction(place))
    found = ivec2(floor((place.along * 0.5 + 0.5) * float(extent)))
    return texel(texture, ivec3(found, place.face))


@func
def sample_cube(texture: TextureCube, direction: vec3, wrap: int) -> vec4:
    """Interpolate bilinearly, also across edges of faces (OpenGL ES 3.0 specification, 3.8.9).

    At a corner of the cube only three texels meet; the fourth is their mean.
    """
    extent = size(texture).x
    place = cube_place(direction)
    position = (place.along * 0.5 + 0.5) * float(extent) - 0.5
    corner = floor(position)
    weight = position - corner
    lower = ivec2(corner)
    upper = lower + 1
    a = cube_texel(texture, place.face, lower, extent)
    b = cube_texel(texture, place.face, ivec2(upper.x, lower.y), extent)
    c = cube_texel(texture, place.face, ivec2(lower.x, upper.y), extent)
    d = cube_texel(texture, place.face, upper, extent)
    last = extent - 1
    left = lower.x < 0
    right = upper.x > last
    below = lower.y < 0
    above = upper.y > last
    if left and below:
        a = (b + c + d) / 3.0
    elif right and below:
        b = (a + c + d) / 3.0
    elif left and above:
        c = (a + b + d) / 3.0
    elif right and above:
        d = (a + b + c) / 3.0
    return mix(mix(a, b, weight.x), mix(c, d, weight.x), weight.y)
