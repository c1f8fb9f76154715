"""Cutters that end exactly on a face of what they cut.

Input: a tree. Output: the leaves that are subtracted and leave a skin without a thickness: places
where the value is 0, with the outside on both sides. Whether a mesh or a picture shows the skin is
a matter of rounding.

Places are drawn on the surface of each such leaf: those nearest to places in its box, and those
nearest to places around the edges where it meets the surfaces of others, near and far, so that the
ends of slender bores have some.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.fields.combine.joins import COMPLEMENT
from distal.fields.guarantees import Primitive
from distal.scene.checks.bounds_report import bounds_of_nodes
from distal.scene.checks.measuring import InterpretedParts, own_values
from distal.scene.lowering.derived import GradientOf
from distal.scene.lowering.placed_leaves import PlacedLeaf, placed_leaves
from distal.scene.objects.field import BaseShape
from distal.scene.tree.node import Node

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

# Trees with more leaves are not looked at.
MOST_LEAVES: Final = 400
PLACES: Final = 1024
# How far from a surface a place is on it, and how far beside it the sides are looked at, as shares
# of the size of the box. Skins that are thicker than the latter are no skins but walls.
_ON: Final = 1e-12
_BESIDE: Final = 1e-9
# How many leaves that a cutter meets are looked at.
_MOST_FACES: Final = 8
# How far around edges others are drawn, as logarithms of shares of the size.
_AROUND: Final = (math.log(1e-3), math.log(0.3))
# A skin is at least this wide, as a share of this size: what touches in a point or a line has none.
_WIDE: Final = 3e-4
_BACK: Final = 0.2
_STEPS: Final = 4
_TURNS: Final = 2


@dataclass(frozen=True, slots=True)
class FlushCut:
    """A cutter that ends on a face.

    Attributes:
        cutter: The leaf that is subtracted.
        face: The leaf whose face it ends on: what is cut, or another cutter.
        place: A place on the skin between them.
    """

    cutter: PlacedLeaf
    face: PlacedLeaf
    place: tuple[float, ...]

    @property
    def message(self) -> str:
        """What is wrong, in words."""
        at = ", ".join(f"{c:.4g}" for c in self.place)
        return f"{self.cutter.text} ends exactly on a face of {self.face.text}, at ({at})"


def flush_cuts(
    root: Node, params: Mapping[str, Any], time: float, seed: int = 0
) -> tuple[FlushCut, ...]:
    """Return the cutters of a tree that end on a face, each once, in the author's order.

    Args:
        root: The tree.
        params: Values of parameters by name.
        time: Time in seconds.
        seed: Seed of the random places.
    """
    leaves = placed_leaves(root)
    if len(leaves) > MOST_LEAVES:
        return ()
    cuts = list(_Cuts(root, leaves, params, time, seed).found())
    found = [cut for cut in cuts if not cut.face.cuts]
    for cut in cuts:
        # Two cutters may end on each other: one is named.
        if cut.face.cuts and cut.face not in {other.cutter for other in found}:
            found.append(cut)
    for leaf in leaves:
        # What is blended is one leaf; the shapes below it have leaves of their own.
        if not isinstance(leaf.leaf.rule, Primitive):
            for child in leaf.leaf.children:
                found += flush_cuts(child, params, time, seed)
    return tuple({cut.cutter.leaf: cut for cut in reversed(found)}.values())[::-1]


class _Cuts:
    """The cutters of a tree, each with places on its surface."""

    def __init__(
        self,
        root: Node,
        leaves: Sequence[PlacedLeaf],
        params: Mapping[str, Any],
        time: float,
        seed: int,
    ) -> None:
        self._root, self._leaves, self._params, self._time = root, leaves, params, time
        self._low, self._high = self._box(root)
        self._boxes = {leaf: self._box(_without_complement(leaf)) for leaf in leaves}
        self._parts = InterpretedParts(params, time)
        self._random = np.random.default_rng(seed)

    def _box(self, node: Node) -> tuple[Floats, Floats]:
        own = own_values(BaseShape._of(node), self._params)
        bounds = bounds_of_nodes(node, own, self._time)[id(node)]
        size = 2 if node.flat else 3
        return np.array(bounds.low[:size]), np.array(bounds.high[:size])

    def _value(self, node: Node, p: Floats) -> Floats:
        return self._parts.values(node, p)

    def _slope(self, node: Node, p: Floats) -> Floats:
        return self._parts.values(node, p, GradientOf)

    def found(self) -> Iterator[FlushCut]:
        """Yield the cutters that end on a face."""
        cutters = [leaf for leaf in self._leaves if leaf.cuts]
        if len(cutters) == len(self._leaves):
            return
        for cutter in cutters:
            low, high = self._boxes[cutter]
            low, high = np.maximum(low, self._low), np.minimum(high, self._high)
            if not np.isfinite([*low, *high]).all() or (low > high).any():
                continue
            place = self._skin(cutter.tree, low, high)
            if place is not None:
                yield FlushCut(cutter, self._face_at(place, cutter), tuple(map(float, place)))

    def _skin(self, cutter: Node, low: Floats, high: Floats) -> Floats | None:
        """Return a place on a skin that a cutter leaves; None without any.

        Args:
            cutter: The cutter.
            low: The low corner of a box around what of it may have one.
            high: The high corner.
        """
        size = max(float(np.abs([low, high]).max()), float((high - low).max()))
        faces = [
            leaf.tree for leaf in self._leaves if not leaf.cuts and self._meets(leaf, low, high)
        ]
        if not faces:
            return None
        p = self._places(
            cutter,
            faces[:_MOST_FACES],
            self._random.uniform(low, high, (PLACES // 2, len(low))),
            size,
        )
        p, out = self._on_surface(cutter, p, size)
        some = np.flatnonzero(self._between_outsides(p, out, size))
        p, out = p[some], out[some]
        wide = np.ones(len(p), np.bool_)
        for way in _aside(out):
            rows = np.flatnonzero(wide)
            start = (p + _WIDE * size * way)[rows]
            q, beside = self._on_surface(cutter, start, size)
            # At a rim, places beside it come back.
            stays = np.linalg.norm(q - start, axis=1) < _BACK * _WIDE * size
            wide[rows] = stays & self._between_outsides(q, beside, size)
        if not wide.any():
            return None
        away = [np.abs(self._value(face, p[wide])) for face in faces]
        found: Floats = p[wide][np.argmin(np.min(away, axis=0))]
        return found

    def _meets(self, leaf: PlacedLeaf, low: Floats, high: Floats) -> bool:
        """Return whether a leaf's box meets another box."""
        own_low, own_high = self._boxes[leaf]
        return bool((own_low <= high).all() and (own_high >= low).all())

    def _places(self, cutter: Node, faces: Sequence[Node], start: Floats, size: float) -> Floats:
        """Return places at which the surface of a cutter may end on others.

        Args:
            cutter: The cutter.
            faces: What it may end on.
            start: Places in its box.
            size: The size of the box.
        """
        p, _ = self._on_surface(cutter, start, size)
        found = [p]
        for face, q in zip(faces, np.array_split(p, len(faces)), strict=True):
            for _ in range(_TURNS):
                q, _ = self._on_surface(face, q, size)
                q, _ = self._on_surface(cutter, q, size)
            way = self._random.normal(size=q.shape)
            way /= np.linalg.norm(way, axis=1, keepdims=True)
            share = np.exp(self._random.uniform(*_AROUND, (len(q), 1)))
            found.append(q + share * size * way)
        return np.concatenate(found)

    def _on_surface(self, node: Node, p: Floats, size: float) -> tuple[Floats, Floats]:
        """Return places on a surface near others, and the way out of it."""
        if not len(p):
            return p, p
        for _ in range(_STEPS):
            slope = self._slope(node, p)
            squares = np.maximum((slope**2).sum(axis=1), 1e-12)
            p = p - (self._value(node, p) / squares)[:, None] * slope
        # At the surface itself the slope may be 0.
        slope = self._slope(node, p + _ON * size)
        return p, slope / np.maximum(np.linalg.norm(slope, axis=1), 1e-12)[:, None]

    def _between_outsides(self, p: Floats, out: Floats, size: float) -> Bools:
        """Return at which places the value is 0, and outside on both sides."""
        some = np.zeros(len(p), np.bool_)
        if len(p):
            some |= np.abs(self._value(self._root, p)) < _ON * size
        for way in (_BESIDE, -_BESIDE):
            if some.any():
                some[some] = self._value(self._root, (p + way * size * out)[some]) > -_ON * size
        return some

    def _face_at(self, place: Floats, cutter: PlacedLeaf) -> PlacedLeaf:
        """Return the leaf whose surface is nearest to a place: one that is cut, if several are."""

        def rank(leaf: PlacedLeaf) -> tuple[float, bool]:
            away = abs(float(self._value(leaf.tree, place[None])[0]))
            return round(away, 9), leaf.cuts

        return min((leaf for leaf in self._leaves if leaf is not cutter), key=rank)


def _aside(out: Floats) -> Iterator[Floats]:
    """Yield directions along surfaces with these normals, of length 1."""
    aside = np.roll(out, 1, axis=1) * [1.0, -1.0, 1.0][: out.shape[1]]
    aside -= (aside * out).sum(axis=1, keepdims=True) * out
    aside /= np.maximum(np.linalg.norm(aside, axis=1, keepdims=True), 1e-12)
    for way in [aside] if out.shape[1] == 2 else [aside, np.cross(out, aside)]:
        yield way
        yield -way


def _without_complement(leaf: PlacedLeaf) -> Node:
    """Return the tree of a leaf as if it were not cut out: what is cut out has no box."""
    tree = leaf.leaf
    for node in reversed(list(leaf.chain())[:-1]):
        if node.rule is not COMPLEMENT:
            tree = replace(node, children=(tree,))
    return tree
