"""A cabin in an autumn forest: thousands of trees of three kinds on hills, in the evening.

``points_on`` scatters places on the hills; NumPy leaves out those near the cabin and chooses a kind
and a color for each of the rest. Try: another season's colors.
"""

import numpy as np

from distal import (
    Box,
    Camera,
    Cone,
    Cylinder,
    DistantLight,
    Ellipsoid,
    PointLight,
    Scene,
    Shape,
    Sky,
    Sphere,
    Triangle,
    copies,
    emissive,
    matte,
    points_on,
)
from distal.lang import func, sin, vec3

SPACING = 0.3
SUN = (-0.85, 0.3, -0.45)


@func
def hills(p: vec3) -> float:
    height = 0.55 * sin(0.42 * p.x + 0.6) * sin(0.36 * p.z - 0.4)
    return 0.9 * (p.y - height - 0.12 * sin(1.3 * p.x - 0.7 * p.z))


land = Shape.from_function(hills, slope=1.0)
places, _ = points_on(land, spacing=SPACING, seed=2, within=((-11, -2, -22), (11, 2, 7)))

# A clearing around the cabin, and a way from there to the camera.
random = np.random.default_rng(1)
x, z = places[:, 0], places[:, 2]
path = np.abs(x - 0.19 * z - 0.3 * np.sin(1.2 * z)) < 0.5
clear = (np.hypot(x, z) < 1.25) | (path & (z > 0.0))
places = places[~clear]
count = len(places)

# Crowns for a height of 1, and their trunks.
fir = Cone(0.26, 0.55).translate(y=0.28) | Cone(0.2, 0.5).translate(y=0.6)
fir = fir | Cone(0.13, 0.4).translate(y=0.86)
beech = (
    Sphere(0.24)
    .translate(y=0.66)
    .union(
        Sphere(0.2).translate(0.13, 0.48, 0.06),
        Sphere(0.18).translate(-0.13, 0.5, -0.05),
        smooth=0.04,
    )
)
birch = Ellipsoid((0.16, 0.34, 0.16)).translate(y=0.62)
trunk = Cylinder(0.025, 0.4).translate(y=0.2).paint("#4a3628")

AUTUMN = ["#c2571a", "#d98e1f", "#a63a1c", "#8c8b2a", "#e0a92e"]
GREEN = ["#23402c", "#2c4f33", "#1d3629"]
# Firs stand together.
groves = (
    np.sin(0.9 * places[:, 0] + 0.5) + np.sin(0.7 * places[:, 2]) + random.normal(0, 0.5, count)
)
which = np.where(groves > 0.3, 0, random.integers(1, 3, count))
colors = np.where(which == 0, random.choice(GREEN, count), random.choice(AUTUMN, count))
grown = random.uniform(0.6, 1.15, count)
turned = random.uniform(0.0, 2.0 * np.pi, count)

crowns = copies(
    [fir, beech, birch], places, which=which, colors=colors.tolist(), scale=grown, rotation=turned
)
trunks = trunk.array(places, scale=grown)

gable = Triangle((-0.45, 0.5), (0.45, 0.5), (0.0, 0.88)).extrude(0.7)
walls = (Box(0.9, 0.55, 0.7).translate(y=0.27) | gable).paint("#6b4a33")
roof = Box(0.78, 0.06, 0.92).rotate(z=-0.7).translate(0.27, 0.68, 0.0)
roof = (roof | roof.rotate(y=np.pi)).paint("#3b3036")
window = Box(0.18, 0.18, 0.05).translate(0.0, 0.3, 0.35).paint(emissive("#ffb84d", 3.0))
cabin = (walls | roof | window).rotate(y=0.35)

scene = Scene(
    land.paint(matte("#6b6a35")) | crowns | trunks | cabin.named("cabin"),
    lights=[
        DistantLight(SUN, intensity=3.0, color="#ffc58a", angle=0.06),
        PointLight((0.4, 0.35, 0.9), intensity=0.25, color="#ffb04d"),
    ],
    camera=Camera((1.5, 2.7, 7.4), target=(-0.1, 0.55, 0.0), fov_deg=36.0),
    background=Sky(
        sun=SUN,
        zenith=(0.16, 0.3, 0.58),
        horizon=(0.95, 0.75, 0.55),
        ground=(0.95, 0.75, 0.55),
        light=True,
    ),
    ambient_occlusion=0.5,
    fog_density=0.02,
    steps=1000,
    far=20000.0,
    tone_map="aces",
)
