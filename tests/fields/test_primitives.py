"""Every shape of the library keeps what it promises.

``DISTAL_FIELD_SAMPLES`` sets how many random sets of numbers each shape is tried with; more than a
few of them also raise the number of points (``make sweep-fields``, which also draws
others each day); a failure names the seed, ``DISTAL_FIELD_SEED`` sets it.
"""

from __future__ import annotations

import os
from typing import Final

import numpy as np
import pytest

from distal.fields.guarantees import Primitive
from tests.fields.checks import examined, numbers_hold
from tests.fields.drawing import default_sample, random_sample, sample_with
from tests.fields.library import measured, primitives
from tests.fields.rows import Sample, dimension_of, slots_of
from tests.fields.seeds import seed_of, seeded
from tests.fields.subject import subject_of

SAMPLES: Final = int(os.environ.get("DISTAL_FIELD_SAMPLES", "1"))
EFFORT: Final = 0.8 if SAMPLES < 10 else 3.0
ROWS: Final = [pytest.param(row, id=name) for name, row in primitives().items()]


def _samples(row: Primitive) -> list[Sample]:
    rng = np.random.default_rng(seed_of(row.name))
    drawn = [default_sample(row)]
    for _ in range(SAMPLES if slots_of(row.distance) else 0):
        sample = random_sample(row, rng)
        assert sample is not None, f"no numbers of {row.name} go together"
        drawn.append(sample)
    return drawn


@pytest.mark.parametrize("row", ROWS)
def test_claims_slope_and_box(row):
    findings = []
    for i, sample in enumerate(_samples(row)):
        effort = EFFORT if i == 0 else 0.6 * EFFORT
        findings += examined(
            subject_of(sample), seed_of(f"points of {row.name} {i}"), effort=effort
        ).findings
    assert not findings, seeded(findings)


@pytest.mark.parametrize("row", ROWS)
def test_special_places_bits_and_reference(row):
    findings = []
    for sample in _samples(row)[:2]:
        findings += numbers_hold(sample, subject_of(sample))
    assert not findings, seeded(findings)


@pytest.mark.parametrize("row", ROWS)
def test_measured_points(row):
    for line in measured(row.distance):
        assert line.function == row.distance.name
        names = [s.name for s in slots_of(row.distance)]
        point, *values = line.args
        given = {**dict(zip(names, values, strict=False)), **line.kwargs}
        sample = sample_with(row, given)
        points = np.array([point], np.float64)
        assert points.shape == (1, dimension_of(row.distance)), line.text
        value = sample.evaluate(points, device="reference")[0][0]
        assert value == pytest.approx(line.value, abs=5e-7), line.text
