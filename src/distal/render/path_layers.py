"""Layers of a picture that is made of random paths: what guides a denoiser.

Input: a ray, the functions of a scene, random numbers. Output: the color or the normal of the first
surface that scatters light: what is seen in mirrors and through clear glass. Their means over the
samples of a pixel are the layers, with the same filter, lens and shutter as the light.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from distal.lang import exp, func, struct, vec3, vec4
from distal.render.camera import Ray
from distal.render.dispersion import wavelength_of
from distal.render.footprint import Cone, Footprint, continued
from distal.render.march import Hit, March
from distal.render.material import Surface
from distal.render.normals import EXACT
from distal.render.paths import (
    CAMERA_DECISIONS,
    DECISIONS,
    DIRECTION,
    WAVELENGTH,
)
from distal.render.sampling.points import Stream, single, triple
from distal.render.scatter import Meeting, Scattering, all_specular, meet
from distal.render.vertices import Start, start_from, straight_on, vertex_at

# Mirrors and sheets of clear glass that are looked through.
MOST_SPECULAR: Final = 12


@struct
class SeenSurface:
    """The first surface along a path that scatters light.

    Attributes:
        found: Whether there is one.
        color: Its color, as seen in mirrors and through glass.
        normal: Its unit normal, on the side that the path came from.
    """

    found: bool
    color: vec3
    normal: vec3


@func
def first_scattering(
    ray: Ray,
    first_hit: Callable[[Ray], Hit],
    first_within: Callable[[Ray, Hit], int],
    next_hit: Callable[[Ray, int, float, int], Hit],
    field_of: Callable[[vec3, int], float],
    surface: Callable[[vec3, Footprint, int], Surface],
    scatter: Callable[[Meeting, vec3], Scattering],
    numbers: March,
    bodies: int,
    common: int,
    stream: Stream,
    cone: Cone,
    normals: int = EXACT,
    normal_step: float = 1e-3,
) -> SeenSurface:
    """Return the first surface along a path that is neither a mirror nor clear glass.

    Args:
        ray: Ray.
        first_hit: The first surface along a ray of the camera.
        first_within: The bodies in which such a ray starts.
        next_hit: The next surface along a ray from a surface; as for ``paths.path_light``.
        field_of: Signed distance near a surface of a part (``Hit.part``).
        surface: The material at a point of a part, averaged over a footprint.
        scatter: A random direction; as for ``paths.path_light``.
        numbers: The parameters of the march.
        bodies: How many bodies the scene has (``media``); a constant.
        common: The body of shapes without a priority; a constant.
        stream: The random numbers of the path, which chooses as ``paths.path_light`` does.
        cone: The cone of the ray.
        normals: The method for normals; a constant of ``normals``.
        normal_step: Step of the normals' differences, in scene units at distance 1.
    """
    found = False
    color = vec3(0.0)
    normal = vec3(0.0)
    throughput = vec3(1.0)
    start = Start(ray, 0, 0.0, -1)
    wavelength = wavelength_of(single(stream, WAVELENGTH))
    width = cone
    for i in range(MOST_SPECULAR):
        here = start.ray
        hit = first_hit(here) if i == 0 else next_hit(here, start.within, start.slope, start.part)
        if not hit.found:
            break
        within = first_within(here, hit) if i == 0 else start.within
        vertex = vertex_at(
            here, hit, within, field_of, surface, width, numbers, normals, normal_step, bodies,
            common, wavelength,
        )  # fmt: skip
        met = vertex.interface
        if within != 0:
            throughput = throughput * exp(-met.absorption * vertex.t)
        if bodies > 1 and not met.is_boundary:
            start = straight_on(vertex, here.direction)
            continue
        meeting = meet(met.surface, -here.direction, vertex.n, met.inside)
        u = triple(stream, CAMERA_DECISIONS + DECISIONS * i + DIRECTION)
        onward = scatter(meeting, u)
        if not all_specular(met.surface) or not onward.specular:
            found = True
            color = throughput * met.surface.color
            normal = vertex.n
            break
        throughput = throughput * onward.weight
        start = start_from(vertex, onward.direction)
        width = continued(width, vertex.t)
    return SeenSurface(found, color, normal)


@func
def seen_color(seen: SeenSurface) -> vec4:
    """Return the color of the first surface that scatters light; alpha is 0 if there is none."""
    return vec4(seen.color, 1.0 if seen.found else 0.0)


@func
def seen_normal(seen: SeenSurface) -> vec4:
    """Return the normal of the first surface that scatters light; alpha is 0 if there is none."""
    return vec4(seen.normal, 1.0 if seen.found else 0.0)


PATH_LAYERS = {"normal": seen_normal, "albedo": seen_color}
