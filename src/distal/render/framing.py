"""A camera that frames a box: the whole box is in the picture, whatever the picture's shape.

Input: a box, the direction to look from, the size of the picture. Output: a ``Ray``. Closed form,
without a search: each side of the picture is a plane through the eye, and the farthest corner of
the box along the plane's normal decides where that plane may be.
"""

from __future__ import annotations

from distal.lang import abs, dot, func, max, tan, vec2, vec3
from distal.render.camera import Ray, basis_turned, through_screen


@func
def half_width(half_size: vec3, direction: vec3) -> float:
    """Return how far a box reaches from its middle along a direction (its support function).

    Args:
        half_size: Half the box's size.
        direction: Direction; of any length, which is a factor on the result.
    """
    return dot(half_size, abs(direction))


@func
def framed(
    uv: vec2,
    resolution: vec2,
    target: vec3,
    half_size: vec3,
    azimuth: float,
    elevation: float,
    fov: float,
    margin: float,
) -> Ray:
    """A perspective camera from which a whole box is visible, as near as possible.

    The eye is behind four planes, one for each side of the picture made smaller by the margin. The
    upper plane touches the box if ``away + g * up`` equals the box's reach along ``back + g * up``
    (``g`` is the cotangent of the plane's angle), and likewise for the others. Two opposite planes
    touch at the same time in the middle of what is left, so the box is centered in the picture.

    Args:
        uv: Place in the picture.
        resolution: Size of the picture in pixels.
        target: Middle of the box.
        half_size: Half the box's size.
        azimuth: Around the y axis, in radians; 0 is on the side of +z, pi/2 on that of +x.
        elevation: Up, in radians.
        fov: The angle from the picture's bottom to its top, in radians.
        margin: Size of the picture divided by that of the box in it; above 1.
    """
    basis = basis_turned(azimuth, -elevation, 0.0)
    focal = 1.0 / tan(0.5 * fov)
    back = -basis.ahead
    upright = focal * margin
    across = focal * margin * resolution.y / resolution.x
    top = half_width(half_size, back + basis.up * upright)
    bottom = half_width(half_size, back - basis.up * upright)
    right = half_width(half_size, back + basis.right * across)
    left = half_width(half_size, back - basis.right * across)
    away = 0.5 * max(top + bottom, left + right)
    aside = basis.up * (0.5 * (top - bottom) / upright)
    aside += basis.right * (0.5 * (right - left) / across)
    return through_screen(uv, target + back * away + aside, basis, focal)
