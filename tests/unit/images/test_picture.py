"""Pictures: what they hold, how values become levels, and what a saved file says."""

import io
import json

import numpy as np
import pytest
from PIL import Image

from distal.file_writer import SaveError
from distal.images.picture import Picture, Provenance
from distal.images.png import quantise
from distal.version import __version__


def gradient(height=3, width=5, alpha=1.0):
    array = np.zeros((height, width, 4), np.float32)
    array[..., 0] = np.linspace(0, 1, width)
    array[..., 1] = np.linspace(0, 1, height)[:, None]
    array[..., 3] = alpha
    return array


@pytest.mark.parametrize(
    ("value", "level"),
    [
        (0.0, 0),
        (1.0, 255),
        (0.5, 128),  # 127.5 goes up
        (0.499 / 255, 0),
        (0.501 / 255, 1),
        (np.nextafter(np.float32(0.5 / 255), np.float32(0)), 0),
        (-3.0, 0),
        (7.0, 255),
        (np.inf, 255),
        (-np.inf, 0),
        (np.nan, 0),
    ],
)
def test_a_value_becomes_the_nearest_level(value, level):
    assert quantise(np.array([value], np.float32))[0] == level


def test_every_level_survives_a_round_trip():
    levels = np.arange(256, dtype=np.uint8)
    assert (quantise(levels.astype(np.float32) / np.float32(255)) == levels).all()


def test_saved_file_holds_the_pixels_top_row_first(tmp_path):
    Picture(gradient()).save(tmp_path / "a.png")
    with Image.open(tmp_path / "a.png") as image:
        assert (image.mode, image.size) == ("RGB", (5, 3))
        assert image.getpixel((4, 0)) == (255, 0, 0)
        assert image.getpixel((0, 2)) == (0, 255, 0)


def test_transparent_picture_keeps_straight_alpha(tmp_path):
    Picture(gradient(alpha=0.5)).save(tmp_path / "a.png")
    with Image.open(tmp_path / "a.png") as image:
        assert image.mode == "RGBA"
        assert image.getpixel((4, 2)) == (255, 255, 0, 128)


def test_file_says_where_it_came_from_and_that_it_is_srgb(tmp_path):
    origin = Provenance(
        source="scène.py:图", source_hash="abc123", parameters={"blend": 0.3, "on": True}, time=1.5
    )
    Picture(gradient(), origin).save(tmp_path / "a.PNG")
    with Image.open(tmp_path / "a.PNG") as image:
        text = image.info
    assert text["srgb"] == 0
    assert text["distal:source"] == "scène.py:图"
    assert text["distal:source-hash"] == "abc123"
    assert json.loads(text["distal:parameters"]) == {"blend": 0.3, "on": True}
    assert text["distal:time"] == "1.5"
    assert text["distal:size"] == "5x3"
    assert text["distal:version"] == __version__


def test_notebook_sees_the_same_png(tmp_path):
    picture = Picture(gradient())
    picture.save(tmp_path / "a.png")
    assert picture._repr_png_() == (tmp_path / "a.png").read_bytes()
    assert Image.open(io.BytesIO(picture._repr_png_())).format == "PNG"


def test_picture_cannot_be_changed():
    array = gradient()
    picture = Picture(array, stats={"render_s": 0.1})
    with pytest.raises(ValueError):
        picture.array[0, 0, 0] = 1
    with pytest.raises(TypeError):
        picture.stats["render_s"] = 0
    array[0, 0, 0] = 1  # the maker's own array stays writable


@pytest.mark.parametrize(
    ("array", "words"),
    [
        (np.zeros((2, 2, 3), np.float32), "(height, width, 4)"),
        (np.zeros((0, 2, 4), np.float32), "(height, width, 4)"),
        (np.zeros((2, 2, 4)), "float32"),
    ],
)
def test_wrong_array_is_refused(array, words):
    with pytest.raises(ValueError) as caught:
        Picture(array)
    assert words in str(caught.value)


@pytest.mark.parametrize("name", ["a.jpg", "a.JPEG"])
def test_a_jpeg_is_close_and_opaque(tmp_path, name):
    Picture(gradient()).save(tmp_path / name)
    with Image.open(tmp_path / name) as image:
        assert (image.format, image.mode, image.size) == ("JPEG", "RGB", (5, 3))
        assert np.abs(np.asarray(image) / 255.0 - gradient()[..., :3]).max() < 0.05
    with pytest.raises(SaveError, match=r"^a JPEG has no transparency: save a \.png$"):
        Picture(gradient(alpha=0.5)).save(tmp_path / "b.jpg")
    with pytest.raises(SaveError, match=r"a channel has 8 bits$"):
        Picture(gradient()).save(tmp_path / "b.jpg", bits=16)
    assert not (tmp_path / "b.jpg").exists()


@pytest.mark.parametrize("name", ["a.gif", "a", "a.png.tiff"])
def test_unknown_suffix_names_what_is_possible(tmp_path, name):
    with pytest.raises(SaveError, match=r"pictures end in \.png"):
        Picture(gradient()).save(tmp_path / name)
    assert list(tmp_path.iterdir()) == []


def test_an_encoded_picture_is_decoded_once() -> None:
    encoded = np.zeros((1, 6, 4), np.float32)
    encoded[0, :, 0] = [-0.1, 0.0, 0.04045, 0.5, 1.0, 2.0]
    encoded[..., 3] = 0.5
    picture = Picture(encoded)
    linear = picture.linear
    expected = [-0.1 / 12.92, 0.0, 0.04045 / 12.92, 0.21404114, 1.0, ((2 + 0.055) / 1.055) ** 2.4]
    assert np.allclose(linear[0, :, 0], expected, rtol=1e-6)
    assert np.all(linear[..., 3] == 0.5)
    assert linear.dtype == np.float32
    assert picture.linear is linear
    with pytest.raises(ValueError, match="read-only"):
        linear[0, 0, 0] = 1.0


def test_light_is_kept_as_it_was_rendered() -> None:
    light = np.full((2, 3, 4), 4.0, np.float32)
    picture = Picture(np.ones((2, 3, 4), np.float32), light=light)
    assert np.array_equal(picture.linear, light)
    with pytest.raises(ValueError, match="light of shape"):
        Picture(np.ones((2, 3, 4), np.float32), light=light[:1])
