"""Flat shapes from pictures: the author's file or array, as a node.

Input: a picture, and what of it is inside. Output: a node that every target compiles: distances in
a texture.
"""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.diagnostics import Span
from distal.fields.flats import profiles as _declares_the_field  # noqa: F401
from distal.fields.guarantees import PRIMITIVES, Limit
from distal.images.picture import Picture
from distal.ir.types import FLOAT, INT
from distal.lang.lazy_module import LazyModule
from distal.lang.resources import Texture2D
from distal.scene.objects.binding import bound
from distal.scene.objects.images import texture_light
from distal.scene.tree.conversion import Asked, beside, number, plain_choice
from distal.scene.tree.errors import refuse, refuse_kind
from distal.scene.tree.node import Node

if TYPE_CHECKING:
    from distal.polygons import pictures
else:
    pictures = LazyModule("distal.polygons.pictures")

Floats = NDArray[np.float64]
WHAT: Final = "from_image"
_INSIDE: Final = ("auto", "dark", "bright", "opaque")
_LUMA: Final = np.array([0.2126, 0.7152, 0.0722])
_FEWEST, _MOST = 2, 4096


def picture_node(
    source: Any,
    place: Span | None,
    *,
    width: Any,
    inside: Any,
    level: Any,
    samples: Any,
    max_memory: Any = None,
) -> Node:
    """Return the node of a picture; see ``Shape2D.from_image``.

    Args:
        source: A file, an array, a ``Picture`` or a texture.
        place: The author's line.
        width: The width of the picture in scene units.
        inside: What is inside, one of ``_INSIDE``.
        level: The share at the edge.
        samples: The most distances along the longest side.
        max_memory: The most bytes that a file may become, or None.

    Raises:
        SceneValueError: The picture cannot be read, a number is beyond its limit, or nothing is
            inside.
        SceneTypeError: The value does not hold a picture.
    """
    wide = _plain(width, Asked("width", WHAT, FLOAT, Limit.POSITIVE, place=place))
    at = _plain(level, Asked("level", WHAT, FLOAT, place=place))
    if not 0.0 < at < 1.0:
        refuse(f"'level of {WHAT}' must be between 0 and 1, not {at:g}", None, place)
    most = plain_choice(samples, Asked("samples", WHAT, INT, place=place))
    if not _FEWEST <= most <= _MOST:
        refuse(f"'samples of {WHAT}' must be {_FEWEST} to {_MOST}, not {most}", None, place)
    if inside not in _INSIDE:
        refuse(f"inside is one of {', '.join(_INSIDE)}, not {inside!r:.40}", None, place)
    kind, shares = _shares(_pixels(source, place, max_memory), inside)
    across = shares.shape[1]
    shares, side = pictures.reduced(shares, most)
    pixel = side * wide / across
    try:
        found = pictures.signed_distances(np.pad(shares, 1), at)
    except ValueError:
        others = " or ".join(f'"{name}"' for name in _INSIDE[1:] if name != kind)
        hint = f"take another level, or inside={others}"
        refuse(f"nothing of {_named(source)} is {kind} enough to be inside", hint, place)
    rows, columns = found.shape
    texture = Texture2D((found * pixel).astype(np.float32), wrap="clamp")
    given = (texture, (columns * pixel, rows * pixel), 1.0)
    rule = PRIMITIVES["ImageField"]
    numbers, constants = bound(rule, given, {}, place)
    return Node(rule, True, (), numbers, constants, place)


def _plain(value: Any, asked: Asked) -> float:
    found = number(value, asked).plain
    if not isinstance(found, float):
        hint = ".scale(slider(…)) changes its size" if asked.name == "width" else None
        refuse_kind(f"'{asked.label}' is data: a plain number", hint, asked.place)
    return found


def _pixels(source: Any, place: Span | None, max_memory: Any) -> NDArray[np.float32]:
    """Return a picture's values, (rows, columns, 4), top row first: for display, or light."""
    if isinstance(source, Picture):
        held = Texture2D(source.linear)  # its soft edges are mixed as light
    elif isinstance(source, Texture2D):
        held = source
    elif isinstance(source, str | PathLike):
        held = Texture2D(beside(source, place), max_memory=max_memory)
    elif hasattr(source, "dtype") and getattr(source, "ndim", 0) in (2, 3):
        held = Texture2D(source)
    else:
        refuse_kind(
            f"{WHAT} takes a picture, not {type(source).__name__} {source!r:.40}",
            "a picture's file, an array (height, width) or (height, width, 3 or 4), or a Picture",
            place,
        )
    pixels = texture_light(held, WHAT, place)
    if not all(np.isfinite(row).all() for row in pixels):
        refuse(f"a pixel of {_named(source)} is no finite number", None, place)
    return pixels


def _shares(pixels: NDArray[np.float32], inside: str) -> tuple[str, Floats]:
    """Return what is inside, and how much of each pixel is so, from 0 to 1.

    Args:
        pixels: The picture.
        inside: One of ``_INSIDE``.
    """
    kind = inside
    if inside == "auto":
        kind = "opaque" if any((row[:, 3] < 1.0).any() for row in pixels) else "dark"
    shares = np.empty(pixels.shape[:2])
    for share, row in zip(shares, pixels, strict=True):
        share[...] = _shares_of_row(row.astype(np.float64), kind)
    return kind, shares


def _shares_of_row(row: Floats, kind: str) -> Floats:
    opaque: Floats = np.clip(row[:, 3], 0.0, 1.0)
    bright: Floats = np.clip(row[:, :3] @ _LUMA, 0.0, 1.0)
    match kind:
        case "opaque":
            return opaque
        case "bright":
            return bright * opaque
        case _:
            return (1.0 - bright) * opaque


def _named(source: Any) -> str:
    return f"'{Path(source).name}'" if isinstance(source, str | PathLike) else "the picture"
