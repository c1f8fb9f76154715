"""Parts of a mechanical engineer beside a B-rep kernel and a kernel of triangles.

Four parts, an L bracket, a case, a hinge and a bolt without a thread, are modelled in distal, in
CadQuery and by manifold3d, and written with the same tolerance. Printed for each: triangles, the
processor's seconds of a warm call, the error of the volume, and the largest error of the part's
dimensions, measured on sections of the triangles, in millimetres. distal's files are then read by
trimesh, manifold3d and lib3mf (strict) and sliced by PrusaSlicer, if they are installed.

    pip install cadquery trimesh manifold3d lib3mf shapely rtree networkx
    python benchmarks/bench_cad_parts.py [--tolerance 0.01]
"""

# ruff: noqa: PLC0415 -- a program that is not there is left out
from __future__ import annotations

import argparse
import math
import shutil
import subprocess
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from distal import Box, Cylinder, HexPrism, Rectangle, union

Triangles = tuple[NDArray[np.float64], NDArray[np.int64]]


@dataclass(frozen=True)
class Section:
    """A cut across an axis, and the loops in it.

    Attributes:
        axis: 0, 1 or 2.
        at: Where the cut is along it.
        widths: The sizes of the outline along the other two axes.
        holes: The diameters of round loops in it, in any order.
    """

    axis: int
    at: float
    widths: tuple[float, float]
    holes: tuple[float, ...] = ()


@dataclass(frozen=True)
class Part:
    """A part in three programs.

    Attributes:
        name: Its name.
        distal: Makes the shape.
        cadquery: Makes the solid, given the module.
        manifold: Makes the solid, given the module and the count of segments of a circle by radius.
        volume: Its volume in closed form, or None where two blends meet.
        sections: Where its dimensions are measured.
    """

    name: str
    distal: Callable[[], Any]
    cadquery: Callable[[Any], Any]
    manifold: Callable[[Any, Callable[[float], int]], Any]
    volume: float | None
    sections: Sequence[Section]


# The bracket: two legs with a fillet of 8, two bores of 5.5 in each

FILLET, BORE = 8.0, 5.5
FOOT_BORES, WALL_BORES = ((8.0, -8.0), (8.0, 8.0)), ((38.0, -7.0), (38.0, 7.0))


def bracket() -> Any:
    """The bracket, with its corner at (-30, 0, 0)."""
    foot = Box(60, 14, 30).translate(0, 7, 0)
    wall = Box(14, 50, 30).translate(-23, 25, 0)
    bores = [Cylinder(0.5 * BORE, 40).translate(x, 7, z) for x, z in FOOT_BORES]
    across = Cylinder(0.5 * BORE, 40).rotate(z=0.5 * math.pi)
    bores += [across.translate(-23, y, z) for y, z in WALL_BORES]
    return (foot | wall).fillet(FILLET) - union(*bores)


def cadquery_bracket(cq: Any) -> Any:
    """The same as a B-rep solid."""
    outline = [(-30, 0), (30, 0), (30, 14), (-16, 14), (-16, 50), (-30, 50)]
    solid = cq.Workplane("XY").polyline(outline).close().extrude(30).translate((0, 0, -15))
    solid = solid.edges(cq.selectors.NearestToPointSelector((-16, 14, 0))).fillet(FILLET)
    for x, z in FOOT_BORES:
        bore = cq.Workplane("XZ").center(x, z).circle(0.5 * BORE).extrude(-40)
        solid = solid.cut(bore.translate((0, -10, 0)))
    for y, z in WALL_BORES:
        bore = cq.Workplane("YZ").center(y, z).circle(0.5 * BORE).extrude(40)
        solid = solid.cut(bore.translate((-43, 0, 0)))
    return solid


