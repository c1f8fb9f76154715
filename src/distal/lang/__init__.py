"""The names that scene code imports: types, built-ins, decorators, parameters.

``__init__.pyi`` declares the same names for editors and type checkers. ``tools/gen_lang_stub.py``
generates it, and a test fails if it is out of date. Importing this package compiles nothing.
"""

from __future__ import annotations

from distal.ir.intrinsics import INTRINSICS
from distal.ir.types import Type
from distal.lang.annotations import Field2, Field3, Floats, Numbers, Vectors, array
from distal.lang.functions import FrameBuffer, Func, Image, buffer, func, image
from distal.lang.keys import key_held, key_pressed, key_toggled
from distal.lang.live_textures import ImageInput, Key, Keys, SoundFile, keyboard, microphone
from distal.lang.names import (
    LangForm,
    LangFunction,
    gradient,
    sample,
    select,
    size,
    texel,
    value_and_gradient,
)
from distal.lang.parameters import Parameter, choice, color, integer, point, slider, toggle
from distal.lang.resources import Buffer, Texture2D, Texture3D, TextureCube
from distal.lang.structs import struct
from distal.lang.values import VALUE_CLASSES, Frame, uint

BUILTINS = {row.name: LangFunction(row) for row in INTRINSICS.values() if not row.hidden}

globals().update({str(type): value for type, value in VALUE_CLASSES.items()})
globals().update(BUILTINS)

__all__ = [
    "Buffer",
    "Field2",
    "Field3",
    "Floats",
    "Frame",
    "FrameBuffer",
    "Func",
    "Image",
    "ImageInput",
    "Key",
    "Keys",
    "LangForm",
    "LangFunction",
    "Numbers",
    "Parameter",
    "SoundFile",
    "Texture2D",
    "Texture3D",
    "TextureCube",
    "Type",
    "Vectors",
    "array",
    "buffer",
    "choice",
    "color",
    "func",
    "gradient",
    "image",
    "integer",
    "key_held",
    "key_pressed",
    "key_toggled",
    "keyboard",
    "microphone",
    "point",
    "sample",
    "select",
    "size",
    "slider",
    "struct",
    "texel",
    "toggle",
    "uint",
    "value_and_gradient",
]
__all__ += [*map(str, VALUE_CLASSES), *BUILTINS]


def __dir__() -> list[str]:
    return sorted(__all__)
