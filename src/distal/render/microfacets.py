"""Rough surfaces: facets of GGX, how they mask each other, and what light they give back.

Input: cosines and unit vectors about the normal (z), the width of the distribution. Output:
densities, fractions. Does not depend on materials.

A cosine is that of a direction to the normal, 0 to 1. ``alpha`` is the width of the distribution of
Trowbridge and Reitz: 0 for a mirror, 1 for the roughest surface.
"""

from __future__ import annotations

from distal.lang import clamp, func, max, min, sqrt, vec3
from distal.render.material import fresnel_dielectric

PI = 3.14159265358979


@func
def facet_density(facet: vec3, alpha: float) -> float:
    """Return the density of facets with this normal, by solid angle and by area of the surface.

    Source: Trowbridge and Reitz, "Average irregularity representation of a rough surface for ray
        reflection" (1975); written so that a small ``alpha`` loses no digits.
    """
    squared = alpha * alpha
    spread = facet.x * facet.x + facet.y * facet.y + squared * facet.z * facet.z
    return squared / (PI * max(spread * spread, 1e-30))


@func
def masking_root(cosine: float, alpha: float) -> float:
    """Return the cosine times 1 + 2 L, where L is Smith's Lambda.

    The visible fraction of the facets that face a direction is 2 c / (c + root).

    Source: Eric Heitz, "Understanding the Masking-Shadowing Function" (2014).
    """
    squared = alpha * alpha
    return sqrt(cosine * cosine * (1.0 - squared) + squared)


@func
def white_loss(cosine: float, alpha: float) -> float:
    """Return the fraction of light that facets of perfect mirrors lose in one reflection.

    Real facets pass this light on to each other. A rational function, off by at most 0.006, fitted
    to the integral of the distribution with height-correlated masking.
    """
    rough = sqrt(alpha)
    t = cosine / max(masking_root(cosine, alpha), 1e-9)
    over = 0.27544 + rough * (-0.5799 + rough * (0.81746 - 0.36322 * rough))
    over += t * (-0.22069 + rough * (0.25025 + 0.13358 * rough))
    over += t * t * (0.1756 - 0.38636 * rough + 0.05883 * t)
    under = 1.0 + rough * (-1.76868 + 0.83422 * rough)
    under += t * (-0.02599 + 0.78206 * rough - 0.5912 * t)
    return max(t * (1.0 - t * t + alpha * alpha) * over / max(under, 0.01), 0.0)


@func
def mean_white_loss(alpha: float) -> float:
    """Return the mean of ``white_loss`` over the hemisphere, weighted by the cosine."""
    rough = sqrt(alpha)
    terms = 0.37924 + rough * (2.59615 + rough * (-3.12191 + rough * (0.1197 + 0.62056 * rough)))
    return alpha * rough * terms


@func
def mean_fresnel_metal(color: vec3) -> vec3:
    """Return the mean of ``material.fresnel_metal`` over the hemisphere, weighted by the cosine."""
    return (20.0 * color + 1.0) / 21.0


@func
def passed_on(reflectance: vec3, alpha: float) -> vec3:
    """Return the fraction that comes back of the light which facets pass on to each other.

    Args:
        reflectance: What one facet reflects, on average.
        alpha: Width of the distribution.

    Source: Christopher Kulla and Alejandro Conty, "Revisiting Physically Based Shading at
        Imageworks" (2017).
    """
    lost = mean_white_loss(alpha)
    return reflectance * reflectance * (1.0 - lost) / max(1.0 - reflectance * lost, vec3(1e-6))


@func
def coat_reflectance(cosine: float, alpha: float, ior: float) -> float:
    """Return the fraction of light that the facets of a clear coat reflect to the outside.

    Off by at most 0.01 for cosines above 0.1 and indices from 1.2 to 3, exact for a smooth coat:
    the loss of perfect mirrors, and Fresnel's formula at a mean angle of the visible facets that
    is fitted to the integral.

    Args:
        cosine: Cosine of the direction from which the light comes.
        alpha: Width of the distribution.
        ior: Index of refraction beyond the coat divided by that before it.
    """
    rough = sqrt(alpha)
    root = sqrt(cosine * cosine + alpha * alpha * (1.0 - cosine * cosine))
    terms = root * (13.1282 - 1.5602 * root) - 4.8462 - 9.2994 * alpha
    moved = (root - cosine) * (2.6244 + rough * terms)
    moved += alpha * (0.53 + cosine * (1.5019 * root - 2.4086))
    mean = clamp(cosine + moved, 0.0, 1.0)
    return fresnel_dielectric(mean, ior) * (1.0 - white_loss(cosine, alpha))


@func
def mean_coat_reflectance(alpha: float, ior: float) -> float:
    """Return the mean of ``coat_reflectance`` over the hemisphere, weighted by the cosine.

    A polynomial, off by at most 0.002 for indices from 1 to 3. Seen from the dense side, as much
    light passes as in the other direction, from a cone of directions that is narrower by the
    square of the index.

    Args:
        alpha: Width of the distribution.
        ior: Index of refraction beyond the coat divided by that before it.
    """
    dense = max(ior, 1.0 / ior)
    r = sqrt(alpha)
    s = min((dense - 1.0) / (dense + 1.0), 0.5)
    first = 0.5158 + r * (0.1685 + r * (-4.0061 + r * (5.5039 - 2.1109 * r)))
    second = -0.4994 + r * (0.2398 + r * (14.81 + r * (-27.3233 + 13.1191 * r)))
    third = 1.1585 + r * (-1.1343 + r * (-14.427 + r * (30.2109 - 15.9443 * r)))
    reflected = clamp(s * (first + s * (second + s * third)), 0.0, 0.99)
    return reflected if ior >= 1.0 else 1.0 - (1.0 - reflected) * ior * ior
