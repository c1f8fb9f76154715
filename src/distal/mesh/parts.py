"""Which shapes of the author's tree are at places in space: for messages.

Input: a tree and places. Output: shapes with the author's names. Does not depend on meshes.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Final

from distal.frontend import Assembly
from distal.ir.nodes import Param, Read, Return
from distal.ir.types import FLOAT, VEC3
from distal.lang.composed import Composed
from distal.lang.functions import Func
from distal.lang.runtime_access import executor
from distal.mesh.solid import Floats
from distal.scene.lowering.attributes import AttributePoint, Part, attribute
from distal.scene.lowering.part_map import path_in
from distal.scene.lowering.parts.table import rolled_for
from distal.scene.lowering.shapes import ZERO_CELL, ShapeComposer
from distal.scene.tree.node import Node
from distal.scene.tree.part_names import PlacedPart
from distal.scene.tree.values import StatementList

# The name under which a tree keeps its ``PartAt``.
PARTS: Final = "parts"


class PartAt(Composed):
    """The number of the leaf that a place belongs to, as a function of a point.

    Attributes:
        paths: By number, once it is composed: the leaf, after the nodes above it.
    """

    signature = (("p", VEC3),)
    result = FLOAT

    def __init__(self, node: Node) -> None:
        self._node = node
        self.name = f"parts of {node.name}"
        self.paths: Sequence[tuple[Node, ...]] = ()

    def compose(self, assembly: Assembly) -> str:
        """Add the function to the program, and return its name."""
        node = rolled_for(assembly, self._node)
        composer = ShapeComposer(assembly, [node])
        body = StatementList({"p"})
        part = Part(composer)
        point = AttributePoint(Read("p", VEC3), ZERO_CELL, composer.values.all(node))
        value = attribute(body, part, node, point)
        self.paths = part.paths
        body.statements.append(Return(value))
        return assembly.define("part_at", (Param("p", VEC3),), FLOAT, body.statements, node.place)

    def functions(self) -> Iterable[Func]:
        """Yield the scene functions that the shape calls."""
        return self._node.functions()

    def at(self, places: Floats, params: Mapping[str, Any], time: float) -> list[PlacedPart]:
        """Return what of the tree is at each place; see ``parts_at``."""
        numbers = executor().call(self, (places,), {}, params=params, time=time)
        found: dict[int, PlacedPart] = {}
        for number in {int(number) for number in numbers}:
            path = self.paths[number]
            # A table of parts has not all nodes of the author's tree.
            above = (*reversed(path), *reversed(path_in(self._node, path)))
            label = next((holder.label for holder in above if holder.label), "")
            found[number] = PlacedPart(path[-1], label)
        return [found[int(number)] for number in numbers]


def parts_at(
    node: Node, places: Floats, params: Mapping[str, Any], time: float
) -> list[PlacedPart]:
    """Return what of the tree is at each place.

    Args:
        node: The tree.
        places: Of shape (n, 3).
        params: Values of parameters by name.
        time: Seconds.
    """
    if not len(places):
        return []
    return node.derived(PARTS, lambda: PartAt(node)).at(places, params, time)


def part_at(node: Node, place: Floats, params: Mapping[str, Any], time: float) -> PlacedPart:
    """Return what of a tree is at a place."""
    return parts_at(node, place[None], params, time)[0]
