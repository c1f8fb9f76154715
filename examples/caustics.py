"""Caustics: a small sun through a ball, a wine glass and off a polished ring, on a table.

The light that glass and metal gather is found by photons, so it is sharp after a few samples.
Try: the size of the sun, and the glass's index of refraction.
"""

from distal import (
    Camera,
    Cylinder,
    DistantLight,
    HemisphereLight,
    Plane,
    RoundedCylinder,
    Scene,
    Sky,
    Sphere,
    Torus,
    glass,
    matte,
    metal,
)
from distal.lang import slider

ior = slider("Index of refraction", 1.5, low=1.2, high=2.0)
width = slider("Angular size of the sun", 0.01, low=0.0, high=0.2)

table = Plane().paint(matte("#c9b79c"))
clear = glass(ior)

ball = Sphere(0.62).translate(-1.35, 0.62, 0.35).paint(glass(ior, color="#d6f0ee"))

# The bowl of the wine glass is a ball with a smaller one cut out, open at the top.
bowl = Sphere(0.62) - Sphere(0.57) - Cylinder(1.0, 1.0).translate(y=0.85)
stem = Cylinder(0.055, 0.8).translate(y=-0.95)
foot = RoundedCylinder(0.42, 0.06, 0.03).translate(y=-1.34)
wine_glass = bowl.union(stem, smooth=0.05).union(foot, smooth=0.05)
wine_glass = wine_glass.translate(0.25, 1.4, -0.65).paint(clear)

ring = Cylinder(0.62, 0.3) - Cylinder(0.57, 1.0)
ring = ring.translate(1.35, 0.15, 0.55).paint(metal((1.0, 0.78, 0.42), roughness=0.05))

donut = Torus(0.36, 0.15).rotate(x=0.25).translate(0.05, 0.2, 1.15)
donut = donut.paint(glass(ior, color="#f3b8a8"))

scene = Scene(
    [table, ball, wine_glass, ring, donut],
    lights=[
        DistantLight((-0.55, 0.62, -0.5), intensity=1.5, color="#fff1dc", angle=width),
        HemisphereLight((0.5, 0.62, 0.8), (0.3, 0.25, 0.2), 0.3),
    ],
    camera=Camera((0.5, 3.4, 5.2), target=(0.1, 0.45, 0.25), fov_deg=36.0),
    background=Sky(zenith=(0.3, 0.42, 0.6), horizon=(0.85, 0.82, 0.78), ground=(0.6, 0.5, 0.4)),
    mode="path",
    floor=False,
    tone_map="aces",
)
