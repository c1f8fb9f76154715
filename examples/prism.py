"""A prism spreads a beam of sunlight into its colors.

Each path through the glass has one wavelength, whose index of refraction bends it; photons carry
the colors to the table. Try: the dispersion, which is 20 divided by Abbe's number; glass has .3 to
.8, more makes a wider rainbow.
"""

import math

from distal import (
    Box,
    Camera,
    DistantLight,
    HemisphereLight,
    Plane,
    RegularPolygon,
    Scene,
    glass,
    matte,
)
from distal.lang import slider

dispersion = slider("Dispersion", 2.0, low=0.0, high=2.5)
turn = slider("Turn of the prism", -0.4, low=-1.0, high=1.0)

prism = RegularPolygon(0.42, 3).extrude(1.0).rotate(x=-math.pi / 2).rotate(y=turn)
prism = prism.translate(-0.2, 0.5, 0.0).paint(glass(1.6, dispersion=dispersion))

wall = Box((0.12, 1.6, 12.0)).translate(-2.2, 0.8, 0.0)
slit = Box((1.0, 3.0, 0.04)).translate(-2.2, 1.0, 0.0)

scene = Scene(
    prism | (wall - slit).paint(matte("#3a3f45")) | Plane().paint(matte("#e8e4dc")),
    lights=[
        DistantLight((-1.0, 0.24, 0.0), intensity=30.0, angle=0.004),
        HemisphereLight((0.55, 0.62, 0.75), (0.5, 0.45, 0.4), 0.25),
    ],
    background=(0.05, 0.055, 0.065),
    camera=Camera((1.1, 3.6, 4.2), target=(0.4, 0.1, 0.6), fov_deg=40.0),
    mode="path",
    floor=False,
    tone_map="aces",
)
