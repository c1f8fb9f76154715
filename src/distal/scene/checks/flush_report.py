"""Cutters that end exactly on a face of what they cut: a skin without a thickness is left there.

Input: a tree, values of parameters, a time. Output: a ``FlushCut`` for each such cutter. Points are
moved onto the surfaces of the cutters, each below the operators that place it. Where a face of the
whole coincides with one, its value there is 0, and positive on both sides.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from distal.fields.combine.joins import COMPLEMENT, DIFFERENCE, UNION
from distal.fields.guarantees import Growth, Operator
from distal.lang import abs, func
from distal.lang.lazy_module import LazyModule
from distal.lang.runtime_access import executor
from distal.scene.checks.bounds_report import NodeBounds, bounds_of_nodes
from distal.scene.checks.measuring import own_values
from distal.scene.objects.field import BaseShape
from distal.scene.tree.node import Node

if TYPE_CHECKING:
    from distal.mesh import placed_leaves
    from distal.mesh.placed_leaves import PlacedLeaf
else:
    placed_leaves = LazyModule("distal.mesh.placed_leaves")

Points: TypeAlias = NDArray[np.float64]
Indices: TypeAlias = NDArray[np.intp]

MOST_LEAVES: Final = 400
_POINTS: Final = 1024  # for each cutter: half of them in its box, half beside the sides of the box
_MOST_POINTS: Final = 1 << 17
_BESIDE_BOX: Final = 0.02  # how far, as a share of the box
_STEPS: Final = 4  # Newton's, onto a surface
_TURNS: Final = 2  # onto the body and the cutter by turns
# As shares of the size of the cutters: how near to a surface a point of it is, how far apart faces
# are that coincide (measured extents, by which parts are put on each other, are as exact as that),
# and how far beside a point the signs are looked at.
_ON_SURFACE: Final = 1e-9
_SAME: Final = 2e-7
_BESIDE: Final = 4e-6
# Faces that only touch along a line have no such points beside them: so many are looked at, so far
# away as a share of the cutter's smallest side, and at least this share must be as the first.
_AROUND: Final = 16
_TRIED: Final = 8  # points of one cutter
_AWAY: Final = 0.02
_LEAST_SHARE: Final = 0.3


@func
def unsigned(d: float) -> float:
    """Return the distance from the surface of a shape, on both of its sides."""
    return abs(d)


_SURFACE: Final = Operator("surface", finish=unsigned, growth=Growth.UNKNOWN)


@dataclass(frozen=True, slots=True)
class FlushCut:
    """A cutter that ends exactly on a face.

    Attributes:
        cutter: The shape that cuts.
        body: The shape on whose face it ends; None if it is not known.
        place: A point of both faces, in the coordinates of the whole, or of the blend that both
            are a part of.
    """

    cutter: PlacedLeaf
    body: PlacedLeaf | None
    place: tuple[float, ...]

    @property
    def message(self) -> str:
        """What is wrong, in words."""
        face = "a face" if self.body is None else f"a face of {_named(self.body)}"
        return (
            f"{_named(self.cutter, lined=False)} ends exactly on {face}: whether a skin without a "
            "thickness is left there is a matter of rounding"
        )


def _named(placed: PlacedLeaf, *, lined: bool = True) -> str:
    """Return the author's name of a leaf, or its kind, and the line."""
    label = next((node.label for node in reversed(list(placed.chain())) if node.label), "")
    kind, place = placed.leaf.rule.name, placed.leaf.place
    name = f"'{label}' ({kind})" if label else f"'{kind}'"
    return f"{name} (line {place.line})" if lined and place is not None else name


def flush_cuts(
    root: Node, params: Mapping[str, Any], time: float, seed: int = 0
) -> tuple[FlushCut, ...]:
    """Return the cutters of a tree that end exactly on a face.

    Args:
        root: The tree. If it has more than ``MOST_LEAVES`` leaves, nothing is looked for.
        params: Values of parameters by name.
        time: Time in seconds.
        seed: Seed of the random points.
    """
    found: dict[int, FlushCut] = {}
    for whole in _wholes(root):
        for cut in _Cutters(whole, params, time, np.random.default_rng(seed)).flush():
            found.setdefault(id(cut.cutter.leaf), cut)
    return tuple(found.values())


