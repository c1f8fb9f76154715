"""Cutters that end exactly on a face of what they cut are named; those that go through are not."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from distal import Box, Circle, Cylinder, InfiniteCylinder, Rectangle, Sphere, union
from distal.error_codes import ErrorCode
from distal.lang import slider
from distal.scene.checks.flush_cuts import flush_cuts
from distal.scene.checks.validation import Severity, check

PLATE = Box(20.0, 4.0, 12.0)
BORE = Cylinder(0.7, 4.0)
THROUGH = Cylinder(0.7, 6.0)
ON_EXTENTS = Cylinder(0.7, 3.0).rotate(z=0.4)

FLUSH = {
    "bore": PLATE - BORE,
    "one end": PLATE - Cylinder(0.7, 3.0).translate(y=0.5),
    "slender": Box(20.0, 40.0, 12.0) - Cylinder(0.3, 40.0),
    "pocket at a side": PLATE - Box(5.0, 4.0, 4.0).translate(x=7.5),
    "same radius": Cylinder(1.0, 4.0) - Cylinder(1.0, 1.0).translate(y=1.0),
    "array": PLATE - BORE.repeat(3.0, 0.0, 3.0, count=(4, 1, 3)),
    "second of two": PLATE - THROUGH - BORE.translate(x=5.0),
    "shell": PLATE.shell(0.2, where="center") - Cylinder(0.7, 2.0).translate(y=1.1),
    "pour hole": Box(4.0) - Box(2.0) - Cylinder(0.3, 1.0).translate(y=1.5),
    "extruded": (Rectangle(4.0, 4.0) - Rectangle(1.0, 4.0)).extrude(2.0),
    "flat": Rectangle(4.0, 4.0) - Rectangle(1.0, 4.0),
    "complement": PLATE & ~BORE,
    "in a blend": (PLATE - BORE).union(Sphere(1.0).translate(x=8.0, y=2.0), smooth=0.3),
    "inside a blend of cuts": PLATE.difference(Sphere(1.0).translate(y=2.0), smooth=0.3) - BORE,
    "aligned": Box(20.0, 4.0, 12.0) - Box(3.0, 1.0, 3.0).align(PLATE, y="high"),
}
CLEAR = {
    "through": PLATE - THROUGH,
    "blind": PLATE - Cylinder(0.7, 4.0).translate(y=1.0),
    "endless": PLATE - InfiniteCylinder(0.7),
    "tangent": Box(4.0) - Cylinder(1.0, 6.0).translate(x=1.0),
    "tangent ball": Box(4.0) - Sphere(1.0).translate(y=1.0),
    "a skin of a thousandth": PLATE - Cylinder(0.7, 3.996),
    "array": PLATE - THROUGH.repeat(3.0, 0.0, 3.0, count=(4, 1, 3)),
    "beside": PLATE - BORE.translate(x=30.0),
    "touches from outside": PLATE - BORE.translate(y=4.0),
    "cut away later": PLATE - BORE - Box(2.0, 6.0, 2.0),
    "filled later": (PLATE - Cylinder(0.7, 2.0).translate(y=1.0)) | Box(3.0, 4.0, 3.0),
    "post on a plate": PLATE | BORE.translate(y=4.0),
    "ring": Circle(2.0).extrude(1.0) - Circle(1.0).extrude(2.0),
    "nothing": PLATE,
}


def turned(shape: Any, seed: int) -> Any:
    """A shape turned and moved at random; seed 0, and a flat shape, stay as they are."""
    if not seed or shape.flat:
        return shape
    rng = np.random.default_rng(seed)
    quaternion = rng.normal(size=4)
    quaternion /= np.linalg.norm(quaternion)
    return shape.rotate(quaternion=tuple(quaternion)).translate(*rng.uniform(-30.0, 30.0, 3))


@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize("name", FLUSH)
def test_a_cutter_that_ends_on_a_face_is_found(name: str, seed: int) -> None:
    shape = turned(FLUSH[name], seed)
    (cut,) = flush_cuts(shape.node, {}, 0.0, seed)
    assert cut.cutter.leaf.name in ("Cylinder", "Box", "Rectangle")
    if name == "in a blend":
        return  # the place is in the coordinates of what is blended
    # The place is on a skin: nothing is inside, however near.
    rng = np.random.default_rng(3)
    near = np.array(cut.place) + rng.normal(0.0, 1e-5, (200, len(cut.place)))
    values = shape(near)
    assert values.min() > -1e-12 and values.max() < 1e-4


@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize("name", CLEAR)
def test_others_are_not(name: str, seed: int) -> None:
    assert flush_cuts(turned(CLEAR[name], seed).node, {}, 0.0, seed) == ()


def test_both_shapes_and_what_to_do_are_named() -> None:
    part = Box(20.0, 4.0, 12.0).named("plate") - Cylinder(0.7, 4.0).named("screw hole")
    (found,) = [f for f in check(part).findings if f.diagnostic.code is ErrorCode.FLUSH_FACES]
    assert found.severity is Severity.WARNING
    text = found.diagnostic.message
    assert re.match(
        r"'screw hole \(Cylinder\)' \(line \d+\) ends exactly on a face of 'plate \(Box\)' \(line ",
        text,
    )
    assert found.diagnostic.hint == "let it go through by a little"
    assert check(part).shapes[found.shape].node.name == "screw hole"
    line = found.diagnostic.span.line
    assert "screw hole" in Path(__file__).read_text("utf-8").splitlines()[line - 1]


def test_each_of_many_is_named_once() -> None:
    bores = [Cylinder(0.2 + 0.01 * i, 4.0 + i % 2).translate(x=i - 9.0) for i in range(18)]
    found = flush_cuts((PLATE - union(bores)).node, {}, 0.0)
    assert {cut.cutter.leaf for cut in found} == {bore.node.children[0] for bore in bores[::2]}


def test_it_follows_parameters_and_time() -> None:
    part = PLATE - Cylinder(0.7, slider("Height", 6.0, 1.0, 9.0))
    assert not flush_cuts(part.node, {}, 0.0)
    assert flush_cuts(part.node, {"height": 4.0}, 0.0)
    # The body has no such parameter.
    codes = [finding.diagnostic.code for finding in check(part, {"height": 4.0}).findings]
    assert ErrorCode.FLUSH_FACES in codes
