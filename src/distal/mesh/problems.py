"""What prevents a mesh: the kinds of problems, found deep in the algorithm.

Input: a kind and a place in space. Output: an exception that ``extract`` turns into a message with
the shape's name, the author's line and what to write instead.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, TypeAlias

if TYPE_CHECKING:
    from distal.scene.lowering.placed_leaves import PlacedLeaf

Kind: TypeAlias = Literal["too many", "no number", "leaves its box", "too far"]


class MeshProblem(Exception):  # noqa: N818 (no message: only a kind)
    """A shape cannot be meshed.

    Attributes:
        kind: What is wrong.
        place: Where, in scene units; None if it is not at one place.
    """

    def __init__(self, kind: Kind, place: tuple[float, ...] | None = None) -> None:
        super().__init__(kind)
        self.kind: Kind = kind
        self.place = place


class ThinWall(MeshProblem):
    """A wall or a gap between two leaves is so thin that it needs too many cells.

    Attributes:
        thickness: About how thick it is.
        leaves: The leaves on its two sides.
    """

    def __init__(
        self, place: tuple[float, ...], thickness: float, leaves: tuple[PlacedLeaf, PlacedLeaf]
    ) -> None:
        super().__init__("too many", place)
        self.thickness = thickness
        self.leaves = leaves
