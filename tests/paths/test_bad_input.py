"""Paths of scenes with extreme numbers: refused at the author's line, or finite light."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

from distal import (
    Camera,
    DistantLight,
    Environment,
    Material,
    Plane,
    PointLight,
    Scene,
    Sphere,
    emissive,
    glass,
    matte,
    metal,
)

BALL = Sphere(0.5).translate(y=0.55)
LAMP = PointLight((2.0, 3.0, 2.0), intensity=9.0, radius=0.3)
FRONT = Camera((0.0, 1.0, 4.0), target=(0.0, 0.5, 0.0))
MIDDLE = (0.0, 0.55, 0.0)


def panorama(value):
    image = np.ones((8, 16, 3), np.float32)
    image[2, 5, 1] = value
    return image


REFUSED = {
    "'roughness of Material' must be between 0 and 1, not -1": lambda: Material(roughness=-1),
    "'ior of glass' must be above 0, not 0": lambda: glass(ior=0),
    "'ior of glass' takes a finite 32-bit number, not nan": lambda: glass(ior=float("nan")),
    "'emission of Material' takes a finite 32-bit number, not nan": lambda: Material(
        emission=(float("nan"), 0, 0)
    ),
    "'absorption of glass' must be 0 or more, not (-1, 0, 0)": lambda: glass(absorption=(-1, 0, 0)),
    "'color of matte' must be between 0 and 1, not (5, 5, 5)": lambda: matte((5, 5, 5)),
    "the weights of Material add up to 2: diffuse 1 + transmission 1": lambda: Material(
        diffuse=1, transmission=1
    ),
    "'radius of PointLight' must be 0 or more, not -1": lambda: PointLight((0, 1, 0), radius=-1),
    "'image of Environment' must be finite light, not nan in row 2, column 5": lambda: Environment(
        panorama(np.nan)
    ),
    "'image of Environment' must be finite light, not inf in row 2, column 5": lambda: Environment(
        panorama(np.inf)
    ),
    "'image of Environment' must be light without negative values, not -0.5 in row 2, column 5": (
        lambda: Environment(panorama(-0.5))
    ),
}


@pytest.mark.parametrize("message", REFUSED)
def test_it_is_refused(message):
    with pytest.raises(ValueError) as caught:
        REFUSED[message]()
    assert str(caught.value).splitlines()[0] == f"error: {message}"


# Materials and lights of one structure share a kernel.
FINITE = {
    "index near 0": (glass(ior=1e-6), LAMP, FRONT),
    "index of a million": (glass(ior=1e6), LAMP, FRONT),
    "black glass": (glass(absorption=(1e30,) * 3), LAMP, FRONT),
    "huge emission": (emissive((1, 1, 1), 1e30), LAMP, FRONT),
    "the roughest metal": (metal(roughness=1.0), LAMP, FRONT),
    "a lamp inside glass": (glass(), PointLight(MIDDLE, intensity=3.0, radius=0.1), FRONT),
    "a point inside glass": (glass(), PointLight(MIDDLE, intensity=3.0), FRONT),
    "a lamp around the ball": (glass(), PointLight(MIDDLE, intensity=3.0, radius=0.9), FRONT),
    "a lamp in the floor": (matte(), PointLight((1, 0, 0), intensity=3.0, radius=0.1), FRONT),
    "a lamp of nearly no size": (matte(), PointLight((2, 3, 2), radius=1e-20), FRONT),
    "a huge lamp": (matte(), PointLight((2, 3, 2), intensity=1e30, radius=1e-3), FRONT),
    "a dark lamp": (matte(), PointLight((2, 3, 2), intensity=0.0, radius=0.3), FRONT),
    "a sun as wide as the sky": (matte(), DistantLight((1, 1, 1), angle=np.pi), FRONT),
    "a camera inside glass": (glass(), LAMP, Camera((0, 0.55, 0.1), target=(0, 0.5, -1))),
    "a camera inside the lamp": (glass(), LAMP, Camera((2, 3, 2), target=(0, 0.5, 0))),
    "a camera on glass": (glass(), LAMP, Camera((0, 0.55, 0.5), target=(0, 0.5, 4))),
}


@pytest.mark.parametrize("name", FINITE)
def test_light_is_finite(name):
    paint, light, camera = FINITE[name]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        scene = Scene(BALL.paint(paint) | Plane(), lights=light, camera=camera)
        picture = scene.render(size=(24, 18), mode="path", spp=4)
    assert np.isfinite(picture.linear).all()
    assert picture.linear[..., :3].min() >= 0.0
    # Closed hits have no limit of their distance and no limit of steps.
    assert set(picture.stats["lost"]) <= {"inside"}
