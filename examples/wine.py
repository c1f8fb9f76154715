"""A glass of wine: three media inside of each other, each with its own index and color.

The glass has the highest priority, so it displaces the wine that reaches a little into its wall:
light goes from glass to wine without air between them. Try: another color of the wine, water.
"""

from distal import (
    Box,
    Camera,
    Cylinder,
    Ellipsoid,
    Plane,
    Scene,
    Sky,
    Sphere,
    checker,
    emissive,
    glass,
    matte,
    plastic,
)
from distal.lang import slider

level = slider("Level of the wine", 1.55, low=1.1, high=1.9)

middle = 1.65
bowl = Ellipsoid((0.5, 0.75, 0.5)).translate(y=middle)
hollow = Ellipsoid((0.475, 0.72, 0.475)).translate(y=middle + 0.005)
rim = Box((2.0, 1.0, 2.0)).translate(y=middle + 0.95)
stem = Cylinder(0.035, 0.85).translate(y=0.45)
foot = Cylinder(0.42, 0.02).translate(y=0.012).round(0.012)
cup = bowl.union(stem, smooth=0.12).union(foot, smooth=0.12) - hollow - rim

# The wine reaches half of the wall's thickness into the glass.
wine = Ellipsoid((0.485, 0.732, 0.485)).translate(y=middle + 0.003)
wine = wine & Box((2.0, 2.0, 2.0)).translate(y=level - 1.0)

grape = Sphere(0.13)
grapes = grape.translate(0.95, 0.13, 0.35) | grape.translate(1.18, 0.13, 0.2)
grapes = grapes | grape.translate(1.0, 0.13, 0.08) | grape.translate(1.06, 0.33, 0.22)

window = Box((1.6, 1.6, 0.04)).rotate(y=-0.9).translate(-3.2, 2.6, -1.6)

scene = Scene(
    cup.paint(glass(1.5, dispersion=0.3), priority=2)
    | wine.paint(glass(1.34, absorption=(0.9, 5.5, 4.6)), priority=1)
    | grapes.paint(plastic("#3d4f1c", 0.2))
    | window.paint(emissive((1.0, 0.9, 0.75), 18.0))
    | Plane().paint(checker(matte("#d9cdb8"), matte("#b8a88c"), size=0.5)),
    lights=[],
    camera=Camera((0.5, 1.9, 4.4), target=(0.15, 1.15, 0.0), fov_deg=36.0),
    background=Sky(
        sun=(-0.6, 0.5, -0.6),
        sun_intensity=0.0,
        zenith=(0.25, 0.3, 0.42),
        horizon=(0.55, 0.52, 0.5),
        ground=(0.3, 0.27, 0.24),
        light=True,
    ),
    mode="path",
    floor=False,
    tone_map="aces",
)
