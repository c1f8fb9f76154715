"""The part map of a scene: which shape of the author's tree each pixel shows.

Input: a scene. Output: an image of numbers, and the shapes that the numbers stand for. Needs the
standard library alone.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, ClassVar

from distal.frontend import Assembly
from distal.ir.build import field
from distal.ir.nodes import EntryKind, Param, Read, Return
from distal.ir.types import FRAME, VEC4
from distal.lang.composed import Composed
from distal.lang.functions import Func
from distal.loading import copy_loaded_from
from distal.render.part_map import part_bytes
from distal.scene.lowering.attributes import Part
from distal.scene.lowering.picture import SceneLowering
from distal.scene.tree.node import Node
from distal.scene.tree.values import StatementList

if TYPE_CHECKING:
    from distal.scene.scene import Scene


class PartMap(Composed):
    """The image of the numbers; the camera is moved by the numbers of a ``Steering``.

    Attributes:
        parts: By number, once it is composed: the nodes of ``attributes.Part.paths``.
    """

    kind: ClassVar[EntryKind] = EntryKind.IMAGE
    signature = (("frame", FRAME),)
    result = VEC4

    def __init__(self, scene: Scene) -> None:
        copy_loaded_from(scene, self)
        self.name = f"{scene.name} (part map)"
        self._scene = scene
        self.parts: Sequence[tuple[Node, ...]] = ()

    def compose(self, assembly: Assembly) -> str:
        """Add the function that maps the frame to the bytes of a number, and return its name."""
        body = StatementList(taken={"frame"})
        made = SceneLowering(assembly, self._scene)
        frame = Read("frame", FRAME)
        given = made.given(body, field(frame, "resolution"), steered=True)
        given["coord"] = field(frame, "coord")
        part = Part(made.composer)
        given["part"] = made.known_of_place("part", part)
        self.parts = part.paths
        body.statements.append(Return(made.composer.call(part_bytes, given)))
        params = (Param("frame", FRAME),)
        return assembly.define("part_map", params, VEC4, body.statements, self._scene.place)

    def functions(self) -> Iterable[Func]:
        """Yield the scene functions that the scene calls."""
        return self._scene.functions()


def path_in(root: Node, path: Sequence[Node]) -> tuple[Node, ...]:
    """Return the nodes from the author's root to a leaf; the first way if there are several.

    Args:
        root: The author's tree.
        path: A leaf after nodes of the lowered tree above it; some are not the author's.
    """
    above = _parents(root)
    own = _own(path, above, root)
    found = [own[0]] if own else [root]
    while found[-1] is not root:
        found.append(above[id(found[-1])][0])
    return (*reversed(found), *own[1:])


def holders(root: Node, paths: Iterable[Sequence[Node]]) -> Iterator[tuple[Node, ...]]:
    """Yield for each path all of the author's nodes that hold its leaf, the leaf among them.

    A shape that is used several times is held by what leads to this use of it alone, where the
    lowered tree tells that.

    Args:
        root: The author's tree.
        paths: Leaves after nodes of the lowered tree above them.
    """
    above = _parents(root)
    for path in paths:
        own = _own(path, above, root)
        found = {id(node): node for node in own}
        gaps = zip([None, *own], own, strict=False)
        waiting = [node for before, node in gaps if before not in above.get(id(node), ())]
        while waiting:
            for node in above.get(id(waiting.pop()), ()):
                if id(node) not in found:
                    found[id(node)] = node
                    waiting.append(node)
        yield tuple(found.values())


def _parents(root: Node) -> dict[int, list[Node]]:
    parents: dict[int, list[Node]] = {}
    for node in root.walk():
        for child in node.children:
            parents.setdefault(id(child), []).append(node)
    return parents


def _own(path: Sequence[Node], above: dict[int, list[Node]], root: Node) -> list[Node]:
    """Return the end of a path from its first node of the author's tree on."""
    return [node for node in path if id(node) in above or node is root]
