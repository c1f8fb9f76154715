"""The two strategies that find a light, each alone, agree with each other and with their mixture.

A path looks for light along a ray to a light and along the scattered ray. A weight that does not
sum to one, a wrong density or a light that only one of them knows would show as a difference.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from distal import (
    Box,
    DistantLight,
    Environment,
    Plane,
    PointLight,
    Sphere,
    emissive,
    matte,
    metal,
    plastic,
)
from distal.lang import func, select
from distal.render import path_lights, paths
from distal.session import SESSION
from tests.paths.test_integrator import estimate


@func
def all_of_it(own: float, other: float) -> float:
    """The weight of a strategy alone."""
    return 1.0


@func
def what_the_other_cannot(own: float, other: float) -> float:
    """The weight of a strategy beside one that does alone all that it can."""
    return select(own > 0.0 and other > 0.0, 0.0, 1.0)


def picture() -> Any:
    """A panorama with a broad bright place above and a gray rest."""
    light = np.full((16, 32, 3), 0.2, np.float32)
    light[3:6, 18:24] = (6.0, 5.0, 3.0)
    return light


# The weights of a ray to a light, and of the scattered ray.
STRATEGIES = {
    "lights alone": (all_of_it, what_the_other_cannot),
    "scattering alone": (what_the_other_cannot, all_of_it),
}
SUN = DistantLight((1, 2, 0), intensity=2.0, angle=0.9)
BULB = PointLight((0.6, 1.2, 0.2), intensity=1.5, radius=0.5)
LIGHTS: dict[str, tuple[Any, dict[str, Any]]] = {
    "lamps": (None, {"lights": [SUN, BULB]}),
    "ball that emits": (Sphere(0.5).translate(0.4, 1.2, 0).paint(emissive((2, 2, 2))), {}),
    "box that emits": (Box(0.4).translate(0.5, 1.1, 0).paint(emissive((6, 6, 6))), {}),
    "environment": (None, {"lights": [Environment(picture())]}),
}
MATERIALS = {
    "diffuse": matte((0.7, 0.6, 0.5)),
    "rough metal": metal((0.9, 0.8, 0.6), roughness=0.5),
    "plastic": plastic((0.6, 0.3, 0.2), roughness=0.4),
}


def light_of(name: str, material: Any, spp: int = 48) -> Any:
    lamp, scene = LIGHTS[name]
    floor = Plane().paint(material)
    shape = floor if lamp is None else floor | lamp
    return estimate(shape, (-1.2, 1.0, 0.3), (0, 0, 0), spp, **scene)


@pytest.mark.parametrize(
    ("name", "material"),
    [
        ("lamps", "plastic"),
        ("ball that emits", "rough metal"),
        ("box that emits", "diffuse"),
        ("environment", "rough metal"),
    ],
)
def test_each_strategy_alone_finds_the_same_light(monkeypatch, name, material):
    found = {"both": light_of(name, MATERIALS[material])}
    for strategy, (of_lights, of_scattering) in STRATEGIES.items():
        with monkeypatch.context() as patched:
            patched.setattr(path_lights, "power_share", of_lights)
            patched.setattr(paths, "power_share", of_scattering)
            SESSION.fresh()
            found[strategy] = light_of(name, MATERIALS[material])
        SESSION.fresh()
    both, sigma = found.pop("both")
    assert both.min() > 0.05
    for strategy, (mean, error) in found.items():
        assert not np.array_equal(mean, both), f"{strategy}: nothing was switched"
        apart = np.abs(mean - both) / np.hypot(sigma, error)
        assert apart.max() <= 4.0, (strategy, both, sigma, mean, error)
        assert error.max() < 0.2 * both.max(), f"{strategy}: too noisy to tell"
