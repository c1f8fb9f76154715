"""A lightweight bracket, cut open: a solid skin, and a gyroid that fills it, denser at the bolts.

A minimal surface carries load in all directions with little material; another shape's distance
steers its thickness. Try: cell size, thickness, and how far the part is cut open.
"""

import math

from distal import (
    Box,
    Camera,
    Cylinder,
    Gyroid,
    Plane,
    RoundBox,
    RoundedCylinder,
    Scene,
    glossy,
    matte,
    metal,
)
from distal.lang import slider

cell = slider("Cell size", 0.36, low=0.25, high=0.8)
thin = slider("Thickness", 0.035, low=0.02, high=0.1)
opened = slider("Cut", 0.0, low=-2.0, high=2.0, help="Where along x the skin is cut away.")

PAINT = glossy("#2f6f8f", 0.85, 0.1, 0.25)
INSIDE = matte("#e8a33d")
STEEL = metal((0.62, 0.6, 0.57), roughness=0.25)

# The outer form: a foot with two bolts, a neck, and an eye for a shaft.
foot = RoundBox((3.6, 0.6, 1.6), 0.12).translate(y=-0.9)
eye = RoundedCylinder(0.8, 1.5, 0.1).rotate(x=math.pi / 2).translate(y=0.75)
neck = RoundBox((1.1, 1.4, 1.1), 0.1).translate(y=-0.2)
body = foot.union(neck.union(eye, smooth=0.1), smooth=0.16)
shaft = Cylinder(0.42, 2.0).rotate(x=math.pi / 2).translate(y=0.75)
bolt = Cylinder(0.24, 2.0).translate(1.3, -0.9, 0.0).symmetry("x")
holes = shaft | bolt

# The skin, and the bushings around the holes; what fills the rest.
skin = body.shell(0.07, "inner")
bushings = (
    Cylinder(0.56, 1.5).rotate(x=math.pi / 2).translate(y=0.75)
    | Cylinder(0.38, 0.6).translate(1.3, -0.9, 0.0).symmetry("x")
) & body
filling = Gyroid(cell, thickness=thin, solid=True)
filling = filling.apply("thicken by", 3.0 * thin, thin, 0.5, others=[bushings])
cut = Box((4.0, 4.0, 4.0)).translate(opened + 2.0, 0.0, 2.0)
part = (skin.paint(PAINT) - cut) | (filling & body).paint(INSIDE)
part = (part | bushings.paint(PAINT)) - holes.cut_material(STEEL)

scene = Scene(
    part.named("bracket") | Plane(y=-1.2).paint("#a9a8a6"),
    camera=Camera((2.6, 1.9, 5.4), target=(0.0, -0.15, 0.0), fov_deg=36.0),
    ambient_occlusion=0.35,
    bounces=2,
)
