"""Random trees of shapes, and the values of programs of them, for the tests of pieces."""

from __future__ import annotations

import numpy as np

from distal import Box, Capsule, Cylinder, Ellipsoid, Sphere, Torus, matte
from distal.fields.combine.blends import BLENDS
from distal.ir.build import field
from distal.ir.nodes import Param, Read, Return
from distal.ir.types import VEC3
from distal.lang.composed import Composed
from distal.lang.runtime_access import executor
from distal.scene.lowering.attributes import AttributePoint, SurfaceAttribute, attribute
from distal.scene.lowering.derived import DistanceOf
from distal.scene.lowering.known_bounds import known_bounds_of
from distal.scene.lowering.pieces.builder import build
from distal.scene.lowering.pieces.emission import StepMode
from distal.scene.lowering.pieces.joins import JoinCode, ValueJoin
from distal.scene.lowering.shapes import ZERO_CELL, ShapeComposer
from distal.scene.tree.values import StatementList

WIDE = [name for name, blend in BLENDS.items() if blend.width is not None]


def called(function, args=(), given=None):
    found = executor().call(function, args, given or {}, device="reference")
    return np.asarray(found, float)


def field_of(node, points):
    """The values of a tree."""
    return np.broadcast_to(called(DistanceOf(node), (points,)), len(points))


def joined(join: ValueJoin, *values):
    """The value of a step."""
    numbers = dict(join.numbers)
    if join.code.is_binary:
        return called(join.rule.combine, (), {"a": values[0], "b": values[1], **numbers})
    return called(join.rule.finish, (), {"d": values[0], **numbers})


def program_values(program, of_leaf):
    """The values of a program, from those of its leaves: ``of_leaf(number)``."""
    stack = []
    for step in program.steps:
        if step.leaf >= 0:
            stack.append(of_leaf(step.leaf))
            continue
        join = program.joins[step.join]
        if join.code.is_binary:
            b = stack.pop()
            stack.append(joined(join, stack.pop(), b))
        else:
            stack.append(joined(join, stack.pop()))
    (value,) = stack
    return value


def leaf_values(program, points):
    """The values of each leaf at points, computed once."""
    known = {}

    def of_leaf(number):
        if number not in known:
            known[number] = field_of(program.leaves[number].part, points)
        return known[number]

    return of_leaf


def random_leaf(rng):
    size = rng.uniform(0.1, 0.5)
    shape = (
        lambda: Sphere(size),
        lambda: Box(size, 1.5 * size, 2.0 * size),
        lambda: Torus(size, 0.3 * size),
        lambda: Capsule(0.4 * size, size),
        lambda: Cylinder(0.5 * size, 2.0 * size),
        lambda: Ellipsoid(size, 0.6 * size, 0.8 * size),
    )[rng.integers(6)]()
    if rng.random() < 0.3:
        shape = shape.rotate(x=rng.uniform(0, 3), z=rng.uniform(0, 3))
    shape = shape.translate(*rng.uniform(-0.6, 0.6, 3).tolist())
    return shape.paint(rng.choice(["red", "blue", "lime"])) if rng.random() < 0.3 else shape


