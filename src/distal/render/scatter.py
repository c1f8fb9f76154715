"""Scattering: where light goes that meets a surface, sampled and evaluated for paths.

Input: a ``Surface``, the unit direction to where the path came from (``view``), the unit normal
``n`` on that side, and whether that side is the inside of the solid. Output: ``Scattering``
(``sample``: a random direction) or ``Response`` (``respond``: how much of the light of a given
direction goes to ``view``). Where both are wanted, ``meet`` computes once what they share, for
``sample_from`` and ``respond_to``. Does not depend on geometry or lights.

A surface has at most three lobes, whose weights are those of direct light (``material.shares``),
taken at each facet:

- Mirror: facets of GGX with height-correlated masking, or a perfect mirror.
- Through: the same facets refract, or a smooth surface does.
- Even: scattered light, under the coat if there is one (it gets what the coat lets pass, in both
  directions), and the light that the facets of a rough mirror pass on to each other.

Directions of a perfect mirror or of smooth glass have no density: they are ``specular``, only
``sample`` finds them, and ``respond`` leaves them out.

**Radiance is divided by the square of the index of refraction.** A path multiplies its throughput
by ``weight`` alone; there is no factor at a boundary. A picture taken inside glass is not brighter
for the index, and a lamp shows the same through a pane as without it, as in direct light.

``ior`` is that of the inside relative to the outside. Where two solids touch, the caller passes the
surface with the quotient of their indices.
"""

from __future__ import annotations

from distal.lang import abs, clamp, dot, func, max, min, mix, select, sqrt, struct, vec3
from distal.render.material import Surface, brightest, fresnel_metal, shares
from distal.render.microfacets import (
    coat_reflectance,
    facet_density,
    masking_root,
    mean_coat_reflectance,
    mean_fresnel_metal,
    mean_white_loss,
    passed_on,
    white_loss,
)
from distal.render.sampling.warps import (
    Axes,
    along_axes,
    axes_about,
    in_cosine_hemisphere,
    into_space,
    visible_facet,
)

PI = 3.14159265358979
BLACK = vec3(0.0)
WHITE = vec3(1.0)
# Narrower lobes count as perfect mirrors: 32 bits cannot tell their facets apart.
SHARPEST = 1e-4
# A view closer to the surface is moved up to it, where n is not the exact normal.
LOWEST = 1e-4


@struct
class Scattering:
    """A random direction in which a path goes on.

    Attributes:
        direction: Unit direction.
        weight: The factor for the path's throughput: value divided by density; 0 if it ends.
        density: Density of the direction by solid angle; 0 if it is ``specular``.
        transmitted: Whether the path goes through the surface, to its other side.
        specular: Whether the direction is that of a perfect mirror or of smooth glass.
    """

    direction: vec3
    weight: vec3
    density: float
    transmitted: bool
    specular: bool


@struct
class Response:
    """What a surface does with the light of one direction.

    Attributes:
        value: The scattering function times the absolute cosine; without specular lobes.
        density: Density with which ``sample`` chooses the direction, by solid angle.
    """

    value: vec3
    density: float


@struct
class Lobes:
    """What the lobes of a surface have in common for all directions of the light.

    Attributes:
        alpha: Width of the distribution of facets.
        eta: Index of refraction beyond the surface divided by that on the view's side.
        under: Factor of light that is scattered evenly.
        passed: Factor of light that facets pass on to each other.
        even: Probability of the even lobe.
        mirror_specular: Whether the mirror is perfect.
        through_specular: Whether refraction does not spread the light.
    """

    alpha: float
    eta: float
    under: vec3
    passed: vec3
    even: float
    mirror_specular: bool
    through_specular: bool


@struct
class Meeting:
    """A surface as a path meets it: what all directions of the light share.

    Attributes:
        surface: The material.
        axes: The normal on the view's side, and two vectors along the surface.
        view: Unit direction to where the path came from, along the axes.
        inside: Whether that side is the inside of the solid.
        lobes: The lobes at this view.
    """

    surface: Surface
    axes: Axes
    view: vec3
    inside: bool
    lobes: Lobes


@func
def facing(axes: Axes, view: vec3) -> vec3:
    """Return the view along the axes, moved above the surface if it is not."""
    v = along_axes(axes, view)
    held = vec3(v.xy, max(v.z, LOWEST))
    return held / sqrt(dot(held, held))


@func
def under_coat(surface: Surface, cosine: float, alpha: float, eta: float) -> vec3:
    """Return the fraction of light that enters or leaves through the coat, at an angle."""
    clear = coat_reflectance(cosine, alpha, eta)
    coat = mix(vec3(clear), fresnel_metal(cosine, surface.color), surface.metal)
    return 1.0 - surface.fresnel * coat


