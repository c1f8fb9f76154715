"""Which shape each pixel shows, and the lines that make it: the answer of ``map``.

Input: a scene. Output: a program that draws the number of a part in each pixel, and for each number
the author's lines. Needs the standard library alone.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import PurePath

from distal.editor.messages import ShapeMap
from distal.export.page_programs import PagePrograms, compiled
from distal.scene.lowering.part_map import PartMap, holders
from distal.scene.tree.node import Node
from distal.scene.viewing.viewable import Viewable


def shape_map(seen: Viewable, files: Sequence[str]) -> ShapeMap:
    """Return the program that draws which shape each pixel shows.

    Args:
        seen: The scene.
        files: The author's files.

    Raises:
        CompileError: WebGL 2 cannot express it.
    """
    assert seen.scene is not None
    image = PartMap(seen.scene)
    artifact, module = compiled(image)
    made = holders(seen.scene.shape.node, image.parts)
    return ShapeMap(
        program=PagePrograms(seen).program(artifact, module),
        files=tuple(files),
        parts=tuple(tuple(sorted(set(_lines(nodes, files)))) for nodes in made),
    )


def _lines(nodes: Sequence[Node], files: Sequence[str]) -> Iterator[tuple[int, int]]:
    for node in nodes:
        if node.place is not None and (name := PurePath(node.place.file).name) in files:
            yield files.index(name), node.place.line
