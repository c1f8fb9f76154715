"""Files of light: Radiance and OpenEXR, against values that were computed by hand."""

import io
import itertools
import warnings

import numpy as np
import OpenEXR
import pytest

from distal import Environment, Scene, Sphere
from distal.diagnostics import LoadError
from distal.pixels.reading import read_pixels
from distal.render.brightness import brightness_table

RANDOM = np.random.default_rng(5)


def head(lines="FORMAT=32-bit_rle_rgbe\n", size="-Y 6 +X 10"):
    return f"#?RADIANCE\n# a comment\n{lines}\n{size}\n".encode()


def light_of(levels):
    scale = np.where(levels[..., 3] > 0, 2.0 ** (levels[..., 3].astype(float) - 136.0), 0.0)
    return levels[..., :3] * scale[..., None]


LEVELS = RANDOM.integers(3, 256, (6, 10, 4), dtype=np.uint8)
LEVELS[..., 3] = RANDOM.integers(120, 140, (6, 10))
LEVELS[2, 3:9] = LEVELS[2, 3]
LEVELS[0, 0] = (9, 9, 9, 0)


def packed(levels):
    """Pack each channel of each line: runs of 3 and more, and literals."""
    out = bytearray()
    for row in levels:
        out += bytes((2, 2, levels.shape[1] >> 8, levels.shape[1] & 255))
        for channel in row.T:
            for value, run in itertools.groupby(channel.tolist()):
                count = len(list(run))
                out += bytes((128 + count, value)) if count > 2 else bytes((1, value)) * count
    return bytes(out)


def repeated(levels):
    """Write pixels in the older way, with (1, 1, 1, n) for n more of the same."""
    out = bytearray()
    for pixel, run in itertools.groupby(map(tuple, levels.reshape(-1, 4).tolist())):
        out += bytes(pixel)
        more = len(list(run)) - 1
        while more:
            out += bytes((1, 1, 1, more & 255))
            more >>= 8
    return bytes(out)


def read(tmp_path, data):
    (tmp_path / "a.hdr").write_bytes(data)
    found = read_pixels(tmp_path / "a.hdr")
    assert not found.encoded
    assert (found.values[..., 3] == 1.0).all()
    return found.values[..., :3]


@pytest.mark.parametrize("pack", [np.ndarray.tobytes, packed, repeated])
def test_three_ways_to_pack(tmp_path, pack):
    assert read(tmp_path, head() + pack(LEVELS)) == pytest.approx(light_of(LEVELS), rel=1e-6)


def test_long_repeats(tmp_path):
    levels = np.tile(LEVELS[0, 1], (50, 41, 1))
    found = read(tmp_path, head(size="-Y 50 +X 41") + repeated(levels))
    assert found == pytest.approx(light_of(levels), rel=1e-6)


@pytest.mark.parametrize("y", "-+")
@pytest.mark.parametrize("x", "-+")
@pytest.mark.parametrize("is_across", [False, True])
def test_all_ways_up(tmp_path, x, y, is_across):
    stored = LEVELS[::-1] if y == "+" else LEVELS
    stored = stored[:, ::-1] if x == "-" else stored
    size = f"{y}Y 6 {x}X 10"
    if is_across:
        stored, size = stored.swapaxes(0, 1), f"{x}X 10 {y}Y 6"
    found = read(tmp_path, head(size=size) + stored.tobytes())
    assert found == pytest.approx(light_of(LEVELS), rel=1e-6)


def test_exposures_are_taken_back(tmp_path):
    lines = "FORMAT=32-bit_rle_rgbe\nEXPOSURE=2\nEXPOSURE= 4.0\nCOLORCORR=1 2 0.5\n"
    found = read(tmp_path, head(lines) + LEVELS.tobytes())
    assert found == pytest.approx(light_of(LEVELS) / (8.0, 16.0, 4.0), rel=1e-6)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (head() + LEVELS.tobytes()[:-1], "it is truncated"),
        (head() + packed(LEVELS)[:-1], "it is truncated"),
        (head() + repeated(LEVELS)[:-4], "it is truncated"),
        (head(size="-Y 6 -Y 10"), "its size is '-Y 6 -Y 10', not '-Y 8 \\+X 16'"),
        (head(size="-Y 0 +X 10"), "it has no pixels"),
        (head("FORMAT=32-bit_rle_spec\n"), "its format is '32-bit_rle_spec'"),
        (head("EXPOSURE=0\n") + LEVELS.tobytes(), "its exposure '0' is no number above 0"),
        (head(size="-Y 99999 +X 99999"), "would become"),
        (b"#?RADIANCE\n", "its header does not end"),
        (head() + b"\2\2\0\x0a" + b"\xff\0" * 99, "a line of its pixels is damaged"),
        (head(size="-Y 1 +X 2") + b"\1\1\1\2" * 3, "a line of its pixels is damaged"),
    ],
)
def test_damaged_radiance(tmp_path, data, message):
    (tmp_path / "a.hdr").write_bytes(data)
    with pytest.raises(LoadError, match=message):
        read_pixels(tmp_path / "a.hdr")


