"""Two stones have fallen into a pond of 1,225 cubes: each cube rises and falls on its own.

The height and the color of a cube are expressions of the time that differ only in numbers, so all
cubes are one kind of part. Try: ``--set Height=0.5``.
"""

import numpy as np

from distal import Box, Camera, DistantLight, HemisphereLight, Scene, plastic, time, union
from distal.lang import slider

SIDE = 35  # cubes along each side
STONES = ((-0.9, -0.5), (1.1, 0.8))  # where they fell
CREST, TROUGH = (1.0, 0.62, 0.28), (0.015, 0.12, 0.24)  # colors

height = slider("Height", 0.3, low=0.0, high=0.6)
speed = slider("Speed", 2.0, low=0.0, high=5.0)
clock = speed * time


def wave(x, z, stone):
    """A wave that runs away from where a stone fell, and becomes lower."""
    distance = float(np.hypot(x - stone[0], z - stone[1]))
    return 0.5 * float(np.exp(-0.35 * distance)) * np.sin(5.0 * distance - clock)


def cube(x, z):
    """A cube that rises and falls with the waves of both stones."""
    lift = wave(x, z, STONES[0]) + wave(x, z, STONES[1])
    share = 0.48 + 0.7 * lift
    share = share * share
    color = [low + (high - low) * share for low, high in zip(TROUGH, CREST, strict=True)]
    block = Box(0.1).round(0.016).paint(plastic(color, roughness=0.35))
    return block.translate(x, height * lift, z)


places = np.linspace(-2.2, 2.2, SIDE).tolist()
scene = Scene(
    union(cube(x, z) for x in places for z in places),
    camera=Camera((3.6, 3.0, 4.4), target=(0.0, -0.15, 0.0), fov_deg=36.0),
    lights=[
        DistantLight((-0.8, 0.9, 0.5), color="#ffe2bd", intensity=2.6, angle=0.02),
        HemisphereLight("#9dbbe0", "#30281f", intensity=0.5),
    ],
    background="#101a26",
    ambient_occlusion=0.0,
)