@func
def mean_under_coat(surface: Surface, alpha: float, eta: float) -> vec3:
    """Return the mean of ``under_coat`` over the hemisphere, weighted by the cosine."""
    clear = mean_coat_reflectance(alpha, eta)
    metal = mean_fresnel_metal(surface.color)
    return 1.0 - surface.fresnel * mix(vec3(clear), metal, surface.metal)


@func
def between_facets(surface: Surface, alpha: float) -> vec3:
    """Return the factor of the light that facets of mirrors and metals pass on to each other.

    What the facets of a clear coat lose goes to the light below it (``under_coat``); that of rough
    glass is lost.
    """
    whole = surface.diffuse + surface.specular + surface.transmission
    tint = mix(WHITE, surface.color, surface.metal)
    plain = surface.specular * (1.0 - surface.fresnel) * passed_on(tint, alpha)
    reflected = passed_on(mean_fresnel_metal(surface.color), alpha)
    metal = whole * surface.fresnel * surface.metal * reflected
    return (plain + metal) / max(mean_white_loss(alpha), 1e-9)


@func
def lobes_of(surface: Surface, cosine: float, inside: bool) -> Lobes:
    """Return the lobes of a surface, seen at an angle.

    Args:
        surface: The material.
        cosine: Cosine of the view to the normal, above 0.
        inside: Whether the view is on the inside.
    """
    alpha = clamp(surface.roughness * surface.roughness, 0.0, 1.0)
    eta = 1.0 / surface.ior if inside else surface.ior
    sharp = alpha < SHARPEST
    under = surface.color * surface.diffuse
    if surface.fresnel > 0.0 and surface.diffuse > 0.0:
        mean = max(mean_under_coat(surface, alpha, eta), vec3(1e-3))
        under = under * under_coat(surface, cosine, alpha, eta) / mean
    passed = BLACK
    if not sharp and surface.specular + surface.fresnel * surface.metal > 0.0:
        passed = between_facets(surface, alpha) * white_loss(cosine, alpha)
    flat = shares(surface, cosine, inside)
    scattered = brightest(under + passed * mean_white_loss(alpha))
    other = brightest(flat.mirrored + flat.transmitted)
    even = scattered / max(scattered + other, 1e-9)
    thin = alpha * abs(eta - 1.0) < SHARPEST
    return Lobes(alpha, eta, under, passed, even, sharp, sharp or thin)


@func
def mirror_share(mirrored: vec3, transmitted: vec3) -> float:
    """Return the probability that a facet reflects."""
    bright = brightest(mirrored)
    return bright / max(bright + brightest(transmitted), 1e-9)


@func
def meet(surface: Surface, view: vec3, n: vec3, inside: bool) -> Meeting:
    """Return a surface as a path meets it, for ``respond_to`` and ``sample_from``.

    Args:
        surface: The material.
        view: Unit direction to where the path came from.
        n: Unit normal on that side.
        inside: Whether that side is the inside of the solid.
    """
    axes = axes_about(n)
    v = facing(axes, view)
    return Meeting(surface, axes, v, inside, lobes_of(surface, v.z, inside))


@func
def respond_along(meeting: Meeting, light: vec3) -> Response:
    """Return the response to light of a unit direction along the axes.

    Source: Bruce Walter et al., "Microfacet Models for Refraction through Rough Surfaces" (2007);
        Heitz (2014) for the masking of reflected light and of visible facets.
    """
    surface = meeting.surface
    lobes = meeting.lobes
    v = meeting.view
    above = light.z > 0.0
    alpha = lobes.alpha
    cosine = abs(light.z)
    # The even lobe.
    spread = max(light.z, 0.0) / PI
    value = lobes.under
    if surface.fresnel > 0.0 and surface.diffuse > 0.0:
        value = value * under_coat(surface, cosine, alpha, lobes.eta)
    if brightest(lobes.passed) > 0.0:
        value += lobes.passed * white_loss(cosine, alpha)
    value = value * spread
    density = lobes.even * spread
    # The facet that mirrors or refracts the light to the view.
    middle = v + light * select(above, 1.0, lobes.eta)
    middle = middle * (select(middle.z < 0.0, -1.0, 1.0) / sqrt(max(dot(middle, middle), 1e-20)))
    to_view = dot(v, middle)
    to_light = dot(light, middle)
    seen = to_view > 0.0 and (to_light > 0.0) == above and middle.z > 0.0
    specular = lobes.mirror_specular if above else lobes.through_specular
    if seen and not specular:
        facet = shares(surface, min(to_view, 1.0), meeting.inside)
        root_v = masking_root(v.z, alpha)
        root_l = masking_root(cosine, alpha)
        visible = 2.0 * facet_density(middle, alpha) * to_view / (v.z + root_v)
        bent = to_view + lobes.eta * to_light
        through = lobes.eta * lobes.eta * -to_light / max(bent * bent, 1e-20)
        lobe = visible * select(above, 0.25 / to_view, through)
        both = cosine * (v.z + root_v) / max(cosine * root_v + v.z * root_l, 1e-20)
        masked = select(above, both, 2.0 * cosine / (cosine + root_l))
        picked = mirror_share(facet.mirrored, facet.transmitted)
        value += select(above, facet.mirrored, facet.transmitted) * (lobe * masked)
        density += (1.0 - lobes.even) * select(above, picked, 1.0 - picked) * lobe
    return Response(value, density)


