"""Filtering textures from single texels, for targets that do not do it themselves.

Texel (0, 0) is the lower left one of a picture; texel centres lie at half coordinates. ``wrap``
is 0 to repeat and 1 to clamp, as the texture was declared. There are no mip maps.
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
    texel,
    vec2,
    vec3,
    vec4,
)


@func
def wrapped(index: int, count: int, wrap: int) -> int:
    """A texel's index along one axis; reading a texel clamps, so that is left to it."""
    return select(wrap == 0, index % count, index)


@func
def sample_2d(texture: Texture2D, coord: vec2, wrap: int) -> vec4:
    """Bilinear: the four texels around ``coord``, weighted by the overlap."""
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
    """Trilinear: the eight texels around ``coord``, weighted by the overlap."""
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


@func
def sample_cube(texture: TextureCube, direction: vec3, wrap: int) -> vec4:
    """Bilinear on the face that ``direction`` points at, clamped at the face's edges.

    Faces and their axes as in OpenGL's cube maps (OpenGL ES 3.0 specification, table 3.21): +x,
    -x, +y, -y, +z, -z.
    """
    extent = vec2(size(texture))
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
    place = (along / axis * 0.5 + 0.5) * extent - 0.5
    corner = floor(place)
    weight = place - corner
    lower = ivec2(corner)
    x1 = lower.x + 1
    y1 = lower.y + 1
    bottom = mix(
        texel(texture, ivec3(lower.x, lower.y, face)),
        texel(texture, ivec3(x1, lower.y, face)),
        weight.x,
    )
    top = mix(
        texel(texture, ivec3(lower.x, y1, face)), texel(texture, ivec3(x1, y1, face)), weight.x
    )
    return mix(bottom, top, weight.y)
