"""The tree of boxes of parts that move, for one picture.

Input: kinds of parts, the order of their tree, values of parameters, a time. Output: the same tree
around the boxes at that time. Where the host does not compute it, as on pages, the tree has boxes
that hold the parts at all times.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.lang.composed import Composed
from distal.lang.resources import MovingBuffer
from distal.lang.runtime_access import executor
from distal.scene.lowering.parts.box_tree import BoxTree
from distal.scene.lowering.parts.kind_boxes import BoxOfKind, KindBounds, columns_of
from distal.scene.lowering.parts.kinds import PartKind

# The fewest parts of a kind whose boxes are computed for each picture, by a kernel of its own. The
# boxes of a smaller kind hold its parts at all times.
LEAST_REFITTED: Final = 16


def is_refitted(kind: PartKind) -> bool:
    """Return whether the boxes of a kind are computed for each picture."""
    return kind.moving and len(kind.members) >= LEAST_REFITTED


class MovingBoxes(MovingBuffer):
    """A tree of boxes that a host computes again for each picture.

    Attributes:
        order: The order of the tree.
        still: Low and high corners of boxes that hold the parts at all times, (n, 3) each.
        moving: Of the parts that are computed again: which they are, the function that returns
            their boxes, and the values of its parameters, one row for each part.
    """

    def __init__(
        self,
        swept: NDArray[np.float32],
        order: BoxTree,
        still: Sequence[NDArray[Any]],
        moving: Sequence[tuple[slice, Composed, Sequence[NDArray[np.float32]]]],
    ) -> None:
        super().__init__(swept)
        self.order, self.still, self.moving = order, tuple(still), tuple(moving)

    @classmethod
    def of_kinds(
        cls,
        swept: NDArray[np.float32],
        kinds: Sequence[PartKind],
        bounds: Sequence[KindBounds],
        order: BoxTree,
    ) -> MovingBoxes:
        """Return the tree of some parts.

        Args:
            swept: The tree around boxes that hold the parts at all times.
            kinds: The kinds of parts.
            bounds: Boxes of the parts of each kind that hold them at all times.
            order: The order of the tree.
        """
        still = [np.concatenate([getattr(b, c) for b in bounds]) for c in ("low", "high")]
        ends = np.cumsum([0, *(len(kind.members) for kind in kinds)])
        moving = [
            (slice(int(ends[k]), int(ends[k + 1])), BoxOfKind(kind), _packed(columns_of(kind)))
            for k, kind in enumerate(kinds)
            if is_refitted(kind)
        ]
        return cls(swept, order, still, moving)

    def at(self, params: Mapping[str, Any], time: float) -> NDArray[np.float32]:
        """Return the tree at a time; ``params`` are values of parameters by name."""
        low, high = (corner.copy() for corner in self.still)
        for own, boxes, columns in self.moving:
            found = executor().evaluate(boxes, columns, params, time)
            low[own], high[own] = found[0], found[1]
        return self.order.filled(low, high)


def _packed(columns: Sequence[NDArray[np.float64]]) -> list[NDArray[np.float32]]:
    return [np.asarray(column, np.float32) for column in columns]
