"""Vertices of paths: the places where they turn, and the rays that leave these.

Input: the end of a ray, the functions of a scene. Output: a ``Vertex``, a ``Start``. Paths and
photons follow rays by them.
"""

from __future__ import annotations

from collections.abc import Callable

from distal.lang import (
    dot,
    func,
    select,
    struct,
    vec3,
)
from distal.render.bump import bumped_normal
from distal.render.camera import Ray
from distal.render.footprint import (
    Cone,
    Footprint,
    footprint_at,
)
from distal.render.march import Hit, March
from distal.render.material import Surface
from distal.render.media import Interface, interface_at
from distal.render.normals import EXACT
from distal.render.segment import landing, leaving_slope
from distal.render.trace import facing_normal


@struct
class Vertex:
    """A place on a surface where a path turns.

    Attributes:
        t: How far the path came on its last ray.
        p: The place.
        n: The unit normal on the side that the path came from.
        shown: The normal that shading uses: ``n``, turned by a bump.
        slope: |gradient| of the field.
        part: The part that has the surface (``Hit.part``).
        within: The bodies in which the path came.
        interface: What it met: the material, the bodies on the other side.
    """

    t: float
    p: vec3
    n: vec3
    shown: vec3
    slope: float
    part: int
    within: int
    interface: Interface


@func
def vertex_at(
    ray: Ray,
    hit: Hit,
    within: int,
    field_of: Callable[[vec3, int], float],
    surface: Callable[[vec3, Footprint, int], Surface],
    cone: Cone,
    numbers: March,
    normals: int,
    normal_step: float,
    bodies: int,
    common: int,
    wavelength: float,
) -> Vertex:
    """Return the place where a ray met a surface.

    Args:
        ray: Ray.
        hit: Where it ended, at a surface.
        within: The bodies in which it ran.
        field_of: Signed distance near a surface of a part (``Hit.part``).
        surface: The material at a point of a part, averaged over a footprint.
        cone: The cone of the ray.
        numbers: The parameters of the march.
        normals: The method for normals; a constant of ``normals``.
        normal_step: As for ``facing_normal``.
        bodies: How many bodies the scene has; a constant.
        common: The body of shapes without a priority; a constant.
        wavelength: The wavelength of the path, in nanometers.
    """

    def field(q: vec3) -> float:
        return field_of(q, hit.part)

    place = landing(field, ray, hit)
    n = hit.side * place.n
    if normals != EXACT:
        n = facing_normal(field, ray, hit, numbers, normals, normal_step)
    footprint = footprint_at(cone, ray.direction, place.t, n)
    own = surface(place.p, footprint, hit.part)
    met = interface_at(own, place.p, footprint, hit, within, surface, bodies, common, wavelength)
    shown = bumped_normal(n, hit.side * own.tilt, -ray.direction)
    return Vertex(place.t, place.p, n, shown, place.slope, hit.part, within, met)


@struct
class Start:
    """A ray from a surface, as ``RayFunctions.next_hit`` takes it.

    Attributes:
        ray: The ray.
        within: The bodies in which it runs.
        slope: How fast the field grows along it.
        part: The part that has the surface (``Hit.part``).
    """

    ray: Ray
    within: int
    slope: float
    part: int


@func
def start_from(vertex: Vertex, direction: vec3) -> Start:
    """Return the ray from a surface in a direction, on either side."""
    rise = dot(direction, vertex.n)
    within = select(rise > 0.0, vertex.within, vertex.interface.within)
    slope = leaving_slope(vertex.slope, vertex.n, direction)
    return Start(Ray(vertex.p, direction), within, slope, vertex.part)


@func
def straight_on(vertex: Vertex, direction: vec3) -> Start:
    """Return the ray that goes on in its direction, because no media meet at the surface."""
    slope = leaving_slope(vertex.slope, vertex.n, direction)
    return Start(Ray(vertex.p, direction), vertex.interface.within, slope, vertex.part)
