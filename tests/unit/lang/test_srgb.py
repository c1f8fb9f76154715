"""sRGB's curve: the standard's values, and everything that shows or reads colors by it."""

import subprocess
import sys

import numpy as np
import pytest

from distal.images.picture import Picture
from distal.lang import color, select
from distal.lang.srgb import decode_srgb, encode_srgb, hex_of, linear_of
from distal.render import tonemap

# IEC 61966-2-1: encoded values and their light, computed from its text with 40 decimal digits.
PUBLISHED = [
    (0.0, 0.0),
    (10 / 255, 0.0030352698354883749),
    (11 / 255, 0.0033465357638991595),
    (0.25, 0.050876088171556790),
    (128 / 255, 0.21586050011389923),
    (0.5, 0.21404114048223255),
    (0.735356983052449, 0.5),
    (1.0, 1.0),
]


def picture_of(codes: np.ndarray) -> Picture:
    pixels = np.ones((1, len(codes), 4), np.float32)
    pixels[0, :, :3] = codes[:, None]
    return Picture(pixels)


@pytest.mark.parametrize(("encoded", "light"), PUBLISHED)
def test_the_curve_is_the_standards(encoded: float, light: float) -> None:
    assert decode_srgb.python_function(encoded) == pytest.approx(light, rel=1e-9)
    assert encode_srgb.python_function(light) == pytest.approx(encoded, rel=1e-6)


def test_parameters_pictures_and_scene_code_agree_at_every_code() -> None:
    codes = np.arange(256)
    texts = [f"#{code:02x}{code:02x}{code:02x}" for code in codes]
    parameters = np.array([color("Tint", text).default for text in texts])
    encoded = (codes / 255).astype(np.float32)
    shown = picture_of(encoded).linear[0, :, :3]
    scene = tonemap.decode_srgb(np.repeat(encoded[:, None], 3, axis=1))
    assert np.allclose(parameters, shown, rtol=1e-6)
    assert np.allclose(parameters, scene, rtol=1e-6)
    assert [hex_of(value) for value in parameters] == texts
    back = tonemap.encode_srgb(parameters.astype(np.float32))
    assert np.allclose(back, np.repeat(encoded[:, None], 3, axis=1), atol=1e-6)


def test_light_between_codes_is_the_nearest_code_and_bounded() -> None:
    assert hex_of((-1.0, 0.5, 2.0)) == "#00bcff"
    assert hex_of((float("inf"), 0.0, 1.0)) == "#ff00ff"
    assert linear_of("#fff") == (1.0, 1.0, 1.0)
    for text in ("", "fff", "#12", "#12345", "red", "#gggggg", "#1234567", "#fff\n"):
        assert linear_of(text) is None


def test_decoding_goes_on_below_black_and_keeps_what_is_no_number() -> None:
    values = np.array([-2.0, -0.1, np.nan, np.inf], np.float32)
    linear = picture_of(values).linear[0, :, 0]
    assert linear[:2] == pytest.approx([-2 / 12.92, -0.1 / 12.92], rel=1e-6)
    assert np.isnan(linear[2])
    assert linear[3] == 2.0**126  # what powers are held at


def test_a_color_is_read_without_any_package() -> None:
    code = (
        "import sys; from distal.lang import color; print(color('Tint', '#808080').default[0],"
        " {'numpy', 'llvmlite'} & set(sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["0.21586050011389926", "set()"]


def test_select_of_plain_numbers_is_one_of_them_and_refused_of_others() -> None:
    assert select(True, 1.0, 2.0) == 1.0
    assert select(False, 1, 2) == 2
    for arguments in ((1, 1.0, 2.0), (True, 1.0), (True, (1.0,), (2.0,))):
        with pytest.raises(TypeError, match="scene code only"):
            select(*arguments)
