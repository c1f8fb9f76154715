"""Where the shapes of a scene were written.

Input: a scene. Output: ``ShapePlace`` records, each call once, in the order of the source. Needs
the standard library alone.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from pathlib import Path

from distal.diagnostics import Span
from distal.editor.literals import utf16_length
from distal.editor.messages import ShapePlace
from distal.scene.scene import Scene
from distal.scene.tree.node import Node

MOST_SHAPES = 2000


def shapes_of(scene: Scene, files: Collection[str]) -> tuple[ShapePlace, ...]:
    """Return the places of a scene's shapes.

    Args:
        scene: The scene.
        files: The names of the author's files, without folders; shapes of others are left out.
    """
    found: dict[tuple[str, int, int], ShapePlace] = {}
    for node in scene.shape.node.walk():
        for place in _places(node, files):
            found.setdefault((place.file, place.line, place.start), place)
        if len(found) >= MOST_SHAPES:
            break
    return tuple(sorted(found.values(), key=lambda p: (p.file, p.line, p.start)))


def _places(node: Node, files: Collection[str]) -> Iterator[ShapePlace]:
    span = node.place
    if span is None or Path(span.file).name not in files:
        return
    yield ShapePlace(
        name=node.name,
        label=bool(node.label),
        file=Path(span.file).name,
        line=span.line,
        start=column(span, span.col),
        end=column(span, span.end_col),
        material=getattr(node.material, "name", "") or "",
    )


def column(span: Span, col: int) -> int:
    """Return a column of a span's line in UTF-16 units."""
    return utf16_length(span.text[:col])
