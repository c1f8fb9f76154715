"""What the catalogue sheet shows: every shape and operator of the field library, under its name.

Input: the library's declarations. Output: cells, grouped. A shape or operator that needs data, or
that shows little with its defaults, has its numbers here. All others are shown with their defaults,
so a new one is on the sheet by itself. Does not know how a cell is drawn.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any, Final

import numpy as np

from distal import (
    Box,
    Capsule,
    Cylinder,
    Heart,
    Hexagon,
    Pentagram,
    Plane,
    Rectangle,
    RoundBox,
    Shape2D,
    Sphere,
    Text,
    Torus,
)
from distal.fields.library import OPERATORS, PRIMITIVES
from distal.lang import Buffer, Texture2D, Texture3D, cos, func, sin, vec2
from distal.polygons.bricks import from_grid
from distal.scene.objects.shapes import CLASSES

GROUPS: Final = ("solids", "flats", "operators", "blends")
JOINS: Final = ("union", "intersection", "difference", "xor")


@dataclass(frozen=True, slots=True)
class Cell:
    """One shape of the sheet.

    Attributes:
        group: One of ``GROUPS``.
        title: The name under it: a class, or an operator of the library.
        make: What is shown, made when asked.
    """

    group: str
    title: str
    make: Callable[[], Any]


OUTLINE: Final = np.array(
    [(-0.6, -0.4), (0.0, -0.15), (0.6, -0.5), (0.4, 0.5), (-0.1, 0.2), (-0.5, 0.55)]
)
WAY: Final = np.array([(-0.8, -0.5, 0.0), (0.0, 0.5, 0.3), (0.8, -0.2, -0.2), (0.1, -0.6, 0.6)])
BALLS: Final = np.array([(-0.45, -0.1, 0, 0.4), (0.3, 0.3, 0.1, 0.45), (0.35, -0.4, 0, 0.3)])


def _disc_image() -> Texture2D:
    """The signed distance to a ring, sampled: what ``ImageField`` shows."""
    y, x = np.mgrid[0:64, 0:64] / 63.0 - 0.5
    ring = np.abs(np.hypot(x, y) - 0.3) - 0.08
    return Texture2D(np.repeat(ring[:, :, None], 4, axis=2).astype(np.float32), wrap="clamp")


def _hills() -> Texture2D:
    y, x = np.mgrid[0:64, 0:64] / 63.0 * 2.0 * np.pi
    height = 0.5 + 0.25 * np.sin(x) * np.cos(y) + 0.15 * np.sin(2 * x + y)
    return Texture2D(np.repeat(height[:, :, None], 4, axis=2).astype(np.float32), wrap="clamp")


def _ball_volume() -> Texture3D:
    z, y, x = np.mgrid[0:64, 0:64, 0:64] / 63.0 - 0.5
    d = np.maximum(np.sqrt(x * x + y * y + z * z) - 0.45, 0.3 - np.hypot(x, y))
    return Texture3D(np.repeat(d[..., None], 4, axis=3).astype(np.float32), wrap="clamp")


def _ball_bricks() -> dict[str, Any]:
    """The numbers of ``BrickField`` for a ball with a hole, on 97 samples along each axis."""
    z, y, x = np.mgrid[0:97, 0:97, 0:97] / 96.0 * 2.4 - 1.2
    d = np.maximum(np.sqrt(x * x + y * y + z * z) - 0.8, 0.4 - np.hypot(x, y)).astype(np.float32)
    found = from_grid(d, (0.025, 0.025, 0.025))
    assert found is not None
    size = (97 * 0.025,) * 3
    return {
        "values": Buffer(found.numbers),
        "samples": found.samples,
        "size": size,
        "reach": found.reach,
    }


# What a class is called with where its defaults show little, or where it needs data.
GIVEN: Final[dict[str, Callable[[], dict[str, Any]]]] = {
    "Polygon": lambda: {"points": OUTLINE},
    "RoundedPolygon": lambda: {"points": OUTLINE},
    "Polyline": lambda: {"points": OUTLINE},
    "SplinePath": lambda: {"points": OUTLINE},
    "ImageField": lambda: {"image": _disc_image()},
    "Heightfield": lambda: {"image": _hills(), "size": (2, 2), "height": 0.5},
    "VolumeField": lambda: {"volume": _ball_volume(), "size": (1.5, 1.5, 1.5), "value_scale": 1.5},
    "BrickField": _ball_bricks,
    "PolylineTube": lambda: {"points": WAY},
    "CurveTube": lambda: {"points": np.r_[WAY, WAY[:1]]},
    "TaperedPolylineTube": lambda: {"points": np.c_[WAY, (0.22, 0.12, 0.16, 0.05)]},
    "Metaballs": lambda: {"balls": BALLS},
    "BoxCheap": lambda: {"size": (1.2, 0.8, 1.0)},
    "Ellipsoid": lambda: {"radii": (0.8, 0.4, 0.5)},
    # Larger than their defaults: lines of a few pixels would be all that is seen.
    "Honeycomb": lambda: {"cell_size": 1.0, "wall": 0.15},
    "VoronoiLines": lambda: {"cell_size": 1.0, "thickness": 0.1},
    "RackProfile": lambda: {"module": 0.15, "base": 0.3, "count": 4},
}

_BODY: Final = RoundBox((1.0, 1.0, 1.0), 0.1)
_BAR: Final = Box((0.5, 2.0, 0.3))
_PEBBLE: Final = Sphere(0.22)
_LEAF: Final = Capsule(0.1, 0.35).rotate(z=0.7).translate(0.55, 0, 0)
_HEART: Final = Heart(1.0).translate(0, -0.5)
_SHEET: Final = Box((1.6, 0.35, 0.9))
_RING: Final = Torus(0.5, 0.15).rotate(x=np.pi / 2)
_STAR: Final = Pentagram(0.6)

# One showing of each operator: which shape, and its arguments.
SHOWN: Final[dict[str, Callable[[], Any]]] = {
    "complement": lambda: Box(1.4) & Sphere(0.95).complement(),
    "clearance": lambda: _BODY.apply("clearance", 0.15, others=[_ball()]),
    "morph": lambda: Box(1.2).morph(Sphere(0.75), 0.5),
    "displace": lambda: Sphere(0.8).displace(_waves(), 0.15),
    "carve": lambda: _BODY.apply("carve", 0.12, others=[_ball()]),
    "emboss": lambda: _BODY.apply("emboss", 0.12, others=[_letter()]),
    "translate": lambda: _frame() | _PEBBLE.translate(0.3, 0.3, 0.3),
    "rotate": lambda: _BAR.rotate(0.8, axis=(0.6, 0, 0.8)),
    "rotate x": lambda: _BAR.rotate(x=0.6),
    "rotate y": lambda: _BAR.rotate(y=0.6),
    "rotate z": lambda: _BAR.rotate(z=0.6),
    "rotate euler": lambda: _BAR.rotate(x=0.4, y=0.3, z=0.5),
    "rotate quaternion": lambda: _BAR.rotate(quaternion=(0, 0, np.sin(0.3), np.cos(0.3))),
    "rotate matrix": lambda: _BAR.rotate(matrix=[[0.8, -0.6, 0], [0.6, 0.8, 0], [0, 0, 1]]),
    "orient": lambda: Cylinder(0.2, 1.6).orient((0, 1, 0), (0.6, 0.8, 0)),
    "scale": lambda: _BODY.scale(0.7),
    "scale axes": lambda: Sphere(0.7).scale(1.3, 0.6, 1.0),
    "shear": lambda: Box(0.9).shear(xy=0.5),
    "elongate": lambda: Torus(0.35, 0.15).apply("elongate", (0.4, 0.2, 0.0)),
    "twist": lambda: Box((0.7, 1.8, 0.7)).apply("twist", 1.2),
    "bend": lambda: _SHEET.apply("bend", 0.9),
    "bend linear": lambda: _SHEET.apply("bend linear", (-0.8, 0, 0), (0.8, 0, 0), (0, 0.6, 0)),
    "bend radial": lambda: Cylinder(1.0, 0.12).apply("bend radial", 0.1, 1.0, -0.5),
    "taper": lambda: Box((0.9, 1.4, 0.9)).apply("taper", -0.7, 0.7, 0.35),
    "attract": lambda: Box(1.2).apply("attract", (0.0, 0.9, 0.0), 0.9, 1.0),
    "repel": lambda: Box(1.2).apply("repel", (0.4, 0.4, 0.4), 0.8, 0.9),
    "mirror": lambda: _LEAF | _LEAF.mirror("y"),
    "mirror across": lambda: _LEAF | _LEAF.mirror(across=(0.8, 0.6, 0.0)),
    "symmetry across": lambda: _LEAF.symmetry(across=(1, 0, 0)),
    "symmetry": lambda: _PEBBLE.translate(0.5, 0.4, 0.5).symmetry("xyz"),
    "symmetry diagonal": lambda: _LEAF.apply("symmetry diagonal"),
    "symmetry octant": lambda: Capsule(0.08, 0.5).translate(0.8, 0.0, 0.3).apply("symmetry octant"),
    "kaleidoscope": lambda: _LEAF.kaleidoscope(6),
    "flat translate": lambda: Rectangle((0.5, 0.3)).translate(0.3, 0.2),
    "flat rotate": lambda: Rectangle((1.0, 0.4)).rotate(0.6),
    "flat scale": lambda: _STAR.scale(0.6),
    "flat scale axes": lambda: _STAR.scale(1.3, 0.7),
    "flat shear": lambda: Rectangle((0.7, 0.7)).apply("flat shear", 0.5),
    "flat mirror": lambda: Text("R").mirror("x"),
    "flat mirror across": lambda: Text("R").mirror(across=(0.8, 0.6)),
    "flat symmetry across": lambda: _STAR.translate(0.3, 0).symmetry(across=(1, 0)),
    "flat symmetry": lambda: _STAR.scale(0.5).translate(0.45, 0.4).symmetry("xy"),
    "flat symmetry diagonal": lambda: (
        Rectangle((0.6, 0.2)).translate(0.5, 0.1).apply("flat symmetry diagonal")
    ),
    "flat symmetry octant": lambda: (
        Rectangle((0.4, 0.2)).translate(0.6, 0.2).apply("flat symmetry octant")
    ),
    "flat kaleidoscope": lambda: (
        Rectangle((0.5, 0.15)).rotate(0.3).translate(0.6, 0.1).kaleidoscope(6)
    ),
    "repeat": lambda: _PEBBLE.repeat(0.6, 0.6, 0.6) & Box(1.9),
    "repeat neighbors": lambda: Sphere(0.36).repeat(0.6, 0.6, 0.6, neighbors=1) & Box(1.9),
    "repeat mirrored": lambda: (
        _LEAF.translate(-0.5, 0, 0).repeat(0.8, 0.8, 0.8, mirrored=True) & Box(1.9)
    ),
    "repeat limited": lambda: _PEBBLE.repeat(0.6, 0.6, 0.6, count=(3, 2, 3)),
    "repeat limited neighbors": lambda: Sphere(0.36).repeat(
        0.6, 0.6, 0.6, count=(3, 2, 3), neighbors=1
    ),
    "repeat interval": lambda: _PEBBLE.apply(
        "repeat interval", (0.5, 0.5, 0.5), last_x=2, last_z=3
    ),
    "repeat half": lambda: _PEBBLE.repeat_half(0.6, 0, 0.6) & Box(4.0),
    "repeat polar": lambda: RoundBox((0.5, 0.3, 0.2), 0.05).translate(0.6, 0, 0).repeat_polar(7),
    "repeat polar neighbors": lambda: (
        RoundBox((0.5, 0.3, 0.5), 0.1).translate(0.6, 0, 0).repeat_polar(7, neighbors=1)
    ),
    "repeat polar all": lambda: (
        Torus(0.4, 0.08).translate(0.35, 0, 0).repeat_polar(5, neighbors="all")
    ),
    "flat repeat": lambda: _STAR.scale(0.7).apply("flat repeat", (1.1, 1.1)),
    "flat repeat neighbors": lambda: _STAR.apply("flat repeat neighbors", (1.0, 1.0), neighbors=1),
    "flat repeat limited": lambda: _STAR.scale(0.3).apply(
        "flat repeat limited", (0.5, 0.5), count_x=3, count_y=2
    ),
    "flat repeat limited neighbors": lambda: _STAR.scale(0.45).apply(
        "flat repeat limited neighbors", (0.5, 0.5), count_x=3, count_y=2, neighbors=1
    ),
    "flat repeat mirrored": lambda: (
        Heart(0.6).rotate(0.6).apply("flat repeat mirrored", (1.1, 1.1))
    ),
    "flat repeat polar": lambda: (
        Heart(0.25).rotate(-np.pi / 2).translate(0.45, 0).apply("flat repeat polar", 6)
    ),
    "flat repeat polar neighbors": lambda: (
        Heart(0.35)
        .rotate(-np.pi / 2)
        .translate(0.45, 0)
        .apply("flat repeat polar neighbors", 6, neighbors=1)
    ),
    "flat repeat polar all": lambda: Rectangle((1.6, 0.3)).apply("flat repeat polar all", 3),
    "flat repeat at": lambda: _STAR.scale(0.35).apply("flat repeat at", OUTLINE),
    "flat elongate": lambda: Hexagon(0.3).apply("flat elongate", (0.3, 0.1)),
    "flat bend": lambda: Rectangle((1.6, 0.3)).apply("flat bend", 0.8),
    "pipe": lambda: _BODY.pipe(_ball(), 0.08),
    "engrave": lambda: _BODY.engrave(_ball(), 0.08),
    "groove": lambda: _BODY.groove(_ball(), 0.08, 0.08),
    "tongue": lambda: _BODY.tongue(_ball(), 0.08, 0.08),
    "wrap": lambda: Box((4.6, 0.3, 0.5)).apply("wrap", 0.75),
    "sphere fold": lambda: Box(1.6).apply("sphere fold", 0.4, 0.9),
    "repeat scaled": lambda: (
        Sphere(0.14).translate(0.75, 0, 0).apply("repeat scaled", 2.2) & Sphere(1.1)
    ),
    "warp": lambda: Box(1.2).apply("warp", 0.12, 3.0),
    "extrude": lambda: _HEART.extrude(0.4),
    "extrude endless": lambda: _HEART.extrude(None) & Box(3.0, 3.0, 0.8),
    "extrude rounded": lambda: _HEART.extrude(0.4, rounding=0.08),
    "extrude chamfered": lambda: _HEART.extrude(0.4, chamfer=0.08),
    "extrude twisted": lambda: (
        Rectangle((0.7, 0.7)).apply("extrude twisted", 1.6, 1.5).rotate(x=-np.pi / 2)
    ),
    "extrude tapered": lambda: _STAR.apply("extrude tapered", 1.2, 0.4).rotate(x=-np.pi / 2),
    "loft": lambda: Rectangle((1.0, 1.0)).apply("loft", 1.4, others=[_STAR]).rotate(x=-np.pi / 2),
    "sweep": lambda: Hexagon(0.18).apply("sweep", WAY),
    "sweep bezier": lambda: _STAR.scale(0.35).apply("sweep bezier"),
    "revolve": lambda: Pentagram(0.35).revolve(0.6),
    "revolve partly": lambda: Pentagram(0.35).revolve(0.6, 4.0),
    "wrap cylinder": lambda: _STAR.apply("wrap cylinder", 0.6, 0.25),
    "wrap around cylinder": lambda: _STAR.scale(0.5).apply("wrap around cylinder", 0.7, 0.25, 8),
    "slice": lambda: _BODY.rotate(x=0.6).slice(),
    "project": lambda: _RING.rotate(y=0.7).apply("project"),
    "relief": lambda: _ripples().apply("relief") & Box(2.0),
    "round": lambda: Box(0.8).round(0.2),
    "offset": lambda: Box(1.0).offset(0.1),
    "dilate": lambda: Box(1.0).apply("dilate", 0.15),
    "erode": lambda: Box(1.4).apply("erode", 0.15),
    "shell inner": lambda: _open(Sphere(0.9).shell(0.1, "inner")),
    "shell center": lambda: _open(Sphere(0.9).shell(0.1, "center")),
    "shell outer": lambda: _open(Sphere(0.9).shell(0.1, "outer")),
    "split below": lambda: _BODY.split((0.6, 0.8, 0))[0],
    "split above": lambda: _BODY.split((0.6, 0.8, 0))[1],
    "flat split below": lambda: Hexagon(0.6).apply("flat split below", (0.6, 0.8), 0.0),
    "flat split above": lambda: Hexagon(0.6).apply("flat split above", (0.6, 0.8), 0.0),
    "repeat line": lambda: _PEBBLE.array(start=(-1.0, -0.4, 0), end=(1.0, 0.4, 0), count=4),
    "repeat ring": lambda: Sphere(0.14).repeat_ring(0.4, 0.4, count=(5, 4)),
    "repeat at": lambda: _PEBBLE.array(WAY),
    "thicken by": lambda: (
        CLASSES["Gyroid"](1.0, solid=True).apply("thicken by", 0.5, 0.04, 1.2, others=[Plane(-0.9)])
        & Box(1.9)
    ),
    "transition linear": lambda: Box(1.2).apply(
        "transition linear", (-0.6, 0, 0), (0.6, 0, 0), others=[Sphere(0.6)]
    ),
    "transition radial": lambda: Cylinder(0.9, 0.3).apply(
        "transition radial", 0.2, 0.9, others=[Box((1.6, 0.9, 1.6))]
    ),
}


def _ball() -> Any:
    return Sphere(0.6).translate(0.35, 0.4, 0.35)


def _letter() -> Any:
    return Sphere(0.35).translate(0.0, 0.0, 0.5)


def _frame() -> Any:
    return CLASSES["BoxFrame"]((1.2, 1.2, 1.2), 0.04)


def _open(shape: Any) -> Any:
    return shape - Box(2.0).translate(1.0, 1.0, 1.0)


@func
def ripples(p: vec2) -> float:
    """A height that waves."""
    return 0.15 * sin(4.0 * p.x) * cos(3.0 * p.y)


def _ripples() -> Any:
    return Shape2D.from_function(ripples, slope=0.75)


def _waves() -> Any:
    return CLASSES["GradientNoiseSolid"](0.4)


def shape_cells() -> Iterator[Cell]:
    """A cell for every shape of the library."""
    for name, row in PRIMITIVES.items():
        points = str(row.distance.python_function.__annotations__["p"])
        yield Cell("flats" if points == "vec2" else "solids", name, partial(_example, name))


def _example(name: str) -> Any:
    shape = CLASSES[name](**GIVEN.get(name, dict)())
    if not PRIMITIVES[name].signed and not shape.flat:
        return shape.round(0.03)  # a surface without an inside is too thin to see
    return shape


def operator_cells() -> Iterator[Cell]:
    """A cell for every operator that is no blend, and for each plain combination."""
    for name in OPERATORS:
        if name in JOINS:
            yield Cell("operators", name, partial(_joined, name))
        elif name.split()[0] not in JOINS:
            yield Cell("operators", name, partial(_shown, name))


def _shown(name: str) -> Any:
    if name not in SHOWN:
        raise LookupError(f"the operator '{name}' is shown nowhere: add it to SHOWN")
    return SHOWN[name]()


def blend_cells() -> Iterator[Cell]:
    """A cell for every form of every combination."""
    for name in OPERATORS:
        kind, _, form = name.partition(" ")
        if form and kind in JOINS:
            yield Cell("blends", name, partial(_joined, name))


def _joined(name: str) -> Any:
    kind, _, form = name.partition(" ")
    slab, post = Box((1.7, 0.5, 1.4)), Cylinder(0.4, 1.4)
    if kind == "xor":  # what is gone is inside: a corner is cut away
        corner = Box(2.0).translate(1.0, 1.0, 1.0)
        return _mixed(name, form, slab, post) - corner
    return _mixed(name, form, slab, post)


def _mixed(name: str, form: str, slab: Any, post: Any) -> Any:
    if not form:
        return slab.apply(name, others=[post])
    if form == "power":
        return slab.apply(name, 6.0, others=[post])
    extra = {"count": 3} if form in ("columns", "stairs") else {}
    size = 0.06 if form in ("exponential", "root", "sigmoid") else 0.12
    return slab.apply(name, size, others=[post], **extra)


def cells(groups: Iterable[str] = GROUPS) -> list[Cell]:
    """All cells of some groups, in the library's order."""
    every = itertools.chain(shape_cells(), operator_cells(), blend_cells())
    wanted = set(groups)
    return [cell for cell in every if cell.group in wanted]
