"""What a texture or buffer may be made of, and what is said about the rest."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from distal.devices.resources import load, texels
from distal.diagnostics import LoadError
from distal.ir.types import FLOAT, INT, TEXTURE_3D, UINT, VEC3, Buffer, TextureShape
from distal.lang import Buffer as DeclaredBuffer
from distal.lang import Texture3D

FLAT, CUBE, VOLUME = TextureShape.FLAT, TextureShape.CUBE, TextureShape.VOLUME


def test_a_picture_is_turned_upside_down() -> None:
    data = np.zeros((2, 3, 4), np.float32)
    data[0, 0] = (1, 2, 3, 4)
    assert texels(data, FLAT)[1, 0].tolist() == [1, 2, 3, 4]


def test_a_file_is_read_as_it_stands(tmp_path: Path) -> None:
    file = tmp_path / "picture.png"
    Image.fromarray(np.array([[[255, 0, 51]]], np.uint8)).save(file)
    assert texels(str(file), FLAT)[0, 0] == pytest.approx([1.0, 0.0, 0.2, 1.0])


def test_grey_and_lists() -> None:
    assert texels([[0.25, 0.5]], FLAT).tolist() == [[[0.25, 0.25, 0.25, 1], [0.5, 0.5, 0.5, 1]]]


def test_bytes_become_shares() -> None:
    assert texels(np.full((1, 1, 3), 255, np.uint8), FLAT).tolist() == [[[1, 1, 1, 1]]]


def test_a_volume_keeps_its_order() -> None:
    data = np.random.default_rng(1).random((2, 3, 4, 4), np.float32)
    assert np.array_equal(texels(data, VOLUME), data)


@pytest.mark.parametrize("axes", ["zyx", "xyz", "yxz", "zxy"])
def test_the_axes_of_a_volume_are_named(axes: str) -> None:
    numbers = np.random.default_rng(1).random((2, 3, 4), np.float32)
    stored = numbers.transpose(["zyx".index(axis) for axis in axes])
    found = load(Texture3D(stored, axes=axes), TEXTURE_3D)
    assert np.array_equal(found[..., 0], numbers)
    assert np.array_equal(found[..., 2], numbers)
    assert found.flags.c_contiguous


@pytest.mark.parametrize("axes", ["xyw", "xy", "xxyz", 3])
def test_other_axes_are_refused(axes: Any) -> None:
    with pytest.raises(ValueError, match="axes are 'zyx' or another order of the three, not "):
        Texture3D([[[0.0]]], axes=axes)


@pytest.mark.parametrize(
    ("data", "shape", "message"),
    [
        ("nowhere.png", FLAT, "the texture 'nowhere.png' cannot be read"),
        (np.zeros((2, 2, 2)), FLAT, "with 3 or 4 channels"),
        (np.zeros((0, 2, 4)), FLAT, "with 3 or 4 channels"),
        ([[1.0], [1.0, 2.0]], FLAT, "rows have one length"),
        ([["a"]], FLAT, "takes numbers"),
        ("file.png", VOLUME, "takes an array, not the file"),
        ("file.png", CUBE, "six pictures"),
        (np.zeros((5, 2, 2, 4)), CUBE, "six pictures of one size"),
        (np.zeros((6, 2, 3, 4)), CUBE, "square"),
        ([], CUBE, "not none"),
    ],
)
def test_what_is_no_texture(data: Any, shape: TextureShape, message: str) -> None:
    with pytest.raises(LoadError, match=message):
        texels(data, shape)


def test_a_file_that_is_no_picture(tmp_path: Path) -> None:
    file = tmp_path / "text.png"
    file.write_text("not a picture")
    with pytest.raises(LoadError, match="cannot be read"):
        texels(file, FLAT)


def test_buffers() -> None:
    assert load(DeclaredBuffer([1.0, 2.5]), Buffer(FLOAT)).dtype == np.float64
    assert load(DeclaredBuffer([1, -2]), Buffer(INT)).tolist() == [1, -2]
    assert load(DeclaredBuffer(np.array([4294967295], np.uint32)), Buffer(UINT)).tolist() == [
        4294967295
    ]
    assert load(DeclaredBuffer([(1, 2, 3), (4, 5, 6)]), Buffer(VEC3)).shape == (2, 3)


def test_an_int_that_does_not_fit() -> None:
    with pytest.raises(LoadError, match="does not fit int"):
        load(DeclaredBuffer([2**31]), Buffer(INT))
