"""Fields with many branches are drawn on SwiftShader, whose time could double with each of them.

Sixteen choices in a field are some eighty in the loop of reflections; before ``passes.one_way`` and
``mix`` for choices of floats, ten of a kind took all time and memory there was. Of each kind by
itself, so that each has its own guard.
"""

# ruff: noqa: SIM108 (the statement is what is tested)

from __future__ import annotations

import pytest

import distal
from distal import Material, Plane, Scene, Shape
from distal.lang import abs, exp, func, length, sqrt, vec3
from tests import webgl
from tests.browser import BrowserUnavailableError
from tests.pictures.comparison import difference

SIZE = (48, 36)
LIMIT_S = 20.0  # 0.4 s alone


@func
def branch(p: vec3, k: float) -> float:
    """Two ways of an ``if``, neither of which SwiftShader computes ahead."""
    if p.x * k > p.y:
        d = exp(-abs(p.z * k))
    else:
        d = sqrt(abs(p.z) * k)
    return d


@func
def early(p: vec3, k: float) -> float:
    """Two ways to return."""
    if p.x * k > p.y:
        return exp(-abs(p.z * k))
    return sqrt(abs(p.z) * k)


@func
def choice(p: vec3, k: float) -> float:
    """A choice within an expression, between a quotient and another choice."""
    return 0.2 / p.x if p.x > 0.2 else p.y if p.y > k else k / (1.0 + p.z * p.z)


@func
def branches(p: vec3) -> float:
    """Sixteen, each a call of its own."""
    a = branch(p, 1.1) + branch(p, 1.2) + branch(p, 1.3) + branch(p, 1.4)
    b = branch(p, 1.5) + branch(p, 1.6) + branch(p, 1.7) + branch(p, 1.8)
    c = branch(p, 2.1) + branch(p, 2.2) + branch(p, 2.3) + branch(p, 2.4)
    d = branch(p, 2.5) + branch(p, 2.6) + branch(p, 2.7) + branch(p, 2.8)
    return length(p) - 1.0 + 0.01 * (a + b + c + d)


@func
def returns(p: vec3) -> float:
    """Sixteen, each a call of its own."""
    a = early(p, 1.1) + early(p, 1.2) + early(p, 1.3) + early(p, 1.4)
    b = early(p, 1.5) + early(p, 1.6) + early(p, 1.7) + early(p, 1.8)
    c = early(p, 2.1) + early(p, 2.2) + early(p, 2.3) + early(p, 2.4)
    d = early(p, 2.5) + early(p, 2.6) + early(p, 2.7) + early(p, 2.8)
    return length(p) - 1.0 + 0.01 * (a + b + c + d)


@func
def choices(p: vec3) -> float:
    """Sixteen, each a call of its own."""
    a = choice(p, 1.1) + choice(p, 1.2) + choice(p, 1.3) + choice(p, 1.4)
    b = choice(p, 1.5) + choice(p, 1.6) + choice(p, 1.7) + choice(p, 1.8)
    c = choice(p, 2.1) + choice(p, 2.2) + choice(p, 2.3) + choice(p, 2.4)
    d = choice(p, 2.5) + choice(p, 2.6) + choice(p, 2.7) + choice(p, 2.8)
    return length(p) - 1.0 + 0.01 * (a + b + c + d)


@pytest.mark.parametrize("field", [branches, returns, choices], ids=lambda f: f.name)
def test_swiftshader_draws_a_field_of_branches(field):
    body = Shape.from_function(field, slope=5.0, bounds=((-2.0,) * 3, (2.0,) * 3))
    mirror = Material(diffuse=0.4, specular=0.5)
    scene = Scene(body.paint(mirror) | Plane(y=-1.2).paint("#888"))
    program = distal.compile(scene, target="glsl-es300")
    try:
        drawn = webgl.drawn(program, SIZE, limit_s=LIMIT_S)
    except BrowserUnavailableError as error:
        pytest.skip(str(error))
    assert difference(drawn.pixels, scene.render(size=SIZE, samples=1).array).is_agreement
