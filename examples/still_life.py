"""Glass, gold, a mirror and a lemon on a checkered table: what light does at each of them.

The recursion through glass and mirrors follows up to eight bounces, with Fresnel's shares. Try: the
glass's index of refraction, and a rougher gold.
"""

import math

from distal import (
    Camera,
    Capsule,
    DistantLight,
    Ellipsoid,
    Plane,
    RoundBox,
    RoundedCylinder,
    Scene,
    Sky,
    Sphere,
    Torus,
    checker,
    glass,
    metal,
    mirror,
    plastic,
)
from distal.lang import slider

ior = slider("Index of refraction", 1.5, low=1.0, high=2.4)
roughness = slider("Gold's roughness", 0.12, low=0.0, high=0.6)

table = Plane().paint(checker(plastic("#e9e2d3", 0.15), plastic("#31525b", 0.15), size=0.7))
ball = Sphere(0.8).translate(-0.15, 0.8, 0.9).paint(glass(ior, color=(0.93, 0.98, 0.96)))
silver = Sphere(0.95).translate(-1.75, 0.95, -0.5).paint(mirror((0.93, 0.93, 0.95)))
ring = Torus(0.62, 0.2).rotate(x=1.2, y=0.5).translate(1.45, 0.78, 0.2)
ring = ring.paint(metal((1.0, 0.72, 0.3), roughness=roughness))

outside = RoundedCylinder(0.5, 1.7, 0.12)
inside = RoundedCylinder(0.43, 1.7, 0.1).translate(y=0.14)
vase = (outside - inside).translate(0.45, 0.86, -1.2).paint(glass(ior, color=(0.75, 0.9, 0.95)))

lemon = Ellipsoid((0.42, 0.31, 0.31)).union(Capsule(0.07, 0.9).rotate(z=math.pi / 2), smooth=0.06)
lemon = lemon.rotate(y=-0.6).translate(1.1, 0.31, 1.75).paint(plastic("#f2c41d", 0.35))
die = RoundBox((0.55, 0.55, 0.55), 0.07).rotate(y=0.5).translate(-1.35, 0.275, 1.5)
die = die.paint(plastic("#b5322b", 0.2))

scene = Scene(
    table | ball | silver | ring | vase | lemon | die,
    lights=[DistantLight((-0.7, 1.0, 0.55), intensity=1.0, color="#fff0d6", angle=0.08)],
    camera=Camera((0.6, 2.1, 6.4), target=(0.0, 0.72, 0.0), fov_deg=36.0),
    background=Sky(
        sun=(-0.7, 1.0, 0.55),
        sun_intensity=0.0,
        zenith=(0.35, 0.5, 0.75),
        horizon=(0.95, 0.88, 0.8),
        ground=(0.85, 0.78, 0.7),
        intensity=0.8,
        light=True,
    ),
    bounces=8,
    ambient_occlusion=0.4,
    fog=(0.9, 0.85, 0.8),
    fog_density=0.015,
    tone_map="aces",
)
