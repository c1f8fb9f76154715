"""Functions that both the frame and its pixels call: each with its own arguments."""

from __future__ import annotations

import numpy as np
import pytest

from distal.backends import emit, get_target
from distal.compiler.driver import run_passes
from distal.frontend import lower
from distal.lang import Frame, image, ivec2, vec2, vec4
from tests import egl
from tests.glsl import run_glsl


@image
def tiles(frame: Frame) -> vec4:
    # The frame divides by 7, every pixel by 24: one function of the prelude does both.
    return vec4(vec2(ivec2(frame.resolution) // 7), vec2(ivec2(frame.coord) // 24))


def test_a_driver_divides_each_by_its_own_number() -> None:
    artifact = emit(run_passes(lower(tiles), get_target("glsl-es300")), get_target("glsl-es300"))
    try:
        shown = run_glsl(artifact, (48, 30), {"resolution": (48.0, 30.0)})
    except egl.EglUnavailableError as missing:
        pytest.skip(f"nothing is drawn: {missing}")
    assert np.array_equal(shown[..., 0], np.full((30, 48), 6.0))
    assert np.array_equal(shown[..., 1], np.full((30, 48), 4.0))
    assert np.array_equal(shown[0, :, 2], np.repeat([0.0, 1.0], 24))
