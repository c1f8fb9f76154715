"""Materials: the optical properties of a surface at a point, and how it divides light.

Input: colors, weights, optical constants. Output: a ``Surface``, and from it the scattered,
mirrored and transmitted fractions of a ray's light. Does not depend on geometry or lights.
"""

from __future__ import annotations

from distal.fields.guarantees import Limit
from distal.lang import clamp, dot, func, max, min, mix, sqrt, struct, vec3
from distal.render.declarations import material

BLACK = vec3(0.0)
WHITE = vec3(1.0)
SILVER = vec3(0.91, 0.92, 0.92)


@struct
class Surface:
    """The material at a point. Every field but ``bsdf`` is a number that blends linearly.

    Attributes:
        color: Fraction of red, green and blue that is scattered, mirrored by a metal, or
            transmitted.
        diffuse: Weight of the light that is scattered evenly.
        specular: Weight of the light that is mirrored.
        transmission: Weight of the light that is transmitted.
        ior: Index of refraction of the inside relative to the outside.
        roughness: From 0, a perfect mirror, to 1, as rough as paper; the width of highlights.
        metal: 1 for metals, whose mirrored light is tinted by ``color``.
        emission: Light that the surface emits.
        absorption: Absorption coefficient of the inside, per scene unit (Beer and Lambert).
        fresnel: 0: only the weights count. 1: the mirrored fraction follows Fresnel's formulas, and
            the weights divide the rest.
        dispersion: How much the index depends on the wavelength: 20 divided by Abbe's number (crown
            glass 0.3, flint 0.6, diamond 0.36), 0 for not at all. Only paths show it.
        height: How high the surface seems to be, in scene units, where a bump is painted on it.
        tilt: The gradient of the height in the scene's space, which ``bump`` turns the normal by.
        bsdf_share: In paths: the share of an author's scattering function; the weights of the other
            fields are those of the rest.
        bsdf: The number of this function in the scene.
    """

    color: vec3 = WHITE
    diffuse: float = 1.0
    specular: float = 0.0
    transmission: float = 0.0
    ior: float = 1.5
    roughness: float = 0.0
    metal: float = 0.0
    emission: vec3 = BLACK
    absorption: vec3 = BLACK
    fresnel: float = 0.0
    dispersion: float = 0.0
    height: float = 0.0
    tilt: vec3 = BLACK
    bsdf_share: float = 0.0
    bsdf: int = 0


@material("matte")
@func
def matte(color: vec3 = WHITE) -> Surface:
    """A material that scatters light evenly in all directions: plaster, paper.

    Args:
        color: Fraction of the light that it scatters.
    """
    return Surface(color=color)


@material("glossy", reflects=True)
@func
def glossy(
    color: vec3 = WHITE, diffuse: float = 0.5, specular: float = 0.5, roughness: float = 0.0
) -> Surface:
    """A material that scatters part of the light and mirrors part, independent of the angle.

    The weights add up to at most 1.

    Args:
        color: Fraction of the light that it scatters.
        diffuse: Weight of scattered light.
        specular: Weight of mirrored light.
        roughness: 0 mirrors sharply, 1 hardly mirrors.
    """
    return Surface(color=color, diffuse=diffuse, specular=specular, roughness=roughness)


@material("metal", reflects=True)
@func
def metal(color: vec3 = SILVER, roughness: float = 0.2) -> Surface:
    """A metal: it mirrors in its own color, and white at grazing angles.

    Args:
        color: Color of the mirrored light, seen straight on.
        roughness: 0 mirrors sharply, 1 hardly mirrors.
    """
    return Surface(
        color=color, diffuse=0.0, specular=1.0, roughness=roughness, metal=1.0, fresnel=1.0
    )


@material("mirror", reflects=True)
@func
def mirror(color: vec3 = WHITE) -> Surface:
    """A perfect mirror.

    Args:
        color: Color of the mirrored light.
    """
    return Surface(color=color, diffuse=0.0, specular=1.0, metal=1.0)


