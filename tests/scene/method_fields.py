"""What each method of a shape means, as formulas in NumPy that do not look at the library.

A case names a method and asymmetric arguments, and says what the result's field is: a formula of
the fields ``a`` (of the shape) and ``b`` (of the other one) at points ``p``, or where copies of the
shape stand. ``test_methods`` compares, then changes every argument in turn.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from distal.lang import func, sin, vec2, vec3

# Fields without any symmetry, as scene code and in NumPy


@func
def wave_a(p: vec3, level: float, size: float) -> float:
    x = sin(1.3 * p.x + 0.4) + 0.7 * sin(0.9 * p.y - 0.2 + 0.6 * p.z)
    return level + size * (x + 0.5 * sin(1.7 * p.z + 1.1 + 0.3 * p.x))


@func
def wave_b(p: vec3, level: float, size: float) -> float:
    x = sin(1.1 * p.y + 0.9) + 0.8 * sin(1.4 * p.x - 0.5 - 0.4 * p.z)
    return level + size * (x + 0.4 * sin(1.2 * p.z - 0.3 + 0.8 * p.y))


@func
def flat_wave_a(p: vec2, level: float, size: float) -> float:
    return level + size * (sin(1.3 * p.x + 0.4) + 0.7 * sin(0.9 * p.y - 0.2 + 0.6 * p.x))


@func
def flat_wave_b(p: vec2, level: float, size: float) -> float:
    return level + size * (sin(1.1 * p.y + 0.9) + 0.8 * sin(1.4 * p.x - 0.5))


def numpy_a(p: Any) -> Any:
    x, y, z = p.T
    return (
        np.sin(1.3 * x + 0.4)
        + 0.7 * np.sin(0.9 * y - 0.2 + 0.6 * z)
        + 0.5 * np.sin(1.7 * z + 1.1 + 0.3 * x)
    )


def numpy_b(p: Any) -> Any:
    x, y, z = p.T
    return (
        np.sin(1.1 * y + 0.9)
        + 0.8 * np.sin(1.4 * x - 0.5 - 0.4 * z)
        + 0.4 * np.sin(1.2 * z - 0.3 + 0.8 * y)
    )


def numpy_flat_a(p: Any) -> Any:
    x, y = p.T
    return np.sin(1.3 * x + 0.4) + 0.7 * np.sin(0.9 * y - 0.2 + 0.6 * x)


def numpy_flat_b(p: Any) -> Any:
    x, y = p.T
    return np.sin(1.1 * y + 0.9) + 0.8 * np.sin(1.4 * x - 0.5)


@dataclass(frozen=True)
class Child:
    """The field that a case's method works on: its level, how far it swings, its box."""

    level: float
    size: float
    low: tuple[float, ...]
    high: tuple[float, ...]


WIDE = ((-2.0, -2.1, -2.2), (2.3, 2.4, 2.5))
# Crosses 0; never 0, so that what an operator says of the box does not show within it; close to 0
# within a small box, so that a copy's value shows within its box.
MIXED = Child(0.1, 1.0, *WIDE)
HIGH = Child(4.0, 1.0, *WIDE)
SMALL = Child(0.02, 0.005, (-0.25, -0.3, -0.2), (0.35, 0.28, 0.31))

Formula = Callable[..., Any]
Point = Any


@dataclass(frozen=True)
class Case:
    """One way to call a method.

    Attributes:
        method: Its name; "apply" for an operator that has none.
        arguments: By the names of its parameters, in their order; the other shape is no argument.
        formula: ``(a, b, p, **arguments) -> values``; or None, and ``copies`` tells.
        copies: ``(local, **arguments)`` -> arrays of points where the copies show ``a(local)``; or
            pairs of such and a factor on it.
        changed: Other values of arguments, where half as much again is none.
        unit: Arguments of length 1, which are turned instead.
        fixed: Arguments that are not changed here; another case changes them.
        child: What it works on.
        flat: Whether on flat shapes.
        lands: Whether the result is flat; None: as the shape.
        joins: Whether the operator takes a second shape (methods say so themselves).
        part: Which part of a tuple the method gives.
        reach: Where points lie: within so far of the origin.
    """

    method: str
    arguments: dict[str, Any] = field(default_factory=dict)
    formula: Formula | None = None
    copies: Formula | None = None
    changed: dict[str, list[Any]] = field(default_factory=dict)
    unit: tuple[str, ...] = ()
    fixed: tuple[str, ...] = ()
    child: Child = MIXED
    flat: bool = False
    lands: bool | None = None
    joins: bool = False
    part: int | None = None
    reach: float = 0.9

    @property
    def name(self) -> str:
        given = "-".join(
            f"{k}={v}" if isinstance(v, str | int) else k for k, v in self.arguments.items()
        )
        parts = ["flat" if self.flat else "solid", self.method, given]
        return " ".join([*parts, *([] if self.part is None else [str(self.part)])])


