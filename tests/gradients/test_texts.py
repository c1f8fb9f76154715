"""Gradients of random fields inside GLSL and WGSL, against the CPU.

One picture for each batch: a column is a field, a row a point; red is the value, the rest the
gradient. Which pixels are compared is told by the reference in 64 bits: those where moving the
point by a few 32-bit roundings, and computing in 32 bits at all, changes little.
"""

from __future__ import annotations

import re
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from distal.frontend import lower
from distal.ir.nodes import Module
from tests.gradients.fields import make_field
from tests.gradients.running import scope_of
from tests.parity import targets

ROWS = 48
# How far a steady pixel may move when its point does, and how far a target may be off there. The
# latter is four times the worst measured (Mesa and our vector code: 5e-6).
STEADY = 2.5e-4
TOLERANCE = 2e-5
# Mesa's arc sine is off by 4e-4, which a field makes more of; these rows' texts are held in
# tests/parity, their derivatives in 64 bits. The outermost atan of each field stays.
LOOSE = frozenset(("asin", "acos", "atan", "atan2"))
FIELDS = tuple(s for s in range(1000, 1024) if make_field(s, LOOSE).size in (2, 3))[:6]


def picture_text(nudge: float = 0.0) -> str:
    """All fields in one module, their names numbered."""
    text, branches = "", []
    for column, seed in enumerate(FIELDS):
        field = make_field(seed, LOOSE)
        own = field.text if not text else field.text[field.text.index("@func\ndef shaped") :]
        text += re.sub(r"\b(shaped|part|pair|field|both)\(", rf"\1_{column}(", own).replace(
            "value_and_gradient(field, p)", f"value_and_gradient(field_{column}, p)"
        )
        size = field.size
        place = "p" if size == 3 else "p.xy"
        rest = "slope" if size == 3 else "slope, 0.0"
        branches.append(
            f"    if column == {column}:\n"
            f"        value, slope = both_{column}({place})\n"
            f"        return vec4(value, {rest})\n"
        )
    # Points are exact in 32 bits.
    body = (
        "    column = int(frame.coord.x)\n    row = int(frame.coord.y)\n"
        "    q = ivec3(row * 37 % 97, row * 53 % 89, row * 71 % 101)\n"
        f"    p = vec3(q) / 32.0 - 1.5 + {nudge}\n"
    )
    head = "\n\n@image\ndef picture(frame: Frame) -> vec4:\n"
    return text + head + body + "".join(branches) + "    return vec4(0.0, 0.0, 0.0, 1.0)\n"


@cache
def module(nudge: float = 0.0) -> Module:
    return lower(scope_of(picture_text(nudge), f"gradients_{int(nudge * 2**30)}")["picture"])


@cache
def expected() -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """The picture in 64 bits, and where it is steady."""
    truth, ahead, behind = (
        targets.reference(module(n), len(FIELDS), ROWS, {}, 64).astype(float)
        for n in (0.0, 2.0**-18, -(2.0**-18))
    )
    single = targets.reference(module(), len(FIELDS), ROWS, {}).astype(float)
    scale = 1.0 + np.abs(truth).max(axis=2, keepdims=True)
    others = [np.abs(other - truth) / scale for other in (ahead, behind, single)]
    return truth, (np.max(others, axis=(0, 3)) < STEADY)


def test_most_pixels_are_steady() -> None:
    _, steady = expected()
    print(f"steady: {steady.mean():.3f}")
    assert steady.mean() > 0.85


@pytest.mark.parametrize("target", targets.TARGETS)
def test_targets_agree(target: str) -> None:
    truth, steady = expected()
    try:
        picture = targets.TARGETS[target](module(), len(FIELDS), ROWS, {})
    except targets.Unavailable as reason:
        pytest.skip(str(reason))
    scale = 1.0 + np.abs(truth).max(axis=2, keepdims=True)
    off = (np.abs(picture - truth) / scale).max(axis=2)
    off = np.where(np.isfinite(off), off, np.inf) * steady
    print(f"{target}: worst {off.max():.2g}, by field {off.max(axis=0).round(6).tolist()}")
    row, column = np.unravel_index(off.argmax(), off.shape)
    assert off.max() < TOLERANCE, (
        f"{target}: row {row}, seed {FIELDS[column]}: {picture[row, column]}, "
        f"should be {truth[row, column]}"
    )
