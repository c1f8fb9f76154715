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

from distal.fields import folds
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


def mirrored(p: Any, normal: Any, offset: float) -> Any:
    n = arr(normal)
    below = p @ n < offset
    return np.where(below[:, None], p - 2.0 * (p @ n - offset)[:, None] * n, p)


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


SOLIDS = [
    # Placing
    Case("translate", {"offset": (0.3, -0.2, 0.5)}, lambda a, b, p, offset: a(p - arr(offset))),
    Case(
        "translate",
        {"parts": {"x": 0.3, "z": -0.4}},
        lambda a, b, p, parts: a(p - [parts["x"], 0.0, parts["z"]]),
    ),
    Case("scale", {"factors": (1.3,)}, lambda a, b, p, factors: factors[0] * a(p / factors[0])),
    Case(
        "scale",
        {"factors": (1.3, 0.7, 1.9)},
        lambda a, b, p, factors: min(factors) * a(p / arr(factors)),
        changed={"factors": [(1.6, 0.7, 1.9), (1.3, 0.9, 1.9), (1.3, 0.7, 1.5)]},
        child=HIGH,
    ),
    Case(
        "scale",
        {"parts": {"y": 1.3, "z": 1.5}},
        lambda a, b, p, parts: a(p / [1.0, parts["y"], parts["z"]]),
        child=HIGH,
    ),
    Case(
        "mirror",
        {"normal": AXIS, "offset": 0.15},
        lambda a, b, p, normal, offset: a(mirrored(p, normal, offset)),
        unit=("normal",),
    ),
    Case(
        "symmetry",
        {"axes": "xz"},
        lambda a, b, p, axes: a(np.where([c in axes for c in "xyz"], np.abs(p), p)),
        changed={"axes": ["x", "y", "z", "xy", "zyx"]},
    ),
    Case(
        "kaleidoscope",
        {"count": 5},
        # About the y axis, from x towards -z.
        lambda a, b, p, count: a(
            (lambda x, z: joined(x, p[:, 1], -z))(*kaleidoscope(p[:, 0], -p[:, 2], count))
        ),
    ),
    *(
        Case(
            "rotate",
            {axis: 0.7},
            lambda a, b, p, row=row, **k: a(turned_back(p, about(row, *k.values()))),
        )
        for axis, row in zip("xyz", np.eye(3), strict=True)
    ),
    Case(
        "rotate",
        {"x": 0.7, "y": -0.4, "z": 1.1},
        lambda a, b, p, x, y, z: a(turned_back(p, about(Z, z) @ about(Y, y) @ about(X, x))),
    ),
    Case(
        "rotate",
        {"angle": 0.7, "axis": AXIS},
        lambda a, b, p, angle, axis: a(turned_back(p, about(axis, angle))),
        unit=("axis",),
    ),
    Case(
        "rotate",
        {"quaternion": QUATERNION},
        lambda a, b, p, quaternion: a(
            turned_back(
                p,
                about(
                    arr(quaternion[:3]) / np.linalg.norm(quaternion[:3]),
                    2.0 * np.arctan2(np.linalg.norm(quaternion[:3]), quaternion[3]),
                ),
            )
        ),
        changed={"quaternion": [OTHER_QUATERNION]},
    ),
    Case(
        "rotate",
        {"matrix": about(AXIS, 0.7).tolist()},
        lambda a, b, p, matrix: a(turned_back(p, arr(matrix))),
        changed={"matrix": [about(OTHER_AXIS, 0.7).tolist()]},
    ),
    Case(
        "orient",
        {"source": (1.0, 0.2, -0.4), "target": (-0.3, 0.9, 0.6)},
        lambda a, b, p, source, target: a(turned_back(p, turn_towards(source, target))),
    ),
    Case(
        "shear",
        {"xy": 0.3, "xz": -0.4, "yz": 0.5},
        lambda a, b, p, xy, xz, yz: a(
            p @ np.linalg.inv([[1.0, xy, xz], [0.0, 1.0, yz], [0.0, 0.0, 1.0]]).T
        ),
        child=HIGH,
    ),
    # Copies
    Case(
        "repeat",
        {"spacing": (1.1, 1.3, 0.9)},
        copies=lambda q, spacing: at_steps(q, spacing, AROUND),
        child=SMALL,
    ),
    Case(
        "repeat",
        {"spacing": (1.2,)},
        copies=lambda q, spacing: at_steps(q, spacing, AROUND),
        child=SMALL,
    ),
    Case(
        "repeat",
        {"spacing": (1.1, 1.3, 0.9), "neighbours": 1},
        copies=lambda q, spacing, neighbours: at_steps(q, spacing, AROUND),
        child=SMALL,
    ),
    Case(
        "repeat",
        {"spacing": (1.1, 1.3, 0.9), "count": (2, 3, 4)},
        copies=lambda q, spacing, count: at_steps(q, spacing, block(count)),
        changed={"count": [(3, 3, 4), (2, 2, 4), (2, 3, 5)]},
        child=SMALL,
    ),
    Case(
        "repeat",
        {"spacing": (1.1, 1.3, 0.9), "count": (2, 3, 4), "neighbours": 1},
        copies=lambda q, spacing, count, neighbours: at_steps(q, spacing, block(count)),
        changed={"count": [(3, 3, 4), (2, 2, 4), (2, 3, 5)]},
        child=SMALL,
    ),
    Case(
        "repeat",
        {"spacing": (1.1, 1.3, 0.9), "mirrored": True},
        copies=lambda q, spacing, mirrored: [
            mirror_signs(q, spacing, i) if mirrored else q + arr(spacing) * arr(i) for i in AROUND
        ],
        child=SMALL,
    ),
    Case(
        "repeat_half",
        {"spacing": (1.1, 1.3, 0.9)},
        copies=lambda q, spacing: at_steps(q, spacing, [(0, 0, 0), (1, 0, 0), (0, 2, 1)]),
        child=SMALL,
    ),
    Case(
        "repeat_polar",
        {"count": 5},
        copies=lambda q, count: around_y(q, count),
        child=BESIDE,
    ),
    Case(
        "repeat_polar",
        {"count": 5, "neighbours": 1},
        copies=lambda q, count, neighbours: around_y(q, count),
        child=BESIDE,
    ),
    Case(
        "repeat_ring",
        {"spacing": (1.1, 0.9), "count": (4, 3)},
        copies=lambda q, spacing, count: at_steps(
            q, (spacing[0], 0.0, spacing[1]), ring_places(count)
        ),
        changed={"count": [(3, 3), (4, 4)]},
        child=SMALL,
    ),
    Case(
        "array",
        {"positions": [(0.0, 0.3, -0.4), (1.5, -0.2, 0.7), (-0.3, 1.4, 2.0)]},
        lambda a, b, p, positions: np.min([a(p - arr(at)) for at in positions], axis=0),
        changed={"positions": [[(0.0, 0.3, -0.4), (1.5, -0.2, 0.7), (-0.9, 1.4, 2.0)]]},
    ),
    Case(
        "array",
        {"start": (0.3, -0.4, 0.2), "end": (3.0, 2.5, -2.0), "count": 4},
        copies=lambda q, start, end, count: [
            q + arr(start) + (arr(end) - arr(start)) * i / (count - 1) for i in range(count)
        ],
        child=SMALL,
    ),
    Case(
        "split",
        {"normal": AXIS, "offset": 0.15},
        lambda a, b, p, normal, offset: np.maximum(a(p), p @ arr(normal) - offset),
        unit=("normal",),
        part=0,
    ),
    Case(
        "split",
        {"normal": AXIS, "offset": 0.15},
        lambda a, b, p, normal, offset: np.maximum(a(p), offset - p @ arr(normal)),
        unit=("normal",),
        part=1,
    ),
    # The value alone
    Case("round", {"radius": 0.2}, lambda a, b, p, radius: a(p) - radius),
    Case("offset", {"distance": 0.2}, lambda a, b, p, distance: a(p) - distance),
    Case("complement", {}, lambda a, b, p: -a(p)),
    *(
        Case(
            "shell",
            {"thickness": 0.3, "where": where},
            # A wall from so far inside to so far outside of the old surface.
            lambda a, b, p, thickness, where: np.maximum(
                a(p) - thickness * {"inner": 0.0, "centre": 0.5, "outer": 1.0}[where],
                -a(p) - thickness * {"inner": 1.0, "centre": 0.5, "outer": 0.0}[where],
            ),
            changed={"where": [w for w in ("inner", "centre", "outer") if w != where]},
        )
        for where in ("inner", "centre", "outer")
    ),
    # Bent out of shape
    Case(
        "elongate",
        {"lengths": (0.4, 0.7, 1.0)},
        lambda a, b, p, lengths: a(np.sign(p) * np.maximum(np.abs(p) - 0.5 * arr(lengths), 0.0)),
    ),
    Case(
        "twist",
        {"rate": 0.8},
        lambda a, b, p, rate: a(
            np.array([about(Y, rate * q[1]).T @ q for q in p])  # each height by its own angle
        ),
        child=HIGH,
    ),
    Case(
        "bend",
        {"rate": 0.4},
        lambda a, b, p, rate: a(np.array([about(Z, rate * q[0]).T @ q for q in p])),
        child=HIGH,
    ),
    Case(
        "bend_linear",
        {"start": (-0.5, 0.1, 0.2), "end": (0.6, 0.9, -0.3), "shift": (0.2, -0.3, 0.5)}
        | {"ease": "slow start"},
        lambda a, b, p, start, end, shift, ease: a(
            p - along(p, start, end, ease)[:, None] * arr(shift)
        ),
        changed={"ease": ["linear", "smooth"]},
        child=HIGH,
    ),
    Case(
        "bend_radial",
        {"inner": 0.2, "outer": 0.9, "rise": 0.4, "ease": "slow start"},
        lambda a, b, p, inner, outer, rise, ease: a(
            p - joined(0.0, rise * outwards(p, inner, outer, ease), 0.0)
        ),
        changed={"ease": ["linear", "smooth"]},
        child=HIGH,
    ),
    Case(
        "taper",
        {"bottom": -0.6, "top": 0.5, "factor": 0.7},
        lambda a, b, p, **k: a(tapered(p, **k)),
        child=HIGH,
    ),
    Case(
        "warp",
        {"amount": 0.3, "frequency": 1.4, "seed": 2},
        # Noise has no closed form: the library's own, its arguments by name.
        lambda a, b, p, amount, frequency, seed: a(
            np.asarray(folds.warped(p, amount=amount, frequency=frequency, seed=seed))
        ),
        child=HIGH,
    ),
    Case(
        "wrap",
        {"radius": 1.2},
        copies=lambda q, radius: [wrapped(q, radius)],
        child=SMALL,
    ),
    Case(
        "attract",
        {"center": (0.2, -0.1, 0.3), "radius": 0.9, "strength": 0.6},
        lambda a, b, p, center, radius, strength: a(pulled(p, center, radius, strength)),
        child=HIGH,
    ),
    Case(
        "repel",
        {"center": (0.2, -0.1, 0.3), "radius": 0.9, "strength": 0.6},
        lambda a, b, p, center, radius, strength: a(pulled(p, center, radius, -strength)),
        child=HIGH,
    ),
    # With another
    Case(
        "transition_linear",
        {"start": (-0.5, 0.1, 0.2), "end": (0.6, 0.9, -0.3), "ease": "slow start"},
        lambda a, b, p, start, end, ease: a(p) + along(p, start, end, ease) * (b(p) - a(p)),
        changed={"ease": ["linear", "smooth"]},
    ),
    Case(
        "transition_radial",
        {"inner": 0.2, "outer": 0.9, "ease": "slow start"},
        lambda a, b, p, inner, outer, ease: a(p) + outwards(p, inner, outer, ease) * (b(p) - a(p)),
        changed={"ease": ["linear", "smooth"]},
    ),
    Case("clearance", {"gap": 0.2}, lambda a, b, p, gap: np.maximum(a(p), gap - b(p))),
    # Carved: the shape without what is in the other and less than ``depth`` deep.
    Case(
        "carve",
        {"depth": 0.2},
        lambda a, b, p, depth: np.maximum(a(p), -np.maximum(-a(p) - depth, b(p))),
    ),
    # Embossed: and with what is in the other and less than ``height`` outside.
    Case(
        "emboss",
        {"height": 0.2},
        lambda a, b, p, height: np.minimum(a(p), np.maximum(a(p) - height, b(p))),
    ),
    Case("morph", {"t": 0.3}, lambda a, b, p, t: (1.0 - t) * a(p) + t * b(p)),
    Case(
        "displace",
        {"height": 0.3},
        lambda a, b, p, height: a(p) - height * np.clip(b(p), -1.0, 1.0),
    ),
    Case(
        "engrave",
        {"depth": 0.3},
        # A right angle, its edge ``depth`` below the surface.
        lambda a, b, p, depth: np.maximum(a(p), (a(p) + depth - np.abs(b(p))) / np.sqrt(2.0)),
    ),
    Case("pipe", {"radius": 0.3}, lambda a, b, p, radius: np.hypot(a(p), b(p)) - radius),
    Case(
        "groove",
        {"depth": 0.3, "width": 0.5},
        lambda a, b, p, depth, width: np.maximum(
            a(p), -np.maximum(-a(p) - depth, np.abs(b(p)) - width)
        ),
    ),
    Case(
        "tongue",
        {"depth": 0.3, "width": 0.5},
        lambda a, b, p, depth, width: np.minimum(
            a(p), np.maximum(a(p) - depth, np.abs(b(p)) - width)
        ),
    ),
    Case("union", {}, lambda a, b, p: np.minimum(a(p), b(p))),
    Case("intersection", {}, lambda a, b, p: np.maximum(a(p), b(p))),
    Case("difference", {}, lambda a, b, p: np.maximum(a(p), -b(p))),
    Case(
        "xor",
        {},
        lambda a, b, p: np.where(a(p) * b(p) < 0, -1, 1) * np.minimum(*np.abs((a(p), b(p)))),
    ),
    # To the plane
    Case(
        "slice",
        {"origin": (0.2, -0.3, 0.4), "normal": AXIS},
        lambda a, b, p, origin, normal: a(plane_places(p, origin, normal)),
        unit=("normal",),
        lands=True,
    ),
    Case("project", {"count": 5}, lambda a, b, p, count: slices(a, p, count), lands=True),
    # Operators without a method
    Case(
        "apply",
        {"operator": "mirror diagonal"},
        lambda a, b, p, operator: a(
            joined(np.maximum(p[:, 0], p[:, 2]), p[:, 1], np.minimum(p[:, 0], p[:, 2]))
        ),
        fixed=("operator",),
    ),
    Case(
        "apply",
        {"operator": "mirror octant"},
        lambda a, b, p, operator: a(
            joined(np.abs(p[:, ::2]).max(1), p[:, 1], np.abs(p[:, ::2]).min(1))
        ),
        fixed=("operator",),
    ),
    Case(
        "apply",
        {"operator": "dilate", "distance": 0.2},
        lambda a, b, p, operator, distance: a(p) - distance,
        fixed=("operator",),
    ),
    Case(
        "apply",
        {"operator": "erode", "distance": 0.2},
        lambda a, b, p, operator, distance: a(p) + distance,
        fixed=("operator",),
    ),
    Case(
        "apply",
        {"operator": "repeat interval", "spacing": (1.1, 1.3, 0.9)}
        | {"first_x": -1, "first_y": 0, "first_z": -2, "last_x": 1, "last_y": 1, "last_z": 0},
        copies=lambda q, operator, spacing, first_x, first_y, first_z, last_x, last_y, last_z: (
            at_steps(
                q,
                spacing,
                itertools.product(
                    range(first_x, last_x + 1),
                    range(first_y, last_y + 1),
                    range(first_z, last_z + 1),
                ),
            )
        ),
        fixed=("operator",),
        child=SMALL,
    ),
    Case(
        "apply",
        {"operator": "sphere fold", "inner": 0.4, "outer": 0.7},
        lambda a, b, p, operator, inner, outer: a(folded_sphere(p, inner, outer)),
        fixed=("operator",),
        child=HIGH,
    ),
    Case(
        "apply",
        {"operator": "repeat scaled", "ratio": 2.5},
        copies=lambda q, operator, ratio: [
            (ratio**i * (q + arr((1.5, 0.0, 0.0))), ratio**i) for i in (-2, 0, 1)
        ],
        fixed=("operator",),
        child=BESIDE,
    ),
    Case(
        "apply",
        {"operator": "thicken by", "near_thickness": 0.3, "far_thickness": 0.5, "span": 0.7},
        lambda a, b, p, operator, near_thickness, far_thickness, span: (
            np.abs(a(p)) - 0.5 * np.interp(b(p), [0.0, span], [near_thickness, far_thickness])
        ),
        fixed=("operator",),
        joins=True,
    ),
    Case(
        "apply",
        {"operator": "union power", "exponent": 3.0},
        # The inverse powers add up; the level 0 is that of a plain union.
        lambda a, b, p, operator, exponent: (
            (a(p) ** -exponent + b(p) ** -exponent) ** (-1.0 / exponent)
        ),
        fixed=("operator",),
        child=HIGH,
        joins=True,
    ),
]

