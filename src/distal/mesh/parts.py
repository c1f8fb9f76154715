"""Which shapes of the author's tree are at places in space: for messages.

Input: a tree and places. Output: nodes. Does not depend on meshes.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from distal.frontend import Assembly
from distal.ir.nodes import Param, Read, Return
from distal.ir.types import FLOAT, VEC3
from distal.lang.composed import Composed
from distal.lang.functions import Func
from distal.lang.runtime_access import executor
from distal.mesh.solid import Floats
from distal.scene.lowering.attributes import AttributePoint, Part, attribute
from distal.scene.lowering.parts.table import rolled_for
from distal.scene.lowering.shapes import ZERO_CELL, ShapeComposer
from distal.scene.tree.node import Node
from distal.scene.tree.values import StatementList


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


def leaves_at(node: Node, places: Floats, params: Mapping[str, Any], time: float) -> list[Node]:
    """Return the leaf of the tree at each place.

    Args:
        node: The tree.
        places: Of shape (n, 3).
        params: Values of parameters by name.
        time: Seconds.
    """
    if not len(places):
        return []
    part = PartAt(node)
    numbers = executor().call(part, (places,), {}, params=params, time=time)
    return [part.paths[int(number)][-1] for number in numbers]


def named(node: Node) -> str:
    """Return a shape's name and the author's line, for messages."""
    line = "" if node.place is None else f" (line {node.place.line})"
    return f"'{node.name}'{line}"
