"""EXR files: what OpenEXR and, independently, FFmpeg's own decoder find in them."""

import sys

import numpy as np
import pytest

from distal.file_writer import SaveError
from distal.images.metadata import ReadError
from distal.images.picture import Picture
from distal.images.picture_files import read

OpenEXR = pytest.importorskip("OpenEXR", reason="OpenEXR is not installed")

HALF = 2.0**-11  # the largest relative error of rounding to a half float


@pytest.fixture
def picture() -> Picture:
    random = np.random.default_rng(4)
    light = (random.random((31, 47, 4)) * 20.0).astype(np.float32)
    light[..., 3] = random.integers(0, 5, (31, 47)) / np.float32(4.0)
    normal = random.normal(size=(31, 47, 3)).astype(np.float32)
    layers = {
        "depth": np.where(random.random((31, 47)) < 0.2, np.inf, 1000.0 / 3.0).astype(np.float32),
        "normal": normal / np.linalg.norm(normal, axis=-1, keepdims=True),
        "albedo": random.random((31, 47, 3)).astype(np.float32),
        "material": random.integers(0, 70000, (31, 47)).astype(np.uint32),
    }
    made = Picture(np.clip(light, 0.0, 1.0), light=light, layers=layers)
    return made.with_provenance(source="scène.py:图", source_hash="abc", parameters={"blend": 0.3})


def channels(path):
    with OpenEXR.File(str(path), separate_channels=True) as file:
        return {name: channel.pixels for name, channel in file.channels().items()}, dict(
            file.header()
        )


def associated(light):
    return np.dstack((light[..., :3] * light[..., 3:], light[..., 3:]))


def test_light_is_linear_premultiplied_and_right_within_a_half(picture, tmp_path):
    picture.save(tmp_path / "a.exr")
    found, _ = channels(tmp_path / "a.exr")
    for name, expected in zip("RGBA", np.moveaxis(associated(picture.linear), -1, 0), strict=True):
        assert found[name].dtype == np.float16
        # Rounded twice: the product to a float, that to a half.
        assert np.allclose(found[name], expected, rtol=1.01 * HALF, atol=1e-7), name


def test_floats_are_kept_exactly(picture, tmp_path):
    picture.save(tmp_path / "a.exr", bits=32)
    found, _ = channels(tmp_path / "a.exr")
    for name, expected in zip("RGBA", np.moveaxis(associated(picture.linear), -1, 0), strict=True):
        assert found[name].dtype == np.float32
        assert np.array_equal(found[name], expected), name


def test_layers_have_the_names_and_types_that_compositors_know(picture, tmp_path):
    picture.save(tmp_path / "a.exr")
    found, _ = channels(tmp_path / "a.exr")
    layers = picture.layers
    assert set(found) == {
        *"RGBAZ",
        *("N.X", "N.Y", "N.Z"),
        *("albedo.R", "albedo.G", "albedo.B"),
        "material.id",
    }
    assert found["Z"].dtype == np.float32
    assert np.array_equal(found["Z"], layers["depth"])
    assert found["material.id"].dtype == np.uint32
    assert np.array_equal(found["material.id"], layers["material"])
    for i, axis in enumerate("XYZ"):
        assert np.allclose(found[f"N.{axis}"], layers["normal"][..., i], rtol=HALF, atol=1e-7)
    for i, color in enumerate("RGB"):
        assert np.allclose(found[f"albedo.{color}"], layers["albedo"][..., i], rtol=HALF, atol=1e-7)


def test_head_says_primaries_pixel_shape_and_where_it_came_from(picture, tmp_path):
    picture.save(tmp_path / "a.exr")
    _, header = channels(tmp_path / "a.exr")
    rec709 = (0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290)
    assert header["chromaticities"] == pytest.approx(rec709)
    assert header["pixelAspectRatio"] == 1.0
    assert header["compression"] == OpenEXR.ZIP_COMPRESSION
    for key, text in picture.metadata.items():
        assert header[key] == text, key
    record = read(tmp_path / "a.exr")
    assert (record.size, record.format, record.bits) == ((47, 31), "exr", 16)
    assert record.provenance == picture.provenance