@func
def glass(ior: float = 1.5, absorption: vec3 = BLACK, dispersion: float = 0.0) -> Surface:
    """Clear glass: mirrors by Fresnel's formulas and transmits the rest.

    Args:
        ior: Index of refraction: glass 1.5, water 1.33, diamond 2.42.
        absorption: Absorption coefficient of the inside, per scene unit.
        dispersion: 20 divided by Abbe's number.
    """
    return Surface(
        diffuse=0.0,
        transmission=1.0,
        ior=ior,
        absorption=absorption,
        fresnel=1.0,
        dispersion=dispersion,
    )


@material("plastic", reflects=True)
@func
def plastic(color: vec3 = WHITE, roughness: float = 0.2, ior: float = 1.5) -> Surface:
    """A scattering material under a clear coat, which mirrors more at grazing angles.

    Args:
        color: Fraction of the light that it scatters.
        roughness: Roughness of the coat; 0 mirrors sharply.
        ior: Index of refraction of the coat.
    """
    return Surface(color=color, ior=ior, roughness=roughness, fresnel=1.0)


# Emitted light may be brighter than white.
@material("emissive", emits=True, limits={"strength": Limit.NOT_NEGATIVE})
@func
def emissive(color: vec3 = WHITE, strength: float = 1.0) -> Surface:
    """A material that emits light and reflects none.

    Args:
        color: Color of the emitted light.
        strength: Factor on the color; may be above 1.
    """
    return Surface(color=BLACK, diffuse=0.0, emission=color * strength)


@func
def mix_surfaces(a: Surface, b: Surface, t: float) -> Surface:
    """Interpolate linearly from ``a`` (t = 0) to ``b`` (t = 1).

    Of two scattering functions of authors the larger share takes the place of both.
    """
    is_second = b.bsdf_share * t > a.bsdf_share * (1.0 - t)
    return Surface(
        color=mix(a.color, b.color, t),
        diffuse=mix(a.diffuse, b.diffuse, t),
        specular=mix(a.specular, b.specular, t),
        transmission=mix(a.transmission, b.transmission, t),
        ior=mix(a.ior, b.ior, t),
        roughness=mix(a.roughness, b.roughness, t),
        metal=mix(a.metal, b.metal, t),
        emission=mix(a.emission, b.emission, t),
        absorption=mix(a.absorption, b.absorption, t),
        fresnel=mix(a.fresnel, b.fresnel, t),
        dispersion=mix(a.dispersion, b.dispersion, t),
        height=mix(a.height, b.height, t),
        tilt=mix(a.tilt, b.tilt, t),
        bsdf_share=mix(a.bsdf_share, b.bsdf_share, t),
        bsdf=b.bsdf if is_second else a.bsdf,
    )


@func
def choose_surface(a: Surface, b: Surface, is_second: bool) -> Surface:
    """Return ``b`` if ``is_second``, else ``a``."""
    return Surface(
        color=b.color if is_second else a.color,
        diffuse=b.diffuse if is_second else a.diffuse,
        specular=b.specular if is_second else a.specular,
        transmission=b.transmission if is_second else a.transmission,
        ior=b.ior if is_second else a.ior,
        roughness=b.roughness if is_second else a.roughness,
        metal=b.metal if is_second else a.metal,
        emission=b.emission if is_second else a.emission,
        absorption=b.absorption if is_second else a.absorption,
        fresnel=b.fresnel if is_second else a.fresnel,
        dispersion=b.dispersion if is_second else a.dispersion,
        height=b.height if is_second else a.height,
        tilt=b.tilt if is_second else a.tilt,
        bsdf_share=b.bsdf_share if is_second else a.bsdf_share,
        bsdf=b.bsdf if is_second else a.bsdf,
    )


@func
def fresnel_dielectric(cosine: float, eta: float) -> float:
    """Return the fraction of unpolarised light that a clear surface mirrors.

    Args:
        cosine: Cosine of the angle between the ray and the normal, 0 to 1.
        eta: Index of refraction beyond the surface divided by that on the ray's side.

    Source: Fresnel's equations, e.g. Born and Wolf, "Principles of Optics", 1.5.2.
    """
    sine_squared = (1.0 - cosine * cosine) / (eta * eta)
    refracted = sqrt(max(1.0 - sine_squared, 0.0))
    parallel = (eta * cosine - refracted) / max(eta * cosine + refracted, 1e-9)
    across = (cosine - eta * refracted) / max(cosine + eta * refracted, 1e-9)
    mirrored = 0.5 * (parallel * parallel + across * across)
    return 1.0 if sine_squared >= 1.0 else clamp(mirrored, 0.0, 1.0)