def exr(channels, header=None):
    file = io.BytesIO()
    with OpenEXR.File({"type": OpenEXR.scanlineimage, **(header or {})}, channels) as made:
        made.write(file)
    return file.getvalue()


COLORS = RANDOM.uniform(0.0, 9.0, (4, 8, 3)).astype(np.float32)


def named(prefix, type=np.float32):
    return {f"{prefix}{n}": COLORS[..., i].astype(type) for i, n in enumerate("RGB")}


DEPTH = np.ones((4, 8), np.float32)


@pytest.mark.parametrize(
    ("channels", "expected"),
    [
        (named(""), COLORS),
        (named("", np.float16), COLORS.astype(np.float16)),
        ({**named(""), **named("diffuse."), "Z": DEPTH}, COLORS),
        ({**named("View.Combined."), "View.Depth.Z": DEPTH}, COLORS),
        ({"Y": COLORS[..., 0].copy()}, COLORS[..., :1].repeat(3, axis=2)),
        ({**named(""), "A": DEPTH / 4}, COLORS * 4),
    ],
)
def test_openexr(tmp_path, channels, expected):
    (tmp_path / "a.exr").write_bytes(exr(channels))
    found = read_pixels(tmp_path / "a.exr")
    assert not found.encoded
    assert found.values[..., :3] == pytest.approx(expected.astype(np.float32), rel=1e-6)
    assert found.values[..., 3] == pytest.approx(0.25 if "A" in channels else 1.0)


def window(left, top, right, bottom):
    return np.array((left, top), np.int32), np.array((right, bottom), np.int32)


def test_only_the_display_window_is_shown(tmp_path):
    header = {"dataWindow": window(2, -1, 9, 2), "displayWindow": window(0, 0, 7, 5)}
    (tmp_path / "a.exr").write_bytes(exr(named(""), header))
    found = read_pixels(tmp_path / "a.exr").values
    assert found.shape == (6, 8, 4)
    assert np.array_equal(found[:3, 2:, :3], COLORS[1:, :6])
    assert (found[3:] == 0.0).all() and (found[:, :2] == 0.0).all()


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (exr({**named("a."), **named("b.")}), "it has the layers a, b, and none without a name"),
        (exr({"Z": DEPTH}), "it has no colors, but Z"),
        (exr(named(""), {"displayWindow": window(20, 20, 30, 30)}), "outside of its display"),
        (exr(named("")).replace(b"\2\0\0\0", b"\2\2\0\0", 1), "it has tiles, depths or several"),
        (exr(named(""))[:-9], "it is cut short"),
    ],
)
def test_openexr_that_is_refused(tmp_path, data, message):
    (tmp_path / "a.exr").write_bytes(data)
    with pytest.raises(LoadError, match=message):
        read_pixels(tmp_path / "a.exr")


def files(tmp_path, light):
    """The same panorama in both formats; its values are exact in both."""
    mantissa, exponent = np.frexp(light.max(axis=-1))
    levels = np.rint(light * (256.0 / 2.0 ** exponent[..., None].astype(float)))
    levels = np.concatenate([levels, np.where(mantissa > 0, exponent + 128, 0)[..., None]], axis=-1)
    size = f"-Y {light.shape[0]} +X {light.shape[1]}"
    (tmp_path / "a.hdr").write_bytes(head(size=size) + levels.astype(np.uint8).tobytes())
    channels = {n: np.ascontiguousarray(light[..., i]) for i, n in enumerate("RGB")}
    (tmp_path / "a.exr").write_bytes(exr(channels))
    return tmp_path / "a.hdr", tmp_path / "a.exr"


def test_a_uniform_panorama_shows_and_lights_with_all_of_it(tmp_path):
    light = np.full((8, 16, 3), 4.0, np.float32)
    for file in files(tmp_path, light):
        around = Environment(str(file), light=True)
        scene = Scene(Sphere().paint("white"), background=around, floor=False, tone_map="none")
        seen = scene.render(size=(16, 12), samples=1).linear
        assert seen[0, 0, :3] == pytest.approx(4.0, rel=1e-5)
        albedo = scene.render(size=(16, 12), samples=1, view="material").linear[6, 8, :3]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            path = scene.render(size=(16, 12), samples=64, mode="path").linear
        assert path[6, 8, :3] / albedo == pytest.approx(4.0, rel=0.1)


def test_directions_follow_a_sun_of_one_pixel(tmp_path):
    light = np.zeros((32, 64, 3), np.float32)
    light[4, 10] = 65536.0
    for file in files(tmp_path, light):
        pixels = read_pixels(file).values
        rows, columns, cells = brightness_table(pixels)
        densities = np.array([cell[2] for cell in cells]).reshape(rows, columns)[::-1]
        assert np.unravel_index(densities.argmax(), densities.shape) == (4, 10)
        # All but the share that is spread evenly is at the sun and the pixels beside it.
        edges = np.cos(np.linspace(0.0, np.pi, rows + 1))
        areas = 2.0 * np.pi / columns * -np.diff(edges)
        near = (densities * areas[:, None])[3:6, 9:12].sum()
        assert near > 0.94
