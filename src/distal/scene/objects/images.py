"""Pictures as linear light, for patterns and environments.

Input: a picture's file, an array, a ``Picture``, or a texture. Output: a texture of linear light:
levels are encoded for display (sRGB) and are decoded here; floats are already linear. A
file that cannot be read is an error at the author's line.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.diagnostics import LoadError, Span
from distal.foreign_files import Memory
from distal.images.picture import Picture
from distal.lang.resources import Texture2D, TextureCube
from distal.pixels.reading import Pixels, is_pillow, read_pixels
from distal.scene.tree.conversion import beside
from distal.scene.tree.errors import refuse, refuse_kind

_BAND: Final = 256  # rows that are converted at once


def light_texture(image: Any, what: str, place: Span | None) -> Texture2D:
    """Return a picture as a texture of linear light.

    Args:
        image: A file, an array, a ``Picture`` or a texture.
        what: The name in messages of the object that uses it.
        place: The author's line.

    Raises:
        SceneValueError: The file cannot be read, or the array is not a picture.
        SceneTypeError: The value does not hold a picture.
    """
    if isinstance(image, Texture2D):
        return image
    return Texture2D(light_of(image, what, place))


def cube_texture(images: Any, what: str, place: Span | None) -> TextureCube:
    """Return six pictures as a cube texture of linear light.

    Args:
        images: Six pictures, in the order +x, -x, +y, -y, +z, -z.
        what: The name in messages of the object that uses them.
        place: The author's line.

    Raises:
        SceneValueError: There are not six pictures, or one cannot be read.
        SceneTypeError: The values do not hold pictures.
    """
    if isinstance(images, TextureCube):
        return images
    if isinstance(images, str | os.PathLike) or not hasattr(images, "__len__"):
        refuse_kind(
            f"'images of {what}' takes six pictures, not {type(images).__name__} {images!r:.40}",
            "in the order +x, -x, +y, -y, +z, -z",
            place,
        )
    if len(images) != 6:
        refuse(
            f"'images of {what}' takes six pictures, not {len(images)}",
            "in the order +x, -x, +y, -y, +z, -z",
            place,
        )
    return TextureCube([light_of(image, what, place) for image in images])


def texture_light(texture: Texture2D, what: str, place: Span | None) -> NDArray[Any]:
    """Return the content of a texture: (height, width, 4), top row first; see ``Pixels``.

    Args:
        texture: The texture.
        what: The name in messages of the object that uses it.
        place: The author's line.
    """
    return _read(texture.data, what, place, texture.max_memory).values


def _read(data: Any, what: str, place: Span | None, max_memory: Memory | None = None) -> Pixels:
    try:
        return read_pixels(data, max_memory)
    except LoadError as error:
        refuse(f"{what}: {error}", place=place)


def light_of(image: Any, what: str, place: Span | None) -> NDArray[np.float32]:
    """Return the linear light of a picture: float32 (height, width, 4), top row first.

    Args:
        image: A file, an array or a ``Picture``.
        what: The name in messages of the object that uses it.
        place: The author's line.
    """
    if isinstance(image, Picture):
        return image.linear
    is_file = isinstance(image, str | os.PathLike)
    if is_file:
        image = beside(image, place)
    elif not (hasattr(image, "__len__") or is_pillow(image)):
        refuse_kind(
            f"'image of {what}' takes a picture, not {type(image).__name__} {image!r:.40}",
            "a picture's file, an array (height, width, 3), a Picture or a Texture2D",
            place,
        )
    found = _read(os.fspath(image) if is_file else image, what, place)
    pixels = found.values.astype(np.float32, copy=False)
    if found.encoded:
        for band in _bands(pixels):
            band[...] = Picture(band).linear
    check_light(pixels[..., :3], what, place)
    return pixels


def _bands(pixels: NDArray[np.float32]) -> Iterator[NDArray[np.float32]]:
    """Yield parts of a picture, so that what is computed of it is never there as a whole."""
    for top in range(0, len(pixels), _BAND):
        yield pixels[top : top + _BAND]


def check_light(light: NDArray[np.float32], what: str, place: Span | None) -> None:
    """Check that a picture is light: no part of it is negative or not finite.

    Args:
        light: Its texels, (height, width, 3), top row first.
        what: The name in messages of the object that uses it.
        place: The author's line.

    Raises:
        SceneValueError: A texel is not light.
    """
    if all((np.isfinite(band) & (band >= 0.0)).all() for band in _bands(light)):
        return
    wrong = ~(np.isfinite(light) & (light >= 0.0))
    row, column, part = (int(i) for i in np.argwhere(wrong)[0])
    value = float(light[row, column, part])
    named = f"{value:g} in row {row}, column {column}"
    if np.isfinite(value):
        hint = "np.maximum(image, 0) replaces negative values"
        refuse(f"'image of {what}' must be light without negative values, not {named}", hint, place)
    hint = "np.nan_to_num(image, posinf=1, neginf=0) replaces what is not a number"
    refuse(f"'image of {what}' must be finite light, not {named}", hint, place)


def rows_of(cells: list[tuple[float, float, float]]) -> NDArray[np.float32]:
    """Return the cells of a table as an array, which a buffer passes on without a conversion."""
    return np.array(cells, np.float32)
