"""Every operator keeps what it promises, on random trees of shapes that keep what they promise.

``DISTAL_FIELD_SAMPLES`` as for the shapes (``make sweep-fields``).
"""

from __future__ import annotations

import os
import zlib
from typing import Final

import numpy as np
import pytest

from distal.fields.claims import Operator
from tests.fields.checks import examined
from tests.fields.library import operators
from tests.fields.trees import Tree, accepted_tree

SAMPLES: Final = int(os.environ.get("DISTAL_FIELD_SAMPLES", "1"))
EFFORT: Final = 0.6 if SAMPLES < 10 else 2.0
ROWS: Final = [pytest.param(row, id=name) for name, row in operators().items()]


def _trees(row: Operator) -> list[Tree]:
    rng = np.random.default_rng(zlib.crc32(row.name.encode()))
    trees = [accepted_tree(row, rng) for _ in range(SAMPLES)]
    assert None not in trees, f"'{row.name}' refused every random shape"
    return [tree for tree in trees if tree is not None]


@pytest.mark.parametrize("row", ROWS)
def test_claims_slope_and_box(row):
    findings = []
    for i, tree in enumerate(_trees(row)):
        subject = tree.subject()
        findings += examined(subject, i, effort=EFFORT).findings
        low, high = subject.region
        points = np.random.default_rng(i).uniform(low, high, (200, subject.dimension))
        difference = np.abs(tree.evaluate(points)[0] - tree.evaluate(points, "reference")[0])
        if not difference.max() <= 1e-9 * subject.scale * max(subject.slope, 1.0):
            findings.append(f"{subject.name}: CPU and reference differ by {difference.max()}")
    assert not findings, "\n".join(findings)
