"""The promises of a field held against few points: for many shapes rather than thoroughly.

Input: a subject. Output: findings, as those of ``checks``, whose comparisons these
are. The surface is found without trusting a promise: by halving segments from outside to inside.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from tests.fields.checks import (
    STEEP,
    Report,
    at,
    distances_hold,
    levels_hold,
    promises_are_numbers,
    steps_are_safe,
)
from tests.fields.rows import Doubles
from tests.fields.subject import Subject

HALVINGS: Final = 30
NEWTON: Final = 2
NOISE: Final = 1e-12  # of a value, in scales
SLACK: Final = 1e-6  # in scales


def glanced(subject: Subject, seed: int, *, count: int = 300) -> Report:
    """Everything about one subject, at about four times so many points."""
    report, rng = Report(), np.random.default_rng(seed)
    if not promises_are_numbers(subject, report):
        return report
    points = _points(subject, rng, count)
    d, g = subject.evaluate(points)
    if not np.all(np.isfinite(d)) or not np.all(np.isfinite(g)):
        bad = points[~(np.isfinite(d) & np.isfinite(g).all(axis=1))]
        report.add(subject, f"no number at {at(bad[0])} ({len(bad)} of {len(points)} points)")
        return report
    near = _toward_surface(subject, points[: 2 * count])
    surface = _crossings(subject, np.concatenate([points, near]), rng, count // 4)
    every = np.concatenate([points, near, surface])
    d, g = subject.evaluate(every)
    _box_holds(subject, every, d, report)
    levels_hold(subject, every, d, report)
    _segments_hold(subject, every, d, g, rng, report)
    if len(surface):
        steps_are_safe(subject, surface, every, d, report)
        if not subject.estimate:
            distances_hold(subject, surface, points, *subject.evaluate(points), report)
    return report


def _points(subject: Subject, rng: np.random.Generator, count: int) -> Doubles:
    low, high = subject.region
    scale, size = subject.scale, subject.dimension
    return np.concatenate(
        [
            rng.uniform(low - 0.02 * scale, high + 0.02 * scale, (count, size)),
            rng.uniform(low - 0.6 * scale, high + 0.6 * scale, (count, size)),
            0.5 * (low + high) + rng.normal(size=(count // 4, size)) * 6.0 * scale,
        ]
    )


def _toward_surface(subject: Subject, points: Doubles) -> Doubles:
    """Points moved along the gradient: most come close to the surface."""
    x = points
    for _ in range(NEWTON):
        d, g = subject.evaluate(x)
        x = x - (d / np.maximum(np.sum(g * g, axis=1), 1e-3))[:, None] * g
    far = np.linalg.norm(x - points, axis=1) > 20.0 * subject.scale
    return x[~far & np.isfinite(x).all(axis=1)]


def _crossings(subject: Subject, points: Doubles, rng: np.random.Generator, count: int) -> Doubles:
    """The ends, from inside, of halved segments from a point inside to one outside."""
    inside = subject.value(points) < 0.0
    if inside.all() or not inside.any():
        return np.zeros((0, subject.dimension))
    starts = rng.choice(points[inside], count)
    ends = rng.choice(points[~inside], count)
    for _ in range(HALVINGS):
        middle = 0.5 * (starts + ends)
        within = (subject.value(middle) < 0.0)[:, None]
        starts, ends = np.where(within, middle, starts), np.where(within, ends, middle)
    return starts


def _box_holds(subject: Subject, points: Doubles, d: Doubles, report: Report) -> None:
    slack = SLACK * (subject.scale + np.linalg.norm(points, axis=1))
    beyond = np.maximum(subject.low - points, points - subject.high).max(axis=1)
    bad = np.where((d < -NOISE * slack / SLACK) & (beyond > slack), beyond, 0.0)
    worst = int(np.argmax(bad))
    if bad[worst] > 0.0:
        report.add(
            subject,
            f"the box {at(subject.low)} to {at(subject.high)} leaves out the inside at"
            f" {at(points[worst])}, by {bad[worst]:.4g}",
        )


def _segments_hold(
    subject: Subject,
    points: Doubles,
    d: Doubles,
    g: Doubles,
    rng: np.random.Generator,
    report: Report,
) -> None:
    """The slope along segments, half of them where the value changes fastest."""
    if subject.estimate:
        return
    step = rng.normal(size=points.shape)
    steep = np.linalg.norm(g, axis=1) > 1e-9
    steep[::2] = False
    step[steep] = g[steep]
    step /= np.linalg.norm(step, axis=1, keepdims=True)
    length = subject.scale * 10.0 ** rng.uniform(-4.0, -0.3, (len(points), 1))
    ends = points + length * step
    noise = NOISE * (subject.scale + np.linalg.norm(points, axis=1))
    rise = (np.abs(subject.value(ends) - d) - noise) / length[:, 0]
    worst = int(np.argmax(rise))
    report.slope = float(rise[worst])
    if report.slope > subject.slope * (1.0 + STEEP):
        report.add(
            subject,
            f"promises slope {subject.slope:.6g}, but rises by {report.slope:.6g} per unit from"
            f" {at(points[worst])} to {at(ends[worst])}",
        )