def manifold_bracket(m: Any, segments: Callable[[float], int]) -> Any:
    """The same of triangles: the fillet is a box without a cylinder."""
    foot = m.Manifold.cube((60, 14, 30), True).translate((0, 7, 0))
    wall = m.Manifold.cube((14, 50, 30), True).translate((-23, 25, 0))
    corner = m.Manifold.cube((FILLET, FILLET, 30), True).translate((-12, 18, 0))
    corner -= m.Manifold.cylinder(40, FILLET, FILLET, segments(FILLET), True).translate((-8, 22, 0))
    bore = m.Manifold.cylinder(40, 0.5 * BORE, 0.5 * BORE, segments(0.5 * BORE), True)
    bores = [bore.rotate((90, 0, 0)).translate((x, 7, z)) for x, z in FOOT_BORES]
    bores += [bore.rotate((0, 90, 0)).translate((-23, y, z)) for y, z in WALL_BORES]
    return foot + wall + corner - m.Manifold.batch_boolean(bores, m.OpType.Add)


BRACKET_VOLUME = 30 * (60 * 14 + 14 * 36 + FILLET**2 * (1 - math.pi / 4)) - (
    4 * 14 * math.pi * BORE**2 / 4
)

# The case: open on top, walls of 2, four posts with holes of 2.2

WIDE, DEEP, HIGH, WALL = 90.0, 60.0, 30.0, 2.0
CORNER, POST, SCREW = 4.0, 7.0, 2.2
POSTS = [(sx * 38.0, sz * 23.0) for sx in (-1, 1) for sz in (-1, 1)]


def _upright(size: tuple[float, float], corner: float, low: float, high: float) -> Any:
    """A rounded rectangle that stands on y = low."""
    flat = Rectangle(size[0] - 2 * corner, size[1] - 2 * corner).round(corner)
    solid = flat.extrude(high - low).rotate(x=0.5 * math.pi)
    return solid.translate(0, 0.5 * (low + high), 0)


def case() -> Any:
    """The case, which stands on y = 0."""
    outside = _upright((WIDE, DEEP), CORNER, 0, HIGH)
    size = (WIDE - 2 * WALL, DEEP - 2 * WALL)
    inside = _upright(size, CORNER - WALL, WALL, HIGH + 5)
    posts = [Cylinder(0.5 * POST, HIGH - 5).translate(x, 0.5 * (HIGH - 5), z) for x, z in POSTS]
    holes = [Cylinder(0.5 * SCREW, 20).translate(x, HIGH - 5, z) for x, z in POSTS]
    return ((outside - inside) | union(*posts)) - union(*holes)


def cadquery_case(cq: Any) -> Any:
    """The same as a B-rep solid; its y axis is z here."""
    solid = cq.Workplane("XY").rect(WIDE, DEEP).extrude(HIGH).edges("|Z").fillet(CORNER)
    hollow = cq.Workplane("XY").workplane(offset=WALL).rect(WIDE - 2 * WALL, DEEP - 2 * WALL)
    solid = solid.cut(hollow.extrude(HIGH).edges("|Z").fillet(CORNER - WALL))
    posts = cq.Workplane("XY").pushPoints(POSTS).circle(0.5 * POST).extrude(HIGH - 5)
    holes = cq.Workplane("XY").workplane(offset=HIGH - 15).pushPoints(POSTS)
    return solid.union(posts).cut(holes.circle(0.5 * SCREW).extrude(20))


def manifold_case(m: Any, segments: Callable[[float], int]) -> Any:
    """The same of triangles; its y axis is z here."""

    def rounded(wide: float, deep: float, corner: float, low: float, high: float) -> Any:
        round_ = m.CrossSection.circle(corner, segments(corner))
        ends = [
            round_.translate((sx * (0.5 * wide - corner), sy * (0.5 * deep - corner)))
            for sx in (-1, 1)
            for sy in (-1, 1)
        ]
        return m.CrossSection.batch_hull(ends).extrude(high - low).translate((0, 0, low))

    def pins(radius: float, low: float, high: float) -> Any:
        pin = m.Manifold.cylinder(high - low, radius, radius, segments(radius))
        moved = [pin.translate((x, z, low)) for x, z in POSTS]
        return m.Manifold.batch_boolean(moved, m.OpType.Add)

    solid = rounded(WIDE, DEEP, CORNER, 0, HIGH)
    solid -= rounded(WIDE - 2 * WALL, DEEP - 2 * WALL, CORNER - WALL, WALL, HIGH + 5)
    return solid + pins(0.5 * POST, 0, HIGH - 5) - pins(0.5 * SCREW, HIGH - 15, HIGH + 5)


def _rounded_area(wide: float, deep: float, corner: float) -> float:
    return wide * deep - (4 - math.pi) * corner**2


