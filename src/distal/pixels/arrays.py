"""The numbers of arrays: which value of each type is 1.

Input: an array of NumPy, or nested lists. Output: floats by the rules of ``ARRAY_RULES``; the
reference page prints them.
"""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.diagnostics import LoadError, printable

# What is 1 in integers of these types; such pictures are encoded for display, as files are.
WHITE: Final = {"uint8": 255.0, "uint16": 65535.0}
# Rows that are converted at once, so that doubles of a whole picture are never in memory.
BAND: Final = 256
ARRAY_RULES: Final = {
    "uint8": "divided by 255; encoded for display (sRGB)",
    "uint16": "divided by 65535; encoded for display (sRGB)",
    "bool": "False is 0, True is 1; linear",
    "float16, float32, float64, longdouble": "unchanged; linear",
    "nested lists": "unchanged, also integers; linear",
    "other integers, complex numbers, texts": "refused: nothing says which value is white",
}


def is_encoded(array: NDArray[Any]) -> bool:
    """Return whether an array is encoded for display; else it is linear."""
    return array.dtype.newbyteorder("=").name in WHITE


def numbers_of(data: Any) -> NDArray[Any]:
    """Return data as an array whose type has a rule.

    Raises:
        LoadError: It has none.
    """
    try:
        array = np.asarray(data)
    except ValueError as error:
        raise LoadError("a texture's rows have one length") from error
    if array.dtype.kind not in "fiub":
        raise LoadError(f"a texture takes numbers, not {printable(array.dtype, 40)}")
    if array.dtype.kind in "iu" and not is_encoded(array):
        if hasattr(data, "dtype"):
            raise LoadError(
                f"nothing says which value of {array.dtype} is white: write "
                "array.astype(np.uint8) for 0 to 255, array.astype(np.uint16) for 0 to 65535, or "
                "array / white"
            )
        array = array.astype(np.float64)
    return array


def float_type(array: NDArray[Any]) -> np.dtype[Any]:
    """Return the type in which the floats of data are held: float32 if it holds them exactly.

    Where a kernel computes in 32 bits, its device rounds what has 64.
    """
    return np.dtype(np.float32 if np.can_cast(array.dtype, np.float32) else np.float64)


def floats_of(array: NDArray[Any]) -> NDArray[Any]:
    """Return the numbers of an array by the rule of its type, as ``float_type`` says."""
    values = np.empty(array.shape, float_type(array))
    white = values.dtype.type(WHITE.get(array.dtype.newbyteorder("=").name, 1.0))
    with np.errstate(over="ignore"):
        for begin in range(0, len(array), BAND):
            values[begin : begin + BAND] = array[begin : begin + BAND]
    if white != 1.0:
        values /= white
    return values


def with_channels(array: NDArray[Any], axes: int) -> NDArray[Any]:
    """Return RGBA from grey, RGB or RGBA.

    Args:
        array: Numbers with a rule.
        axes: How many axes there are before the channels.

    Raises:
        LoadError: The array does not have the shape of a texture.
    """
    is_grey = array.ndim == axes
    is_colored = array.ndim == axes + 1 and array.shape[-1] in (3, 4)
    if array.size == 0 or not (is_grey or is_colored):
        names = ("height, width", "depth, height, width")[axes - 2]
        raise LoadError(f"a texture is ({names}), with 3 or 4 channels; not {array.shape}")
    values = floats_of(array)
    pixels = np.ones((*array.shape[:axes], 4), values.dtype)
    if is_grey:
        pixels[..., :3] = values[..., None]
    else:
        pixels[..., : array.shape[-1]] = values
    return pixels
