"""The search for places where a field is steeper than it says.

Input: a subject. Output: the steepest pair of points that was found.

Whatever is steep between two points is at least as steep on one half of the way; halving the way
again and again leads to the steepest place, and straight into a jump.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from tests.fields.rows import Doubles
from tests.fields.subject import Subject

HALVINGS: Final = 14
CLIMBS: Final = 9
SHORTEST: Final = 1e-6  # in scales: rounding of 64 bits stays far below what is measured


@dataclass(frozen=True, slots=True)
class Steepest:
    """The steepest pair that was found: its slope, its ends."""

    slope: float
    start: Doubles
    end: Doubles


def steepest(
    subject: Subject, surface: Doubles, rng: np.random.Generator, *, pairs: int = 3000
) -> Steepest:
    """Search pairs far and near, in the region, near the surface and far away; then climb."""
    starts, ends = _pairs(subject, surface, rng, pairs)
    steep_starts, steep_ends = _where_gradients_are_long(subject, rng, 8 * pairs)
    starts, ends = np.concatenate([starts, steep_starts]), np.concatenate([ends, steep_ends])
    starts, ends, slope = _halved(subject, starts, ends)
    for climb in range(CLIMBS):
        best = np.argsort(slope)[-64:]
        a, b = np.repeat(starts[best], 6, axis=0), np.repeat(ends[best], 6, axis=0)
        reach = subject.scale * 0.1 * 0.3**climb
        shift = rng.normal(size=a.shape) * reach * rng.choice([0.1, 1.0], (len(a), 1))
        length = np.linalg.norm(b - a, axis=1, keepdims=True)
        turn = rng.normal(size=a.shape) * length * rng.choice([0.1, 1.0], (len(a), 1))
        tried_a, tried_b, tried = _halved(subject, a + shift, b + shift + turn)
        starts = np.concatenate([starts[best], tried_a])
        ends = np.concatenate([ends[best], tried_b])
        slope = np.concatenate([slope[best], tried])
    top = int(np.argmax(slope))
    return Steepest(float(slope[top]), starts[top], ends[top])


def _pairs(
    subject: Subject, surface: Doubles, rng: np.random.Generator, count: int
) -> tuple[Doubles, Doubles]:
    low, high = subject.region
    scale, size = subject.scale, (count, subject.dimension)
    parts = [
        rng.uniform(low - 0.5 * scale, high + 0.5 * scale, size),
        rng.normal(size=(count // 4, subject.dimension)) * 8.0 * scale,
        rng.normal(size=(count // 4, subject.dimension))
        * rng.choice([1e-3, 1e-1], (count // 4, 1)),
    ]
    if len(surface):
        near = surface[rng.integers(len(surface), size=count)]
        parts.append(near + rng.normal(size=size) * rng.choice([1e-3, 0.03], (count, 1)) * scale)
    starts = np.concatenate(parts)
    # Along an axis symmetric shapes have their kinks; a random direction meets everything else.
    step = rng.normal(size=starts.shape)
    alone = rng.random(len(starts)) < 0.3
    step[alone] *= np.eye(subject.dimension)[rng.integers(subject.dimension, size=alone.sum())]
    step /= np.maximum(np.linalg.norm(step, axis=1, keepdims=True), 1e-12)
    far = np.linalg.norm(starts, axis=1, keepdims=True) > 3.0 * scale
    reach = scale * 10.0 ** rng.uniform(-4.0, 0.3, (len(starts), 1)) * np.where(far, 10.0, 1.0)
    return starts, starts + step * reach


def _where_gradients_are_long(
    subject: Subject, rng: np.random.Generator, count: int
) -> tuple[Doubles, Doubles]:
    """Short pairs along the longest of very many gradients: they only tell where to look."""
    low, high = subject.region
    margin = 0.3 * (high - low) + 0.1 * subject.scale
    points = rng.uniform(low - margin, high + margin, (count, subject.dimension))
    gradients = subject.evaluate(points)[1]
    length = np.linalg.norm(gradients, axis=1)
    top = np.argsort(np.where(np.isfinite(length), length, 0.0))[-96:]
    way = gradients[top] / np.maximum(length[top], 1e-12)[:, None]
    return points[top], points[top] + 1e-4 * subject.scale * way


def _halved(subject: Subject, a: Doubles, b: Doubles) -> tuple[Doubles, Doubles, Doubles]:
    """The steepest of the ever shorter pairs within each pair."""
    d_a, d_b = subject.value(a), subject.value(b)
    slope = _slope(a, b, d_a, d_b)
    best_a, best_b, best = a, b, slope
    for _ in range(HALVINGS):
        m = 0.5 * (a + b)
        d_m = subject.value(m)
        left, right = _slope(a, m, d_a, d_m), _slope(m, b, d_m, d_b)
        first = left >= right
        # Too short to measure: the pair stays as it is.
        long = np.linalg.norm(b - a, axis=1) > 2.0 * SHORTEST * subject.scale
        to_m, from_m = first & long, ~first & long
        a, d_a = np.where(from_m[:, None], m, a), np.where(from_m, d_m, d_a)
        b, d_b = np.where(to_m[:, None], m, b), np.where(to_m, d_m, d_b)
        slope = np.where(long, np.maximum(left, right), slope)
        better = slope > best
        best_a, best_b = np.where(better[:, None], a, best_a), np.where(better[:, None], b, best_b)
        best = np.where(better, slope, best)
    return best_a, best_b, best


def _slope(a: Doubles, b: Doubles, d_a: Doubles, d_b: Doubles) -> Doubles:
    way = np.linalg.norm(b - a, axis=1)
    # What 64 bits round off far from the origin is no slope.
    noise = 1e-14 * (np.abs(d_a) + np.abs(d_b) + np.linalg.norm(a, axis=1))
    rise = np.maximum(np.abs(d_a - d_b) - noise, 0.0)
    return np.asarray(np.where(way > 0.0, rise / np.maximum(way, 1e-300), 0.0))
