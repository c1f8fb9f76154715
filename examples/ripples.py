"""Two stones have fallen into a pond of 1,681 columns: each rises and falls on its own.

The height and the color of a column are expressions of the time that differ only in numbers, so
all columns are one kind of part. Try: ``--set Height=0.2``.
"""

import numpy as np

from distal import Box, Camera, DistantLight, HemisphereLight, Scene, plastic, time, union
from distal.lang import slider

SIDE = 41  # columns along each side
STONES = ((-0.9, -0.5), (1.1, 0.8))  # where they fell
CREST = np.array((1.0, 0.62, 0.28))
TROUGH = np.array((0.015, 0.12, 0.24))

height = slider("Height", 0.3, low=0.0, high=0.6)
speed = slider("Speed", 2.0, low=0.0, high=5.0)


def column(x, z):
    """A column that rises and falls with the waves of both stones."""
    lift = 0.0
    for stone in STONES:
        distance = float(np.hypot(x - stone[0], z - stone[1]))
        lift = lift + 0.5 * np.exp(-0.35 * distance) * np.sin(5.0 * distance - speed * time)
    share = 0.48 + 0.8 * lift
    color = [t + (c - t) * share * share for c, t in zip(CREST, TROUGH, strict=True)]
    block = Box(0.094, 0.6, 0.094).round(0.012).paint(plastic(color, roughness=0.35))
    return block.translate(x, height * lift - 0.3, z)


places = np.linspace(-2.2, 2.2, SIDE).tolist()
scene = Scene(
    union(column(x, z) for x in places for z in places),
    camera=Camera((3.6, 3.0, 4.4), target=(0.0, -0.15, 0.0), fov_deg=38.0),
    lights=[
        DistantLight((-0.8, 0.75, 0.5), color="#ffe2bd", intensity=2.6, angle=0.03),
        HemisphereLight("#9dbbe0", "#30281f", intensity=0.5),
    ],
    background="#101a26",
    ambient_occlusion=0.0,
)
