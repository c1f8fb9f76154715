"""What a ray meets, without a march: solids of boxes, each ray against exact intervals."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from distal import AmbientLight, Box, Camera, Scene, Shape

Points = NDArray[np.float64]
FOV = 48.0


def scene(shape: Shape, eye: Any, target: Any = (0.0, 0.0, 0.0), fov: float = 30.0) -> Scene:
    """A shape in even light before black."""
    camera = Camera(tuple(map(float, eye)), target=tuple(map(float, target)), fov_deg=fov)
    lights = [AmbientLight(1.0)]
    return Scene(shape, camera=camera, floor=False, background="black", lights=lights)


def cover(shape: Shape, eye: Any, fov: float = 30.0, size: int = 160, **given: Any) -> float:
    """The share of a picture's pixels that show a shape."""
    k, off = given.pop("k", 1.0), np.array(given.pop("off", (0.0, 0.0, 0.0)))
    shape = shape if k == 1.0 else shape.scale(k)
    shape = shape.translate(*map(float, off)) if off.any() else shape
    shown = scene(shape, k * np.array(eye) + off, off, fov)
    given = {"samples": 1, **given}
    pixels = shown.render(size=(size, size), transparent=True, **given).array[..., 3]
    return float((pixels > 0.5).mean())


@dataclass
class Tree:
    """A solid of boxes whose corners are whole numbers, so that faces coincide all the time."""

    shape: Shape
    holds: Callable[[Points], NDArray[np.bool_]]


def drawn_tree(rng: np.random.Generator, leaves: int) -> Tree:
    """A random one."""
    if leaves == 1:
        while True:
            ends = rng.integers(-3, 4, (2, 3))
            low, high = ends.min(axis=0), ends.max(axis=0)
            if (high > low).all():
                break
        box = Box(*map(float, high - low)).translate(*map(float, (high + low) / 2))
        return Tree(box, lambda p: ((p > low) & (p < high)).all(axis=-1))
    first = int(rng.integers(1, leaves))
    a, b = drawn_tree(rng, first), drawn_tree(rng, leaves - first)
    kind = rng.integers(0, 4)
    if kind == 0:
        return Tree(a.shape | b.shape, lambda p: a.holds(p) | b.holds(p))
    if kind == 1:
        return Tree(a.shape - b.shape, lambda p: a.holds(p) & ~b.holds(p))
    if kind == 2:
        return Tree(a.shape & b.shape, lambda p: a.holds(p) & b.holds(p))
    return Tree(a.shape ^ b.shape, lambda p: a.holds(p) ^ b.holds(p))


def faults(seed: int, size: int = 96, device: str = "cpu", offset: float = 0.0) -> tuple[int, ...]:
    """How many pixels are judged, have a wrong cover, and a wrong depth; half of the trees turned.

    A ray is not judged if it meets less than 4e-3 of solids, or passes a gap of less than 1e-3.
    """
    rng = np.random.default_rng(seed)
    tree = drawn_tree(rng, int(rng.integers(2, 9)))
    eye = rng.normal(size=3)
    eye *= 11.37 / np.linalg.norm(eye)
    angle = float(rng.uniform(0.0, 6.0)) if seed % 2 else 0.0
    off = offset * np.array([1.0, 1.0 / 3.0, -0.5])
    shape = tree.shape.rotate(y=angle).translate(*map(float, off))
    picture = scene(shape, eye + off, off, FOV).render(
        size=(size, size), samples=1, transparent=True, layers=["depth"], device=device
    )
    shown = picture.array[..., 3].ravel() > 0.5
    depth = np.asarray(picture.layers["depth"]).ravel()
    origin, ways = _rays(eye, size, angle)
    with np.errstate(divide="ignore", invalid="ignore"):
        faces = (np.arange(-3, 4)[None, :, None] - origin) / ways[:, None, :]
    t = np.sort(faces.reshape(len(ways), -1), axis=1)
    middle, length = 0.5 * (t[:, 1:] + t[:, :-1]), t[:, 1:] - t[:, :-1]
    inside = tree.holds(origin + middle[..., None] * ways[:, None, :])
    hit = inside.any(axis=1)
    first = t[np.arange(len(ways)), inside.argmax(axis=1)]
    thin = (inside & (length < 2e-3)).any(axis=1) & ((inside * length).sum(axis=1) < 4e-3)
    gap = (~inside & (length > 1e-9) & (length < 1e-3)).any(axis=1)
    judged = ~thin & ~gap
    both = shown & hit & judged
    wrong = int((np.abs(depth - first)[both] > 5e-3).sum())
    return int(judged.sum()), int(((shown != hit) & judged).sum()), wrong


def _rays(eye: Points, size: int, angle: float) -> tuple[Points, Points]:
    """The rays of the picture, turned as the shape is not."""
    ahead = -eye / np.linalg.norm(eye)
    right = np.cross(ahead, (0.0, 1.0, 0.0))
    right /= np.linalg.norm(right)
    up = np.cross(right, ahead)
    y, x = np.mgrid[0:size, 0:size]
    u, v = (2.0 * x + 1.0 - size) / size, -(2.0 * y + 1.0 - size) / size
    wide = math.tan(math.radians(FOV / 2.0))
    ways = ahead + wide * (u[..., None] * right + v[..., None] * up)
    ways = (ways / np.linalg.norm(ways, axis=-1, keepdims=True)).reshape(-1, 3)
    c, s = math.cos(angle), math.sin(angle)
    turned = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    return eye @ turned, ways @ turned
