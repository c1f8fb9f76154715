"""Whether there is anything of a shape that parameters may hide.

Input: conditions for the children of an operator, None for one that always holds. Output: that for
the result. They are expressions of numbers alone, which every target computes once per frame.
"""

from __future__ import annotations

from typing import Final

from distal.fields.extents import overlap
from distal.fields.guarantees import Growth, Operator
from distal.ir.build import boolean, both, either, negation, select
from distal.ir.nodes import Expr

NEVER: Final = boolean(False)
ALWAYS: Final = boolean(True)


def exists_of_either(a: Expr | None, b: Expr | None, second: Expr) -> Expr | None:
    """Return whether the selected one of two shapes exists; None if it always does."""
    if a is None and b is None:
        return None
    if a is NEVER and b is None:
        return second
    if b is NEVER and a is None:
        return negation(second)
    return select(second, b or ALWAYS, a or ALWAYS)


def exists_after(rule: Operator, a: Expr | None, b: Expr | None) -> Expr | None:
    """Return whether there is anything after an operator on two shapes; None if there always is.

    Args:
        rule: The operator.
        a: Whether the first shape exists.
        b: Whether the second does.
    """
    if rule.cuts or rule.growth is Growth.FIRST:
        return a
    if rule.bounds is overlap:
        if a is None or b is None:
            return b if a is None else a
        return both(a, b)
    return None if a is None or b is None else either(a, b)
