"""How far blends move faces where their shapes have no edge, as findings.

Input: the node of a blend, the boxes of its shapes. Output: the largest movement, and its place. A
face that two shapes share, in one plane, is found at random places. That of prisms that are thinner
than a profile is wide is computed from their boxes.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.fields.combine import joins
from distal.fields.combine.blends import BLENDS, COMBINATIONS, FLAT_UNIONS, PRISMS
from distal.fields.guarantees import Operator
from distal.lang.expressions import Expression
from distal.lang.runtime_access import executor
from distal.scene.checks.bounds_report import NodeBounds
from distal.scene.checks.measuring import InterpretedParts
from distal.scene.lowering.derived import DistanceOf, GradientOf
from distal.scene.tree.node import Node

Floats = NDArray[np.float64]

# The most shapes that are looked at, the number of places, and of those from which the face is
# followed.
MOST_SHAPES: Final = 24
PLACES: Final = 4096
FOLLOWED: Final = 64
STEPS: Final = 3
HALVINGS: Final = 30
# Faces look the same way if the cosine of their angle is larger: 1 degree.
PARALLEL: Final = 0.99985
# How near to both faces a place must be, and which movement is none, in sizes of the blend.
NEAR: Final = 1e-4
LEAST: Final = 2e-3
# How far around such a place there must be no edge, in sizes of the blend.
BESIDE: Final = 1.05
# From which distance on a blend has no effect, in sizes: the largest of those that end.
REACH: Final = 6.0


@dataclass(frozen=True, slots=True)
class BlendKind:
    """What a blend does to values.

    Attributes:
        name: That of the blend: "round".
        sharp: The operator without the blend.
        outwards: 1 if it moves faces outwards, -1 if inwards.
        second: -1 if the second shape is subtracted, else 1.
    """

    name: str
    sharp: Operator
    outwards: float
    second: float

    @property
    def keeps_faces(self) -> bool:
        """Whether the blend should move no face: a fillet or a chamfer."""
        return BLENDS[self.name].cut

    def sign(self, number: int) -> float:
        """Return -1 for a shape that is subtracted, else 1."""
        return self.second if number else 1.0


def _kinds() -> dict[Operator, BlendKind]:
    found: dict[Operator, BlendKind] = {}
    for (sharp, name), rule in COMBINATIONS.items():
        kinds = {
            "union": BlendKind(name, joins.UNION, 1.0, 1.0),
            "intersection": BlendKind(name, joins.INTERSECTION, -1.0, 1.0),
            "difference": BlendKind(name, joins.DIFFERENCE, -1.0, -1.0),
        }
        if name in BLENDS and sharp in kinds:
            of_rule = (rule, FLAT_UNIONS.get(rule, rule), *PRISMS.get(rule, ()))
            found |= dict.fromkeys(of_rule, kinds[sharp])
    return found


_KINDS: Final = _kinds()
OF_PRISMS: Final = frozenset(rule for pair in PRISMS.values() for rule in pair)


@dataclass(frozen=True, slots=True)
class MovedFace:
    """The largest movement of a face.

    Attributes:
        kind: What the blend does.
        size: The size of the blend.
        amount: How far the face moves; infinite if nothing remains.
        place: Where; None if all of the face does.
        half: Half the thickness between the faces that both prisms share, if it is too small for
            the profile; else None.
    """

    kind: BlendKind
    size: float
    amount: float
    place: tuple[float, ...] | None
    half: float | None = None

    def text(self, name: str) -> tuple[str, str]:
        """Return a message, and what to write instead.

        Args:
            name: The shape.
        """
        way = "outwards" if self.kind.outwards > 0.0 else "inwards"
        message = f"{name} moves faces {way} by up to {self.amount:.3g}"
        if self.half is not None:
            if self.amount == math.inf:
                message = f"{name} leaves nothing"
            thickness = f"both shapes end in the same planes, {2.0 * self.half:.4g} apart"
            return f"{message}: {thickness}", f"a size of at most {self.half:.4g}, half of that"
        assert self.place is not None
        at = ", ".join(f"{c:.4g}" for c in self.place)
        message += f", at ({at}), where two shapes share a face and have no edge"
        if self.kind.outwards < 0.0:
            hint = f"let one of the two reach beyond the face, by {self.size:.4g} or more"
        elif self.kind.keeps_faces:
            hint = "fillet these two alone, and then unite them with the others"
        else:
            hint = "fillet(radius) leaves faces that lie in a side of the box around both"
        return message, hint


def moved_face(
    node: Node,
    declared: Mapping[int, NodeBounds],
    params: Mapping[str, Any],
    time: float,
    seed: int,
) -> MovedFace | None:
    """Return how far a blend moves a face that is no edge; None if it moves none.

    Args:
        node: The node of the blend.
        declared: The bounds of its shapes, by the ids of their nodes.
        params: Values of parameters by name.
        time: Time in seconds.
        seed: Seed of the random places.
    """
    kind = _KINDS.get(node.rule)  # type: ignore[arg-type]  # None for a primitive
    if kind is None or "smooth" not in node.numbers or not 2 <= len(node.children) <= MOST_SHAPES:
        return None
    given = node.numbers["smooth"].value
    size = executor().value(given, params, time) if isinstance(given, Expression) else given
    assert isinstance(size, float)
    boxes = [declared[id(child)] for child in node.children]
    thin = _thin_prism(node, kind, boxes, size)
    if thin is not None:
        return thin
    n = 2 if node.flat else 3
    pairs = combinations([(box.low[:n], box.high[:n]) for box in boxes], 2)
    regions = [region for a, b in pairs if (region := _where_both_end(a, b, 2.0 * size))]
    if size <= 0.0 or not regions:
        return None
    random = np.random.default_rng(seed)
    count = -(-PLACES // len(regions))
    p = np.concatenate([random.uniform(*region, (count, n)) for region in regions])
    return _FlushPlaces(node, kind, size, params, time).moved(p)


class _FlushPlaces:
    """A blend and its shapes, evaluated at places."""

    def __init__(
        self, node: Node, kind: BlendKind, size: float, params: Mapping[str, Any], time: float
    ) -> None:
        self._node, self._kind, self._size = node, kind, size
        self._parts = InterpretedParts(params, time)

    def _value(self, node: Node, p: Floats, what: Any = DistanceOf) -> Floats:
        return self._parts.values(node, p, what)

    def _blend(self, p: Floats) -> Floats:
        """Return the value of the blend, negative where it moved a face to or beyond a place."""
        return self._kind.outwards * self._value(self._node, p)

    def _flush(self, p: Floats) -> tuple[NDArray[np.bool_], Floats]:
        """Return which places are in a face that two shapes share, and the way out of it.

        An edge of either with a third shape is farther away than the blend reaches. What moves
        faces inwards also shapes the edges of the face: these are farther away, too.
        """
        node, kind = self._node, self._kind
        off, ways = [], []
        for n, child in enumerate(node.children):
            off.append(np.abs(self._value(child, p)))
            way = kind.sign(n) * self._value(child, p, GradientOf)
            ways.append(way / np.maximum(np.linalg.norm(way, axis=1), 1e-12)[:, None])
        away, out = np.array(off), np.array(ways)
        flush, found = np.zeros(len(p), bool), np.zeros_like(p)
        for i, j in combinations(range(len(out)), 2):
            shared = (away[[i, j]] < NEAR * self._size).all(axis=0)
            shared &= (out[i] * out[j]).sum(axis=1) > PARALLEL
            edge = (out[i] * out).sum(axis=2) <= PARALLEL
            shared &= ~(edge & (away < REACH * self._size)).any(axis=0) | (len(out) == 2)
            if kind.outwards < 0.0:
                shared[shared] = self._far_from_edges(i, j, p[shared], out[i][shared])
            found[shared] = out[i][shared]
            flush |= shared
        return flush, found

    def _far_from_edges(self, i: int, j: int, p: Floats, way: Floats) -> NDArray[np.bool_]:
        """Return around which places of a face two shapes remain the same, as far as a blend is."""
        same = np.ones(len(p), bool)
        aside = np.roll(way, 1, axis=1) * [1.0, -1.0, 1.0][: p.shape[1]]
        aside -= (aside * way).sum(axis=1, keepdims=True) * way
        aside /= np.maximum(np.linalg.norm(aside, axis=1, keepdims=True), 1e-12)
        across = np.cross(way, aside) if p.shape[1] == 3 else aside
        for angle in np.arange(8) * (0.25 * np.pi):
            around = np.cos(angle) * aside + np.sin(angle) * across
            q = p + BESIDE * self._size * around
            a, b = (self._kind.sign(n) * self._value(self._node.children[n], q) for n in (i, j))
            same &= np.abs(a - b) < NEAR * self._size
        return same

    def moved(self, p: Floats) -> MovedFace | None:
        """Return the largest movement of a face near random places."""
        node, kind, size = self._node, self._kind, self._size
        sharp = Node(kind.sharp, node.flat, node.children)
        for _ in range(STEPS):
            slope = self._value(sharp, p, GradientOf)
            step = self._value(sharp, p) / np.maximum((slope**2).sum(axis=1), 1e-12)
            p = p - step[:, None] * slope
        p = p[np.isfinite(p).all(axis=1)]
        flush, way = self._flush(p)
        p, way = p[flush], kind.outwards * way[flush]
        if not len(p):
            return None
        worst = np.argsort(self._blend(p))[:FOLLOWED]
        p, way = p[worst], way[worst]
        low, high = np.zeros(len(p)), np.full(len(p), size)
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            beyond = self._blend(p + middle[:, None] * way) < 0.0
            low, high = np.where(beyond, middle, low), np.where(beyond, high, middle)
        at = int(np.argmax(low))
        if low[at] < LEAST * size:
            return None
        return MovedFace(kind, size, float(low[at]), tuple(map(float, p[at])))


def _thin_prism(
    node: Node, kind: BlendKind, boxes: Sequence[NodeBounds], size: float
) -> MovedFace | None:
    """Return how far faces move between ends that both prisms share, if these are too near.

    In the middle between the ends, both distances are at most half the thickness.
    """
    if node.rule not in OF_PRISMS or size <= 0.0:
        return None
    along = node.numbers["along"].plain
    assert isinstance(along, tuple)
    a, b = boxes
    halves = [size]
    for i, is_prism in enumerate(along):
        low, high = max(a.low[i], b.low[i]), min(a.high[i], b.high[i])
        shared = abs(a.low[i] - b.low[i]) < size or abs(a.high[i] - b.high[i]) < size
        if is_prism and shared and low < high:
            halves.append(0.5 * (high - low))
    half = min(halves)
    if half >= size:
        return None
    amount = size - half
    if kind.name == "round":
        amount = size - math.sqrt(half * (2.0 * size - half))
    return MovedFace(kind, size, amount if amount <= half else math.inf, None, half)


def _where_both_end(
    a: tuple[Sequence[float], ...], b: tuple[Sequence[float], ...], margin: float
) -> tuple[Floats, Floats] | None:
    """Return a box around the places near both boxes; None if it is infinite or empty."""
    low = np.maximum(a[0], b[0]) - margin
    high = np.minimum(a[1], b[1]) + margin
    if not (np.isfinite([*low, *high]).all() and (low < high).all()):
        return None
    return low, high
