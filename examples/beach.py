"""A beach of 10,000 pebbles of four kinds, each with its own size, color and rotation.

``points_on`` scatters places over the sand, none near another; ``copies`` puts a pebble on each.
Try: other colors, larger pebbles.
"""

import numpy as np

from distal import (
    Camera,
    DistantLight,
    Ellipsoid,
    Material,
    Plane,
    RoundBox,
    Scene,
    Sky,
    Sphere,
    copies,
    linear_gradient,
    matte,
    noise,
    plastic,
    points_on,
)

COUNT = 10_000
SUN = (-0.75, 0.36, -0.5)

random = np.random.default_rng(4)
sand = Plane().rotate(x=-0.09)  # it rises towards the camera

# Close together near the water's edge, where the sea sorts them; less so further up.
places, normals = points_on(sand, 2 * COUNT, within=((-7.0, -2.0, -5.6), (7.0, 2.0, 3.2)))
likely = 0.25 + 0.75 * np.exp(-(((places[:, 2] + 1.5) / 3.0) ** 2))
chosen = np.argsort(random.random(len(places)) / likely)[:COUNT]
places, normals = places[chosen], normals[chosen]

stone = plastic("white", 0.45)
kinds = [
    Ellipsoid((1.0, 0.5, 0.75)),
    Ellipsoid((0.8, 0.42, 0.8)),
    RoundBox((1.3, 0.66, 0.95), 0.32),
    Sphere(0.55).union(Sphere(0.42).translate(0.45, 0.0, 0.1), smooth=0.12),
]
colors = np.array(
    ["#8f8b86", "#6d6a6a", "#b5aca0", "#a08571", "#4e4f55", "#c9c2b6", "#7b8087", "#94604c"]
)
size = 0.035 + 0.055 * random.random(COUNT) ** 3
pebbles = copies(
    [kind.paint(stone) for kind in kinds],
    places + 0.25 * size[:, None] * normals,
    which=random.integers(0, len(kinds), COUNT),
    colors=random.choice(colors, COUNT).tolist(),
    scale=size,
    rotation=random.normal(0.0, (0.25, 2.0, 0.25), (COUNT, 3)),
    align=normals,
)

# Wet sand and foam where the sea meets the beach, at z = -4.65.
dry = noise("#8f8371", "#a69984", size=0.25)
beach = matte(linear_gradient(dry, "#5c5144", start=(0.0, 0.0, -3.2), end=(0.0, 0.0, -4.4)))
waves = noise("#1b5a6b", "#2c7f8c", size=0.8)
water = Material(waves, diffuse=0.85, specular=0.15, roughness=0.3)
sea = linear_gradient(matte("#eef2f0"), water, start=(0.0, 0.0, -4.72), end=(0.0, 0.0, -5.0))

scene = Scene(
    pebbles.named("pebbles") | sand.paint(beach) | Plane(y=-0.42).paint(sea),
    lights=[DistantLight(SUN, intensity=2.4, color="#ffd0a6", angle=0.03)],
    camera=Camera((0.0, 1.25, 3.7), target=(0.0, 0.06, -1.6), fov_deg=36.0),
    background=Sky(
        sun=SUN,
        zenith=(0.08, 0.26, 0.68),
        horizon=(0.92, 0.78, 0.7),
        ground=(0.35, 0.32, 0.3),
        light=True,
        intensity=0.9,
    ),
    ambient_occlusion=0.2,
    fog_density=0.006,
    tone_map="aces",
)
