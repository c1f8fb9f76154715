"""Every example agrees with the picture that the original shader draws.

The pictures beside ``tests/originals/index.json`` were drawn by the original texts themselves, on
Mesa's llvmpipe, by ``tools/render_original.py``.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import distal
from tests.pictures.comparison import difference

FOLDER = Path(__file__).parents[1] / "originals"
CASES = json.loads((FOLDER / "index.json").read_text())
PARAMETERS = {"u_blend": "blend_softness", "u_maxSteps": "max_steps"}


@pytest.mark.parametrize("case", CASES, ids=lambda case: Path(case["file"]).stem)
def test_agrees_with_the_original(case):
    original = np.asarray(Image.open(FOLDER / case["file"]).convert("RGB"))
    image = distal.load(f"example:{case['example']}")
    integers = {p.name for p in image.parameters() if p.kind.value == "integer"}
    params = {PARAMETERS[name]: value for name, value in case["parameters"].items()}
    params = {n: int(v) if n in integers else v for n, v in params.items()}
    picture = image.render(size=tuple(case["size"]), samples=1, time=case["time"], params=params)
    found = difference(picture.array, original)
    assert found.is_agreement, found


def test_every_example_that_has_an_original_is_compared():
    compared = {case["example"] for case in CASES}
    ported = {"raymarcher", "melting", *(n for n in distal.gallery() if n.startswith("course_"))}
    assert compared == ported and len(ported) == 8