def random_tree(rng, leaves, blends=WIDE):
    """A tree of about so many leaves, with every operator that programs take apart."""
    if leaves <= 1:
        return random_leaf(rng)
    soft = {}
    if blends and rng.random() < 0.5:
        soft = {"smooth": rng.uniform(0.01, 0.06), "blend": str(rng.choice(blends))}
        if soft["blend"] == "stairs":
            soft["count"] = 3
    if rng.random() < 0.7:
        count = int(min(rng.integers(2, 5), leaves))
        first, *others = (random_tree(rng, leaves // count, blends) for _ in range(count))
        kind = rng.choice(["union", "union", "difference", "difference", "intersection"])
        if kind == "difference" and rng.random() < 0.3:
            others = [other.cut_material("gold") for other in others]
        if kind == "intersection":
            others = [other | random_leaf(rng).round(0.4) for other in others]
        return getattr(first, kind)(others, **soft)
    inner = random_tree(rng, leaves, blends)
    changes = [
        lambda: inner.translate(0.1, 0.2, -0.1).rotate(y=0.4),
        lambda: inner.scale(rng.uniform(0.7, 1.3)),
        lambda: inner.mirror("x"),
        lambda: inner.round(0.03),
        lambda: inner.offset(-0.01),
        lambda: inner.shell(0.08),
        lambda: inner.clearance(random_leaf(rng), gap=0.05),
    ]
    return changes[rng.integers(len(changes))]()


# Pieces


def bounds_of_leaves(program):
    """Corners, slopes and growths of the leaves."""
    bounds = [known_bounds_of(leaf.part) for leaf in program.leaves]
    low, high = (np.array([getattr(b, name) for b in bounds], float) for name in ("low", "high"))
    slopes, growths = (
        np.array([getattr(b, name) for b in bounds], float) for name in ("slope", "side_growth")
    )
    return low, high, slopes, growths


def distances_of(program):
    """The distances of points to leaves, each to its own, as the ends of intervals."""

    def distances(points, leaves):
        found = np.empty(len(points))
        for leaf in np.unique(leaves).tolist():
            chosen = leaves == leaf
            found[chosen] = field_of(program.leaves[leaf].part, points[chosen])
        return found, found

    return distances


def pieces_of(program, limits):
    low, high, slopes, growths = bounds_of_leaves(program)
    return build(program, low, high, slopes, distances_of(program), limits, growths)


def step_values(steps, joins, of_leaf):
    """The values of a piece's steps, and the leaf of each complement that names one."""
    value, aside = None, []
    for mode, leaf, join in steps.tolist():
        if mode == StepMode.LOAD:
            value = of_leaf(leaf)
        elif mode == StepMode.PUSH:
            aside.append(value)
            value = of_leaf(leaf)
        elif mode == StepMode.JOIN:
            value = joined(joins[join], value, of_leaf(leaf))
        elif mode == StepMode.POP:
            value = joined(joins[join], aside.pop(), value)
        else:
            value = joined(joins[join], value)
    assert not aside
    return value


# Materials


class ColorOf(Composed):
    """The color that a tree shows at a point."""

    signature = (("p", VEC3),)
    result = VEC3
    name = "color"

    def __init__(self, node):
        self._node = node

    def compose(self, assembly):
        node = self._node
        composer = ShapeComposer(assembly, [node])
        kind = SurfaceAttribute(composer, matte("white"))
        body = StatementList(taken={"p"})
        site = AttributePoint(Read("p", VEC3), ZERO_CELL, composer.values.all(node))
        shown = attribute(body, kind, node, site)
        body.statements.append(Return(field(body.let("shown", shown), "color")))
        return assembly.define("color", (Param("p", VEC3),), VEC3, body.statements)


def colors_of(node, points):
    """The colors that a tree shows."""
    return np.broadcast_to(called(ColorOf(node), (points,)), points.shape)


def _share(join, a, b):
    if join.code is JoinCode.DIFFERENCE and not join.shows_cutter:
        return np.zeros(len(a), bool)
    if join.mix is None:
        return b < a
    return called(join.mix, (), {"a": a, "b": b, **dict(join.numbers)}) > 0.5


def shown_look(program, of_leaf):
    """The look that a program shows."""
    stack = []
    for step in program.steps:
        if step.leaf >= 0:
            value = of_leaf(step.leaf)
            stack.append((value, np.full(len(value), program.looks[step.leaf])))
            continue
        join = program.joins[step.join]
        if not join.code.is_binary:
            value, look = stack.pop()
            stack.append((joined(join, value), look))
            continue
        (b, other), (a, look) = stack.pop(), stack.pop()
        stack.append((joined(join, a, b), np.where(_share(join, a, b), other, look)))
    return stack[0][1]


def look_of_piece(steps, program, joins, of_leaf):
    """The look that a piece shows."""
    aside = []
    value = look = None
    for mode, leaf, join in steps.tolist():
        of = value, look
        if leaf >= 0 and mode != StepMode.ONE:
            d = of_leaf(leaf)
            of = d, np.full(len(d), program.looks[leaf])
        if mode == StepMode.PUSH:
            aside.append((value, look))
        if mode in (StepMode.LOAD, StepMode.PUSH):
            value, look = of
        elif mode == StepMode.ONE:
            value = joined(joins[join], value)
            look = look if leaf < 0 else np.full(len(value), program.looks[leaf])
        else:
            a, shown = aside.pop() if mode == StepMode.POP else (value, look)
            look = np.where(_share(joins[join], a, of[0]), of[1], shown)
            value = joined(joins[join], a, of[0])
    return look