FLATS = [
    Case("translate", {"offset": (0.3, -0.2)}, lambda a, b, p, offset: a(p - arr(offset))),
    Case("rotate", {"angle": 0.7}, lambda a, b, p, angle: a(p @ about(Z, angle)[:2, :2])),
    Case("scale", {"factors": (1.3,)}, lambda a, b, p, factors: factors[0] * a(p / factors[0])),
    Case(
        "scale",
        {"factors": (1.3, 0.7)},
        lambda a, b, p, factors: min(factors) * a(p / arr(factors)),
        child=HIGH,
    ),
    Case(
        "scale",
        {"parts": {"y": 1.3}},
        lambda a, b, p, parts: a(p / [1.0, parts["y"]]),
        child=HIGH,
    ),
    Case(
        "translate",
        {"parts": {"y": 0.3}},
        lambda a, b, p, parts: a(p - [0.0, parts["y"]]),
    ),
    Case(
        "mirror",
        {"normal": FLAT_NORMAL, "offset": 0.15},
        lambda a, b, p, normal, offset: a(mirrored(p, normal, offset)),
        unit=("normal",),
    ),
    Case(
        "symmetry",
        {"axes": "y"},
        lambda a, b, p, axes: a(np.where([c in axes for c in "xy"], np.abs(p), p)),
        changed={"axes": ["x", "xy"]},
    ),
    Case(
        "kaleidoscope",
        {"count": 5},
        lambda a, b, p, count: a(joined(*kaleidoscope(p[:, 0], p[:, 1], count))),
    ),
    Case(
        "repeat",
        {"spacing": (1.1, 1.3)},
        copies=lambda q, spacing: at_steps(q, spacing, FLAT_AROUND),
        child=SMALL,
    ),
    Case(
        "repeat",
        {"spacing": (1.1, 1.3), "neighbours": 1},
        copies=lambda q, spacing, neighbours: at_steps(q, spacing, FLAT_AROUND),
        child=SMALL,
    ),
    Case(
        "repeat",
        {"spacing": (1.1, 1.3), "count": (2, 3)},
        copies=lambda q, spacing, count: at_steps(q, spacing, block(count)),
        changed={"count": [(3, 3), (2, 2)]},
        child=SMALL,
    ),
    Case(
        "repeat",
        {"spacing": (1.1, 1.3), "count": (2, 3), "neighbours": 1},
        copies=lambda q, spacing, count, neighbours: at_steps(q, spacing, block(count)),
        changed={"count": [(3, 3), (2, 2)]},
        child=SMALL,
    ),
    Case(
        "repeat",
        {"spacing": (1.1, 1.3), "mirrored": True},
        copies=lambda q, spacing, mirrored: [
            mirror_signs(q, spacing, i) if mirrored else q + arr(spacing) * arr(i)
            for i in FLAT_AROUND
        ],
        child=SMALL,
    ),
    Case("repeat_polar", {"count": 5}, copies=flat_around, child=FLAT_BESIDE),
    Case(
        "repeat_polar",
        {"count": 5, "neighbours": 1},
        copies=lambda q, count, neighbours: flat_around(q, count),
        child=FLAT_BESIDE,
    ),
    Case(
        "split",
        {"normal": FLAT_NORMAL, "offset": 0.15},
        lambda a, b, p, normal, offset: np.maximum(a(p), p @ arr(normal) - offset),
        unit=("normal",),
        part=0,
    ),
    Case(
        "split",
        {"normal": FLAT_NORMAL, "offset": 0.15},
        lambda a, b, p, normal, offset: np.maximum(a(p), offset - p @ arr(normal)),
        unit=("normal",),
        part=1,
    ),
    *(case for case in SOLIDS if case.method in ("round", "offset", "complement", "shell")),
    *(case for case in SOLIDS if case.method in ("union", "intersection", "difference", "xor")),
    Case(
        "apply",
        {"operator": "flat shear", "xy": 0.4},
        lambda a, b, p, operator, xy: a(joined(p[:, 0] - xy * p[:, 1], p[:, 1])),
        fixed=("operator",),
        child=HIGH,
    ),
    Case(
        "apply",
        {"operator": "flat mirror diagonal"},
        lambda a, b, p, operator: a(joined(p.max(1), p.min(1))),
        fixed=("operator",),
    ),
    Case(
        "apply",
        {"operator": "flat mirror octant"},
        lambda a, b, p, operator: a(joined(np.abs(p).max(1), np.abs(p).min(1))),
        fixed=("operator",),
    ),
    Case(
        "apply",
        {"operator": "flat elongate", "lengths": (0.4, 0.7)},
        lambda a, b, p, operator, lengths: a(
            np.sign(p) * np.maximum(np.abs(p) - 0.5 * arr(lengths), 0.0)
        ),
        fixed=("operator",),
    ),
    Case(
        "apply",
        {"operator": "flat bend", "rate": 0.4},
        lambda a, b, p, operator, rate: a(
            np.array([about(Z, rate * q[0])[:2, :2].T @ q for q in p])
        ),
        fixed=("operator",),
        child=HIGH,
    ),
    Case(
        "apply",
        {"operator": "flat repeat at", "positions": [(0.0, 0.3), (1.5, -0.2), (-0.3, 1.4)]},
        lambda a, b, p, operator, positions: np.min([a(p - arr(at)) for at in positions], axis=0),
        changed={"positions": [[(0.0, 0.3), (1.5, -0.2), (-0.9, 1.4)]]},
        fixed=("operator",),
    ),
    # To solids
    Case(
        "extrude",
        {"height": 0.8},
        lambda a, b, p, height: within_ends(a(p[:, :2]), np.abs(p[:, 2]) - 0.5 * height),
        lands=False,
    ),
    Case(
        "extrude",
        {"height": 0.8, "rounding": 0.2},
        lambda a, b, p, height, rounding: (
            within_ends(a(p[:, :2]) + rounding, np.abs(p[:, 2]) - 0.5 * height + rounding)
            - rounding
        ),
        lands=False,
    ),
    Case(
        "extrude",
        {"height": 0.8, "chamfer": 0.2},
        lambda a, b, p, height, chamfer: np.maximum(
            within_ends(a(p[:, :2]), np.abs(p[:, 2]) - 0.5 * height),
            (a(p[:, :2]) + np.abs(p[:, 2]) - 0.5 * height + chamfer) / np.sqrt(2.0),
        ),
        lands=False,
    ),
    Case(
        "revolve",
        {"offset": 0.3},
        lambda a, b, p, offset: a(joined(np.hypot(p[:, 0], p[:, 2]) - offset, p[:, 1])),
        lands=False,
    ),
    Case(
        "revolve",
        {"offset": 0.3, "angle": 2.1},
        lambda a, b, p, offset, angle: revolved_part(a, p, offset, angle),
        lands=False,
    ),
    Case(
        "loft",
        {"height": 1.1, "ease": "slow start"},
        lambda a, b, p, height, ease: within_ends(
            a(p[:, :2]) + loft_share(p, height, ease) * (b(p[:, :2]) - a(p[:, :2])),
            np.abs(p[:, 2]) - 0.5 * height,
        ),
        changed={"ease": ["linear", "smooth"]},
        lands=False,
    ),
    Case(
        "twist_extrude",
        {"height": 1.6, "angle": 0.9},
        lambda a, b, p, height, angle: within_ends(
            a(
                np.array(
                    [
                        about(Z, angle * np.clip(z / height, -0.5, 0.5))[:2, :2].T @ (x, y)
                        for x, y, z in p
                    ]
                )
            ),
            np.abs(p[:, 2]) - 0.5 * height,
        ),
        child=HIGH,
        lands=False,
    ),
    Case(
        "taper_extrude",
        {"height": 1.6, "top": 0.7},
        lambda a, b, p, height, top: within_ends(
            (lambda s: s * a(p[:, :2] / s[:, None]))(
                np.interp(p[:, 2], [-0.5 * height, 0.5 * height], [1.0, top])
            ),
            np.abs(p[:, 2]) - 0.5 * height,
        ),
        child=Child(1.5, 0.4, WIDE[0][:2], WIDE[1][:2]),
        lands=False,
    ),
    Case(
        "sweep",
        {"points": [(0.2, -0.3, 0.1), (1.4, 0.6, 1.0)], "up": (0.2, 1.0, -0.3)},
        copies=lambda q, points, up: [on_way(q, *points, up)],
        changed={
            "points": [
                [(0.5, -0.3, 0.1), (1.4, 0.6, 1.0)],
                [(0.2, -0.3, 0.1), (1.4, 0.9, 1.0)],
            ]
        },
        child=SMALL,
        lands=False,
    ),
    Case(
        "sweep_bezier",
        {"start": (0.2, -0.3, 0.1), "control": (2.4, 0.6, 1.0), "end": (5.0, 1.3, -1.0)}
        | {"up": (0.2, 1.0, -0.3), "pieces": 3},
        copies=lambda q, **k: [first_piece(q, **k)],
        child=SMALL,
        lands=False,
    ),
    Case(
        "wrap_cylinder",
        {"radius": 1.2, "height": 0.3},
        # On the surface in the middle of the relief; values as they are at its inner side.
        copies=lambda q, radius, height: [
            (wrapped(joined(*q.T, 0.0), radius), (radius - 0.5 * height) / radius)
        ],
        child=SMALL,
        lands=False,
    ),
    Case(
        "relief",
        {},
        # The child's slope is 2: the vertical way, shortened to a plane's distance.
        lambda a, b, p: (p[:, 1] - a(joined(p[:, 0], -p[:, 2]))) / np.sqrt(5.0),
        lands=False,
    ),
]
