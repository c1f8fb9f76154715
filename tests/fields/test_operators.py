"""Every operator keeps what it promises, on random trees of shapes that keep what they promise.

``DISTAL_FIELD_SAMPLES`` and ``DISTAL_FIELD_SEED`` as for the shapes (``make sweep-fields``).
"""

from __future__ import annotations

import os
from typing import Final

import numpy as np
import pytest

from distal.fields.guarantees import Operator
from tests.fields.checks import examined
from tests.fields.library import operators
from tests.fields.seeds import seed_of, seeded
from tests.fields.subject import Subject
from tests.fields.surface import surface_of
from tests.fields.trees import Tree, accepted_tree

SAMPLES: Final = int(os.environ.get("DISTAL_FIELD_SAMPLES", "1"))
EFFORT: Final = 0.5 if SAMPLES < 10 else 2.0
ROWS: Final = [pytest.param(row, id=name) for name, row in operators().items()]


def _trees(row: Operator) -> list[Tree]:
    rng = np.random.default_rng(seed_of(row.name))
    trees = [accepted_tree(row, rng) for _ in range(SAMPLES)]
    assert None not in trees, f"'{row.name}' refused every random shape"
    return [tree for tree in trees if tree is not None]


@pytest.mark.parametrize("row", ROWS)
def test_claims_slope_and_box(row):
    findings = []
    for i, tree in enumerate(_trees(row)):
        subject = tree.subject()
        seed = seed_of(f"points of {row.name} {i}")
        findings += examined(subject, seed, effort=EFFORT).findings
        low, high = subject.region
        points = np.random.default_rng(seed).uniform(low, high, (200, subject.dimension))
        difference = np.abs(tree.evaluate(points)[0] - tree.evaluate(points, "reference")[0])
        if not difference.max() <= 1e-9 * subject.scale * max(subject.slope, 1.0):
            findings.append(f"{subject.name}: CPU and reference differ by {difference.max()}")
        findings += _site_findings(tree, subject, seed)
    assert not findings, seeded(findings)


def _site_findings(tree: Tree, subject: Subject, seed: int) -> list[str]:
    """On the surface, the place whose material shows lies on the child's surface.

    What keeps a marcher from stepping past a cell must not draw a surface of its own.
    """
    surface = surface_of(subject, np.random.default_rng(seed), edges=400, walkers=400).points
    at_site = tree.at_site(surface) if len(surface) else None
    if at_site is None:
        return []
    # The ends of a sweep lie within its outline; a copy of a repetition is cut nowhere.
    off = np.abs(at_site) if "repeat" in tree.node.rule.name else at_site
    worst = int(np.argmax(off))
    if off[worst] <= 1e-5 * subject.scale:
        return []
    return [f"{subject.name}: at {surface[worst]} the site's own distance is {at_site[worst]:.4g}"]
