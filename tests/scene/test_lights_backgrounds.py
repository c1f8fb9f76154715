"""Backgrounds show what they say; skies and surroundings light the scene as their pictures do."""

from __future__ import annotations

import math

import numpy as np
import pytest

from distal.lang import func, slider, vec3
from distal.lang.expressions import time
from distal.scene.objects.backgrounds import (
    Background,
    Environment,
    GradientBackground,
    Sky,
    as_background,
)
from distal.scene.objects.lights import PointLight
from distal.scene.tree.errors import SceneTypeError, SceneValueError
from tests.scene.probing import emitted

UP, DOWN, AHEAD = (0.0, 1.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0)
RED, BLUE = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)


@func
def bands(direction: vec3, brightness: float = 1.0) -> vec3:
    return vec3(direction.y * brightness)


@func
def no_direction(p: vec3) -> vec3:
    return p


def shown(background, direction=UP, **options):
    return emitted(background, direction=direction, **options)


def test_a_color_is_a_background():
    for value in ("#f00", RED, np.array(RED), slider("R", 1.0) * vec3(*RED)):
        assert shown(as_background(value)) == pytest.approx(RED)
    assert shown(Background("#f00")) == pytest.approx(RED)


def test_a_gradient():
    background = GradientBackground(RED, BLUE)
    assert shown(background, UP) == pytest.approx(BLUE)
    assert shown(background, AHEAD) == pytest.approx((0.5, 0.0, 0.5))
    assert as_background(background) is background


def test_an_own_function_of_the_direction():
    assert shown(as_background(bands)) == pytest.approx((1.0, 1.0, 1.0))
    assert shown(Background(bands, brightness=2.0 + time), time=1.0) == pytest.approx((3.0,) * 3)


def test_a_sky_is_no_light_unless_it_is_declared_one():
    assert as_background(Sky()).light is None
    sky = Sky(light=True)
    assert as_background(sky).light is sky


def test_without_a_background_the_sky_among_the_lights_is_seen():
    sky = Sky(zenith=RED, sun=(0, -1, 0))
    background = as_background(None, [PointLight((1, 2, 3)), sky])
    assert shown(background) == pytest.approx(RED)
    assert background.light is None, "it is among the lights already"
    assert isinstance(as_background(None, [PointLight((1, 2, 3))]), GradientBackground)


def hemisphere(shown_at, normal, count=96):
    """What a white matte surface facing ``normal`` shows, by summing up its surroundings."""
    total, weights = np.zeros(3), 0.0
    for i in range(count):
        polar = math.pi * (i + 0.5) / count
        for j in range(count // 4):
            around = 2 * math.pi * (j + 0.5) / (count // 4)
            direction = (
                math.sin(polar) * math.cos(around),
                math.cos(polar),
                math.sin(polar) * math.sin(around),
            )
            cosine = max(np.dot(direction, normal), 0.0)
            weights += cosine * math.sin(polar)
            total += np.asarray(shown_at(direction)) * cosine * math.sin(polar)
    return total / weights


@pytest.mark.parametrize("normal", [UP, DOWN, (0.6, 0.8, 0.0), AHEAD])
def test_a_skys_light_is_what_it_shows(normal):
    sky = Sky(zenith=(0.1, 0.3, 0.9), horizon=(0.8, 0.7, 0.6), ground=(0.2, 0.1, 0.0))
    zenith, horizon, ground = (
        np.array(c) for c in ((0.1, 0.3, 0.9), (0.8, 0.7, 0.6), (0.2, 0.1, 0))
    )

    def air(direction):
        y = direction[1]
        return horizon + (zenith - horizon) * y if y > 0 else ground

    assert emitted(sky.ambient, n=normal) == pytest.approx(hemisphere(air, normal), abs=0.01)
    assert emitted(sky.sample, "radiance", p=UP) == pytest.approx((1.0, 0.9, 0.75))


def test_surroundings_shine_as_they_look():
    picture = np.zeros((32, 64, 3), np.float32)
    picture[:16] = RED
    picture[16:] = BLUE
    made = Environment(picture, intensity=2.0)
    assert made.sample is None
    background = as_background(made)
    assert shown(background, (0.6, 0.8, 0.0)) == pytest.approx((2.0, 0.0, 0.0))
    assert shown(background, (0.0, -0.8, 0.6)) == pytest.approx((0.0, 0.0, 2.0))
    # Nine harmonics give half spaces with an error below a tenth.
    assert emitted(made.ambient, n=UP) == pytest.approx((2.0, 0.0, 0.0), abs=0.2)
    assert emitted(made.ambient, n=(1.0, 0.0, 0.0)) == pytest.approx((1.0, 0.0, 1.0), abs=0.02)


def test_turned_surroundings_turn_their_light_too():
    picture = np.zeros((32, 64, 3), np.float32)
    picture[:, 24:40] = 1.0  # around -z, the middle
    for turn, towards in ((0.0, AHEAD), (math.pi / 2, (-1.0, 0.0, 0.0))):
        made = Environment(picture, turn=turn)
        assert shown(as_background(made), towards) == pytest.approx((1.0,) * 3)
        away = tuple(-c for c in towards)
        assert emitted(made.ambient, n=towards)[0] > 4 * emitted(made.ambient, n=away)[0] >= 0.0


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (
            lambda: as_background(3),
            SceneTypeError,
            "a background is wanted, not int 3",
        ),
        (
            lambda: as_background(no_direction),
            SceneTypeError,
            "'no_direction' is no background: it is no function of a direction to a color",
        ),
        (
            lambda: Background(bands, height=1),
            SceneTypeError,
            "bands has no 'height'",
        ),
        (
            lambda: Sky(sun=(0, 0, 0)),
            SceneValueError,
            "Sky: sun is a vector of zeros, which points nowhere",
        ),
        (
            lambda: Sky(zenith="#12"),
            SceneValueError,
            "'zenith of Sky' takes a color like #rrggbb or tomato, not '#12'",
        ),
        (
            lambda: Environment(np.zeros(3)),
            SceneValueError,
            "Environment: a texture is (height, width), with 3 or 4 channels; not (3,)",
        ),
    ],
)
def test_mistakes_say_what_is_wrong(make, error, message):
    with pytest.raises(error) as caught:
        make()
    (diagnostic,) = caught.value.diagnostics
    assert diagnostic.message == message
