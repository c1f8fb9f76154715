"""One ray of a scene, and rays by the laws of optics, worked out in Python without the library.

``seen`` renders a picture by an eye so narrow that its pixels show one place; its height makes
the march as fine as in the largest pictures. ``bent``, ``thrown_back`` and ``through_ball`` are
Snell's law and the law of reflection in doubles.
"""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray

from distal import Camera, Material, Scene
from distal.lang import func, vec3

Vector = NDArray[np.float64]
ROWS = 2500


@func
def compass(direction: vec3) -> vec3:
    """Shows which way a ray went."""
    return 0.5 + 0.5 * direction


@func
def upper_half(direction: vec3) -> vec3:
    """Light 1 from above, none from below."""
    return vec3(1.0) if direction.y > 0.0 else vec3(0.0)


def clear(ior: float = 1.5, **weights: Any) -> Material:
    """Glass that lets all light through and mirrors none: one ray in, one ray out."""
    return Material(**{"diffuse": 0.0, "transmission": 1.0, "ior": ior, **weights})


def seen(shape: Any, position: Any, target: Any, **scene: Any) -> Vector:
    """The linear light that reaches a place from the direction of another."""
    way = np.subtract(target, position)
    up = (0, 0, -1) if abs(way[1]) > 0.99 * np.linalg.norm(way) else (0, 1, 0)
    camera = Camera(position, target, up=up, fov=1e-4)
    scene = {"lights": [], "background": (0.0, 0.0, 0.0), **scene}
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "the picture is black")
        picture = Scene(shape, camera=camera, **scene).render(size=(1, ROWS))
    light: Vector = picture.linear[ROWS // 2, 0, :3].astype(float)
    return light


def way_seen(shape: Any, position: Any, target: Any, **scene: Any) -> Vector:
    """Which way the one ray goes on that leaves a scene."""
    return 2.0 * seen(shape, position, target, background=compass, **scene) - 1.0


def unit(*v: float) -> Vector:
    """A vector at length 1."""
    found: Vector = np.array(v, float)
    return found / np.linalg.norm(found)


def thrown_back(direction: Vector, n: Vector) -> Vector:
    """The law of reflection."""
    return direction - 2.0 * (direction @ n) * n


def bent(direction: Vector, n: Vector, outer: float, inner: float) -> Vector | None:
    """Snell's law from index ``outer`` to ``inner``; n against the ray; None beyond the angle."""
    across = direction - (direction @ n) * n
    across = across * (outer / inner)
    rest = 1.0 - across @ across
    return None if rest < 0.0 else across - np.sqrt(rest) * n


def through_ball(origin: Vector, direction: Vector, radius: float, ior: float) -> Any:
    """Where a ray leaves a ball of glass about the origin that it hits, and which way."""
    along = -(origin @ direction)
    reach = radius**2 - (origin @ origin - along**2)
    place = origin + (along - np.sqrt(reach)) * direction
    inside = bent(direction, place / radius, 1.0, ior)
    assert inside is not None
    place = place - 2.0 * (place @ inside) * inside
    return place, bent(inside, -place / radius, ior, 1.0)


def fresnel(angle: float, outer: float, inner: float) -> float:
    """The mirrored share of unpolarised light by Fresnel's sines and tangents."""
    if angle == 0.0:
        return ((outer - inner) / (outer + inner)) ** 2
    sine = np.sin(angle) * outer / inner
    if sine >= 1.0:
        return 1.0
    beyond = np.arcsin(sine)
    across = np.sin(angle - beyond) / np.sin(angle + beyond)
    parallel = np.tan(angle - beyond) / np.tan(angle + beyond)
    return float(0.5 * (across**2 + parallel**2))