def about(axis: Any, angle: float) -> Any:
    """The matrix that turns forwards about an axis (Rodrigues)."""
    x, y, z = axis
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]], float)
    return np.eye(3) + np.sin(angle) * k + (1.0 - np.cos(angle)) * k @ k


X, Y, Z = np.eye(3)
AXIS = (0.6, -0.64, 0.48)
OTHER_AXIS = (0.48, 0.6, -0.64)
FLAT_NORMAL = (0.8, -0.6)
QUATERNION = (*(np.sin(0.4) * np.array(AXIS)).tolist(), float(np.cos(0.4)))
OTHER_QUATERNION = (*(np.sin(0.6) * np.array(OTHER_AXIS)).tolist(), float(np.cos(0.6)))


def arr(value: Any) -> Any:
    return np.asarray(value, float)


def part(p: Any, i: int) -> Any:
    return p[:, i]


def joined(*columns: Any) -> Any:
    return np.stack(np.broadcast_arrays(*columns), axis=1)


def turned_back(p: Any, matrix: Any) -> Any:
    """Where points were before a rotation."""
    return p @ matrix


def eased(t: Any, ease: str) -> Any:
    x = np.clip(t, 0.0, 1.0)
    return {"linear": x, "smooth": 3 * x**2 - 2 * x**3, "slow start": x**2}[ease]


def along(p: Any, start: Any, end: Any, ease: str) -> Any:
    way = arr(end) - arr(start)
    return eased((p - arr(start)) @ way / (way @ way), ease)


def outwards(p: Any, inner: float, outer: float, ease: str) -> Any:
    return eased((np.hypot(p[:, 0], p[:, 2]) - inner) / (outer - inner), ease)


def reflected(p: Any, normal: Any, offset: float) -> Any:
    n = arr(normal)
    return p - 2.0 * (p @ n - offset)[:, None] * n


def folded(p: Any, normal: Any, offset: float) -> Any:
    below = p @ arr(normal) < offset
    return np.where(below[:, None], reflected(p, normal, offset), p)


def reversed_axes(p: Any, axes: str) -> Any:
    return p * [-1.0 if c in axes else 1.0 for c in "xyz"[: p.shape[1]]]


def kaleidoscope(x: Any, y: Any, count: int) -> Any:
    """The wedge between the x axis and half a sector, for points of the plane."""
    sector = 2.0 * np.pi / count
    angle = np.abs((np.arctan2(y, x) + 0.5 * sector) % sector - 0.5 * sector)
    radius = np.hypot(x, y)
    return radius * np.cos(angle), radius * np.sin(angle)


def within_ends(d: Any, past: Any) -> Any:
    """The distance where one distance ends across another at a right angle."""
    return np.minimum(np.maximum(d, past), 0.0) + np.hypot(np.maximum(d, 0), np.maximum(past, 0))


def at_steps(local: Any, spacing: Any, indices: Any) -> list[Any]:
    return [local + arr(spacing) * arr(i) for i in indices]


def block(counts: Any) -> list[Any]:
    """Indices of a block whose middle is at the origin."""
    return list(itertools.product(*(np.arange(n) - 0.5 * (n - 1) for n in counts)))


AROUND = [(0, 0, 0), (1, 0, 0), (0, -2, 0), (0, 0, 3), (-1, 2, -1)]
FLAT_AROUND = [(0, 0), (1, 0), (0, -2), (-1, 3)]


def ring_places(counts: Any) -> list[Any]:
    x, z = counts
    inside = {(i, j) for i in range(1, x - 1) for j in range(1, z - 1)}
    rim = [(i, j) for i in range(x) for j in range(z) if (i, j) not in inside]
    return [(i - 0.5 * (x - 1), 0.0, j - 0.5 * (z - 1)) for i, j in rim]


def mirror_signs(local: Any, spacing: Any, index: Any) -> Any:
    """A cell's points where every other cell is mirrored along each axis."""
    sign = np.where(arr(index) % 2 == 1, -1.0, 1.0)
    return sign * local + arr(spacing) * arr(index)


