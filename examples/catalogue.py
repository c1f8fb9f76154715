"""Every closed solid of the library on one table, each with its default sizes.

The list comes from the library: a new shape appears here by itself. The catalogue of the
documentation names them in the same order. All shapes are compiled to one kernel; normals by
differences halve the time that this takes.
"""

import inspect
from math import isfinite

import distal
from distal import DistantLight, HemisphereLight, OrbitCamera, Plane, Scene, Shape, pattern, plastic
from distal.fields.library import PRIMITIVES
from distal.fields.noise import fraction, lattice_hash
from distal.lang import Buffer, cos, func, ivec3, round, slider, vec3

turn = slider("Turn", 0.35, low=-3.15, high=3.15, help="The camera's way around.")

ACROSS = 9
SPACING = 2.1


def stands_by_itself(name: str) -> bool:
    """Whether a shape is bounded, has an inside, and needs no data."""
    row, made = PRIMITIVES[name], getattr(distal, name)
    given = [p.default for p in inspect.signature(made).parameters.values()]
    complete = not any(d is inspect.Parameter.empty or isinstance(d, Buffer) for d in given)
    if not (issubclass(made, Shape) and complete and row.signed) or row.estimate:
        return False
    return all(isfinite(number) for corner in made().bounds() for number in corner)


@func
def own_color(p: vec3) -> vec3:
    """A color for each place on the table."""
    chance = fraction(lattice_hash(ivec3(round(p / SPACING)), 3))
    return 0.52 + 0.38 * cos(6.2831853 * (chance + vec3(0.0, 0.36, 0.6)))


names = [name for name in PRIMITIVES if stands_by_itself(name)]
down = -(-len(names) // ACROSS)
width, depth = SPACING * (ACROSS - 1), SPACING * (down - 1)
solids = [
    getattr(distal, name)().translate(
        SPACING * (i % ACROSS) - width / 2, 0.0, SPACING * (i // ACROSS) - depth / 2
    )
    for i, name in enumerate(names)
]
shown = solids[0].union(*solids[1:]).paint(plastic(pattern(own_color), roughness=0.3))

scene = Scene(
    shown.named("shown") | Plane(y=-1.05).paint("#e9e2d4"),
    lights=[
        DistantLight((-0.7, 1.0, 0.3), intensity=0.85, color="#fff4e2", angle=0.12),
        HemisphereLight(sky=(0.95, 0.97, 1.0), ground=(0.6, 0.52, 0.46), intensity=0.42),
    ],
    camera=OrbitCamera(46.0, azimuth=turn, elevation=0.9, target=(-0.4, -0.5, 0.0), fov_deg=20.5),
    background="#e9e2d4",
    normals="tetrahedron",
    ambient_occlusion=0.7,
    tone_map="none",
    bounces=0,
)
