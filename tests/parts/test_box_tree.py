"""The tree of boxes: every part once, parents around their children, a way past each box."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from distal.scene.lowering.parts.box_tree import box_tree


def boxes(count, seed):
    rng = np.random.default_rng(seed)
    middles = rng.normal(size=(count, 3)) * rng.choice([1e-3, 1.0, 1e4], (count, 1))
    if seed % 3 == 0:
        middles[:] = middles[0]  # all in one place
    halves = np.abs(rng.normal(size=(count, 3))) * rng.choice([0.0, 1e-4, 10.0], (count, 1))
    return middles - halves, middles + halves


def count_of(tree, box):
    """Return the number of parts below a box."""
    return (int(tree[2 * box, 3]) - box + 1) // 2


def walk(tree, box, inside, around=0):
    """Return the parts below a box, in the order of the tree."""
    (low, after), (high, part) = [(row[:3], int(row[3])) for row in tree[2 * box : 2 * box + 2]]
    assert (low >= inside[0]).all() and (high <= inside[1]).all()
    if part >= 0:
        assert after == box + 1
        return [part]
    second = int(tree[2 * (box + 1), 3])
    above, axis = divmod(-1 - part, 4)
    assert above == around
    low_middle, high_middle = (tree[2 * b : 2 * b + 2, :3].mean(axis=0) for b in (box + 1, second))
    if count_of(tree, box) == 2:  # boxes around many may reach back over others
        rounding = 1e-6 * np.abs(tree[2 * box : 2 * box + 2, :3]).max()
        assert low_middle[axis] <= high_middle[axis] + rounding
    found = walk(tree, box + 1, (low, high), box) + walk(tree, second, (low, high), box)
    assert int(tree[2 * second, 3]) == after
    return found


@given(st.integers(1, 70), st.integers(0, 10**6))
def test_every_part_is_below_boxes_around_it(count, seed):
    low, high = boxes(count, seed)
    parts = 7 + 3 * np.arange(count)
    tree = box_tree(low, high, parts).filled(low, high)
    assert tree.shape == (2 * (2 * count - 1), 4) and tree.dtype == np.float32
    everywhere = (np.full(3, -np.inf), np.full(3, np.inf))
    assert sorted(walk(tree, 0, everywhere)) == parts.tolist()
    leaves = tree.reshape(-1, 2, 4)[tree[1::2, 3] >= 0]
    for leaf in leaves:
        of = (int(leaf[1, 3]) - 7) // 3
        assert (leaf[0, :3] <= low[of]).all() and (leaf[1, :3] >= high[of]).all()


def test_the_depth_grows_with_the_logarithm():
    low, high = boxes(5000, 1)
    tree = box_tree(low, high, np.arange(5000)).filled(low, high)

    def depth(box):
        if tree[2 * box + 1, 3] >= 0:
            return 1
        return 1 + max(depth(box + 1), depth(int(tree[2 * (box + 1), 3])))

    assert depth(0) == 14  # 2^13 is the first power of two above 5000


@pytest.mark.parametrize("count", [1, 2, 3])
def test_a_box_is_halved_where_it_is_longest(count):
    middles = np.array([[0.0, 5.0, 0.1], [0.1, 0.0, 0.0], [0.0, 9.0, 0.2]])[:count]
    low, high = middles - 0.1, middles + 0.1
    tree = box_tree(low, high, np.arange(count)).filled(low, high)
    order = [int(part) for part in tree[1::2, 3] if part >= 0]
    assert order == {1: [0], 2: [1, 0], 3: [1, 0, 2]}[count]
