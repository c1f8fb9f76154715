"""Solids as scene code, and their closed forms in doubles that do not use the library."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from distal.fields.solids.boxes import box
from distal.fields.solids.rings import torus
from distal.fields.solids.round import sphere
from distal.fields.solids.tpms import GYROID_STEEPEST, GYROID_TYPICAL, gyroid
from distal.lang import abs, func, length, max, sin, vec3

Doubles = NDArray[np.float64]
BUMPS = 1.95  # a bound on the slope of the bumpy ball


@func
def ball(p: vec3) -> float:
    """A ball of radius 1."""
    return sphere(p, 1.0)


@func
def shell(p: vec3) -> float:
    """A hollow ball, a thousandth thick."""
    return abs(sphere(p, 1.0)) - 0.0005


@func
def bumpy(p: vec3) -> float:
    """A ball with bumps."""
    return length(p) - 1.0 + 0.1 * sin(8.0 * p.x) * sin(8.0 * p.y) * sin(8.0 * p.z)


@func
def brick(p: vec3) -> float:
    """A box."""
    return box(p, vec3(1.8, 1.2, 1.4))


@func
def pane(p: vec3) -> float:
    """A pane, a thousandth thick."""
    return box(p, vec3(100.0, 0.001, 100.0))


@func
def ring(p: vec3) -> float:
    """A torus."""
    return torus(p, 0.8, 0.3)


@func
def sheet(p: vec3) -> float:
    """The part of a gyroid in a ball."""
    return max(gyroid(p, 1.0, 0.1), sphere(p, 1.5))


def _length(p: Doubles) -> Any:
    return np.linalg.norm(p, axis=-1)


def _box(p: Doubles, *size: float) -> Any:
    beyond = np.abs(p) - 0.5 * np.array(size)
    return _length(np.maximum(beyond, 0.0)) + np.minimum(beyond.max(axis=-1), 0.0)


def _sheet(p: Doubles) -> Any:
    q = 2.0 * np.pi * p
    value = (np.sin(q) * np.cos(np.roll(q, -1, axis=-1))).sum(axis=-1)
    gyroid_distance = np.abs(value / (2.0 * np.pi * GYROID_TYPICAL)) - 0.05
    return np.maximum(gyroid_distance, _length(p) - 1.5)


def _ring(p: Doubles) -> Any:
    return np.hypot(np.hypot(p[..., 0], p[..., 2]) - 0.8, p[..., 1]) - 0.3


@dataclass(frozen=True)
class Solid:
    """A solid about the origin.

    Attributes:
        field: Scene code.
        truth: The same in doubles.
        divisor: A bound on the slope.
        half: Half of the size of its box.
    """

    field: Any
    truth: Callable[[Doubles], Any]
    divisor: float
    half: tuple[float, float, float]


SOLIDS = {
    "ball": Solid(ball, lambda p: _length(p) - 1.0, 1.0, (1.0, 1.0, 1.0)),
    "shell": Solid(shell, lambda p: np.abs(_length(p) - 1.0) - 0.0005, 1.0, (1.0005,) * 3),
    "bumpy ball": Solid(
        bumpy,
        lambda p: _length(p) - 1.0 + 0.1 * np.sin(8.0 * p).prod(axis=-1),
        BUMPS,
        (1.1, 1.1, 1.1),
    ),
    "box": Solid(brick, lambda p: _box(p, 1.8, 1.2, 1.4), 1.0, (0.9, 0.6, 0.7)),
    "pane": Solid(pane, lambda p: _box(p, 100.0, 0.001, 100.0), 1.0, (50.0, 0.0005, 50.0)),
    "torus": Solid(ring, _ring, 1.0, (1.1, 0.3, 1.1)),
    "gyroid": Solid(sheet, _sheet, float(GYROID_STEEPEST / GYROID_TYPICAL), (1.5, 1.5, 1.5)),
}
