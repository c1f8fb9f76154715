"""What is held against what: a field's promises against what it does.

Input: subjects and samples. Output: findings, one sentence each, and what was
measured on the way. No finding means that nothing was found, at this number of points.

A value f at p is the distance when two things hold: no point of the surface is nearer than |f|, and
some point of the surface is as near as |f|. The first is held against points of the surface found
by halving edges of a grid, with no error but their own. For the second a witness is sought: the
point that the gradient tells, else the nearest of the found ones, moved along the surface.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

import numpy as np
from scipy.spatial import cKDTree

from distal.fields.guarantees import UNBOUNDED, Guarantee
from tests.fields.rows import Doubles, Sample
from tests.fields.slopes import steepest
from tests.fields.subject import Subject
from tests.fields.surface import Surface, surface_of

NEAR: Final = 1e-6  # in scales: how near a witness must come
OVER: Final = 3e-7  # in scales: how much too far a distance may be
STEEP: Final = 1e-5  # how much steeper than promised, as a share
NOT_UNIT: Final = 2e-3  # share of points on creases that are forgiven


@dataclass(slots=True)
class Report:
    """What was found about one subject.

    Attributes:
        findings: Sentences; none when all is well.
        error: The largest difference from the true distance, where exactness is claimed.
        slope: The steepest that was seen.
        points: How many points were compared.
    """

    findings: list[str] = field(default_factory=list)
    error: float = 0.0
    slope: float = 0.0
    points: int = 0

    def add(self, subject: Subject, text: str) -> None:
        """Keep a finding."""
        self.findings.append(f"{subject.name}: {text}")


def examined(subject: Subject, seed: int, *, effort: float = 1.0) -> Report:
    """Everything about one subject."""
    report, rng = Report(), np.random.default_rng(seed)
    if not promises_are_numbers(subject, report):
        return report
    surface = surface_of(subject, rng, edges=int(6000 * effort), walkers=int(2000 * effort))
    _surface_is_sound(subject, surface, report)
    _box_holds(subject, surface, rng, report)
    points = _points(subject, surface, rng, int(1500 * effort))
    d, g = subject.evaluate(points)
    if not np.all(np.isfinite(d)) or not np.all(np.isfinite(g)):
        bad = points[~(np.isfinite(d) & np.isfinite(g).all(axis=1))]
        report.add(subject, f"no number at {at(bad[0])} ({len(bad)} of {len(points)} points)")
        return report
    report.points = len(points)
    levels_hold(subject, points, d, report)
    if len(surface.points):
        steps_are_safe(subject, surface.points, points, d, report)
        distances_hold(subject, surface.points, points, d, g, report)
    _slope_holds(subject, surface.points, rng, report, effort)
    return report


def promises_are_numbers(subject: Subject, report: Report) -> bool:
    """Whether a subject can be looked at."""
    if not 0.0 <= subject.slope < UNBOUNDED / 1000.0:
        report.add(subject, f"the slope's bound is {subject.slope}")
        return False
    if np.isnan(subject.low).any() or np.isnan(subject.high).any():
        report.add(subject, f"the box is {subject.low} to {subject.high}")
        return False
    return True


def _surface_is_sound(subject: Subject, surface: Surface, report: Report) -> None:
    if not len(surface.points) and not subject.empty:
        report.add(subject, "has no surface in its region")
    if len(surface.jumps):
        report.add(
            subject,
            f"the sign jumps at {at(surface.jumps[0])}, where the value is"
            f" {subject.value(surface.jumps[:1])[0]:.4g} ({len(surface.jumps)} places)",
        )
    bare = len(surface.points) > 0 and not _has_inside(subject, surface)
    if subject.signed and not subject.hollow and bare:
        report.add(subject, "says it has an inside, but is nowhere negative")
    if not subject.signed:
        low, high = subject.region
        grid = np.random.default_rng(5).uniform(low, high, (4000, subject.dimension))
        least = float(np.min(subject.value(grid)))
        if least < 0.0:
            report.add(subject, f"says it has no inside, but is {least:.4g}")


def _has_inside(subject: Subject, surface: Surface) -> bool:
    rng = np.random.default_rng(5)
    spread = subject.scale * 10.0 ** rng.uniform(-5.0, -1.0, (len(surface.points), 1))
    near = surface.points + rng.normal(size=surface.points.shape) * spread
    return bool((subject.value(near) < -1e-9 * subject.scale).any())


def _box_holds(
    subject: Subject, surface: Surface, rng: np.random.Generator, report: Report
) -> None:
    # A bound may be far smaller than the distance: what counts as its surface lies near it only.
    slack = 1e-6 * subject.scale
    points = surface.points
    low, high = subject.region
    around = rng.uniform(
        low - 1.5 * subject.scale, high + 1.5 * subject.scale, (6000, subject.dimension)
    )
    inside = around[subject.value(around) < 0.0]
    for what, held in (("surface", points), ("inside", inside)):
        outside = (held < subject.low - slack) | (held > subject.high + slack)
        bad = held[outside.any(axis=1)]
        if len(bad):
            far = np.maximum(subject.low - bad, bad - subject.high)
            worst = int(np.argmax(far.max(axis=1)))
            report.add(
                subject,
                f"the box {at(subject.low)} to {at(subject.high)} leaves out the {what} at"
                f" {at(bad[worst])}, by {far[worst].max():.4g}",
            )


def levels_hold(subject: Subject, points: Doubles, d: Doubles, report: Report) -> None:
    """A point outside the box is at most growth times its value away from it."""
    if not 0.0 < subject.side_growth <= subject.growth * (1.0 + 1e-6):
        report.add(subject, f"the growth is {subject.growth}, of sides {subject.side_growth}")
        return
    beyond = np.maximum(np.maximum(subject.low - points, points - subject.high), 0.0)
    size = subject.scale + np.linalg.norm(points, axis=1)
    for what, away, growth in (
        ("box", np.linalg.norm(beyond, axis=1), subject.growth),
        ("side", beyond.max(axis=1), subject.side_growth),
    ):
        if growth >= UNBOUNDED / 1000.0:
            continue
        over = np.where(away > 0.0, away - growth * np.maximum(d, 0.0), 0.0) / size
        worst = int(np.argmax(over))
        if over[worst] > OVER:
            report.add(
                subject,
                f"{at(points[worst])} is {away[worst]:.6g} from the {what}, its value"
                f" {d[worst]:.6g}, but the growth {growth:.6g} ({(over > OVER).sum()} points)",
            )


def _points(subject: Subject, surface: Surface, rng: np.random.Generator, count: int) -> Doubles:
    """Anywhere in the region, close to the surface, and far away."""
    low, high = subject.region
    scale, size = subject.scale, subject.dimension
    parts = [
        rng.uniform(low, high, (count, size)),
        rng.uniform(low - 0.6 * scale, high + 0.6 * scale, (count // 2, size)),
        0.5 * (low + high) + rng.normal(size=(count // 8, size)) * 6.0 * scale,
    ]
    if len(surface.points):
        near = surface.points[rng.integers(len(surface.points), size=count)]
        spread = 10.0 ** rng.uniform(-3.0, -0.7, (count, 1))
        parts.append(near + rng.normal(size=near.shape) * spread * scale)
    return np.concatenate(parts)


def steps_are_safe(
    subject: Subject, surface: Doubles, points: Doubles, d: Doubles, report: Report
) -> None:
    """No step from outside goes farther than the nearest surface."""
    nearest, index = cKDTree(surface).query(points)
    step = np.where(d > 0.0, d / max(subject.divisor, 1e-9), 0.0)
    over = step - nearest - OVER * (subject.scale + np.linalg.norm(points, axis=1))
    worst = int(np.argmax(over))
    if over[worst] > 0.0 and not subject.estimate:
        report.add(
            subject,
            f"a step from {at(points[worst])} goes {step[worst]:.6g} far, past the surface at"
            f" {at(surface[index[worst]])}, {nearest[worst]:.6g} away",
        )


def distances_hold(
    subject: Subject, surface: Doubles, points: Doubles, d: Doubles, g: Doubles, report: Report
) -> None:
    """Values that claim to be the distance, or below it, are."""
    claims = subject.claims
    outside = (d > 0.0) & bool(claims & {Guarantee.LOWER_BOUND, Guarantee.EXACT_OUTSIDE})
    inside = (d < 0.0) & (Guarantee.EXACT_INSIDE in claims)
    checked = outside | inside
    if not checked.any():
        return
    tree = cKDTree(surface)
    nearest, index = tree.query(points)
    size = subject.scale + np.linalg.norm(points, axis=1)
    over = np.where(checked, np.abs(d) - nearest, -np.inf)
    worst = int(np.argmax(over - OVER * size))
    if over[worst] > OVER * size[worst]:
        side = "outside" if d[worst] > 0.0 else "inside"
        report.add(
            subject,
            f"{side} at {at(points[worst])} the value is {d[worst]:.6g}, the surface at"
            f" {at(surface[index[worst]])} is {nearest[worst]:.6g} away",
        )
    exact = ((d > 0.0) & (Guarantee.EXACT_OUTSIDE in claims)) | inside
    # Beyond the region the surface of an endless shape was not searched; the witness still serves.
    if exact.any():
        witness = np.minimum(
            _witnessed(subject, points, d, g), _moved(subject, points, surface[index], nearest)
        )
        lacking = np.where(exact, witness - np.abs(d), 0.0)
        report.error = float(np.max(np.maximum(np.where(exact, over, 0.0), np.abs(lacking))))
        worst = int(np.argmax(lacking - NEAR * size))
        if lacking[worst] > NEAR * size[worst]:
            side = "outside" if d[worst] > 0.0 else "inside"
            count = int(np.sum(lacking > NEAR * size))
            report.add(
                subject,
                f"{side} at {at(points[worst])} the value is {d[worst]:.6g}, but the surface is"
                f" {witness[worst]:.6g} away ({count} of {int(exact.sum())} points)",
            )
        _gradient_is_unit(subject, points[exact], g[exact], report)


def _witnessed(subject: Subject, points: Doubles, d: Doubles, g: Doubles) -> Doubles:
    """How far the point is that the gradient tells, where that lies on the surface."""
    length = np.maximum(np.linalg.norm(g, axis=1, keepdims=True), 1e-9)
    foot = points - d[:, None] * g / length
    return _confirmed(subject, points, foot)


def _confirmed(subject: Subject, points: Doubles, feet: Doubles) -> Doubles:
    size = subject.scale + np.linalg.norm(points, axis=1)
    on = np.abs(subject.value(feet)) <= 0.3 * NEAR * size
    return np.asarray(np.where(on, np.linalg.norm(points - feet, axis=1), np.inf))


def _moved(subject: Subject, points: Doubles, feet: Doubles, nearest: Doubles) -> Doubles:
    """How far the nearest found point is, once it has been moved along the surface."""
    x, best = feet.copy(), nearest.copy()
    for _ in range(12):
        d, g = subject.evaluate(x)
        n = g / np.maximum(np.linalg.norm(g, axis=1, keepdims=True), 1e-9)
        to_point = points - x
        tangent = to_point - np.sum(to_point * n, axis=1, keepdims=True) * n
        x = x + 0.7 * tangent
        for _ in range(2):
            d, g = subject.evaluate(x)
            square = np.maximum(np.sum(g * g, axis=1), 1e-3)
            x = x - (d / square)[:, None] * g
        best = np.minimum(best, _confirmed(subject, points, x))
    return best


def _gradient_is_unit(subject: Subject, points: Doubles, g: Doubles, report: Report) -> None:
    length = np.linalg.norm(g, axis=1)
    off = np.abs(length - 1.0) > 1e-5
    if off.mean() > NOT_UNIT:
        where = points[off][0]
        report.add(
            subject,
            f"claims exactness, but |gradient| is {length[off][0]:.6g} at {at(where)}"
            f" ({off.sum()} of {len(off)} points)",
        )


def _slope_holds(
    subject: Subject, surface: Doubles, rng: np.random.Generator, report: Report, effort: float
) -> None:
    found = steepest(subject, surface, rng, pairs=int(1500 * effort))
    report.slope = found.slope
    if not subject.estimate and found.slope > subject.slope * (1.0 + STEEP):
        report.add(
            subject,
            f"promises slope {subject.slope:.6g}, but rises by {found.slope:.6g} per unit from"
            f" {at(found.start)} to {at(found.end)}",
        )


# Numbers at special places


def special_points(subject: Subject) -> Doubles:
    """The origin, axes, corners, far away and next to zero."""
    low, high = subject.region
    far = 1e6
    columns = []
    for a, b in zip(low, high, strict=True):
        columns.append([0.0, 1e-6, -1e-6, a, b, 0.5 * b, 1.0, -1.0, far, -far])
    grid = np.meshgrid(*columns, indexing="ij")
    return np.stack(grid, axis=-1).reshape(-1, subject.dimension)


def numbers_hold(sample: Sample, subject: Subject) -> list[str]:
    """Findings about special places, in 64 and 32 bits, and against the reference."""
    points = special_points(subject)
    found: list[str] = []
    d64, g64 = sample.evaluate(points)
    d32, g32 = sample.evaluate(points, precision=32)
    for bits, d, g in ((64, d64, g64), (32, d32, g32)):
        bad = ~(np.isfinite(d) & np.isfinite(g).all(axis=1))
        if bad.any():
            where = int(np.argmax(bad))
            found.append(
                f"{subject.name}: in {bits} bits at {at(points[where])} the value is {d[where]},"
                f" the gradient {g[where]} ({bad.sum()} of {len(bad)} places)"
            )
    size = subject.scale + np.linalg.norm(points, axis=1)
    off = np.abs(d32 - d64) > 2e-4 * size * max(1.0, subject.slope)
    if off.any():
        where = int(np.argmax(off))
        found.append(
            f"{subject.name}: at {at(points[where])} 32 bits give {d32[where]:.6g}, 64 give"
            f" {d64[where]:.6g} ({off.sum()} of {len(off)} places)"
        )
    return found + _reference_agrees(sample, subject, points)


def _reference_agrees(sample: Sample, subject: Subject, points: Doubles) -> list[str]:
    low, high = subject.region
    rng = np.random.default_rng(3)
    scattered = rng.uniform(low - 1.0, high + 1.0, (300, subject.dimension))
    both = np.concatenate([points, scattered])
    d, _ = sample.evaluate(both)
    expected, _ = sample.evaluate(both, device="reference")
    size = subject.scale + np.linalg.norm(both, axis=1)
    off = ~(np.abs(d - expected) <= 1e-8 * size * max(1.0, subject.slope))
    if not off.any():
        return []
    where = int(np.argmax(off))
    return [
        f"{subject.name}: at {at(both[where])} the CPU gives {d[where]!r}, the reference"
        f" {expected[where]!r} ({off.sum()} of {len(off)} points)"
    ]


def at(point: Doubles) -> str:
    """A point in a finding."""
    return f"({', '.join(f'{v:.9g}' for v in point)})"
