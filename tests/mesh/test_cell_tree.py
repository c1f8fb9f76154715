"""Cells of several sizes, found by their keys."""

import numpy as np
import pytest

from distal.mesh.cell_tree import balanced, leaves_of, ringed, together
from distal.mesh.lattice import ancestors, cells_of_keys, keys_of
from distal.polygons.whole_numbers import sorted_keys


@pytest.mark.parametrize("levels", range(10))
def test_ancestors_by_shifts_are_those_by_coordinates(levels):
    cells = np.random.default_rng(levels).integers(-8, 2**19, (1000, 3))
    cells[:4] = [(-8, -8, -8), (0, 0, 0), (-1, 7, 2**19 - 1), (2**19 - 1, -1, 8)]
    np.testing.assert_array_equal(ancestors(keys_of(cells), levels), keys_of(cells >> levels))


def random_tree(random):
    """Cells of the base level, which are divided, the levels, and the base level."""
    base = int(random.integers(0, 4))
    levels = base + int(random.integers(1, 5))
    cells = sorted_keys(keys_of(random.integers(0, 6 << base, (int(random.integers(1, 300)), 3))))
    divided = []
    for level in range(levels):
        some = cells_of_keys(random.choice(cells, int(random.integers(0, 4))))
        if level < base:
            divided.append(keys_of(some >> base - level))
        else:
            inside = random.integers(0, 1 << level - base, some.shape)
            divided.append(keys_of((some << level - base) + inside))
    return cells, divided, levels, base


@pytest.mark.parametrize("seed", range(40))
def test_leaves_near_cells_are_those_of_the_whole_that_are_near(seed):
    random = np.random.default_rng(seed)
    cells, divided, *sizes = random_tree(random)
    divided = balanced(divided)
    changed = tuple(np.sort(random.permutation(keys)[: random.integers(0, 3)]) for keys in divided)
    whole = leaves_of(cells, divided, *sizes)
    for rings in (1, 4):
        expected = whole.some(whole.near(changed, rings))
        found = leaves_of(cells, divided, *sizes, ringed(changed, rings))
        for name in ("corner", "level", "key"):
            np.testing.assert_array_equal(getattr(found, name), getattr(expected, name))


@pytest.mark.parametrize("seed", range(10))
def test_cells_that_are_divided_later_balance_as_if_at_once(seed):
    random = np.random.default_rng(seed)
    _, first, levels, base = random_tree(random)
    while True:
        _, more, *others = random_tree(random)
        if others == [levels, base]:
            break
    later = together(balanced(first), balanced(more))
    at_once = balanced([np.concatenate(pair) for pair in zip(first, more, strict=True)])
    for one, other in zip(later, at_once, strict=True):
        np.testing.assert_array_equal(one, other)
