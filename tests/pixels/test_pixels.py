"""Pixels of every mode of Pillow and type of NumPy: what is white, what is linear, which way up."""

import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from distal import (
    AmbientLight,
    Box,
    Environment,
    Heightfield,
    OrthographicCamera,
    Scene,
    image_pattern,
)
from distal.diagnostics import LoadError
from distal.pixels.arrays import ARRAY_RULES
from distal.pixels.modes import MODE_RULES
from distal.pixels.reading import read_pixels

ORDERS = ["<", ">"]
RAMP = np.linspace(0.0, 1.0, 9)


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize(("type", "white"), [("u1", 255), ("u2", 65535)])
def test_levels_are_shares_of_white(type, white, order):
    levels = np.rint(RAMP * white).astype(order + type)[None]
    found = read_pixels(levels)
    assert found.values[0, :, 0] == pytest.approx(levels[0].astype(float) / white, abs=1e-7)
    assert found.encoded


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("type", ["f2", "f4", "f8", "g"])
def test_floats_are_light_as_they_are(type, order):
    found = read_pixels((4.0 * RAMP).astype(np.dtype(type).newbyteorder(order))[None])
    assert found.values[0, :, 2] == pytest.approx(4.0 * RAMP)
    assert not found.encoded


def test_bools_and_lists():
    assert read_pixels(np.array([[False, True]])).values[0, :, 1].tolist() == [0.0, 1.0]
    assert read_pixels([[0, 3]]).values[0, :, 0].tolist() == [0.0, 3.0]


@pytest.mark.parametrize("type", ["i1", "i2", "i4", "i8", "u4", "u8"])
def test_integers_without_a_white_are_refused(type):
    with pytest.raises(LoadError, match=r"nothing says which value of u?int\d+ is white: .*astype"):
        read_pixels(np.ones((2, 2), type))


def of_mode(mode):
    """A picture whose pixels are red 200, green 100, blue 50, or grey 100, half transparent."""
    color = Image.new("RGBA", (5, 3), (200, 100, 50, 128))
    grey = Image.new("LA", (5, 3), (100, 128))
    match mode:
        case "1":
            return Image.new("1", (5, 3), 1), (1.0, 1.0, 1.0, 1.0)
        case "P":
            made = Image.new("P", (5, 3), 1)
            made.putpalette([0, 0, 0, 200, 100, 50])
            made.info["transparency"] = 1
            return made, (200 / 255, 100 / 255, 50 / 255, 0.0)
        case "PA":
            return color.convert("PA"), None
        case "L" | "LA" | "La":
            alpha = 1.0 if mode == "L" else 128 / 255
            return grey.convert(mode), (*(100 / 255,) * 3, alpha)
        case "I;16" | "I;16B" | "I;16L" | "I":
            made = Image.fromarray(np.full((3, 5), 30000, np.uint16))
            return made.convert(mode) if mode == "I" else _deep(mode), (*(30000 / 65535,) * 3, 1.0)
        case "F":
            return Image.new("F", (5, 3), 4.5), (4.5, 4.5, 4.5, 1.0)
        case "LAB":
            return Image.new("LAB", (5, 3), (255, 128, 128)), (1.0, 1.0, 1.0, 1.0)
        case "RGBA" | "RGBa":
            return color.convert(mode), (200 / 255, 100 / 255, 50 / 255, 128 / 255)
        case _:
            return color.convert("RGB").convert(mode), (200 / 255, 100 / 255, 50 / 255, 1.0)


def _deep(mode):
    order = ">" if mode == "I;16B" else "<"
    data = np.full((3, 5), 30000, f"{order}u2").tobytes()
    return Image.frombytes(mode, (5, 3), data)


@pytest.mark.parametrize("mode", sorted(set(MODE_RULES) - {"I;16N"}))
def test_every_mode_of_pillow(mode):
    picture, color = of_mode(mode)
    assert picture.mode == mode
    found = read_pixels(picture)
    assert found.values.shape == (3, 5, 4)
    assert found.encoded == (mode != "F")
    if color is not None:
        # Premultiplied and other color spaces round to 8 bits once more.
        assert found.values[1, 2] == pytest.approx(color, abs=0.012)


def test_levels_beyond_16_bits_are_refused():
    with pytest.raises(LoadError, match="its grey levels are 0 to 65536, and nothing says which"):
        read_pixels(Image.fromarray(np.array([[0, 65536]], np.int32)))


