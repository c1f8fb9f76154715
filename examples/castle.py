"""A castle of four towers: battlements, roofs, a gate with a grating, a keep with a flag.

Each part is modelled once, at the origin; mirrors and repetitions place the others. Try: how high
and how far apart the towers are.
"""

import math

from distal import (
    Box,
    Camera,
    Cone,
    Cylinder,
    Plane,
    Prism,
    Scene,
    Triangle,
    concrete,
    gold,
    steel,
)
from distal.lang import slider

height = slider("Height", 1.8, low=1.4, high=2.6, help="Height of the towers.")
apart = slider("Size", 1.6, low=1.5, high=1.9, help="Half of the distance between towers.")

QUARTER = math.pi / 2.0
STONE = concrete(color="#c9b79a")
ROOF = concrete(color="#963f2e")

merlon = Box(0.12, 0.16, 0.1)

# A tower: a shaft with slits, a wider platform with merlons, a roof on it.
platform = Cylinder(0.5, 0.24) - Cylinder(0.4, 0.3).translate(y=0.15)
platform = platform | merlon.translate(0.45, 0.18, 0.0).repeat_polar(9)
slit = Box(0.05, 0.3, 0.4).translate(0.0, 1.1, 0.4)
shaft = Cylinder(0.42, height).translate(y=0.5 * height)
tower = (shaft - slit - slit.rotate(y=QUARTER)) | platform.translate(y=height)
roof = Cone(0.46, 0.7).translate(y=height + 0.5)
towers = (tower.paint(STONE) | roof.paint(ROOF)).translate(apart, 0.0, apart).symmetry("xz")

# Walls between them; the front one has a gatehouse.
teeth = merlon.repeat(0.26, 1.0, 1.0, count=(10, 1, 1)).translate(y=1.28)
wall = Box(3.4, 1.2, 0.22).translate(y=0.6) | teeth
gatehouse = Box(1.1, 1.5, 0.5).translate(y=0.75) | merlon.repeat(
    0.24, 1.0, 1.0, count=(5, 1, 1)
).translate(0.0, 1.58, 0.2)
arch = Box(0.6, 1.0, 1.2) | Cylinder(0.3, 1.2).rotate(x=QUARTER).translate(y=0.5)
sides = wall.rotate(y=QUARTER).translate(x=apart).symmetry("x")
walls = sides.union(wall.translate(z=-apart), ((wall | gatehouse) - arch).translate(z=apart))
bars = Cylinder(0.02, 0.9).repeat(0.12, 1.0, 1.0, count=(5, 1, 1)).translate(0.0, 0.45, apart)

# The keep, and a flag of gold and crimson.
keep = Prism(0.6, 2.4, count=6).translate(y=1.2).paint(STONE) | Cone(0.75, 0.9).translate(
    y=2.85
).paint(ROOF)
flag = Triangle((0.0, 0.0), (0.5, 0.14), (0.0, 0.28)).extrude(0.03).translate(y=3.5)
pole = Cylinder(0.02, 0.7).translate(y=3.45)

castle = towers.union(
    walls.paint(STONE),
    keep,
    bars.paint(steel(0.5)),
    flag.paint("crimson"),
    pole.paint(gold()),
)

scene = Scene(
    castle.named("castle") | Plane().paint("olivedrab"),
    look="outdoor",
    camera=Camera((3.4, 4.2, 7.6), target=(0.0, 1.25, 0.0), fov_deg=36.0),
)
