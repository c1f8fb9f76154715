"""What must hold of the pieces of a tree, checked at random points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from distal.scene.lowering.pieces.box_order import PieceTree
from distal.scene.lowering.pieces.builder import PieceLimits, build
from distal.scene.lowering.pieces.operands import operand_tree
from distal.scene.lowering.pieces.programs import PieceProgram, program_of
from tests.pieces.random_trees import (
    bounds_of_leaves,
    distances_of,
    leaf_values,
    look_of_piece,
    program_values,
    shown_look,
    step_values,
)


@dataclass
class Built:
    """A program, its pieces, and the limits."""

    program: PieceProgram
    pieces: PieceTree
    limits: PieceLimits

    @property
    def margin(self):
        return self.limits.margin * float((self.pieces.high[0] - self.pieces.low[0]).max())

    @property
    def error(self):
        """What chains of more than two blended operands may lose (``cell_pruning``)."""
        tree = operand_tree(self.program, *np.ones((2, len(self.program.leaves))))
        count = np.bincount(tree.parent[1:], minlength=len(tree.kind))
        return 0.005 * float(tree.width[count > 2].max(initial=0.0))


def built(shape, **limits):
    """Return the pieces of a shape."""
    program = program_of(shape.node)
    low, high, slopes, growths = bounds_of_leaves(program)
    chosen = PieceLimits(**limits)
    pieces = build(program, low, high, slopes, distances_of(program), chosen, growths)
    return Built(program, pieces, chosen)


def places(made, rng, in_boxes=6, around=2000):
    """Points in each box with a piece, on its sides, and around all of them."""
    pieces = made.pieces
    low, high = (np.repeat(c[pieces.box], in_boxes, axis=0) for c in (pieces.low, pieces.high))
    inside = rng.uniform(low, high)
    sides = np.where(rng.random(inside.shape) < 0.3, low, inside)
    wide = rng.uniform(pieces.low[0] - 0.1, pieces.high[0] + 0.1, (around, 3))
    return np.concatenate([inside, sides, wide])


def check_values(made, rng):
    """Check that the union of the pieces, each within its box, is the solid.

    Near the surface the least value of the pieces around a point is that of the tree.
    """
    pieces = made.pieces
    points = places(made, rng)
    of_leaf = leaf_values(made.program, points)
    whole = program_values(made.program, of_leaf)
    least = np.full(len(points), np.inf)
    covered = np.zeros(len(points), bool)
    for i, box in enumerate(pieces.box.tolist()):
        within = ((points >= pieces.low[box]) & (points <= pieces.high[box])).all(axis=1)
        here = np.flatnonzero(within | ~pieces.is_cut[i])
        value = step_values(pieces.steps_of(i), pieces.joins, lambda n, h=here: of_leaf(n)[h])
        if not pieces.is_cut[i]:
            # It holds the whole solid of its program.
            assert not ((value < -1e-9) & ~within[here]).any()
        least[here] = np.minimum(least[here], value)
        covered |= within
    margin = 0.99 * made.margin
    difference = np.abs(np.clip(whole, -margin, margin) - np.clip(least, -margin, margin))
    assert difference[covered].max(initial=0.0) <= 1e-9 + made.error
    far = np.flatnonzero(~covered)
    # Outside of all boxes is nothing, or the inside.
    assert (least[far] > -1e-9).all()
    assert ((whole[far] > 0.0) | (whole[far] < -margin)).all()
    if made.limits.interior:
        assert (whole[far] > 0.0).all()
    return whole


def check_looks(made, rng, near=0.02):
    """Check that pieces show the materials of the tree at its surface."""
    pieces = made.pieces
    points = places(made, rng, in_boxes=12, around=0)
    of_leaf = leaf_values(made.program, points)
    whole = program_values(made.program, of_leaf)
    expected = shown_look(made.program, of_leaf)
    checked = 0
    for i, box in enumerate(pieces.box.tolist()):
        within = ((points >= pieces.low[box]) & (points <= pieces.high[box])).all(axis=1)
        here = np.flatnonzero(within & (np.abs(whole) < min(near, made.margin)))
        if not len(here) or not pieces.is_cut[i]:
            continue
        steps = pieces.steps_of(i)
        value = step_values(steps, pieces.joins, lambda n, h=here: of_leaf(n)[h])
        here = here[np.abs(value - whole[here]) < 1e-9]  # not that of another member of a union
        shown = look_of_piece(steps, made.program, pieces.joins, lambda n, h=here: of_leaf(n)[h])
        assert (shown == expected[here]).all()
        checked += len(here)
    return checked


def check_order(pieces):
    """Check the order of the boxes: parents first, and the lower child first."""
    count = len(pieces.skip)
    for i in range(count):
        if pieces.piece[i] >= 0:
            assert pieces.skip[i] == i + 1 and pieces.axis[i] == -1
            assert pieces.box[pieces.piece[i]] == i
            continue
        first, second = i + 1, pieces.skip[i + 1]
        assert pieces.skip[second] == pieces.skip[i] <= count
        for child in (first, second):
            assert (pieces.low[child] >= pieces.low[i] - 1e-12).all()
            assert (pieces.high[child] <= pieces.high[i] + 1e-12).all()
        axis = pieces.axis[i]
        middles = pieces.low[:, axis] + pieces.high[:, axis]
        assert middles[first] <= middles[second] + 1e-9
    assert (np.diff(pieces.box) > 0).all()
