"""What prevents a mesh: the kinds of problems, found deep in the algorithm.

Input: a kind and a place in space. Output: an exception that ``extract`` turns into a message with
the shape's name, the author's line and what to write instead.
"""

from __future__ import annotations

from typing import Literal, TypeAlias

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
