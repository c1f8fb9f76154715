"""Buckyballs in a tube of boron nitride: a molecule read from a table of atoms.

The table is a text in the columns of a PDB file, made by the functions below from the geometry of
the molecule. Try: ``text = open("your.pdb").read()``.
"""

import itertools

import numpy as np

from distal import (
    Camera,
    Cylinder,
    DistantLight,
    HemisphereLight,
    Scene,
    Sphere,
    copies,
    plastic,
    studio,
    union,
)

RINGS = 24  # rings of atoms along the tube
BALLS = 3

BOND = 1.446  # angstroms between boron and nitrogen
# Color, radius of the ball: after Corey, Pauling and Koltun.
ELEMENTS = {"C": ("#f2b134", 0.36), "B": ("#e8927c", 0.40), "N": ("#2f5fd0", 0.37)}


def tube(rings, around=12):
    """Atoms of a rolled sheet of hexagons (an armchair tube), about the z axis."""
    radius = 3.0 * around * BOND / (2.0 * np.pi)
    for ring in range(rings):
        for i in range(2 * around):
            # Pairs of atoms, a bond apart; every other ring is turned by half a step.
            arc = 3.0 * BOND * (i // 2 + 0.5 * (ring % 2)) + BOND * (i % 2)
            angle = arc / radius
            z = (ring - 0.5 * (rings - 1)) * BOND * np.sqrt(0.75)
            yield "BN"[i % 2], (radius * np.cos(angle), radius * np.sin(angle), z)


def ball(center, turn):
    """The 60 atoms of a buckyball: the corners of a truncated icosahedron."""
    golden = 0.5 * (1.0 + np.sqrt(5.0))
    cos, sin = np.cos(turn), np.sin(turn)
    for x, y, z in ((0, 1, 3 * golden), (1, 2 + golden, 2 * golden), (golden, 2, 2 * golden + 1)):
        corners = set()
        for signs in itertools.product((-1, 1), repeat=3):
            corner = np.multiply((x, y, z), signs)
            corners |= {tuple(np.roll(corner, shift).round(6)) for shift in range(3)}
        for a, b, c in sorted(corners):
            a, b, c = 0.716 * np.array((a, b, c))
            yield "C", (cos * a - sin * b, sin * a + cos * b, c + center)


def table():
    """The atoms as text, one line each: number, element, molecule, and x, y, z."""
    molecules = [("TUB", list(tube(RINGS)))]
    for i in range(BALLS):
        molecules.append(("C60", list(ball(10.0 * (i - 0.5 * (BALLS - 1)), 0.4 * i))))
    atoms = [(element, name, xyz) for name, found in molecules for element, xyz in found]
    return "\n".join(
        f"HETATM{number:5d} {element:<4} {name} A   1    {x:8.3f}{y:8.3f}{z:8.3f}"
        for number, (element, name, (x, y, z)) in enumerate(atoms, 1)
    )


def read(text):
    """The elements, molecules and positions of a table."""
    lines = [line for line in text.splitlines() if line.startswith(("ATOM", "HETATM"))]
    elements = np.array([line[12:16].strip()[0] for line in lines])
    names = np.array([line[17:20] for line in lines])
    xyz = np.array([[float(line[i : i + 8]) for i in (30, 38, 46)] for line in lines])
    return elements, names, xyz


elements, names, xyz = read(table())

# The upper front of the tube is open.
angle = np.arctan2(xyz[:, 1], xyz[:, 0])
shown = (names == "C60") | (np.abs(angle - 2.4) > 0.7)
elements, names, xyz = elements[shown], names[shown], xyz[shown]

# A bond between atoms of one molecule that are near each other.
apart = np.linalg.norm(xyz[:, None] - xyz, axis=2)
first, second = np.nonzero(np.triu((apart < 1.6) & (names[:, None] == names), 1))
along = xyz[second] - xyz[first]

kinds = list(ELEMENTS)
balls = [Sphere(radius).paint(plastic(color, 0.15)) for color, radius in ELEMENTS.values()]
atoms = copies(balls, xyz, which=[kinds.index(e) for e in elements])

# Two halves for each bond, each in the color of its atom.
stick = Cylinder(0.13, 0.73).paint(plastic("white", 0.25))
colors = np.array([ELEMENTS[e][0] for e in elements])
halves = [
    stick.array(xyz[end] + sign * 0.25 * along, colors=colors[end].tolist(), align=along)
    for end, sign in ((first, 1.0), (second, -1.0))
]

molecule = union(atoms, *halves).rotate(y=np.pi / 2.0).named("molecule")

scene = Scene(
    molecule,
    look=studio(floor_color=(0.05, 0.065, 0.1), zenith=(0.02, 0.03, 0.05)),
    lights=[
        DistantLight((-0.5, 1.0, 0.7), intensity=1.7, color="#fff3e2", angle=0.02),
        HemisphereLight(sky=(0.5, 0.56, 0.66), ground=(0.3, 0.28, 0.28), intensity=0.7),
    ],
    camera=Camera((16.0, 20.0, 44.0), target=(0.6, -1.5, 0.0), fov_deg=32.0),
    ambient_occlusion=1.0,
)