CASE_VOLUME = (
    _rounded_area(WIDE, DEEP, CORNER) * HIGH
    - _rounded_area(WIDE - 2 * WALL, DEEP - 2 * WALL, CORNER - WALL) * (HIGH - WALL)
    + 4 * math.pi / 4 * (POST**2 * (HIGH - 5 - WALL) - SCREW**2 * 10)
)

# The leaf of a hinge: a plate, two knuckles with a bore of 4, three countersunk holes

LENGTH, LEAF, THICK, KNUCKLE, PIN, HOLE, HEAD = 60.0, 25.0, 3.0, 9.0, 4.0, 4.5, 9.0
KNUCKLES, HOLES = (-20.0, 20.0), (-20.0, 0.0, 20.0)


def hinge() -> Any:
    """The leaf: the pin lies along x; the plate goes from it to +z."""
    plate = Box(LENGTH, THICK, LEAF).translate(0, -0.5 * (KNUCKLE - THICK), 0.5 * LEAF)
    along = Cylinder(0.5 * KNUCKLE, 20).rotate(z=0.5 * math.pi)
    knuckles = union(*(along.translate(x, 0, 0) for x in KNUCKLES))
    gap = Box(20.2, KNUCKLE, 5.0).translate(0, 0, 2.5)
    pin = Cylinder(0.5 * PIN, LENGTH + 10).rotate(z=0.5 * math.pi)
    bores = union(*(Cylinder(0.5 * HOLE, 20).translate(x, 0, 16) for x in HOLES))
    return ((plate - gap) | knuckles) - pin - bores


def cadquery_hinge(cq: Any) -> Any:
    """The same as a B-rep solid."""
    low = -0.5 * KNUCKLE
    plate = cq.Workplane("XY").box(LENGTH, THICK, LEAF).translate((0, low + 1.5, 0.5 * LEAF))
    solid = plate.cut(cq.Workplane("XY").box(20.2, KNUCKLE, 5).translate((0, 0, 2.5)))
    for x in KNUCKLES:
        knuckle = cq.Workplane("YZ").circle(0.5 * KNUCKLE).extrude(20).translate((x - 10, 0, 0))
        solid = solid.union(knuckle)
    solid = solid.cut(cq.Workplane("YZ").circle(0.5 * PIN).extrude(70).translate((-35, 0, 0)))
    for x in HOLES:
        bore = cq.Workplane("XZ").center(x, 16).circle(0.5 * HOLE).extrude(20)
        solid = solid.cut(bore.translate((0, 10, 0)))
    return solid


def manifold_hinge(m: Any, segments: Callable[[float], int]) -> Any:
    """The same of triangles."""

    def cylinder(radius: float, length: float) -> Any:
        return m.Manifold.cylinder(length, radius, radius, segments(radius), True)

    low = -0.5 * KNUCKLE
    solid = m.Manifold.cube((LENGTH, THICK, LEAF), True).translate((0, low + 1.5, 0.5 * LEAF))
    solid -= m.Manifold.cube((20.2, KNUCKLE, 5), True).translate((0, 0, 2.5))
    for x in KNUCKLES:
        solid += cylinder(0.5 * KNUCKLE, 20).rotate((0, 90, 0)).translate((x, 0, 0))
    solid -= cylinder(0.5 * PIN, 70).rotate((0, 90, 0))
    for x in HOLES:
        solid -= cylinder(0.5 * HOLE, 20).rotate((90, 0, 0)).translate((x, 0, 16))
    return solid


# The bolt without a thread: a head of 13 across flats, a shank of 8

ACROSS, HEAD_HIGH, SHANK, SHANK_LONG = 13.0, 5.3, 8.0, 30.0


def bolt() -> Any:
    """The bolt: the head is below y = 5.3, the shank points down from 0."""
    head = HexPrism(0.5 * ACROSS, HEAD_HIGH).translate(0, 0.5 * HEAD_HIGH, 0)
    return head | Cylinder(0.5 * SHANK, SHANK_LONG).translate(0, -0.5 * SHANK_LONG, 0)


