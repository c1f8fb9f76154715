"""PNG of 16 bits a channel: exact levels, as other programs read them."""

import shutil
import subprocess

import numpy as np
import pytest
from PIL import Image

from distal.images.metadata import ReadError
from distal.images.picture import Picture
from distal.images.picture_files import read
from distal.images.png import decode, quantise


def ramp(alpha=1.0):
    """Every one of the 65536 levels in red, others in green and blue."""
    array = np.empty((256, 256, 4), np.float32)
    array[..., 0] = (np.arange(65536) / 65535.0).reshape(256, 256)
    array[..., 1] = array[::-1, :, 0]
    array[..., 2] = array[:, ::-1, 0]
    array[..., 3] = alpha
    return array


def levels(array):
    return np.rint(array.astype(np.float64) * 65535.0).astype(np.uint16)


@pytest.mark.parametrize(
    ("value", "level"),
    [
        (0.0, 0),
        (1.0, 65535),
        (0.5, 32768),  # 32767.5 goes up
        (0.499 / 65535, 0),
        (0.501 / 65535, 1),
        (-3.0, 0),
        (7.0, 65535),
        (np.inf, 65535),
        (-np.inf, 0),
        (np.nan, 0),
    ],
)
def test_a_value_becomes_the_nearest_of_65536_levels(value, level):
    assert quantise(np.array([value], np.float32), 16)[0] == level


def test_every_level_survives(tmp_path):
    picture = Picture(ramp())
    picture.save(tmp_path / "a.png", bits=16)
    found = decode((tmp_path / "a.png").read_bytes())
    assert found.dtype == np.uint16
    assert np.array_equal(found, levels(picture.array))
    assert np.array_equal(np.unique(found[..., 0]), np.arange(65536))


@pytest.mark.parametrize(
    ("alpha", "format", "channels"), [(1.0, "rgb48be", 3), (0.25, "rgba64be", 4)]
)
def test_ffmpeg_reads_the_same_levels(tmp_path, alpha, format, channels):
    av = pytest.importorskip("av", reason="PyAV is not installed")
    Picture(ramp(alpha)).save(tmp_path / "a.png", bits=16)
    with av.open(str(tmp_path / "a.png")) as file:
        frame = next(file.decode(video=0))
    assert frame.format.name == format
    assert np.array_equal(frame.to_ndarray(), levels(ramp(alpha))[..., :channels])


@pytest.mark.skipif(shutil.which("convert") is None, reason="ImageMagick is not installed")
def test_imagemagick_reads_the_same_levels_and_texts(tmp_path):
    picture = Picture(ramp(0.25)).with_provenance(source="scene.py:ball", source_hash="abc")
    picture.save(tmp_path / "a.png", bits=16)
    raw = subprocess.run(
        ["convert", "a.png", "-depth", "16", "-endian", "LSB", "RGBA:-"],
        cwd=tmp_path,
        capture_output=True,
        check=True,
    ).stdout
    found = np.frombuffer(raw, "<u2").reshape(256, 256, 4)
    assert np.array_equal(found, levels(picture.array))
    said = subprocess.run(
        ["identify", "-verbose", "a.png"], cwd=tmp_path, capture_output=True, check=True, text=True
    ).stdout
    assert "png:IHDR.bit_depth: 16" in said
    assert "png:sRGB: intent=0 (Perceptual Intent)" in said
    assert "distal:source-hash: abc" in said
    assert "distal:source: scene.py:ball" in said


def test_texts_and_head_are_those_of_a_usual_file(tmp_path):
    picture = Picture(ramp()).with_provenance(source="scène.py:图", source_hash="abc", time=0.1)
    picture.save(tmp_path / "a.png", bits=16)
    picture.save(tmp_path / "b.png")
    with Image.open(tmp_path / "a.png") as deep, Image.open(tmp_path / "b.png") as usual:
        assert deep.size == usual.size
        assert deep.info == usual.info
        assert deep.info["srgb"] == 0
    assert read(tmp_path / "a.png").bits == 16
    assert read(tmp_path / "b.png").bits == 8
    assert read(tmp_path / "a.png").provenance == picture.provenance


@pytest.mark.parametrize("size", [(1, 1), (1, 7), (5, 1)])
def test_smallest_sizes(tmp_path, size):
    width, height = size
    array = np.random.default_rng(1).random((height, width, 4), np.float32)
    Picture(array).save(tmp_path / "a.png", bits=16)
    assert np.array_equal(decode((tmp_path / "a.png").read_bytes()), levels(array))


def test_pixels_of_another_program_are_not_mistaken(tmp_path):
    if shutil.which("convert") is None:
        pytest.skip("ImageMagick is not installed")
    Picture(ramp()).save(tmp_path / "a.png", bits=16)
    again = ["convert", "a.png", "-define", "png:compression-filter=4", "b.png"]
    subprocess.run(again, cwd=tmp_path, check=True)
    with pytest.raises(ReadError, match="written by another program"):
        decode((tmp_path / "b.png").read_bytes())


@pytest.mark.parametrize("bits", [8, 16])
@pytest.mark.parametrize("keep", [9, 40, 0.5, 0.9])
def test_cut_file_is_told_in_one_line(tmp_path, bits, keep):
    Picture(ramp()).with_provenance(source_hash="a").save(tmp_path / "a.png", bits=bits)
    data = (tmp_path / "a.png").read_bytes()
    end = keep if isinstance(keep, int) else int(keep * len(data))
    (tmp_path / "a.png").write_bytes(data[:end])
    with pytest.raises(ReadError) as caught:
        read(tmp_path / "a.png")
    assert "is broken: it is no whole PNG" in str(caught.value)
    assert "\n" not in str(caught.value)