@func
def fresnel_metal(cosine: float, color: vec3) -> vec3:
    """Return the fraction that a metal mirrors: its color straight on, white at grazing angles.

    Source: Christophe Schlick, "An Inexpensive BRDF Model for Physically-based Rendering" (1994).
    """
    return color + (1.0 - color) * (1.0 - clamp(cosine, 0.0, 1.0)) ** 5


@struct
class Shares:
    """The weights of the scattered, mirrored and transmitted light at a surface."""

    diffuse: vec3
    mirrored: vec3
    transmitted: vec3


@func
def shares(surface: Surface, cosine: float, inside: bool) -> Shares:
    """Return the weights of scattered, mirrored and transmitted light.

    With Fresnel, the mirrored fraction is subtracted from the whole, and the weights divide the
    rest; what is neither scattered nor transmitted (in a metal) is lost. Beyond the critical angle
    all light that would be transmitted is mirrored, with and without Fresnel.

    Args:
        surface: The material where the ray hits.
        cosine: Cosine of the angle between the ray and the normal, 0 to 1.
        inside: Whether the ray comes from the inside.
    """
    eta = 1.0 / surface.ior if inside else surface.ior
    dielectric = fresnel_dielectric(cosine, eta)
    total_reflection = 1.0 if eta * eta <= 1.0 - cosine * cosine else 0.0
    tint = mix(WHITE, surface.color, surface.metal)
    of_fresnel = mix(vec3(dielectric), fresnel_metal(cosine, surface.color), surface.metal)
    whole = surface.diffuse + surface.specular + surface.transmission
    mirrored = mix(surface.specular * tint, whole * of_fresnel, surface.fresnel)
    left = 1.0 - surface.fresnel * of_fresnel
    through = left * surface.color * surface.transmission
    return Shares(
        diffuse=surface.color * surface.diffuse * left,
        mirrored=mirrored + through * total_reflection,
        transmitted=through * (1.0 - total_reflection),
    )


@func
def brightest(color: vec3) -> float:
    """Return the largest of the three components."""
    return max(color.r, color.g, color.b)


@func
def highlight(surface: Surface, n: vec3, view: vec3, light: vec3, widened: float) -> float:
    """Return the highlight of a light, relative to a white diffuse surface that faces the light.

    The microfacet distribution of Trowbridge and Reitz ("GGX") with the height-correlated masking
    of Smith. A light of non-zero angular size widens the lobe; a point light in a smooth mirror is
    not visible.

    Args:
        surface: The material; only ``roughness`` is used.
        n: Unit normal.
        view: Unit direction to the eye.
        light: Unit direction to the light.
        widened: Tangent of half the angular size of the light.

    Source: Walter et al., "Microfacet Models for Refraction through Rough Surfaces" (2007); Heitz,
        "Understanding the Masking-Shadowing Function" (2014); Karis, "Real Shading in Unreal
        Engine 4" (2013) for the widening.
    """
    alpha = min(surface.roughness * surface.roughness + 0.5 * widened, 1.0)
    if alpha < 1e-3:
        return 0.0
    middle = light + view
    middle = middle / max(sqrt(dot(middle, middle)), 1e-6)
    squared = alpha * alpha
    n_light = max(dot(n, light), 0.0)
    n_view = max(dot(n, view), 1e-4)
    n_middle = clamp(dot(n, middle), 0.0, 1.0)
    spread = 1.0 - n_middle * n_middle * (1.0 - squared)
    # The distribution times pi: a white diffuse surface shows 1 / pi of the incident light.
    facets = squared / max(spread * spread, 1e-12)
    masked_view = n_light * sqrt(n_view * n_view * (1.0 - squared) + squared)
    masked_light = n_view * sqrt(n_light * n_light * (1.0 - squared) + squared)
    return facets * n_light * 0.5 / max(masked_view + masked_light, 1e-6)