def test_light_out_of_reach_of_a_half_is_its_largest_and_broken_pixels_stay(tmp_path):
    light = np.ones((1, 4, 4), np.float32)
    light[0, :, 0] = [1e9, -1e9, np.inf, np.nan]
    Picture(np.ones((1, 4, 4), np.float32), light=light).save(tmp_path / "a.exr")
    found, _ = channels(tmp_path / "a.exr")
    assert found["R"][0, :3].tolist() == [65504.0, -65504.0, np.inf]
    assert np.isnan(found["R"][0, 3])


def test_nothing_covers_nothing_even_where_light_is_infinite(tmp_path):
    light = np.zeros((1, 1, 4), np.float32)
    light[0, 0, :3] = np.inf
    Picture(np.zeros((1, 1, 4), np.float32), light=light).save(tmp_path / "a.exr")
    found, _ = channels(tmp_path / "a.exr")
    assert [found[name][0, 0] for name in "RGBA"] == [0.0, 0.0, 0.0, 0.0]


def test_picture_without_light_is_decoded_for_the_file(tmp_path):
    Picture(np.full((2, 2, 4), 0.5, np.float32)).save(tmp_path / "a.exr", bits=32)
    found, _ = channels(tmp_path / "a.exr")
    assert found["R"][0, 0] == pytest.approx(0.5 * 0.21404114, rel=1e-6)  # times alpha
    assert set(found) == set("RGBA")


@pytest.mark.parametrize("layer", ["", "albedo"])
def test_ffmpeg_finds_the_same(picture, tmp_path, layer):
    av = pytest.importorskip("av", reason="PyAV is not installed")
    picture.save(tmp_path / "a.exr")
    expected, _ = channels(tmp_path / "a.exr")
    with av.open(str(tmp_path / "a.exr")) as file:
        file.streams.video[0].codec_context.options = {"layer": layer}
        frame = next(file.decode(video=0))
    assert frame.format.name == ("gbrpf16le" if layer else "gbrapf16le")
    planes = [
        np.frombuffer(bytes(p), np.float16).reshape(p.height, -1)[:, : frame.width]
        for p in frame.planes
    ]
    prefix = f"{layer}." if layer else ""
    for name, plane in zip("GBR", planes, strict=False):
        assert np.array_equal(plane, expected[prefix + name]), name
    if not layer:
        assert np.array_equal(planes[3], expected["A"])


def test_without_the_package_one_line_says_how_to_get_it(picture, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "OpenEXR", None)
    with pytest.raises(SaveError) as caught:
        picture.save(tmp_path / "a.exr")
    assert str(caught.value).endswith("OpenEXR is missing: pip install 'distal[exr]'")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("suffix", "bits"), [(".exr", 8), (".png", 32), (".png", 0)])
def test_bits_that_a_format_has_not_are_refused(picture, tmp_path, suffix, bits):
    with pytest.raises(SaveError, match=r"a channel has \d+ or \d+ bits"):
        picture.save(tmp_path / f"a{suffix}", bits=bits)


@pytest.mark.parametrize("share", [0.02, 0.3, 0.7, 0.999])
def test_cut_file_is_told_in_one_line(picture, tmp_path, share, capfd):
    picture.save(tmp_path / "a.exr")
    data = (tmp_path / "a.exr").read_bytes()
    (tmp_path / "a.exr").write_bytes(data[: int(share * len(data))])
    with pytest.raises(ReadError, match="is broken: it is no whole EXR"):
        read(tmp_path / "a.exr")
    assert "".join(capfd.readouterr()) == ""  # its library prints nothing beside


def test_file_that_claims_to_be_huge_is_refused(tmp_path):
    picture = Picture(np.ones((2, 2, 4), np.float32)).with_provenance(source_hash="a")
    picture.save(tmp_path / "a.exr")
    data = (tmp_path / "a.exr").read_bytes()
    window = b"dataWindow\0box2i\0\x10\0\0\0"
    at = data.index(window) + len(window) + 8
    huge = (200000).to_bytes(4, "little")
    (tmp_path / "a.exr").write_bytes(data[:at] + huge + huge + data[at + 8 :])
    with pytest.raises(ReadError, match="is broken"):
        read(tmp_path / "a.exr")
