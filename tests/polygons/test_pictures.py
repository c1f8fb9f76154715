"""Flat shapes from pictures: exact distances to the edge that a picture shows."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image

import distal
from distal import Circle, Rectangle, Shape2D
from distal.lang import slider
from distal.polygons.pictures import edge_of, reduced, signed_distances

RING = (Circle(0.35) - Circle(0.15)).translate(0.05, -0.03)


def drawn(shape, count=96):
    """A picture of the unit square, black on white; its soft edges show how much is inside."""
    inside = shape(grid(8 * count)) < 0.0
    shares = inside.reshape(count, 8, count, 8).mean(axis=(1, 3))[::-1]  # top row first
    return 1.0 - shares


def grid(count, width=1.0):
    at = (np.arange(count) + 0.5) / count * width - 0.5 * width
    return np.stack(np.meshgrid(at, at), axis=-1).reshape(-1, 2)


def test_distances_are_exact():
    rng = np.random.default_rng(1)
    shares = np.pad(rng.uniform(0.0, 1.0, (45, 37)), 1)  # many saddles
    pieces = edge_of(shares - 0.5)
    places = np.argwhere(np.ones_like(shares)).astype(float)
    begin, along = pieces[:, 0], pieces[:, 1] - pieces[:, 0]
    away = places[:, None] - begin
    t = np.clip((away * along).sum(2) / np.maximum((along**2).sum(1), 1e-300), 0.0, 1.0)
    wanted = np.linalg.norm(away - t[..., None] * along, axis=2).min(axis=1).reshape(shares.shape)
    found = signed_distances(shares)
    np.testing.assert_allclose(np.abs(found), wanted, atol=1e-12)
    np.testing.assert_array_equal(found < 0.0, (shares > 0.5) & (wanted > 0.0))
    # The edge is closed: each of its points ends two pieces.
    ends = np.round(pieces.reshape(-1, 2), 9)
    assert (np.unique(ends, axis=0, return_counts=True)[1] % 2 == 0).all()


def test_edges_at_a_level_lie_between_pixels():
    straight = np.zeros((9, 9))
    straight[:, 3:6] = 0.75
    found = signed_distances(np.pad(straight, 1), 0.25)
    np.testing.assert_allclose(found[5, 3:8], [1 / 3, -2 / 3, -5 / 3, -2 / 3, 1 / 3])


@pytest.mark.parametrize("source", ["array", "picture", "file", "bytes"])
def test_a_picture_becomes_the_shape_that_it_shows(source, tmp_path):
    pixels = drawn(RING)
    if source == "array":
        shape = Shape2D.from_image(np.stack([pixels] * 3, axis=-1))
    elif source == "picture":
        box = ((-0.5, -0.5), (0.5, 0.5))
        shape = Shape2D.from_image(
            RING.fill((96, 96), box=box, inside="black", outside="white", samples=64)
        )
    elif source == "bytes":
        shape = Shape2D.from_image(np.round(pixels * 255).astype(np.uint8))
    else:
        Image.fromarray(np.round(pixels * 255).astype(np.uint8)).save(tmp_path / "ring.png")
        shape = Shape2D.from_image(tmp_path / "ring.png")
    places = grid(101)
    apart = np.abs(shape(places) - RING(places))
    inside = np.abs(places).max(axis=1) < 0.48
    # An eighth of a pixel at the edge: a pixel's share is the mean over a square, whose level line
    # bends where the edge is oblique. At ridges, as in a hole's middle, interpolation cuts off the
    # way from the corner of four pixels to their middles, 0.71 pixels.
    near = np.abs(RING(places)) < 0.02
    assert apart[near & inside].max() < 0.125 / 96
    assert apart[inside].max() < (0.71 + 0.125) / 96
    low, high = shape.extents()
    wanted = RING.extents()
    np.testing.assert_allclose((low, high), wanted, atol=0.125 / 96)


def test_what_is_inside_is_said_or_seen():
    square = np.ones((20, 40, 4), np.float32)
    square[5:15, 10:30, :3] = 0.0
    half = Rectangle((2.0, 1.0))
    # 40 pixels are 4 units wide, so a pixel is 0.1.
    places = np.array([(0.0, 0.0), (0.3, 0.1), (1.5, 0.0), (0.0, 0.8)])
    dark = Shape2D.from_image(square, width=4.0)
    np.testing.assert_allclose(dark(places), half(places), atol=0.06)
    bright = Shape2D.from_image(square, width=4.0, inside="bright")
    assert (np.sign(bright(places)) == [1, 1, -1, -1]).all()
    square[..., 3] = 0.0
    square[5:15, 10:30, 3] = 1.0
    square[..., :3] = 1.0
    np.testing.assert_allclose(Shape2D.from_image(square, width=4.0)(places), dark(places))
    # What touches the border ends at it: half a pixel beyond the middles of its pixels.
    whole = Shape2D.from_image(np.zeros((11, 11)), width=2.0)
    np.testing.assert_allclose(whole(np.array([(0.0, 0.0), (0.95, 0.0)])), [-1.0, -0.05], atol=0.02)


def test_large_pictures_are_reduced():
    means, side = reduced(np.arange(24.0).reshape(4, 6), 3)
    assert (side, means.tolist()) == (2, [[3.5, 5.5, 7.5], [15.5, 17.5, 19.5]])
    shape = Shape2D.from_image(drawn(RING), samples=32)
    assert shape.node.constants["image"].data.shape == (34, 34)
    assert shape(np.array([(0.05, 0.22)]))[0] == pytest.approx(
        RING(np.array([(0.05, 0.22)]))[0], abs=0.02
    )


def test_it_is_compiled_for_every_target_and_made_solid():
    solid = Shape2D.from_image(drawn(RING, 32)).extrude(0.2)
    for target in ("glsl-es300", "wgsl"):
        assert distal.compile(solid, target=target).text
    assert solid(np.array([(0.3, 0.0, 0.0)]))[0] < 0.0


ALL = np.ones((8, 8))


@pytest.mark.parametrize(
    ("make", "message", "hint"),
    [
        (
            lambda: Shape2D.from_image(ALL),
            "nothing of the picture is dark enough to be inside",
            'take another level, or inside="bright" or "opaque"',
        ),
        (
            lambda: Shape2D.from_image("missing.png"),
            "from_image: the texture 'missing.png' cannot be read: No such file or directory",
            None,
        ),
        (
            lambda: Shape2D.from_image(3),
            "from_image takes a picture, not int 3",
            "a picture's file, an array (height, width) or (height, width, 3 or 4), or a Picture",
        ),
        (
            lambda: Shape2D.from_image(ALL, inside="black"),
            "inside is one of auto, dark, bright, opaque, not 'black'",
            None,
        ),
        (
            lambda: Shape2D.from_image(ALL, level=1.0),
            "'level of from_image' must be between 0 and 1, not 1",
            None,
        ),
        (
            lambda: Shape2D.from_image(ALL, samples=5000),
            "'samples of from_image' must be 2 to 4096, not 5000",
            None,
        ),
        (
            lambda: Shape2D.from_image(ALL, width=0.0),
            "'width of from_image' must be above 0, not 0",
            None,
        ),
        (
            lambda: Shape2D.from_image(ALL, width=slider("Width", 1.0, 0.1, 2.0)),
            "'width of from_image' is data: a plain number",
            ".scale(slider(…)) changes its size",
        ),
        (
            lambda: Shape2D.from_image(ALL * np.nan),
            "a pixel of the picture is no finite number",
            None,
        ),
    ],
)
def test_mistakes_are_told(make, message, hint):
    with pytest.raises(distal.CompileError) as caught:
        make()
    (found,) = caught.value.diagnostics
    assert (found.message, found.hint) == (message, hint)


def test_gray_files_and_palettes_are_read(tmp_path):
    pixels = Image.fromarray(np.round(drawn(RING, 48) * 255).astype(np.uint8))
    plain = Shape2D.from_image(np.asarray(pixels))(grid(21))
    for name, mode in (("gray.png", "L"), ("palette.png", "P")):
        pixels.convert(mode).save(tmp_path / name)
        np.testing.assert_allclose(Shape2D.from_image(tmp_path / name)(grid(21)), plain, atol=1e-6)
