"""A glass of wine: three media inside of each other, each with its own index and color.

The glass has the highest priority, so it displaces the wine that reaches a little into its wall:
light goes from glass to wine without air between them. Try: another color of the wine, water.
"""

from distal import (
    Box,
    Camera,
    Cylinder,
    Ellipsoid,
    HemisphereLight,
    Plane,
    Scene,
    Sphere,
    emissive,
    glass,
    matte,
    plastic,
    wood,
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
grapes = grape.translate(0.62, 0.13, 0.62) | grape.translate(0.86, 0.13, 0.5)
grapes = grapes | grape.translate(0.66, 0.13, 0.36) | grape.translate(0.71, 0.33, 0.5)

window = Box((1.8, 2.2, 0.04)).rotate(y=0.9).translate(-3.2, 2.6, -1.2)
wall = Plane().rotate(x=1.5707963).translate(z=-2.6)

scene = Scene(
    cup.paint(glass(1.5), priority=2)
    | wine.paint(glass(1.34, absorption=(0.5, 4.2, 3.6)), priority=1)
    | grapes.paint(plastic("#3d4f1c", 0.2))
    | window.paint(emissive((1.0, 0.88, 0.7), 34.0))
    | wall.paint(matte("#7d8f8c"))
    | Plane().paint(wood(size=0.6)),
    lights=[HemisphereLight("#8fa3b8", "#5a4a3a", 0.6)],
    camera=Camera((0.35, 1.75, 4.6), target=(0.12, 1.12, 0.0), fov_deg=35.0),
    mode="path",
    floor=False,
    tone_map="aces",
)
