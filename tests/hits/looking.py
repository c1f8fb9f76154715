"""What a ray meets, without a march: each ray against exact intervals or a count by points."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from distal import AmbientLight, Annulus, Box, Camera, Cylinder, Scene, Shape, Sphere
from distal.lang import slider

Points = NDArray[np.float64]
FOV = 48.0


def evenly_lit(shape: Shape, camera: Camera) -> Scene:
    """A shape in even light before black."""
    lights = [AmbientLight(1.0)]
    return Scene(shape, camera=camera, floor=False, background="black", lights=lights)


def scene(shape: Shape, eye: Any, target: Any = (0.0, 0.0, 0.0), fov: float = 30.0) -> Scene:
    """A shape in even light before black."""
    eye, target = tuple(map(float, eye)), tuple(map(float, target))
    return evenly_lit(shape, Camera(eye, target=target, fov_deg=fov))


def seen_from_anywhere(shape: Shape) -> Scene:
    """A shape whose camera is given by the parameters x, y, z and fov."""
    eye = tuple(slider(name, 1.0, low=-1e9, high=1e9) for name in "xyz")
    fov = slider("fov", 30.0, low=1e-3, high=90.0)
    return evenly_lit(shape, Camera(eye, target=(0.0, 0.0, 0.0), fov_deg=fov))


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
    """A solid with faces at whole numbers, so that faces coincide all the time."""

    shape: Shape
    holds: Callable[[Points], NDArray[np.bool_]]


def drawn_box(rng: np.random.Generator) -> Tree:
    """A random box."""
    while True:
        ends = rng.integers(-3, 4, (2, 3))
        low, high = ends.min(axis=0), ends.max(axis=0)
        if (high > low).all():
            break
    box = Box(*map(float, high - low)).translate(*map(float, (high + low) / 2))
    return Tree(box, lambda p: ((p > low) & (p < high)).all(axis=-1))


def drawn_solid(rng: np.random.Generator) -> Tree:
    """A random box, ball, cylinder or ring, with faces and axes that others have too."""
    kind = rng.integers(0, 4)
    if kind == 0:
        return drawn_box(rng)
    radius, height = float(rng.integers(1, 4)), float(rng.integers(1, 3)) * 2.0
    at = rng.integers(-1, 2, 3).astype(float)
    if kind == 1:
        ball = Sphere(radius).translate(*at.tolist())
        return Tree(ball, lambda p: np.linalg.norm(p - at, axis=-1) < radius)
    upright = kind == 2
    axis, across = (1, (0, 2)) if upright else (2, (0, 1))
    ring = Annulus(radius + 0.5, 1.0).extrude(height)
    shape = Cylinder(radius, height) if upright else ring
    low, high = (0.0, radius) if upright else (radius, radius + 1.0)

    def holds(p: Points) -> NDArray[np.bool_]:
        away = np.hypot(p[..., across[0]] - at[across[0]], p[..., across[1]] - at[across[1]])
        within = np.abs(p[..., axis] - at[axis]) < 0.5 * height
        return (away >= low) & (away < high) & within

    return Tree(shape.translate(*at.tolist()), holds)


def drawn_tree(
    rng: np.random.Generator, leaves: int, leaf: Callable[[np.random.Generator], Tree] = drawn_box
) -> Tree:
    """A random one."""
    if leaves == 1:
        return leaf(rng)
    first = int(rng.integers(1, leaves))
    a, b = drawn_tree(rng, first, leaf), drawn_tree(rng, leaves - first, leaf)
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


def faults_by_points(seed: int, size: int = 48, k: float = 1.0) -> tuple[int, ...]:
    """How many pixels are judged, have a wrong cover, and a wrong depth; of a tree times k.

    Points stand on each ray at steps of .02. A pixel is judged if those around it meet something,
    or nothing, too; its depth, if theirs differs by less than .2.
    """
    rng = np.random.default_rng(seed)
    tree = drawn_tree(rng, int(rng.integers(2, 7)), drawn_solid)
    eye = rng.normal(size=3)
    eye *= 13.0 / np.linalg.norm(eye)
    shown = scene(tree.shape.scale(k), k * eye, fov=FOV).render(
        size=(size, size), samples=1, transparent=True, layers=["depth"]
    )
    origin, ways = _rays(eye, size, 0.0)
    along = np.arange(0.0, 26.0, 0.02)
    first = np.full(len(ways), np.inf)
    for i in range(0, len(ways), 256):
        inside = tree.holds(origin + along[:, None] * ways[i : i + 256, None, :])
        met = inside.any(axis=1)
        first[i : i + 256][met] = along[inside.argmax(axis=1)][met]
    first = first.reshape(size, size)
    around = np.stack([np.roll(first, move, (0, 1)) for move in np.ndindex(3, 3)])
    around = np.roll(around, (-1, -1), (1, 2))[:, 1:-1, 1:-1]
    hit, middle = np.isfinite(around), first[1:-1, 1:-1]
    judged = hit.all(axis=0) | ~hit.any(axis=0)
    seen = shown.array[1:-1, 1:-1, 3] > 0.5
    wrong_cover = (seen != np.isfinite(middle)) & judged
    smooth = seen & hit.all(axis=0) & (np.ptp(np.where(hit, around, 0.0), axis=0) < 0.2)
    depth = np.asarray(shown.layers["depth"])[1:-1, 1:-1] / k
    wrong_depth = np.abs(depth - middle)[smooth] > 0.05
    return int(judged.sum()), int(wrong_cover.sum()), int(wrong_depth.sum())


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
