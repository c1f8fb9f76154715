"""Letters and drawings as flat shapes: ``Text`` and ``SvgPath``.

Input: a text, or an SVG path. Output: flat shapes, exact outside, which can be extruded, engraved
and combined like any other. ``lettering`` and ``outlines`` read fonts and paths; they are imported
only when such a shape is made.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from distal.diagnostics import Span
from distal.fields.flats.outlines import OUTLINE
from distal.lang.lazy_module import LazyModule
from distal.lang.source_places import author_place
from distal.scene.objects.field import BaseShape
from distal.scene.objects.shape import Shape2D
from distal.scene.tree.node import Node
from distal.scene.tree.value import recorded

if TYPE_CHECKING:
    from distal.scene.objects import lettering, outlines
else:
    lettering = LazyModule("distal.scene.objects.lettering")  # needs fonts and NumPy
    outlines = LazyModule("distal.scene.objects.outlines")  # needs NumPy


@recorded
class Text(Shape2D):
    r"""Text in a font, as a flat shape; the middle of capital letters is at y = 0.

    Args:
        text: The text; "\n" starts a new line.
        font: The font's file, or the name of an installed font; None for a default font.
        size: Font size; capital letters are about 0.7 times as high.
        justify: Position of x = 0 in each line: "left", "center" or "right".
        line_spacing: Distance between lines, as a multiple of ``size``.

    Raises:
        CompileError: At the author's line: the text is blank, or the font or a letter is missing.
    """

    # The arguments, of which ``recorded`` makes attributes.
    text: Any
    font: Any
    size: Any
    justify: Any
    line_spacing: Any

    def __init__(
        self,
        text: str,
        *,
        font: str | os.PathLike[str] | None = None,
        size: float = 1.0,
        justify: str = "center",
        line_spacing: float = 1.2,
    ) -> None:
        place = author_place()
        outline = lettering.text_outline(
            text, font=font, size=size, justify=justify, line_spacing=line_spacing, place=place
        )
        BaseShape.__init__(self, _node(outline, place, even_odd=False))


@recorded
class SvgPath(Shape2D):
    """The area enclosed by an SVG path; y points up, and the middle is at the origin.

    Args:
        path: The value of the path's attribute ``d``: "M 0 0 L 10 0 …".
        size: The larger of width and height; None keeps the drawing's own units.
        even_odd: Whether to fill by the even-odd rule, instead of the nonzero rule.

    Raises:
        CompileError: At the author's line, if the path cannot be read.
    """

    # The arguments, of which ``recorded`` makes attributes.
    path: Any
    size: Any
    even_odd: Any

    def __init__(self, path: str, *, size: float | None = None, even_odd: bool = False) -> None:
        place = author_place()
        outline = outlines.svg_path(path, size=size, place=place)
        BaseShape.__init__(self, _node(outline, place, even_odd=bool(even_odd)))


def _node(outline: Any, place: Span | None, *, even_odd: bool) -> Node:
    constants = {"lines": outline.lines, "curves": outline.curves, "even_odd": even_odd}
    return Node(OUTLINE, True, (), {}, constants, place)