def _wholes(root: Node) -> Iterator[Node]:
    """Yield the tree, and what blends join, if something is subtracted in it."""
    stack, seen = [root], set[int]()
    while stack:
        node = stack.pop()
        cuts = any(part.rule in (DIFFERENCE, COMPLEMENT) for part in node.walk())
        if id(node) in seen or not cuts:
            continue
        seen.add(id(node))
        leaves = placed_leaves.placed_leaves(node)
        if len(leaves) <= MOST_LEAVES:
            yield node
            stack.extend(child for placed in leaves for child in placed.leaf.children)


@dataclass(frozen=True, slots=True)
class _Cutters:
    """What is subtracted in a tree.

    Attributes:
        whole: The tree.
        params: Values of parameters by name.
        time: Time in seconds.
        random: Where points come from.
    """

    whole: Node
    params: Mapping[str, Any]
    time: float
    random: np.random.Generator

    def flush(self) -> Iterator[FlushCut]:
        """Yield those that end exactly on a face."""
        leaves = placed_leaves.placed_leaves(self.whole)
        cutters = [placed for placed in leaves if _subtracts(placed)]
        boxes = self._boxes(cutters)
        cutters = [placed for placed, box in zip(cutters, boxes, strict=True) if box is not None]
        held = [box for box in boxes if box is not None]
        bodies = [placed for placed in leaves if not _subtracts(placed)]
        if not cutters or not bodies:
            return
        surface, faces = self._surfaces(cutters), self._surfaces(bodies)
        size = max(float((high - low).max()) for low, high in held)
        least = np.array([float((high - low).min()) for low, high in held])
        count = min(_POINTS, _MOST_POINTS // len(held))
        owner = np.repeat(np.arange(len(held)), count)
        points = np.concatenate([self._around(low, high, count) for low, high in held])
        points, owner = self._onto(surface, points, owner)
        # The ends of a slender cutter are small: the rims of faces lead to them.
        rims, of = points, owner
        for _turn in range(_TURNS):
            rims, of = self._onto(faces, rims, of)
            rims, of = self._onto(surface, rims, of)
        rims, of = self._beside(rims, of, least)
        points, owner = np.concatenate([points, rims]), np.concatenate([owner, of])
        points, owner = self._touching(surface, points, owner, size)
        # Of those of one cutter the one that has the most of them beside it.
        order = np.lexsort((self.random.random(len(owner)), owner))
        _, first, rank = np.unique(owner[order], return_index=True, return_inverse=True)
        tried = order[np.arange(len(owner)) - first[rank] < _TRIED]
        points, owner = points[tried], owner[tried]
        share = self._share_beside(surface, points, owner, least, size)
        best = np.lexsort((-share, owner))
        owner, first = np.unique(owner[best], return_index=True)
        best = best[first]
        points = points[best[share[best] >= _LEAST_SHARE]]
        # Where two cutters end on each other, the later one is said to end on the other's face.
        for at, own, others in zip(
            points, self._at(cutters, points, size), self._at(bodies, points, size), strict=True
        ):
            face = [*others, *reversed(own[:-1])]
            if own:
                yield FlushCut(own[-1], face[0] if face else None, tuple(at.tolist()))

    def _boxes(self, cutters: Sequence[PlacedLeaf]) -> list[tuple[Points, Points] | None]:
        """Return the part of each cutter's box that is in the box of the whole; None if empty."""
        trees = tuple(map(_uncomplemented, cutters))
        union = Node(UNION, self.whole.flat, (self.whole, *trees))
        declared = bounds_of_nodes(union, self.params, self.time)
        n = 2 if self.whole.flat else 3

        def within(own: NodeBounds) -> tuple[Points, Points] | None:
            box = declared[id(self.whole)]
            low = np.maximum(own.low[:n], box.low[:n])
            high = np.minimum(own.high[:n], box.high[:n])
            valid = np.isfinite(high - low).all() and (low < high).all()
            return (low, high) if valid else None

        return [within(declared[id(tree)]) for tree in trees]

    def _around(self, low: Points, high: Points, count: int) -> Points:
        """Return points in a box, and points beside its sides, as many at each: ends are small."""
        n = len(low)
        points = self.random.uniform(low, high, (count, n))
        side = np.arange(count // 2) % (2 * n)
        rows, axis, upper = np.arange(count // 2), side // 2, side % 2 == 1
        beside = _BESIDE_BOX * (high - low)[axis]
        points[rows, axis] = np.where(upper, high[axis] + beside, low[axis] - beside)
        return points

    def _given(self, shape: Any) -> dict[str, Any]:
        """Return the time, and the values of the parameters that a shape has."""
        return {"params": own_values(shape, self.params), "time": self.time}

    def _surfaces(self, leaves: Sequence[PlacedLeaf]) -> Any:
        """Return the distance from the nearest surface of some leaves."""
        surfaces = tuple(_below(_SURFACE, placed.tree) for placed in leaves)
        one = surfaces[0] if len(surfaces) == 1 else Node(UNION, self.whole.flat, surfaces)
        return BaseShape._of(one)

    def _onto(self, surface: Any, points: Points, owner: Indices) -> tuple[Points, Indices]:
        """Return points moved onto a surface, without those that have left everything."""
        given = self._given(surface)
        for _step in range(_STEPS):
            value, slope = surface(points, **given), surface.gradient(points, **given)
            square = np.maximum((slope * slope).sum(axis=1), 1e-12)
            points = points - slope * (value / square)[:, None]
            valid = np.isfinite(points).all(axis=1)
            points, owner = points[valid], owner[valid]
        return points, owner

    def _beside(
        self, points: Points, owner: Indices, least: Points, count: int = 1
    ) -> tuple[Points, Indices]:
        """Return places beside points, some for each.

        Args:
            points: The points.
            owner: The cutter of each.
            least: The smallest side of each cutter.
            count: How many places there are for each point.
        """
        points, owner = np.repeat(points, count, axis=0), np.repeat(owner, count)
        away = self.random.normal(0.0, _AWAY, points.shape) * least[owner][:, None]
        return points + away, owner

    def _touching(
        self, surface: Any, points: Points, owner: Indices, size: float
    ) -> tuple[Points, Indices]:
        """Return the points, moved onto the cutters, at which a face of the whole coincides."""
        given = self._given(surface)
        points, owner = self._onto(surface, points, owner)
        on = surface(points, **given) <= _ON_SURFACE * size
        points, owner = points[on], owner[on]
        # On the surface the gradient may be 0 or noise; beside it, it is not.
        aside = self.random.normal(0.0, 0.1 * _BESIDE * size, points.shape)
        normal = surface.gradient(points + aside, **given)
        normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-12)[:, None]
        whole = BaseShape._of(self.whole)
        given = self._given(whole)
        touches = np.abs(whole(points, **given)) <= _SAME * size
        for side in (-1.0, 1.0):
            touches &= whole(points + side * _BESIDE * size * normal, **given) > 0.0
        return points[touches], owner[touches]

    def _share_beside(
        self, surface: Any, points: Points, owner: Indices, least: Points, size: float
    ) -> Points:
        """Return how many of the places beside each point are like it, as a share."""
        number = np.arange(len(points))
        around, number = self._beside(points, number, least[owner], _AROUND)
        _, alike = self._touching(surface, around, number, size)
        return np.bincount(alike, minlength=len(points)) / _AROUND

    def _at(
        self, leaves: Sequence[PlacedLeaf], points: Points, size: float
    ) -> list[list[PlacedLeaf]]:
        """Return the leaves whose surface passes through each point."""
        found: list[list[PlacedLeaf]] = [[] for _ in points]
        for placed in leaves if len(points) else ():
            shape = BaseShape._of(placed.tree)
            # Interpreted: to compile hundreds of leaves takes longer.
            values = executor().call(shape, (points,), {}, device="reference", **self._given(shape))
            for row in np.flatnonzero(np.abs(np.asarray(values)) <= _SAME * size):
                found[row].append(placed)
        return found


def _subtracts(placed: PlacedLeaf) -> bool:
    return any(node.rule is COMPLEMENT for node in placed.chain())


def _below(rule: Operator, child: Node) -> Node:
    return Node(rule, child.flat, (child,), place=child.place)


def _uncomplemented(placed: PlacedLeaf) -> Node:
    """Return the tree of a leaf that is not turned inside out, so that it has a box."""
    tree = placed.leaf
    for node in reversed(list(placed.chain())[:-1]):
        if node.rule is not COMPLEMENT:
            tree = Node(node.rule, node.flat, (tree,), node.numbers, node.constants, node.place)
    return tree
