"""Deep trees: a turtle moves and turns all that it has drawn so far with each step."""

from __future__ import annotations

import math

import numpy as np
import pytest

import distal
from distal import Box, Circle, CompileError, Rectangle, Scene, Sphere
from distal.lang import slider
from distal.scene.lowering import nesting

RANDOM = np.random.default_rng(11)


def rotation(axis, angle: float) -> np.ndarray:
    x, y, z = axis
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + math.sin(angle) * k + (1 - math.cos(angle)) * k @ k


def unit(n: int) -> np.ndarray:
    v = RANDOM.normal(size=n)
    return v / np.linalg.norm(v)


def step(shape):
    """Apply a random operator: the shape, and what it does to points outside and to values."""
    kind, flat = RANDOM.integers(9), shape.flat
    n = 2 if flat else 3
    if kind == 0:
        v = RANDOM.uniform(-0.1, 0.1, n)
        return shape.translate(tuple(v)), lambda p: p - v, 1.0
    if kind == 1:
        factor = float(RANDOM.uniform(0.97, 1.03))
        return shape.scale(factor), lambda p: p / factor, factor
    if kind == 7:
        normal, offset = unit(n), float(RANDOM.uniform(-0.1, 0.1))
        image = shape.mirror(across=tuple(normal), offset=offset)
        return image, lambda p: p - 2 * (p @ normal - offset)[:, None] * normal, 1.0
    if kind == 8:
        axis = int(RANDOM.integers(n))
        return shape.mirror("xyz"[axis]), lambda p: p * (1.0 - 2.0 * np.eye(n)[axis]), 1.0
    if kind in (2, 3):
        normal, offset = unit(n), float(RANDOM.uniform(-0.3, 0.0))

        def back(p):
            return p - 2 * np.minimum(p @ normal - offset, 0.0)[:, None] * normal

        return shape.symmetry(across=tuple(normal), offset=offset), back, 1.0
    if kind == 4:
        names = "xy" if flat else "xyz"
        axis = int(RANDOM.integers(n))
        signs = np.eye(n)[axis]
        return shape.symmetry(names[axis]), lambda p: np.where(signs, np.abs(p), p), 1.0
    angle = float(RANDOM.uniform(-3, 3))
    if flat:
        m = rotation((0, 0, 1), angle)[:2, :2]
        return shape.rotate(angle), lambda p: p @ m, 1.0
    axis = unit(3)
    m = rotation(axis, angle)
    way = RANDOM.integers(5)
    if way == 0:
        return shape.rotate(angle, axis=tuple(axis)), lambda p: p @ m, 1.0
    if way == 1:
        turned = shape.rotate(quaternion=(*math.sin(angle / 2) * axis, math.cos(angle / 2)))
        return turned, lambda p: p @ m, 1.0
    if way == 2:
        return shape.rotate(matrix=m), lambda p: p @ m, 1.0
    if way == 3:
        m = rotation((0, 1, 0), angle)
        return shape.rotate(y=angle), lambda p: p @ m, 1.0
    m = rotation((0, 0, 1), 0.3) @ rotation((0, 1, 0), angle) @ rotation((1, 0, 0), 0.7)
    return shape.rotate(x=0.7, y=angle, z=0.3), lambda p: p @ m, 1.0


# No mirror image of them is themselves.
SOLID = Box(1, 0.6, 0.4) - Sphere(0.3).translate(0.5, 0.3, 0.2)
FLAT = Rectangle(1, 0.6) - Circle(0.3).translate(0.5, 0.3)


@pytest.mark.parametrize("shape", [SOLID, FLAT], ids=["solid", "flat"])
def test_placements_in_a_long_row_give_the_values_of_one_after_the_other(shape):
    backs, factor, leaf = [], 1.0, shape
    for _ in range(400):
        shape, back, grown = step(shape)
        backs.append(back)
        factor *= grown
    assert shape.node.nesting < nesting.FOLDED_FROM + 32
    p = q = RANDOM.uniform(-2, 2, (500, 2 if shape.flat else 3))
    for back in reversed(backs):
        q = back(q)
    assert np.abs(shape(p) - factor * leaf(q)).max() < 2e-4
    inside = p[shape(p) < 0.0]
    low, high = map(np.array, shape.bounds())
    assert ((inside >= low) & (inside <= high)).all()


