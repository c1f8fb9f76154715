"""The library is complete, and every row says all that others read from it."""

from __future__ import annotations

import re
import subprocess
import sys
from typing import Final

import pytest

from distal.fields.guarantees import EXACT, Guarantee, Limit, Operator, Primitive
from distal.ir.types import Buffer, Texture
from distal.lang import Func
from distal.scene.objects.in_plane import IN_PLANE
from distal.scene.tree.arguments import RESERVED, RESERVED_OF_SHAPES
from tests.fields.library import MODULES, docstring, measured, operators, primitives
from tests.fields.rows import PLACE, default_of, header_of, slots_of
from tests.fields.trees import operator_slots

SHAPES: Final = [pytest.param(row, id=name) for name, row in primitives().items()]
OPERATORS: Final = [pytest.param(row, id=name) for name, row in operators().items()]

# The shapes that the catalogue promises, by the names they have here.
WANTED_SOLIDS: Final = [
    "Sphere", "Box", "BoxCheap", "RoundBox", "ChamferBox", "BoxFrame", "RoundFrame", "Torus",
    "CappedTorus", "Link", "InfiniteCylinder", "Cylinder", "CylinderBetween", "RoundedCylinder",
    "Cone", "ConeCheap", "ConeBetween", "InfiniteCone", "CappedCone", "CappedConeBetween",
    "RoundCone", "RoundConeBetween", "SolidAngle", "CutSphere", "CutHollowSphere", "DeathStar",
    "Capsule", "CapsuleBetween", "VesicaSolid", "VesicaBetween", "Ellipsoid", "HexPrism",
    "TriPrism", "OctagonPrism", "RhombusPrism", "Octahedron", "OctahedronCheap", "Pyramid",
    "Tetrahedron", "Dodecahedron", "Icosahedron", "TruncatedOctahedron", "TruncatedIcosahedron",
    "SmoothOctahedron", "SmoothDodecahedron", "SmoothIcosahedron", "SmoothTruncatedOctahedron",
    "SmoothTruncatedIcosahedron", "ConvexPolyhedron", "TriangleSheet", "Quad", "Plane", "HalfSpace",
    "Slab", "Prism", "Corner", "Wedge", "Disc", "CircleLine", "Blob", "Superellipsoid",
]  # fmt: skip
WANTED_FLATS: Final = [
    "Circle", "RoundedRectangle", "ChamferedRectangle", "Rectangle", "OrientedRectangle",
    "Segment", "Rhombus", "IsoscelesTrapezoid", "Parallelogram", "EquilateralTriangle",
    "IsoscelesTriangle", "Triangle", "UnevenCapsule", "Pentagon", "Hexagon", "Octagon",
    "RegularPolygon", "Hexagram", "Pentagram", "RegularStar", "Pie", "CutDisk", "Arc", "Ring",
    "Horseshoe", "Vesica", "OrientedVesica", "Moon", "CircleCross", "Egg", "Heart", "Cross",
    "RoundedX", "Polygon", "Ellipse", "Parabola", "ParabolaSegment", "QuadraticBezier",
    "BlobbyCross", "Tunnel", "Stairs", "QuadraticCircle", "Hyperbola", "CoolS", "CircleWave",
    "CubicBezier", "SplinePath", "Polyline", "ImageField", "HalfPlane", "Annulus", "GearProfile",
    "TangentCam", "ArcCam", "ArchimedeanSpiral", "LogarithmicSpiral", "RoundedPolygon",
]  # fmt: skip
WANTED_LATER_TIERS: Final = [
    "PolylineTube", "TaperedPolylineTube", "BezierTube", "CurveTube", "CubicBezierTube",
    "TaperedBezierTube", "HexagonalLattice", "Isotruss",
    "Helix", "Spring", "VolumeField", "BrickField", "Heightfield", "Metaballs", "Gyroid",
    "SchwarzP", "SchwarzD",
    "Neovius", "Lidinoid", "SplitP", "IWP", "CubicLattice", "BccLattice", "FccLattice",
    "OctetLattice", "VoronoiWalls", "VoronoiCells", "VoronoiLines", "ScatteredBalls",
    "ValueNoiseSolid", "GradientNoiseSolid", "SimplexNoiseSolid", "FbmSolid", "MengerSponge",
    "Mandelbulb", "Mandelbox", "QuaternionJulia",
]  # fmt: skip
BLENDS: Final = [
    "quadratic", "cubic", "quartic", "circular", "circular_geometric", "exponential", "root",
    "sigmoid", "chamfer", "round", "columns", "stairs", "soft",
]  # fmt: skip
WANTED_OPERATORS: Final = [
    *("union", "intersection", "difference", "xor", "complement", "clearance", "morph"),
    *(f"{kind} {b}" for kind in ("union", "intersection", "difference") for b in BLENDS),
    *("pipe", "engrave", "groove", "tongue", "union power", "emboss", "carve", "displace"),
    *("transition linear", "transition radial", "split below", "split above"),
    *("round", "offset", "dilate", "erode", "shell inner", "shell center", "shell outer"),
    *("translate", "rotate", "rotate euler", "rotate quaternion", "rotate matrix", "orient"),
    *("scale", "scale axes", "shear", "mirror", "mirror across", "symmetry"),
    *("symmetry across", "symmetry diagonal", "symmetry octant"),
    *("kaleidoscope", "repeat", "repeat neighbors", "repeat mirrored", "repeat limited"),
    *("repeat limited neighbors", "repeat interval", "repeat half", "repeat polar"),
    *("repeat polar neighbors", "repeat line", "repeat ring", "repeat at", "repeat scaled"),
    *("elongate", "twist", "bend", "bend linear", "bend radial", "taper", "wrap", "attract"),
    *("repel", "warp", "sphere fold", "relief", "thicken by", "wrap cylinder", "slice", "project"),
    *("extrude", "extrude rounded", "extrude chamfered", "extrude twisted", "extrude tapered"),
    *("loft", "revolve", "revolve partly", "sweep", "sweep bezier"),
]


