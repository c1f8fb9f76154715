"""Components of a vector in the order of their size: mirror folds at diagonal planes.

Input: a vector. Output: the vector with its components exchanged. Does not depend on shapes.

``vec2(max(q.x, q.y), min(q.x, q.y))`` gives the same values, but where both components are equal,
``max`` and ``min`` both take the first: the derivative of such a fold is no mirror, and the
gradient of a shape on its diagonals does not have length 1. Here components are exchanged or kept,
so the derivative is a mirror everywhere.
"""

from __future__ import annotations

from distal.lang import func, select, vec2, vec3


@func
def larger_first(q: vec2) -> vec2:
    """Return the two components, the larger one first."""
    return select(q.y > q.x, q.yx, q)


@func
def largest_first(q: vec3) -> vec3:
    """Return the three components, from the largest to the smallest."""
    r = select(q.y > q.x, q.yxz, q)
    r = select(r.z > r.y, r.xzy, r)
    return select(r.y > r.x, r.yxz, r)
