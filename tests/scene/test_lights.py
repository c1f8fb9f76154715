"""Lights reach places as physics says, and refuse what shines nowhere."""

from __future__ import annotations

import math

import pytest

from distal.ir.types import FLOAT
from distal.lang import slider
from distal.lang.expressions import time
from distal.scene.objects.lights import (
    AmbientLight,
    DistantLight,
    HemisphereLight,
    PointLight,
    SpotLight,
)
from distal.scene.tree.errors import SceneTypeError, SceneValueError
from tests.scene.probing import emitted

ORIGIN = (0.0, 0.0, 0.0)


def radiance(light, p=ORIGIN, **options):
    return emitted(light.sample, "radiance", p=p, **options)


def test_a_point_light_of_one_shows_white_at_distance_one_and_fades_with_the_square():
    light = PointLight((0, 1, 0))
    assert light.ambient is None
    assert radiance(light) == pytest.approx((1.0, 1.0, 1.0))
    assert radiance(light, (0, -1, 0)) == pytest.approx((0.25,) * 3)
    assert emitted(light.sample, "direction", p=ORIGIN) == pytest.approx((0, 1, 0))
    assert float(emitted(light.sample, "distance", FLOAT, p=(0, -1, 0))) == pytest.approx(2.0)


def test_colors_intensities_and_places_may_change():
    power = slider("Power", 2.0, 0.0, 10.0)
    light = PointLight((0, 1 + time, 0), intensity=power, color="#f00")
    assert radiance(light) == pytest.approx((2.0, 0.0, 0.0))
    assert radiance(light, params={"power": 8.0}, time=1.0) == pytest.approx((2.0, 0.0, 0.0))


def test_a_distant_light_is_the_same_everywhere():
    light = DistantLight((0, 3, 4), intensity=1.5, color=(0, 0, 1), angle=0.2)
    for p in (ORIGIN, (5.0, 5.0, 5.0)):
        assert radiance(light, p) == pytest.approx((0.0, 0.0, 1.5))
        assert emitted(light.sample, "direction", p=p) == pytest.approx((0, 0.6, 0.8))
        assert float(emitted(light.sample, "radius", FLOAT, p=p)) == pytest.approx(math.tan(0.1))


def test_a_spot_light_lights_its_cone():
    light = SpotLight((0, 2, 0), intensity=4.0, angle=math.pi / 2, softness=0.5)
    assert radiance(light) == pytest.approx((1.0, 1.0, 1.0))
    assert radiance(light, (2.1, 0, 0)) == pytest.approx(ORIGIN)
    within = radiance(light, (1.5, 0, 0))[0] * (2**2 + 1.5**2) / 4.0
    assert 0.0 < within < 1.0


def test_light_from_everywhere():
    light = AmbientLight(0.25, "#fff")
    assert light.sample is None
    assert emitted(light.ambient, n=(0, 1, 0)) == pytest.approx((0.25,) * 3)
    half = HemisphereLight("#f00", "#00f", intensity=2.0)
    assert emitted(half.ambient, n=(0, 1, 0)) == pytest.approx((2.0, 0.0, 0.0))
    assert emitted(half.ambient, n=(0, -1, 0)) == pytest.approx((0.0, 0.0, 2.0))
    assert emitted(half.ambient, n=(1, 0, 0)) == pytest.approx((1.0, 0.0, 1.0))


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (
            lambda: PointLight((1, 2, 3), intensity=-1),
            SceneValueError,
            "'intensity of PointLight' must be 0 or more, not -1",
        ),
        (
            lambda: DistantLight((0, 0, 0)),
            SceneValueError,
            "DistantLight: direction is a vector of zeros, which points nowhere",
        ),
        (
            lambda: SpotLight((0, 1, 0), angle=30),
            SceneValueError,
            "SpotLight: angle is the cone's opening in radians, below pi; in degrees: 45 * deg",
        ),
        (
            lambda: SpotLight((0, 0, 0)),
            SceneValueError,
            "SpotLight: position and target are the same place",
        ),
        (
            lambda: PointLight(3),
            SceneTypeError,
            "'position of PointLight' takes three numbers, not int 3",
        ),
        (
            lambda: PointLight(intensity=2.0),
            SceneTypeError,
            "PointLight needs 'position'",
        ),
        (
            lambda: PointLight((0, 1, 0), intensty=2.0),
            SceneTypeError,
            "PointLight has no 'intensty'",
        ),
        (
            lambda: AmbientLight(0.1, "#fff", 2.0),
            SceneTypeError,
            "AmbientLight: too many positional arguments",
        ),
    ],
)
def test_mistakes_say_what_is_wrong(make, error, message):
    with pytest.raises(error) as caught:
        make()
    (diagnostic,) = caught.value.diagnostics
    assert diagnostic.message == message


def test_a_light_does_not_change():
    with pytest.raises(AttributeError, match="does not change"):
        AmbientLight().sample = None