def around_y(local: Any, count: int) -> list[Any]:
    """Turned to the right by whole sectors; the shape itself where x is above 0."""
    beside = local + arr((1.5, 0.0, 0.0))
    return [beside @ about(Y, 2.0 * np.pi * i / count).T for i in range(count)]


BESIDE = Child(0.02, 0.005, (1.25, -0.3, -0.2), (1.85, 0.28, 0.31))
FLAT_BESIDE = Child(0.02, 0.005, (1.25, -0.3), (1.85, 0.28))


def flat_around(local: Any, count: int) -> list[Any]:
    beside = local + arr((1.5, 0.0))
    return [
        (joined(*beside.T, 0.0 * beside[:, 0]) @ about(Z, 2.0 * np.pi * i / count).T)[:, :2]
        for i in range(count)
    ]


def frame(ahead: Any, up: Any) -> tuple[Any, Any, Any]:
    """x, y and z of an outline on a way: y as near to ``up`` as can be."""
    z = ahead / np.linalg.norm(ahead)
    y = up - (up @ z) * z
    y = y / np.linalg.norm(y)
    return np.cross(y, z), y, z


def on_way(local: Any, start: Any, end: Any, up: Any) -> Any:
    """Outline points carried to the middle of a straight way."""
    x, y, _ = frame(arr(end) - arr(start), arr(up))
    return 0.5 * (arr(start) + arr(end)) + local[:, :1] * x + local[:, 1:] * y


def first_piece(local: Any, start: Any, control: Any, end: Any, up: Any, pieces: int) -> Any:
    """The same on the first straight piece of a Bézier curve."""
    t = 1.0 / pieces
    s, c, e = arr(start), arr(control), arr(end)
    return on_way(local, s, (1 - t) ** 2 * s + 2 * t * (1 - t) * c + t**2 * e, up)


def turn_towards(source: Any, target: Any) -> Any:
    s, t = arr(source) / np.linalg.norm(source), arr(target) / np.linalg.norm(target)
    axis = np.cross(s, t)
    return about(axis / np.linalg.norm(axis), np.arctan2(np.linalg.norm(axis), s @ t))


def slices(a: Any, p: Any, count: int) -> Any:
    low, high = MIXED.low[2], MIXED.high[2]
    heights = low + (high - low) * (np.arange(count) + 0.5) / count
    return np.min([a(joined(p[:, 0], p[:, 1], h)) for h in heights], axis=0)


def plane_places(p: Any, origin: Any, normal: Any) -> Any:
    """Places on a plane: x level, y upwards."""
    right = np.cross(Y, arr(normal))
    right = right / np.linalg.norm(right)
    return arr(origin) + p[:, :1] * right + p[:, 1:] * np.cross(arr(normal), right)


def loft_share(p: Any, height: float, ease: str) -> Any:
    return eased(p[:, 2] / height + 0.5, ease)


def partly(p: Any, offset: float, angle: float) -> Any:
    """Points of a turn: within it the ring's, past an end those of the end's face."""
    half, z = 0.5 * angle, np.abs(p[:, 2])
    out = np.cos(half) * p[:, 0] + np.sin(half) * z
    past = np.cos(half) * z - np.sin(half) * p[:, 0]
    radius = np.where(past > 0.0, out, np.hypot(p[:, 0], p[:, 2]))
    return joined(radius - offset, p[:, 1]), past, out


def revolved_part(a: Any, p: Any, offset: float, angle: float) -> Any:
    q, past, out = partly(p, offset, angle)
    inside = np.where(out > 0.0, past, -np.hypot(p[:, 0], p[:, 2]))
    return within_ends(a(q), np.where(past > 0.0, past, inside))


def wrapped(local: Any, radius: float) -> Any:
    """x laid around the y axis, z out of it."""
    turn, rho = local[:, 0] / radius, radius + local[:, 2]
    return joined(rho * np.sin(turn), local[:, 1], rho * np.cos(turn))


def tapered(p: Any, bottom: float, top: float, factor: float) -> Any:
    share = np.clip((p[:, 1] - bottom) / (top - bottom), 0.0, 1.0)
    return p / joined(1.0 + (factor - 1.0) * share, 1.0, 1.0 + (factor - 1.0) * share)


def pulled(p: Any, center: Any, radius: float, strength: float) -> Any:
    away = p - arr(center)
    rest = np.maximum(1.0 - (away**2).sum(1) / radius**2, 0.0)
    return p + strength * (rest**2)[:, None] * away


def folded_sphere(p: Any, inner: float, outer: float) -> Any:
    square = np.clip((p**2).sum(1), inner**2, outer**2)
    return p * (outer**2 / square)[:, None]