@pytest.mark.parametrize("leaf", [SOLID, FLAT], ids=["solid", "flat"])
def test_mirror_images_in_a_long_row_keep_their_hand(leaf):
    n = 2 if leaf.flat else 3
    normal, m = np.array((0.6, 0.8, 0.0)[:n]), rotation((0, 0, 1), 0.3)[:n, :n]
    p = q = RANDOM.uniform(-2, 2, (100, n))
    shape, backs = leaf, []
    for count in range(120):
        if count % 5 == 0:
            shape = shape.mirror(across=tuple(normal), offset=0.1)
            backs.append(lambda p: p - 2 * (p @ normal - 0.1)[:, None] * normal)
        else:
            shape = shape.rotate(0.3) if leaf.flat else shape.rotate(z=0.3)
            backs.append(lambda p: p @ m)
        if count > 60:
            q = p
            for back in reversed(backs):
                q = back(q)
            assert np.abs(shape(p) - leaf(q)).max() < 1e-5
    assert shape.node.nesting < nesting.FOLDED_FROM + 32


def test_a_turtle_of_two_thousand_steps():
    count, turn, drawn = 2000, 0.1, Sphere(0.2)
    for _ in range(count):
        drawn = (drawn.translate(0.3, 0, 0).rotate(y=turn) | Sphere(0.2)).translate(0, 0.01, 0)
    places, m = np.zeros((1, 3)), rotation((0, 1, 0), turn)
    ahead, up = np.array([0.3, 0, 0]), np.array([0, 0.01, 0])
    for _ in range(count):
        places = np.vstack([(places + ahead) @ m.T, np.zeros(3)]) + up
    p = RANDOM.uniform((-4, 0, -7), (7, 21, 4), (300, 3))
    true = np.linalg.norm(p[:, None] - places[None], axis=2).min(axis=1) - 0.2
    assert np.abs(drawn(p) - true).max() < 1e-3
    text = distal.compile(Scene(drawn), "wgsl").text
    assert len(text) < 400_000
    assert distal.compile(Scene(drawn), "glsl-es300").text


def test_a_deep_tree_keeps_materials_and_labels(monkeypatch):
    def turtle():
        made = Box(1, 0.5, 0.5).paint("red")
        for i in range(10):
            made = made.translate(0.2, 0, 0).rotate(z=0.2)
            made = made | Sphere(0.3).paint("blue" if i % 2 else "lime")
            if i == 5:
                made = made.named("half").scale(0.9)
            if i == 7:
                made = (made - Sphere(0.2)).translate(0, 0.2, 0)
        return made

    plain = turtle()
    monkeypatch.setattr(nesting, "FOLDED_FROM", 3)
    monkeypatch.setattr(nesting, "_STEP", 2)
    deep = turtle()
    assert deep.node.nesting < plain.node.nesting
    assert any(node.label == "half" for node in deep.node.walk())
    colors = [Scene(s).render((60, 45), device="reference").array[..., :3] for s in (plain, deep)]
    off = np.abs(colors[0].astype(float) - colors[1].astype(float)).max(axis=2)
    assert (off > 8).mean() < 0.01


def test_what_cannot_be_folded_is_lowered_while_it_is_not_too_deep():
    amount, deep = slider("Amount", 0.01, 0, 1), Box(1)
    for _ in range(nesting.MOST_NESTED - 1):
        deep = deep.translate(amount, 0, 0)
    assert deep((3.0, 0, 0)) == pytest.approx(3.0 - 2.99 - 0.5, abs=1e-4)
    with pytest.raises(CompileError) as error:
        deep.translate(amount, 0, 0).translate(amount, 0, 0)
    assert "is the last of 301 operators, each on the result of the one before" in str(error.value)
    assert "test_nesting.py" in str(error.value)


def test_a_shallow_tree_stays_as_it_was_written():
    made = Circle(1)
    for _ in range(nesting.FOLDED_FROM - 1):
        made = made.translate(0.1, 0)
    assert made.node.nesting == nesting.FOLDED_FROM - 1
