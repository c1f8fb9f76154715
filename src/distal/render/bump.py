"""Bumps: relief that is painted on a surface, by turning its normal and not its geometry.

Input: a material, a height, the height's gradient, the normal. Output: the material with the
height, and the normal that shading uses. The outline and the shadows of the shape do not change.

Source: James F. Blinn, "Simulation of Wrinkled Surfaces", SIGGRAPH 1978; the gradient of the height
in space, without its part along the normal, as in Morten S. Mikkelsen, "Bump Mapping Unparametrized
Surfaces on the GPU" (2010).
"""

from __future__ import annotations

from typing import Final

from distal.lang import dot, func, max, normalize, vec3
from distal.render.material import Surface

# The least cosine between a turned normal and the direction to the eye.
LEAST: Final = 0.03


@func
def raised(surface: Surface, height: float) -> Surface:
    """Return a material with a bump on it.

    Args:
        surface: The material.
        height: The height in scene units, added to that of the material.
    """
    made = surface
    made.height = surface.height + height
    return made


@func
def tilted_surface(surface: Surface, tilt: vec3) -> Surface:
    """Return a material with the gradient of its height."""
    made = surface
    made.tilt = tilt
    return made


@func
def bumped_normal(n: vec3, tilt: vec3, view: vec3) -> vec3:
    """Return the normal of a surface that is raised by a height with this gradient.

    Args:
        n: Unit normal, on the side of the eye.
        tilt: Gradient of the height above this side.
        view: Unit direction to the eye, to which the result stays turned.
    """
    if dot(tilt, tilt) == 0.0:
        return n
    turned = normalize(n - (tilt - dot(tilt, n) * n))
    return normalize(turned + max(LEAST - dot(turned, view), 0.0) * view)
