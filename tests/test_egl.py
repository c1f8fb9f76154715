"""The EGL runner runs each dialect we emit natively, hands varyings on, and refuses mistakes."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from tests.egl import (
    EglShader,
    EglUnavailableError,
    ShaderRejectedError,
    context,
    renderer,
    to_bytes,
)

ES_300 = "precision highp float;\nout vec4 color;\nuniform vec2 shift;\n"


@pytest.fixture(autouse=True)
def egl() -> Iterator[None]:
    try:
        context()
    except EglUnavailableError as error:
        pytest.skip(str(error))
    yield


@pytest.mark.parametrize("version", ["300 es", "310 es", "330", "450"])
def test_pixel_centres_and_rows(version: str) -> None:
    text = ES_300 + "void main() { color = vec4(gl_FragCoord.xy + shift, -2.0, 1.5); }"
    picture = EglShader(text, version).render((3, 2), {"shift": (10, 20)})
    assert picture.shape == (2, 3, 4)
    assert picture.dtype == np.float32
    # top row first, neither clamped nor rounded
    assert picture[0, 0].tolist() == [10.5, 21.5, -2.0, 1.5]
    assert picture[1, 2].tolist() == [12.5, 20.5, -2.0, 1.5]


def test_es_100() -> None:
    text = "precision highp float;\nuniform float k;\nvoid main() { gl_FragColor = vec4(k); }"
    assert EglShader(text, "100").render((2, 2), {"k": 0.25}).tolist() == [[[0.25] * 4] * 2] * 2


@pytest.mark.parametrize("corners", ["vertex buffer", "vertex index"])
@pytest.mark.parametrize("version", ["300 es", "330"])
def test_flat_varyings_carry_exact_values(version: str, corners: str) -> None:
    if corners == "vertex buffer":
        vertex = "in vec2 corner;\n"
        position = "corner"
    else:
        vertex = ""
        position = "vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0"
    vertex += (
        "uniform float time;\nflat out vec4 frame[2];\n"
        "void main() {\n  frame[0] = vec4(time, time * 3.0, 0.1, 7.0);\n  frame[1] = vec4(-time);\n"
        f"  gl_Position = vec4({position}, 0.0, 1.0);\n}}\n"
    )
    fragment = (
        "precision highp float;\nflat in vec4 frame[2];\nout vec4 color;\n"
        "void main() { color = vec4(frame[0].xyz, frame[1].w); }\n"
    )
    picture = EglShader(fragment, version, vertex).render((7, 5), {"time": 1.7})
    expected = np.array([1.7, np.float32(1.7) * np.float32(3), 0.1, -1.7], np.float32)
    assert (picture == expected).all()


def test_interpolated_varying_in_es_100() -> None:
    vertex = (
        "attribute vec2 corner;\nvarying vec2 uv;\n"
        "void main() { uv = corner; gl_Position = vec4(corner, 0.0, 1.0); }"
    )
    fragment = (
        "precision highp float;\nvarying vec2 uv;\nvoid main() { gl_FragColor = vec4(uv, 0, 1); }"
    )
    picture = EglShader(fragment, "100", vertex).render((4, 2))
    assert picture[0, 0, :2] == pytest.approx([-0.75, 0.5], abs=1e-6)
    assert picture[1, 3, :2] == pytest.approx([0.75, -0.5], abs=1e-6)


def test_kinds_of_uniform() -> None:
    text = (
        "precision highp float;\nprecision highp int;\nout vec4 color;\n"
        "uniform int i;\nuniform uint u;\nuniform bool b;\n"
        "uniform mat2 m;\nuniform vec3 list[2];\n"
        "void main() {\n  float mixed = float(i) + (b ? 0.5 : 0.0);\n"
        "  color = vec4(mixed, float(u), (m * vec2(1, 10)).x, list[1].y);\n}\n"
    )
    values = {
        "i": -3,
        "u": 4000000000,
        "b": True,
        "m": [[1, 2], [3, 4]],
        "list": [[0, 0, 0], [1, 2, 3]],
    }
    picture = EglShader(text, "300 es").render((1, 1), values)
    assert picture[0, 0].tolist() == [-2.5, 4e9, 31.0, 2.0]


@pytest.mark.parametrize("version", ["100", "300 es"])
def test_llvmpipe_takes_medium_precision_at_its_word(version: str) -> None:
    """Without ``precision highp int`` ints are 16 bits wide (70001 * 3 wraps, then rounds to half).

    Emitted ES texts must therefore declare both precisions; this keeps the reason true.
    """
    if "llvmpipe" not in renderer():
        pytest.skip(f"the driver is {renderer()}, not llvmpipe")
    main = "uniform int k;\nvoid main() { gl_FragColor = vec4(float(k * 3)); }\n"
    if version != "100":
        main = "out vec4 color;\n" + main.replace("gl_FragColor", "color")
    medium = EglShader("precision highp float;\n" + main, version)
    high = EglShader("precision highp float;\nprecision highp int;\n" + main, version)
    assert medium.render((1, 1), {"k": 70001})[0, 0, 0] == np.float16((70001 * 3) % 65536)
    assert high.render((1, 1), {"k": 70001})[0, 0, 0] == 70001 * 3


def test_mistakes_are_refused() -> None:
    with pytest.raises(ShaderRejectedError, match=r"undeclared|undefined"):
        EglShader("void main() { nothing = 1.0; }", "330")
    with pytest.raises(ValueError, match="no #version"):
        EglShader("void main() {}")
    shader = EglShader(ES_300 + "void main() { color = vec4(shift, 0, 1); }", "300 es")
    with pytest.raises(ValueError, match="no value for uniform shift"):
        shader.render((1, 1))
    with pytest.raises(ValueError, match="takes 2 numbers, not 3"):
        shader.render((1, 1), {"shift": (1, 2, 3)})
    with pytest.raises(ValueError, match="no uniform 'shfit'"):
        shader.render((1, 1), {"shift": (1, 2), "shfit": 1})


def test_bytes_round_half_up_after_clamping() -> None:
    values = np.array([[[-1.0, 0.5 / 255, 2.0, 1.0], [0.49 / 255, 0.5, np.nan, 0.0]]], np.float32)
    assert to_bytes(values).tolist() == [[[0, 1, 255], [0, 128, 0]]]