@func
def respond_to(meeting: Meeting, light: vec3) -> Response:
    """Return how much of the light of a direction goes to the view, and ``sample_from``'s density.

    Args:
        meeting: The surface, made by ``meet``.
        light: Unit direction to the light, on either side.
    """
    return respond_along(meeting, along_axes(meeting.axes, light))


@func
def sample_from(meeting: Meeting, u: vec3) -> Scattering:
    """Return a random direction in which a path goes on.

    Args:
        meeting: The surface, made by ``meet``.
        u: Three random numbers in [0, 1); the third chooses the lobe.
    """
    lobes = meeting.lobes
    v = meeting.view
    evenly = u.z < lobes.even
    # What is left of the third number is uniform again.
    choice = min((u.z - lobes.even) / max(1.0 - lobes.even, 1e-9), 0.99999994)
    facet = vec3(0.0, 0.0, 1.0)
    if not lobes.mirror_specular:
        facet = visible_facet(v, lobes.alpha, u.xy)
    to_view = clamp(dot(v, facet), 0.0, 1.0)
    of_facet = shares(meeting.surface, to_view, meeting.inside)
    picked = mirror_share(of_facet.mirrored, of_facet.transmitted)
    mirrors = evenly or choice < picked
    inverse = 1.0 / lobes.eta
    sunk = sqrt(max(1.0 - (1.0 - to_view * to_view) * inverse * inverse, 0.0))
    refracted = (to_view * inverse - sunk) * facet - v * inverse
    light = select(mirrors, 2.0 * to_view * facet - v, refracted)
    if evenly:
        light = in_cosine_hemisphere(u.xy)
    light = light / sqrt(max(dot(light, light), 1e-20))
    specular = not evenly and (lobes.mirror_specular if mirrors else lobes.through_specular)
    weight = BLACK
    density = 0.0
    if (light.z > 0.0) == mirrors and light.z != 0.0:
        if specular:
            chance = (1.0 - lobes.even) * select(mirrors, picked, 1.0 - picked)
            weight = select(mirrors, of_facet.mirrored, of_facet.transmitted) / max(chance, 1e-9)
        else:
            found = respond_along(meeting, light)
            density = found.density
            weight = found.value / max(density, 1e-30)
    return Scattering(into_space(meeting.axes, light), weight, density, not mirrors, specular)


@func
def respond(surface: Surface, view: vec3, light: vec3, n: vec3, inside: bool) -> Response:
    """Return how much of the light of a direction goes to the view, and ``sample``'s density.

    Args:
        surface: The material.
        view: Unit direction to where the path came from.
        light: Unit direction to the light, on either side.
        n: Unit normal on the view's side.
        inside: Whether that side is the inside of the solid.
    """
    return respond_to(meet(surface, view, n, inside), light)


@func
def sample(surface: Surface, view: vec3, n: vec3, inside: bool, u: vec3) -> Scattering:
    """Return a random direction in which a path goes on.

    Args:
        surface: The material.
        view: Unit direction to where the path came from.
        n: Unit normal on the view's side.
        inside: Whether that side is the inside of the solid.
        u: Three random numbers in [0, 1); the third chooses the lobe.
    """
    return sample_from(meet(surface, view, n, inside), u)


@func
def all_specular(surface: Surface) -> bool:
    """Return whether only ``sample`` finds the surface's light: lights need not be sampled."""
    smooth = surface.roughness * surface.roughness < SHARPEST
    even = max(brightest(surface.color) * surface.diffuse, surface.bsdf_share)
    return smooth and even <= 0.0


@func
def emitted(surface: Surface, inside: bool) -> vec3:
    """Return the light that a surface emits; it emits to the outside."""
    return BLACK if inside else surface.emission
