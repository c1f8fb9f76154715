"""An author's scattering function (BSDF) at a surface, beside the library's.

Input: a surface as a path meets it, and the author's functions. Output: ``Scattering`` and
``Response``, as those of ``scatter``. A surface has a share of the author's function
(``Surface.bsdf_share``); the weights of its other fields are those of the rest.

The author's functions take vectors of space: the unit normal ``n`` on the side of the view, the
unit directions to the eye and to the light. The surface that they get has the index of refraction
beyond it, relative to the side of the view.
"""

from __future__ import annotations

from collections.abc import Callable

from distal.lang import abs, dot, func, max, min, select, sqrt, vec3
from distal.render.material import Surface
from distal.render.sampling.warps import (
    axes_about,
    cosine_density,
    in_cosine_hemisphere,
    into_space,
)
from distal.render.scatter import (
    BLACK,
    Meeting,
    Response,
    Scattering,
    respond_to,
    sample_from,
)

# A direction of the author's is none if the square of its length is below this.
SHORTEST = 1e-12


@func
def with_bsdf(surface: Surface, bsdf: int) -> Surface:
    """Return a material whose light an author's function scatters.

    Args:
        surface: The material.
        bsdf: The number of the function in the scene; 0 in programs that call none.
    """
    if bsdf == 0:
        return surface
    made = surface
    made.diffuse = 0.0
    made.specular = 0.0
    made.transmission = 0.0
    made.bsdf_share = 1.0
    made.bsdf = bsdf
    return made


@func
def even_sample(surface: Surface, n: vec3, view: vec3, u: vec3) -> vec3:
    """Return a direction on the side of the view, as dense as the cosine."""
    return into_space(axes_about(n), in_cosine_hemisphere(u.xy))


@func
def even_density(surface: Surface, n: vec3, view: vec3, light: vec3) -> float:
    """Return the density of ``even_sample`` by solid angle."""
    return cosine_density(dot(n, light))


@func
def own_response(
    surface: Surface,
    n: vec3,
    view: vec3,
    light: vec3,
    evaluate: Callable[[Surface, vec3, vec3, vec3], vec3],
    density: Callable[[Surface, vec3, vec3, vec3], float],
) -> Response:
    """Return the author's function times the cosine, and the density of its directions.

    Args:
        surface: The material.
        n: Unit normal on the side of the view.
        view: Unit direction to where the path came from.
        light: Unit direction to the light, on either side.
        evaluate: The author's function of these.
        density: The density of its directions by solid angle.
    """
    value = evaluate(surface, n, view, light) * abs(dot(n, light))
    return Response(value, density(surface, n, view, light))


@func
def seen_from_side(meeting: Meeting) -> Surface:
    """Return a surface whose index of refraction is that beyond it, relative to the view's side."""
    made = meeting.surface
    made.ior = 1.0 / made.ior if meeting.inside else made.ior
    return made


@func
def respond_with_own(
    meeting: Meeting,
    light: vec3,
    respond_own: Callable[[Surface, vec3, vec3, vec3], Response],
) -> Response:
    """Return how much of the light of a direction goes to the view, and the density of directions.

    Args:
        meeting: The surface, made by ``scatter.meet``.
        light: Unit direction to the light, on either side.
        respond_own: The response of the author's function with the surface's number.
    """
    share = meeting.surface.bsdf_share
    if share <= 0.0:
        return respond_to(meeting, light)
    view = into_space(meeting.axes, meeting.view)
    own = respond_own(seen_from_side(meeting), meeting.axes.n, view, light)
    if share >= 1.0:
        return own
    rest = respond_to(meeting, light)
    value = own.value * share + rest.value
    return Response(value, own.density * share + rest.density * (1.0 - share))


@func
def scatter_with_own(
    meeting: Meeting,
    u: vec3,
    respond_own: Callable[[Surface, vec3, vec3, vec3], Response],
    sample_own: Callable[[Surface, vec3, vec3, vec3], vec3],
) -> Scattering:
    """Return a random direction in which a path goes on.

    Args:
        meeting: The surface, made by ``scatter.meet``.
        u: Three random numbers in [0, 1).
        respond_own: The response of the author's function with the surface's number.
        sample_own: A random direction of this function.
    """
    share = meeting.surface.bsdf_share
    n = meeting.axes.n
    direction = n
    if u.z >= share:
        # What is left of the third number is uniform again.
        left = min((u.z - share) / max(1.0 - share, 1e-9), 0.99999994)
        found = sample_from(meeting, vec3(u.xy, left))
        if found.specular:
            found.weight = found.weight / max(1.0 - share, 1e-9)
        if share <= 0.0 or found.specular or found.density <= 0.0:
            return found
        direction = found.direction
    else:
        left = min(u.z / max(share, 1e-9), 0.99999994)
        view = into_space(meeting.axes, meeting.view)
        direction = sample_own(seen_from_side(meeting), n, view, vec3(u.xy, left))
        squared = dot(direction, direction)
        if not squared > SHORTEST:
            return Scattering(n, BLACK, 0.0, False, False)
        direction = direction / sqrt(squared)
    total = respond_with_own(meeting, direction, respond_own)
    weight = total.value * select(total.density > 0.0, 1.0 / max(total.density, 1e-30), 0.0)
    return Scattering(direction, weight, total.density, dot(direction, n) < 0.0, False)