def cadquery_bolt(cq: Any) -> Any:
    """The same as a B-rep solid; its y axis is z here."""
    head = cq.Workplane("XY").polygon(6, ACROSS / math.cos(math.pi / 6)).extrude(HEAD_HIGH)
    return head.union(cq.Workplane("XY").circle(0.5 * SHANK).extrude(-SHANK_LONG))


def manifold_bolt(m: Any, segments: Callable[[float], int]) -> Any:
    """The same of triangles; its y axis is z here."""
    corner = 0.5 * ACROSS / math.cos(math.pi / 6)
    head = m.Manifold.cylinder(HEAD_HIGH, corner, corner, 6)
    shank = m.Manifold.cylinder(SHANK_LONG, 0.5 * SHANK, 0.5 * SHANK, segments(0.5 * SHANK))
    return head + shank.translate((0, 0, -SHANK_LONG))


BOLT_VOLUME = math.sqrt(3) / 2 * ACROSS**2 * HEAD_HIGH + math.pi / 4 * SHANK**2 * SHANK_LONG

PARTS = (
    Part(
        "L bracket",
        bracket,
        cadquery_bracket,
        manifold_bracket,
        BRACKET_VOLUME,
        (Section(1, 3.0, (60, 30), (BORE, BORE)), Section(0, -28.0, (50, 30), (BORE, BORE))),
    ),
    Part(
        "case",
        case,
        cadquery_case,
        manifold_case,
        CASE_VOLUME,
        (Section(1, 18.0, (WIDE, DEEP), (SCREW,) * 4), Section(1, 1.0, (WIDE, DEEP))),
    ),
    Part(
        "hinge leaf",
        hinge,
        cadquery_hinge,
        manifold_hinge,
        None,
        (Section(0, -25.0, (KNUCKLE, LEAF + 0.5 * KNUCKLE), (PIN,)),),
    ),
    Part(
        "bolt blank",
        bolt,
        cadquery_bolt,
        manifold_bolt,
        BOLT_VOLUME,
        (Section(1, -20.0, (SHANK, SHANK), (SHANK,)),),
    ),
)


# What distal's reports warn of, by the name of the part.
WARNINGS: dict[str, list[str]] = {}


def dimension_error(made: Triangles, section: Section, *, swapped: bool) -> float:
    """The largest error of a section's widths and holes.

    Args:
        made: Points and triangles.
        section: The section.
        swapped: Whether y is stored as z, as in CadQuery and manifold3d for some parts.
    """
    import trimesh

    points = made[0][:, [0, 2, 1]] if swapped else made[0]
    mesh = trimesh.Trimesh(points, made[1], process=True)
    normal = np.eye(3)[section.axis]
    cut = mesh.section(plane_origin=section.at * normal, plane_normal=normal)
    others = [axis for axis in range(3) if axis != section.axis]
    loops = [np.asarray(loop)[:, others] for loop in cut.discrete]
    whole = np.concatenate(loops)
    widths = whole.max(axis=0) - whole.min(axis=0)
    errors = [abs(w - e) for w, e in zip(widths, section.widths, strict=True)]
    # A facetted circle's points lie on it: its diameter is the mean of its two sizes.
    sizes = sorted(float((loop.max(axis=0) - loop.min(axis=0)).mean()) for loop in loops)
    for hole in section.holes:
        nearest = min(sizes, key=lambda size: abs(size - hole))
        errors.append(abs(nearest - hole))
        sizes.remove(nearest)
    return max(errors)


def volume_of(made: Triangles) -> float:
    """The volume within triangles."""
    a, b, c = (made[0][made[1][:, i]] for i in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0)


def warm(make: Callable[[], Triangles]) -> tuple[Triangles, float]:
    """The result of a second call, and its seconds of the processor."""
    make()
    begin = time.process_time()
    made = make()
    return made, time.process_time() - begin


def by_distal(part: Part, tolerance: float) -> Callable[[], Triangles]:
    """How distal meshes a part."""
    shape = part.distal()

    def make() -> Triangles:
        made = shape.mesh(tolerance, check=True)
        WARNINGS[part.name] = made.report["warnings"]
        return made.points, made.triangles

    return make


