"""Former names and orders of arguments are refused at the author's line, with those of now."""

from __future__ import annotations

import inspect
from pathlib import Path

import pytest

import distal
from distal.diagnostics import CompileError
from distal.fields.library import PRIMITIVES
from distal.scene.tree.former_names import FORMER_NAMES, FORMER_OBJECTS, FORMERLY_FIRST

BOX, BALL = distal.Box(1.0), distal.Sphere(0.6)
REFUSED = (
    (lambda: distal.Moon(offset=0.4), "Moon has no 'offset'", "shift=…"),
    (lambda: distal.Pie(angle=0.7), "Pie has no 'angle'", "opening=2 * …, the whole angle"),
    (lambda: distal.Wedge(angle=0.7), "Wedge has no 'angle'", "opening=…"),
    (lambda: distal.Capsule(height=1), "Capsule has no 'height'", "length=…, between the centers"),
    (lambda: distal.Nut("M6", clearance=0.1), "Nut has no 'clearance'", "gap=…"),
    (lambda: distal.Gear(bore=3.0), "Gear has no 'bore'", "bore_diameter=…"),
    (lambda: distal.Gear(hellix=0.1), "Gear has no 'hellix'", "did you mean 'helix'?"),
    (lambda: distal.Camera(mirror=True), "Camera has no 'mirror'", "mirrored=…"),
    (lambda: distal.Text("a", align="left"), "Text has no 'align'", "justify=…"),
    (lambda: distal.Text("a", justify="centre"), "justify is 'left', 'center'", 'justify="center"'),
    (lambda: distal.Box().shell(0.1, "centre"), "a shell lies inner, center", 'where="center"'),
    (lambda: BOX.union(BALL, k=0.1), "a quadratic union has no 'k'", "smooth=…"),
    (lambda: BOX.xor(BALL).apply("xor cubic", others=[BALL], k=1), "has no 'k'", "smooth=…"),
    (lambda: BOX.union(BALL, smooth=0.1).replace(k=0.2), "has no 'k'", "smooth=…"),
    (lambda: BOX.engrave(BALL, 0.1).replace(k=0.2), "engrave has no 'k'", "depth=…"),
    (lambda: BOX.pipe(BALL, 0.1).replace(k=0.2), "pipe has no 'k'", "radius=…"),
    (lambda: BOX.mirror(normal=(1, 0, 0)), "mirror has no 'normal'", "across=…"),
    (lambda: BOX.symmetry(normal=(1, 0, 0)), "symmetry has no 'normal'", "across=…"),
    (lambda: distal.Triangle(first=(0, 0)), "Triangle has no 'first'", "a=…"),
    (lambda: BOX.repeat(1, neighbours=1), "repeat has no 'neighbours'", "'neighbors'"),
    # Solids whose name a flat shape has now.
    (lambda: distal.Triangle((0, 0, 0)), "takes two numbers, not 3", "its solid is TriangleSheet"),
    (lambda: distal.Rhombus((1, 1), 2.0), "takes nothing after", "its solid is RhombusPrism"),
    (lambda: distal.Rhombus(height=2.0), "Rhombus has no 'height'", "its solid is RhombusPrism"),
    # An angle by position may be a half.
    (lambda: distal.Pie(1.0, 0.7), "Pie takes nothing after 'radius'", "by name: opening=2 * …"),
    (lambda: distal.Wedge(0.7), "Wedge takes nothing by position", "by name: opening=…"),
    (lambda: distal.Arc(1.0, 0.7, 0.1), "Arc takes nothing after 'radius'", "thickness=…, opening"),
    # Numbers by position may be in the former order.
    (lambda: distal.Prism(5, 0.5), "Prism takes 'count' by name", "inradius, height, *, count"),
    (lambda: distal.Link(0.5), "Link takes 'length' by name", "major, minor, *, length"),
    (lambda: distal.VesicaSolid(1.5), "VesicaSolid takes 'height' by name", "width, *, height"),
    (lambda: distal.SolidAngle(0.6, 1.0), "SolidAngle takes 'opening' by name", "it takes radius"),
    (lambda: distal.CappedTorus(2.0, 0.7), "CappedTorus takes 'opening' by name", "it takes major"),
)


@pytest.mark.parametrize(("make", "message", "hint"), REFUSED)
def test_a_former_call_is_refused_with_the_one_of_now(make, message, hint):
    with pytest.raises(CompileError) as caught:
        make()
    found = caught.value.diagnostics[0]
    assert message in found.message
    assert hint in (found.hint or "")
    assert found.span is not None and Path(found.span.file).name == "test_former_names.py"


def test_calls_of_now_are_taken():
    assert distal.Prism(0.5, 1.0, count=5)((0.0, 0.0, 0.0)) == pytest.approx(-0.5)
    assert distal.Link(0.5, 0.25, length=1.0)((0.0, 5.0, 3.0)) == pytest.approx(4.75)
    assert distal.VesicaSolid(1.0, height=2.0)((0.0, 0.0, 0.0)) == pytest.approx(-0.5)
    assert distal.Pie(2.0, opening=2.0)((0.0, 3.0)) == pytest.approx(1.0)


def test_a_former_name_is_none_of_now():
    for name, changed in FORMER_NAMES.items():
        made = getattr(distal, name, distal.Camera.yaw_pitch_roll)  # TurnedCamera
        now = inspect.signature(made).parameters
        assert not set(changed) & set(now), name
        assert {renamed.name for renamed in changed.values()} <= set(now), name
    for name, first in FORMERLY_FIRST.items():
        parameters = inspect.signature(getattr(distal, name)).parameters
        assert parameters[first].kind is inspect.Parameter.KEYWORD_ONLY


def test_an_angle_is_passed_by_name():
    for name in PRIMITIVES:
        parameters = inspect.signature(getattr(distal, name)).parameters
        for angle in {"opening", "pressure_angle", "slant"} & set(parameters):
            assert parameters[angle].kind is inspect.Parameter.KEYWORD_ONLY, name


@pytest.mark.parametrize(("former", "now"), FORMER_OBJECTS.items())
def test_a_former_object_is_told_the_one_of_now(former, now):
    with pytest.raises(AttributeError, match=f"; it is '{now.name}'"):
        getattr(distal, former)
    assert hasattr(distal, now.name)


@pytest.mark.parametrize(("former", "now"), [("aluminium", "aluminum"), ("metre", "meter")])
def test_a_former_spelling_is_told_the_one_of_now(former, now):
    with pytest.raises(AttributeError, match=f"did you mean '{now}'"):
        getattr(distal, former)
