"""The look of the faces that a section cuts: the material's color, with lines across it.

Input: the surface of the cut solid, the place, the plane. Output: the surface that is shown. Does
not depend on lights or on how the place was found.
"""

from __future__ import annotations

from distal.lang import abs, dot, floor, func, max, mix, select, vec3
from distal.render.material import Surface
from distal.render.sampling.warps import axes_about

# Cut faces of glass, which has no color of its own.
_CLEAR = vec3(0.62, 0.72, 0.78)
# Width of a line as a fraction of the distance of two, and the color's factor on it.
_WIDTH = 0.14
_DARK = 0.55
# The share of a cut face's color that needs no light: it faces away from most lights.
_GLOW = 0.3


@func
def line_shade(p: vec3, normal: vec3, hatch: float) -> float:
    """Return the factor on the color at a place: less than 1 on lines at 45 degrees.

    Args:
        p: Point on the cut face.
        normal: Unit normal of the plane.
        hatch: Distance of two lines, above 0.
    """
    axes = axes_about(normal)
    along = (dot(p, axes.s) + dot(p, axes.t)) * 0.70710678 / hatch
    return select(abs(along - floor(along) - 0.5) > 0.5 - 0.5 * _WIDTH, _DARK, 1.0)


@func
def cut_surface(
    surface: Surface, p: vec3, d: float, normal: vec3, offset: float, hatch: float
) -> Surface:
    """Return the surface at a place of a solid that a section cuts.

    The face of the cut is where the plane is farther than the solid's own surface. It scatters the
    material's color, whatever the material is, and shows it a little where no light is, so that a
    cut can be read from every side.

    Args:
        surface: The solid's surface at the place.
        p: The place, on the solid's surface or on the plane.
        d: The solid's distance there: below 0 on the cut face.
        normal: Unit normal of the plane.
        offset: Distance of the plane from the origin along the normal.
        hatch: Distance of two lines; 0 keeps the material as it is.
    """
    shade = line_shade(p, normal, max(hatch, 1e-20))
    color = mix(surface.color, _CLEAR, surface.transmission) * shade
    shown = Surface(color=color * (1.0 - _GLOW), emission=color * _GLOW + surface.emission * shade)
    is_cut = hatch > 0.0 and dot(p, normal) - offset > d
    if is_cut:
        return shown
    return surface