def by_cadquery(part: Part, tolerance: float) -> Callable[[], Triangles]:
    """How CadQuery does; the solid is modelled in the call, as distal's field is."""
    import cadquery as cq

    def make() -> Triangles:
        points, triangles = part.cadquery(cq).val().tessellate(tolerance, 0.5)
        return np.array([p.toTuple() for p in points]), np.array(triangles)

    return make


def by_manifold(part: Part, tolerance: float) -> Callable[[], Triangles]:
    """How manifold3d does, with circles of as many segments as the tolerance asks for."""
    import manifold3d

    def segments(radius: float) -> int:
        return 4 * math.ceil(0.25 * math.pi / math.acos(1.0 - tolerance / radius))

    def make() -> Triangles:
        mesh = part.manifold(manifold3d, segments).to_mesh64()
        return np.asarray(mesh.vert_properties)[:, :3], np.asarray(mesh.tri_verts)

    return make


def checks_of(part: Part, tolerance: float, folder: Path) -> str:
    """What the readers of files say about distal's 3MF and STL of a part."""
    made = part.distal().mesh(tolerance)
    path = folder / f"{part.name.replace(' ', '_')}.3mf"
    made.save(path)
    stl = path.with_suffix(".stl")
    made.save(stl)
    return ", ".join([*_by_trimesh(stl), *_by_manifold(made), *_by_lib3mf(path), *_by_slicer(stl)])


def _by_trimesh(path: Path) -> list[str]:
    try:
        import trimesh
    except ImportError:
        return ["trimesh not installed"]
    mesh = trimesh.load(path)
    return [f"trimesh {'watertight' if mesh.is_watertight and mesh.is_volume else 'FAULTY'}"]


def _by_manifold(made: Any) -> list[str]:
    try:
        import manifold3d
    except ImportError:
        return ["manifold3d not installed"]
    mesh = manifold3d.Mesh64(np.array(made.points), np.array(made.triangles, np.uint64))
    return [f"manifold3d {manifold3d.Manifold(mesh).status().name}"]


def _by_lib3mf(path: Path) -> list[str]:
    try:
        import lib3mf
    except ImportError:
        return ["lib3mf not installed"]
    model = lib3mf.get_wrapper().CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(True)
    reader.ReadFromFile(str(path))
    meshes, faults = model.GetMeshObjects(), reader.GetWarningCount()
    while meshes.MoveNext():
        faults += not meshes.GetCurrentMeshObject().IsManifoldAndOriented()
    return [f"lib3mf {faults} faults"]


def _by_slicer(path: Path) -> list[str]:
    slicer = shutil.which("prusa-slicer")
    if slicer is None:
        return ["prusa-slicer not installed"]
    out = path.with_suffix(".gcode")
    command = [slicer, "--export-gcode", "--output", str(out), str(path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600, check=False)
    told = [line for line in (done.stdout + done.stderr).splitlines() if "error" in line.lower()]
    fine = done.returncode == 0 and out.exists() and not told
    return [f"prusa-slicer {'sliced' if fine else f'FAILED {told[:1]}'}"]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tolerance", type=float, default=0.01)
    tolerance = parser.parse_args().tolerance
    programs = {"distal": by_distal, "CadQuery": by_cadquery, "manifold3d": by_manifold}
    print("| part | program | triangles | CPU s, warm | volume off, % | dimensions off, mm |")
    print("|---|---|---|---|---|---|")
    for part in PARTS:
        for name, program in programs.items():
            try:
                made, seconds = warm(program(part, tolerance))
            except ImportError:
                print(f"| {part.name} | {name} | not installed | | | |")
                continue
            swapped = name != "distal" and part.name in ("case", "bolt blank")
            off = max(dimension_error(made, section, swapped=swapped) for section in part.sections)
            volume = (
                "" if part.volume is None else f"{100 * (volume_of(made) / part.volume - 1):.3f}"
            )
            cells = (part.name, name, f"{len(made[1]):,}", f"{seconds:.2f}", volume, f"{off:.4f}")
            print(f"| {' | '.join(cells)} |", flush=True)
    for name, warnings in WARNINGS.items():
        print(f"{name}: {'; '.join(warnings) or 'no warnings'}")
    with tempfile.TemporaryDirectory() as folder:
        for part in PARTS:
            print(f"{part.name}: {checks_of(part, tolerance, Path(folder))}", flush=True)


if __name__ == "__main__":
    main()
