"""Whether an author's function has an inside: a sheet and an estimate of a distance have none.

Input: a leaf of the tree. Output: a decision, from samples, for the defaults of parameters at time
0. Rays are marched to the surface from around its box. Behind it, along the gradient, values of a
solid are negative; those of a sheet are not, and those of an estimate only here and there.
"""

from __future__ import annotations

from typing import Any, Final

from distal.fields.guarantees import Primitive
from distal.lang.runtime_access import executor
from distal.packages import PackageError, imported
from distal.scene.lowering.derived import DistanceOf, GradientOf
from distal.scene.lowering.known_bounds import known_bounds_of
from distal.scene.tree.node import Node

RAYS: Final = 256
STEPS: Final = 96
# A ray has arrived if the value is less than this part of the size; so far behind, and in so many
# steps, a value has to be negative.
NEAR: Final = 1e-3
BEHIND: Final = 4e-3
LOOKS: Final = 16
# The share of the rays that arrive, and the least number of them by which anything is said.
MOST: Final = 0.99
LEAST: Final = 16
# What has no box is looked at this far from the origin.
REACH: Final = 10.0


def has_inside(node: Node) -> bool:
    """Return whether an author's function is negative behind its surface.

    Without NumPy, and where too few rays arrive, it is taken for a solid.
    """
    try:
        np = imported("numpy")  # only what runs scene code needs it
    except PackageError:
        return True
    assert isinstance(node.rule, Primitive)
    known = known_bounds_of(node)
    count = 2 if node.flat else 3
    low, high = (np.clip(corner[:count], -REACH, REACH) for corner in (known.low, known.high))
    size = float(np.linalg.norm(high - low))
    if not size > 0.0:
        return True
    distance = DistanceOf(node)

    def values(points: Any) -> Any:
        return np.asarray(executor().call(distance, (points,), {}, device="reference"))

    with np.errstate(all="ignore"):
        places = _arrived(np, values, low, high, size, max(float(known.divisor), 1.0))
        if len(places) < LEAST:
            return True
        slope = np.asarray(executor().call(GradientOf(node), (places,), {}, device="reference"))
        n = slope / np.maximum(np.linalg.norm(slope, axis=1, keepdims=True), 1e-30)
        depths = size * BEHIND * np.arange(1, LOOKS + 1) / LOOKS
        behind = places[:, None] - depths[:, None] * n[:, None]
        found = values(behind.reshape(-1, count)).reshape(len(places), LOOKS)
        return float((found < 0.0).any(axis=1).mean()) >= MOST


def _arrived(np: Any, values: Any, low: Any, high: Any, size: float, divisor: float) -> Any:
    """Return the places where rays from around a box come near the surface."""
    drawn = np.random.default_rng(0)
    middle, count = 0.5 * (low + high), len(low)
    start = drawn.normal(size=(RAYS, count))
    start = middle + 0.6 * size * start / np.linalg.norm(start, axis=1, keepdims=True)
    way = drawn.uniform(low, high, (RAYS, count)) - start
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    places, arrived = start, []
    for _ in range(STEPS):
        value = np.abs(values(places))
        near = value < NEAR * size
        arrived.append(places[near])
        places = places + (value / divisor)[:, None] * way
        goes = ~near & (np.linalg.norm(places - start, axis=1) < 2.0 * size)
        places, start, way = places[goes], start[goes], way[goes]
        if not len(places):
            break
    return np.concatenate(arrived)
