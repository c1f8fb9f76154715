"""Texts hold what the table says of built-ins where a driver says nothing."""

from __future__ import annotations

import numpy as np
import pytest

import distal
from distal.compiler.driver import compile
from distal.lang import Frame, image, normalize, vec2, vec3
from tests.egl import EglUnavailableError
from tests.glsl import run_glsl


def drawn(obj, size, seconds):
    try:
        given = {"resolution": size} | ({} if seconds is None else {"time": seconds})
        return run_glsl(compile(obj, "shadertoy"), size, given)
    except EglUnavailableError as error:
        pytest.skip(str(error))


def test_the_raymarcher_has_no_pixel_without_a_number() -> None:
    """At 3.3 seconds its forward differences vanish in one pixel, and the normal is zero's."""
    picture = drawn(distal.load("example:raymarcher"), (640, 480), 3.3)
    assert np.isfinite(picture).all()
    assert np.isfinite(picture[316, 355]).all() and picture.max() <= 1.0


@image
def directions(frame: Frame) -> vec3:
    """Of zero in the left half."""
    v = vec3(frame.coord - vec2(2.5, 0.5), 0.0)
    return normalize(vec3(max(v.x, 0.0), 0.0, 0.0)) + 0.25


def test_the_direction_of_nothing_is_nothing() -> None:
    row = drawn(directions, (4, 1), None)[0, :, 0]
    assert row.tolist() == [0.25, 0.25, 0.25, 1.25]
