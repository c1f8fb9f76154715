"""Which members of a smooth union have no effect in a cell.

Input: the distances of a cell's middle to its members, in the order in which they are joined.
Output: the members that may matter in the cell.

With slope L and a cell of radius R, the difference of two distances changes by at most 2 L R in the
cell. Where the distance of a member and that of what is joined before differ by the width of the
blend or more, the blend is the minimum. So a member has no effect if it is farther by 2 L R + width
in the middle, and what is joined before has none if it is farther by as much.

Source: Barbier et al., "Lipschitz Pruning: Hierarchical Simplification of Primitive-Based SDFs",
Eurographics 2025.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.fields.combine.joins import UNION
from distal.lang.functions import Func
from distal.lang.runtime_access import executor
from distal.scene.lowering.smooth.chain import Link

Floats = NDArray[np.float64]
Whole = NDArray[np.int64]
Flags = NDArray[np.bool_]

# Up to so many members, the distance of what is joined before is computed; with more, bounds do.
MOST_JOINED: Final = 128
# A distance in place of none: farther than any.
NONE: Final = 1e30


class Joins:
    """How the members of a smooth union are joined.

    Attributes:
        widths: For each member, from which difference of distances on the blend is the minimum.
        slope: Lipschitz bound (slope) of all members, and so of the union.
    """

    def __init__(self, links: Sequence[Link], widths: Floats, slope: float) -> None:
        self.widths = widths
        self.slope = slope
        known: dict[Hashable, int] = {}
        self._functions: list[tuple[Func, dict[str, Any]]] = []
        rule_of: dict[int, int] = {}
        self._rule = np.zeros(len(links), int)
        self._sizes = np.zeros(len(links))
        for i, link in enumerate(links):
            join = link.join
            if id(join) not in rule_of:
                choices = {n: getattr(v, "value", v) for n, v in join.constants.items()}
                key = (id(join.rule), *choices.items())
                if key not in known:
                    known[key] = len(known)
                    self._functions.append((join.rule.combine, choices))  # type: ignore[union-attr, arg-type]
                rule_of[id(join)] = known[key]
            self._rule[i] = rule_of[id(join)]
            if "smooth" in join.numbers:
                self._sizes[i] = float(join.numbers["smooth"].plain)  # type: ignore[arg-type]

    def joined(self, before: Floats, member: NDArray[np.int32], d: Floats) -> Floats:
        """Return the distances of unions.

        Args:
            before: The distances of what is joined before.
            member: The members.
            d: The distances of the members.
        """
        rules = self._rule[member]
        found = before.copy()
        for r, (function, choices) in enumerate(self._functions):
            chosen = np.flatnonzero(rules == r)
            if len(chosen):
                given: dict[str, Any] = {"a": before[chosen], "b": d[chosen], **choices}
                if function is not UNION.combine:
                    given["smooth"] = self._sizes[member[chosen]]
                found[chosen] = executor().call(function, (), given, device="reference")
        return found


def kept_members(
    joins: Joins, members: NDArray[np.int32], mask: Flags, d: Floats, reach: float
) -> Flags:
    """Return which members of lists may matter in the cells of the lists.

    Args:
        joins: How the members are joined.
        members: The lists, one in each row.
        mask: Which entries are members; the others come last.
        d: The distances of the cells' middles to the members.
        reach: The radius of the cells.
    """
    limit = 2.0 * joins.slope * reach + joins.widths[members]
    d = np.where(mask, d, NONE)
    if mask.shape[1] <= MOST_JOINED:
        nearest, loss = _joined_before(joins, members, mask, d), 0.0
    else:
        # What is joined is nearer than the nearest member by the largest width at most: where it
        # is nearer by as much, a member that is joined to it has no effect.
        nearest, loss = np.minimum.accumulate(d, axis=1)[:, :-1], float(joins.widths.max())
    farther = d[:, 1:] - nearest
    keep = mask.copy()
    keep[:, 1:] &= farther < limit[:, 1:]
    replaces = (farther <= -limit[:, 1:] - loss) & mask[:, 1:]
    # The last member that replaces what is joined before it; the first one of the list otherwise.
    number = np.arange(mask.shape[1])
    last = (replaces * number[1:]).max(axis=1, initial=0)
    kept: Flags = keep & (number >= last[:, None])
    return kept


def _joined_before(joins: Joins, members: NDArray[np.int32], mask: Flags, d: Floats) -> Floats:
    """Return the distance of what is joined before each member but the first."""
    before = np.full((len(d), d.shape[1] - 1), NONE)
    union = d[:, 0]
    for i in range(1, d.shape[1]):
        before[:, i - 1] = union
        here = np.flatnonzero(mask[:, i])
        union = union.copy()
        union[here] = joins.joined(union[here], members[here, i], d[here, i])
    return before
