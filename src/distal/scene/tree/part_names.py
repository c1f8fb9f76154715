"""What messages call a part of a tree: the author's name, the kind of the shape, the line.

Input: a leaf and its label. Output: a text.
"""

from __future__ import annotations

from dataclasses import dataclass

from distal.scene.tree.node import Node


@dataclass(frozen=True, slots=True)
class PlacedPart:
    """What is at a place.

    Attributes:
        leaf: The shape of the library.
        label: The author's name that is nearest to it, its own or of what holds it; "" without any.
    """

    leaf: Node
    label: str

    @property
    def line(self) -> int | None:
        """The author's line; None if it is not known."""
        return None if self.leaf.place is None else self.leaf.place.line

    @property
    def text(self) -> str:
        """The author's name, the kind of the shape and the line, for messages."""
        kind = self.leaf.rule.name
        return _with_line(f"{self.label} ({kind})" if self.label else kind, self.line)


def named(node: Node) -> str:
    """Return a shape's name and the author's line, for messages."""
    return _with_line(node.name, None if node.place is None else node.place.line)


def _with_line(name: str, line: int | None) -> str:
    return f"'{name}'" if line is None else f"'{name}' (line {line})"
