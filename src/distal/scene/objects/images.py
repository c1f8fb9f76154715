"""Pictures as light: what patterns and surroundings read.

Input: a picture's file, an array, a ``Picture``, a texture. Output: a texture of
linear light: files and bytes are encoded for display (sRGB) and are decoded here, floats are linear
light already. A file that cannot be read is an error at the author's line.
"""

from __future__ import annotations

import os
from typing import Any

import numpy as np
from numpy.typing import NDArray

from distal.devices.resources import texels
from distal.diagnostics import LoadError, Span
from distal.images.picture import Picture
from distal.ir.types import TextureShape
from distal.lang.resources import Texture2D, TextureCube
from distal.scene.tree.conversion import beside
from distal.scene.tree.errors import refuse, refuse_kind


def light_texture(image: Any, what: str, place: Span | None) -> Texture2D:
    """A picture as a texture of linear light.

    Raises:
        SceneValueError: The file cannot be read, or the array is no picture.
        SceneTypeError: It is nothing that holds a picture.
    """
    if isinstance(image, Texture2D):
        return image
    return Texture2D(light_of(image, what, place))


def cube_texture(images: Any, what: str, place: Span | None) -> TextureCube:
    """Six pictures, in the order +x, -x, +y, -y, +z, -z, as a texture of linear light.

    Raises:
        SceneValueError: There are not six, or one cannot be read.
        SceneTypeError: They are nothing that holds pictures.
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


def texture_light(texture: Texture2D, what: str, place: Span | None) -> NDArray[np.float32]:
    """What a texture holds: float32 (height, width, 4), top row first."""
    try:
        return texels(texture.data, TextureShape.FLAT)[::-1]
    except LoadError as error:
        message = str(error)
        refuse(f"{what}: {message}", place=place)


def light_of(image: Any, what: str, place: Span | None) -> NDArray[np.float32]:
    """The linear light of a picture: float32 (height, width, 4), top row first."""
    if isinstance(image, Picture):
        return image.linear
    encoded = isinstance(image, str | os.PathLike)
    if encoded:
        image = beside(image, place)
    elif not hasattr(image, "__len__"):
        refuse_kind(
            f"'image of {what}' takes a picture, not {type(image).__name__} {image!r:.40}",
            "a picture's file, an array (height, width, 3), a Picture or a Texture2D",
            place,
        )
    held = Texture2D(os.fspath(image) if encoded else image)
    pixels = texture_light(held, what, place)
    if encoded or getattr(image, "dtype", None) == np.uint8:
        return Picture(pixels).linear
    return pixels