@pytest.mark.parametrize("suffix", ["png", "tif", "ppm"])
def test_files_of_16_bits_grey(tmp_path, suffix):
    levels = np.rint(RAMP * 65535).astype(np.uint16)[None]
    Image.fromarray(levels).save(tmp_path / f"a.{suffix}")
    found = read_pixels(tmp_path / f"a.{suffix}")
    assert found.values[0, :, 0] == pytest.approx(RAMP, abs=1e-5)


def test_a_file_of_floats_is_light(tmp_path):
    Image.fromarray(np.full((4, 8), 4.0, np.float32)).save(tmp_path / "a.tif")
    found = read_pixels(tmp_path / "a.tif")
    assert (found.values[..., :3] == 4.0).all()
    assert not found.encoded


# What viewers show of a picture of the rows (1, 2, 3) and (4, 5, 6), by the orientation of its tag.
SHOWN = {
    1: [[1, 2, 3], [4, 5, 6]],
    2: [[3, 2, 1], [6, 5, 4]],
    3: [[6, 5, 4], [3, 2, 1]],
    4: [[4, 5, 6], [1, 2, 3]],
    5: [[1, 4], [2, 5], [3, 6]],
    6: [[4, 1], [5, 2], [6, 3]],
    7: [[6, 3], [5, 2], [4, 1]],
    8: [[3, 6], [2, 5], [1, 4]],
    9: [[1, 2, 3], [4, 5, 6]],
}


@pytest.mark.parametrize("suffix", ["png", "tif", "webp"])
@pytest.mark.parametrize("orientation", SHOWN)
def test_photos_are_the_right_way_up(tmp_path, suffix, orientation):
    levels = np.array(SHOWN[1], np.uint8) * 40
    tag = Image.Exif()
    tag[0x0112] = orientation
    more = {"lossless": True} if suffix == "webp" else {}
    picture = Image.fromarray(np.stack([levels] * 3, -1))
    picture.save(tmp_path / f"a.{suffix}", exif=tag, **more)
    # Pillow reads the pixels of an opened picture later.
    with Image.open(tmp_path / f"a.{suffix}") as opened:
        for source in (tmp_path / f"a.{suffix}", opened):
            found = read_pixels(source).values[..., 0]
            assert np.rint(found * 255 / 40).tolist() == SHOWN[orientation]


def test_a_photo_in_a_scene_is_the_right_way_up(tmp_path):
    pixels = np.zeros((40, 80, 3), np.uint8)
    pixels[:] = (200, 0, 0)
    pixels[:20] = (0, 0, 250)
    tag = Image.Exif()
    tag[0x0112] = 3
    file = tmp_path / "photo.jpg"
    Image.fromarray(pixels).save(file, quality=100, subsampling=0, exif=tag)
    box = Box(2, 1, 0.1).paint(image_pattern(str(file), size=2.0))
    camera = OrthographicCamera((0, 0, 5), height=1.0)
    scene = Scene(box, camera=camera, floor=False, lights=[AmbientLight(1.0)])
    seen = scene.render(size=(40, 20), samples=1, view="material").array
    assert seen[3, 20, 0] > 0.5 > seen[3, 20, 2]
    assert seen[16, 20, 2] > 0.5 > seen[16, 20, 0]


def test_a_height_map_of_16_bits(tmp_path):
    levels = np.linspace(0, 65535, 65).round().astype(np.uint16)
    file = tmp_path / "ramp.png"
    Image.fromarray(np.tile(levels, (65, 1))).save(file)
    land = Heightfield(str(file), size=(4, 4), height=1.0)
    ys = np.linspace(-0.5, 1.5, 4001)
    found = []
    for x in np.linspace(-1.8, 1.8, 7):
        values = land(np.stack([np.full_like(ys, x), ys, np.zeros_like(ys)], -1))
        found.append(float(ys[np.argmax(values > 0)]))
    assert found == pytest.approx([0.05, 0.2, 0.35, 0.5, 0.65, 0.8, 0.95], abs=0.02)


def test_a_picture_of_pillow_is_a_pattern():
    scene = Scene(Box(), background=Environment(Image.new("L", (8, 4), 255)), tone_map="none")
    assert scene.render(size=(8, 6), samples=1).linear[0, 0, 0] == pytest.approx(1.0, abs=1e-5)


def test_the_guide_has_all_rules():
    text = (Path(__file__).parents[2] / "docs/guide/data-pictures.md").read_text(encoding="utf-8")
    rows = dict(re.findall(r"^\| (.+?) \| (.+?) \|$", text, re.MULTILINE))
    for types, rule in ARRAY_RULES.items():
        assert rows[types] == rule
    for mode, rule in MODE_RULES.items():
        names = next(name for name in rows if f"`{mode}`" in name)
        assert rows[names] == rule.meaning
