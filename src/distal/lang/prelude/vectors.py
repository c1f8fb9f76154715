"""Geometry of vectors."""

from __future__ import annotations

from distal.lang import Vectors, dot, func, inversesqrt, length, max, select, sqrt


@func
def distance_between(a: Vectors, b: Vectors) -> float:
    """Return the Euclidean distance."""
    return length(a - b)


@func
def normalized(v: Vectors) -> Vectors:
    """Return the vector of length 1 with the same direction."""
    return v * inversesqrt(dot(v, v))


@func
def reflected(incident: Vectors, normal: Vectors) -> Vectors:
    """Reflect ``incident`` at the plane with the unit vector ``normal``."""
    return incident - normal * (2.0 * dot(normal, incident))


@func
def refracted(incident: Vectors, normal: Vectors, eta: float) -> Vectors:
    """Refract by Snell's law in vector form; the zero vector for total internal reflection."""
    cosine = dot(normal, incident)
    discriminant = 1.0 - eta * eta * (1.0 - cosine * cosine)
    bent = incident * eta - normal * (eta * cosine + sqrt(max(discriminant, 0.0)))
    return select(discriminant < 0.0, incident * 0.0, bent)


@func
def facing_forward(n: Vectors, incident: Vectors, reference: Vectors) -> Vectors:
    """Return ``n`` or ``-n``: ``n`` if dot(reference, incident) is negative."""
    return select(dot(incident, reference) < 0.0, n, -n)
