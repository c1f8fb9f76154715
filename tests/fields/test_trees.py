"""Operators upon operators on shapes keep what they promise: random trees.

``DISTAL_FIELD_SAMPLES`` and ``DISTAL_FIELD_SEED`` as for the shapes (``make sweep-fields``).
"""

from __future__ import annotations

import os
from typing import Final

import numpy as np
import pytest

from distal.fields.guarantees import ENDLESS, OPERATORS
from tests.fields.quick_checks import glanced
from tests.fields.seeds import seed_of, seeded
from tests.fields.trees import Tree, flatness, nested_tree, random_node

TRIES: Final = 60
TREES: Final = int(os.environ.get("DISTAL_FIELD_SAMPLES", "1"))
# What moves the surface out, where a box must hold more than the surface did, and what turns or
# cuts a box before that.
GROWING: Final = (
    *("round", "offset", "shell center", "shell outer", "emboss", "tongue", "displace", "pipe"),
    *("union quadratic", "union chamfer", "union round", "union exponential", "union power"),
    *("thicken by", "extrude rounded", "extrude tapered", "revolve partly", "sweep", "rotate"),
    *("symmetry octant", "kaleidoscope", "slice", "intersection"),
)


@pytest.mark.parametrize("name", GROWING)
def test_a_random_tree_keeps_its_promises(name: str):
    findings = []
    for i in range(TREES):
        subject = _accepted(name, np.random.default_rng(seed_of(f"tree {name} {i}")))
        findings += glanced(subject, seed_of(f"points of tree {name} {i}")).findings
    assert not findings, seeded(findings)


def _accepted(name: str, rng: np.random.Generator):
    """The operator on shapes that are made by operators, and moved out by ``round``."""
    rule = OPERATORS[name]
    for _ in range(TRIES):
        flat, below = flatness(rule, rng)
        count = 2 if rule.combine is not None else 1
        inner = [nested_tree(rng, flat=below, depth=int(rng.integers(3))) for _ in range(count)]
        node = random_node(rule, flat, tuple(inner), rng)
        if node is None:
            continue
        radius = float(rng.uniform(0.0, 0.6))
        node = random_node(OPERATORS["round"], flat, (node,), rng, radius=radius)
        subject = Tree(node).subject("reference")
        if subject.slope < ENDLESS:
            return subject
    raise AssertionError(seeded([f"{name} refused every shape"]))
