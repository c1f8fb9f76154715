"""No ray leaves a solid, or enters it, without a hit: random walks against closed forms.

``make sweep-segments`` runs it with 1e7 segments (DISTAL_SEGMENTS).
"""

from __future__ import annotations

import os

import pytest

from tests.paths.solids import CLOSED, SOLIDS
from tests.paths.walks import Count, closed_programs, programs, walk

SEGMENTS = int(float(os.environ.get("DISTAL_SEGMENTS", "1e5")))
CENTERS = {"at the origin": (0.0, 0.0, 0.0), "30 away": (18.0, 19.2, 14.4)}
PATHS = 20000  # of one batch


KINDS = len(SOLIDS) + len(CLOSED)


@pytest.mark.parametrize("name", SOLIDS)
def test_a_ray_is_on_the_side_that_it_believes_to_be_on(name):
    """A fifth of the rays leave a surface within a thousandth of its tangent plane."""
    check(name, SOLIDS[name], programs(SOLIDS[name]))


@pytest.mark.parametrize("name", CLOSED)
def test_so_is_a_ray_that_is_met_by_chords(name):
    solid, parts = CLOSED[name]
    check(f"{name} by chords", solid, closed_programs(parts))


def check(name, solid, made):
    """No ray is on a wrong side, and all end at the surface."""
    share = SEGMENTS // (KINDS * len(CENTERS))
    for where, center in CENTERS.items():
        total = Count()
        seed = 0
        while total.segments < share:
            paths = min(PATHS, 100 + (share - total.segments) // 3)
            total += walk(solid, center, paths, seed=seed, made=made)
            seed += 1
        if share > 100000:
            print(f"\n{name} {where}: {total}")
        assert total.leaks == 0, where
        assert total.exhausted <= 1e-4 * total.segments, where
        # A hit is at the surface, as far as 32 bits tell.
        assert total.off < 12.0, where