def test_the_catalogue_is_there():
    wanted = WANTED_SOLIDS + WANTED_FLATS + WANTED_LATER_TIERS
    assert set(wanted) - set(primitives()) == set()
    assert set(WANTED_OPERATORS) - set(operators()) == set()


def test_whoever_is_measured_is_declared():
    declared = {id(row.distance) for row in primitives().values()}
    for module in MODULES:
        if not module.__name__.rpartition(".")[2].startswith(("solids", "flats")):
            continue
        for name, value in vars(module).items():
            if isinstance(value, Func) and "Measured:" in docstring(value):
                assert id(value) in declared, f"{module.__name__}.{name} is no primitive"


@pytest.mark.parametrize("row", SHAPES)
def test_a_shape_is_documented(row: Primitive):
    text = docstring(row.distance)
    assert re.fullmatch(r"[A-Z][A-Za-z0-9]*", row.name)
    assert re.search(r"^Source: \S", text, re.MULTILINE), "no source"
    assert len(measured(row.distance)) == 3
    block = re.search(r"^Args:\n((?: +.*\n)+)", text, re.MULTILINE)
    assert block is not None
    explained = re.findall(r"^    (\w+): \S", block[1], re.MULTILINE)
    assert explained == [s.name for s in header_of(row.distance).parameters if s.name != "cell"]


@pytest.mark.parametrize("row", SHAPES)
def test_a_shape_is_declared_soundly(row: Primitive):
    slots = {s.name: s for s in slots_of(row.distance)}
    assert not set(slots) & (RESERVED_OF_SHAPES - set(PLACE)), "a number has a reserved name"
    assert set(row.limits) <= set(slots)
    for rule in (row.bounds, row.slope):
        if isinstance(rule, Func):
            assert {s.name for s in header_of(rule).parameters} <= set(slots)
    if row.requires is not None:
        assert _arguments(row.requires) <= set(slots)
    for slot in slots.values():
        given = default_of(slot) if not isinstance(slot.type, Buffer | Texture) else True
        assert given is not None, f"{slot.name} has no default"
    assert row.tier in (1, 2, 3)
    assert Guarantee.LOWER_BOUND in row.claims or Guarantee.EXACT_OUTSIDE not in row.claims
    if row.claims >= EXACT:
        assert row.slope == 1.0 and not row.estimate


@pytest.mark.parametrize("row", OPERATORS)
def test_an_operator_is_declared_soundly(row: Operator):
    functions = row.number_functions
    assert functions, "does nothing"
    assert (row.combine is None) or (row.around is None)
    names = {s.name for s in operator_slots(row)}
    given = names | RESERVED | {*row.fixed}
    for func in (*functions, row.mix, row.site, row.bounds, row.slope):
        if isinstance(func, Func):
            unknown = {s.name for s in header_of(func).parameters} - given
            assert not unknown, f"{func.name} asks for {unknown}"
    assert set(row.limits) <= names
    if row.requires is not None:
        assert _arguments(row.requires) <= names
    kept = row.keeps | row.keeps_exact
    assert Guarantee.LOWER_BOUND in kept or Guarantee.EXACT_OUTSIDE not in kept
    for name, limit in row.limits.items():
        assert isinstance(limit, Limit), name


def _arguments(function) -> set[str]:
    code = function.__code__
    return set(code.co_varnames[: code.co_argcount + code.co_kwonlyargcount])


def test_usual_limits_hold_unless_a_shape_says_otherwise():
    limits = {name: row.limits.get("height") for name, row in primitives().items()}
    assert limits["Cone"] is Limit.POSITIVE
    assert limits["CutDisk"] is None
    assert limits["Heightfield"] is Limit.NOT_ZERO


def test_operators_in_the_plane_are_those_of_space():
    for solid, flat in IN_PLANE.items():
        assert flat.name == f"flat {solid.name}"
        assert (solid.lies_flat(False), flat.lies_flat(True)) == (False, True)
    paired = {flat.name for flat in IN_PLANE.values()} | {"flat rotate"}
    assert paired == {name for name in operators() if name.startswith("flat ")}


def test_the_order_of_the_shapes_does_not_depend_on_what_was_imported_first():
    code = "from distal.fields.library import PRIMITIVES; print(*PRIMITIVES)"
    for first in ("distal.fields.solids.tubes", "distal.video.recording"):
        run = [sys.executable, "-c", f"import {first}; {code}"]
        found = subprocess.run(run, capture_output=True, text=True, check=True, timeout=120)
        assert found.stdout.split() == [*primitives()], first
