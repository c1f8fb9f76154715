"""Points on the surface of a field, found without trusting what it promises.

Input: a subject. Output: points where its value is zero, and the places where the
sign changes without passing through zero.

Two ways, since each misses what the other finds: edges of a grid whose ends differ in sign, halved
until nothing is left of them; and random points that walk down (or up) the gradient, which also
finds walls thinner than a cell and surfaces without an inside.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from tests.fields.rows import Doubles
from tests.fields.subject import Subject

HALVINGS: Final = 48
WALK: Final = 24
ON_SURFACE: Final = 1e-8  # in scales
JUMP: Final = 1e-6  # in scales: less is what formulas with roots of small differences round off


@dataclass(frozen=True, slots=True)
class Surface:
    """What was found.

    Attributes:
        points: Points of the surface (n, dimension).
        jumps: Points where the sign changes but the value does not come near zero.
    """

    points: Doubles
    jumps: Doubles


def surface_of(
    subject: Subject, rng: np.random.Generator, *, edges: int = 8000, walkers: int = 4000
) -> Surface:
    """Points of the surface within the region and a little around it."""
    low, high = subject.region
    margin = 0.1 * subject.scale
    low, high = low - margin, high + margin
    crossings, jumps = _crossings(subject, low, high, edges, rng)
    reached = walked(subject, rng.uniform(low, high, (walkers, subject.dimension)))
    return Surface(np.concatenate([crossings, reached]), jumps)


def walked(subject: Subject, points: Doubles) -> Doubles:
    """Where points arrive that follow the gradient to the surface; the rest is left out."""
    x = points.copy()
    for _ in range(WALK):
        d, g = subject.evaluate(x)
        square = np.maximum(np.sum(g * g, axis=1), 1e-3)
        x = x - (d / square)[:, None] * g
    d = subject.value(x)
    return x[np.abs(d) <= ON_SURFACE * subject.scale]


def _crossings(
    subject: Subject, low: Doubles, high: Doubles, most: int, rng: np.random.Generator
) -> tuple[Doubles, Doubles]:
    starts, ends = _edges(subject, low, high, rng)
    empty = np.zeros((0, subject.dimension))
    if not len(starts):
        return empty, empty
    if len(starts) > most:
        chosen = rng.choice(len(starts), most, replace=False)
        starts, ends = starts[chosen], ends[chosen]
    for _ in range(HALVINGS):
        middle = 0.5 * (starts + ends)
        inside = (subject.value(middle) < 0.0)[:, None]
        starts, ends = np.where(inside, middle, starts), np.where(inside, ends, middle)
    # The inner end is the start: whoever has an inside has points of it here.
    value = np.minimum(np.abs(subject.value(starts)), np.abs(subject.value(ends)))
    jumped = value > JUMP * subject.scale * max(1.0, min(subject.slope, 1e3))
    return 0.5 * (starts + ends)[~jumped], starts[jumped]


def _edges(
    subject: Subject, low: Doubles, high: Doubles, rng: np.random.Generator
) -> tuple[Doubles, Doubles]:
    """The edges of a grid from inside to outside. The grid lies askew, off all symmetries."""
    count = 200 if subject.dimension == 2 else 36
    axes = [
        np.linspace(a, b, count) + rng.uniform(-0.5, 0.5) * (b - a) / count
        for a, b in zip(low, high, strict=True)
    ]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    inside = (subject.value(grid.reshape(-1, subject.dimension)) < 0.0).reshape(grid.shape[:-1])
    starts, ends = [], []
    for axis in range(subject.dimension):
        a = grid.take(range(count - 1), axis)
        b = grid.take(range(1, count), axis)
        a_in, b_in = inside.take(range(count - 1), axis), inside.take(range(1, count), axis)
        starts += [a[a_in & ~b_in], b[b_in & ~a_in]]
        ends += [b[a_in & ~b_in], a[b_in & ~a_in]]
    return np.concatenate(starts), np.concatenate(ends)
