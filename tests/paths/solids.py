"""Solids as scene code, and their closed forms in doubles that do not use the library."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from distal.fields.chords import in_ball, missed
from distal.fields.solids.boxes import box, box_chord
from distal.fields.solids.cylinders import cylinder, cylinder_chord
from distal.fields.solids.rings import torus
from distal.fields.solids.round import sphere
from distal.fields.solids.tpms import GYROID_STEEPEST, GYROID_TYPICAL, gyroid
from distal.lang import abs, func, length, max, min, sin, vec2, vec3

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


@func
def can(p: vec3) -> float:
    """A cylinder."""
    return cylinder(p, 0.7, 1.6)


@func
def joined(p: vec3) -> float:
    """A box, and a cylinder that stands in it and comes out of two of its faces."""
    return min(brick(p), can(p))


@func
def ball_chord(p: vec3, direction: vec3) -> vec2:
    """The chord of ``ball``."""
    return in_ball(p, direction, 1.0)


@func
def brick_chord(p: vec3, direction: vec3) -> vec2:
    """The chord of ``brick``."""
    return box_chord(p, direction, vec3(1.8, 1.2, 1.4))


@func
def pane_chord(p: vec3, direction: vec3) -> vec2:
    """The chord of ``pane``."""
    return box_chord(p, direction, vec3(100.0, 0.001, 100.0))


@func
def can_chord(p: vec3, direction: vec3) -> vec2:
    """The chord of ``can``."""
    return cylinder_chord(p, direction, 0.7, 1.6)


@func
def no_chord(p: vec3, direction: vec3) -> vec2:
    """The chord of nothing."""
    return missed()


def _can(p: Doubles) -> Any:
    beyond = np.stack([np.hypot(p[..., 0], p[..., 2]) - 0.7, np.abs(p[..., 1]) - 0.8], axis=-1)
    return _length(np.maximum(beyond, 0.0)) + np.minimum(beyond.max(axis=-1), 0.0)


NOTHING = (ball, no_chord)
# Solids whose chords are known, and the field and chord of their two parts.
CLOSED = {
    "ball": (SOLIDS["ball"], ((ball, ball_chord), NOTHING)),
    "box": (SOLIDS["box"], ((brick, brick_chord), NOTHING)),
    "pane": (SOLIDS["pane"], ((pane, pane_chord), NOTHING)),
    "cylinder": (Solid(can, _can, 1.0, (0.7, 0.8, 0.7)), ((can, can_chord), NOTHING)),
    "box and cylinder": (
        Solid(
            joined,
            lambda p: np.minimum(_box(p, 1.8, 1.2, 1.4), _can(p)),
            1.0,
            (0.9, 0.8, 0.7),
        ),
        ((brick, brick_chord), (can, can_chord)),
    ),
}
