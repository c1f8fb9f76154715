"""A lithophane, ready to print: a picture as the thickness of a plate, seen by the light behind it.

The picture is made here, as an array: ridges in the evening under a full moon. Where it is dark the
plate is thick. Sizes are millimetres. Try: the lamp, and how thick the darkest places are.
"""

import numpy as np

from distal import (
    Box,
    Camera,
    Heightfield,
    Material,
    Plane,
    RoundedRectangle,
    Scene,
    SpotLight,
    pattern,
    plastic,
)
from distal.lang import Texture2D, func, sample, slider, vec2, vec3

lamp = slider("Lamp", 1.0, low=0.0, high=2.0, help="The light behind the plate; 0: off.")
thick = slider("Thickest", 2.6, low=1.6, high=3.6, help="Thickness where it is black, in mm.")

THINNEST = 0.8  # millimetres: two or three layers of most printers
WIDTH, HEIGHT = 96.0, 72.0  # millimetres
ACROSS, DOWN = 192, 144  # texels


def evening() -> np.ndarray:
    """The picture: brightness from 0 to 1, (DOWN, ACROSS), upper row first."""
    x, y = np.meshgrid(np.linspace(-1.33, 1.33, ACROSS), np.linspace(1.0, -1.0, DOWN))
    light = 0.55 - 0.3 * y  # the sky, brighter at the horizon
    moon = np.hypot(x - 0.55, y - 0.5)
    light += 0.22 * np.exp(-5.0 * moon) + 0.5 / (1.0 + np.exp((moon - 0.2) / 0.012))
    for number, shade in enumerate((0.5, 0.34, 0.2, 0.06)):
        base, wild = 0.02 - 0.27 * number, 3.0 + 1.3 * number
        ridge = base + 0.16 * np.sin(wild * x + 2.1 * number) + 0.07 * np.sin(2.7 * wild * x)
        ridge += 0.03 * np.sin(7.9 * wild * x + number)
        above = 1.0 / (1.0 + np.exp(-(y - ridge) / 0.008))
        mist = shade + 0.25 * np.clip(ridge - y, 0.0, 0.5)  # brighter towards the valley
        light = above * light + (1.0 - above) * np.minimum(mist, 0.75)
    return np.clip(light, 0.02, 1.0)


picture = evening()
dark = np.repeat((1.0 - picture)[..., None], 3, axis=2).astype(np.float32)

# The relief lies on its back, its upper side at the smallest z, and is put upright.
relief = Heightfield(dark, size=(WIDTH, HEIGHT), height=thick - THINNEST)
plate = (relief & Box(WIDTH, 8.0, HEIGHT)) | Box(WIDTH, THINNEST, HEIGHT).translate(
    y=-0.5 * THINNEST
)
plate = plate.rotate(x=0.5 * np.pi)

frame = RoundedRectangle((WIDTH + 8.0, HEIGHT + 8.0), 4.0) - RoundedRectangle(
    (WIDTH - 2.0, HEIGHT - 2.0), 1.0
)
frame = frame.extrude(6.0).translate(z=0.8)
foot = Box(40.0, 3.0, 30.0).round(1.0).translate(y=-0.5 * HEIGHT - 4.0)

# Light that comes through is the picture, in the color of the lamp.
warm = picture[..., None] ** 2.0 * np.array((1.0, 0.7, 0.4, 1.0))
glow = Texture2D(warm.astype(np.float32))


@func
def through(p: vec3) -> vec3:
    """The light that comes through the plate."""
    return sample(glow, vec2(p.x / WIDTH + 0.5, p.y / HEIGHT + 0.5)).xyz * (1.6 * lamp)


lit = Material(color="#f2eee6", emission=pattern(through))

part = (plate | frame | foot).named("lithophane")
shown = plate.paint(lit) | (frame | foot).paint(plastic("#e9e4da", roughness=0.5))
table = Plane(y=-0.5 * HEIGHT - 6.0).paint("#54483c")

scene = Scene(
    shown | table,
    camera=Camera((58.0, 26.0, 150.0), target=(0.0, -2.0, 0.0), fov_deg=38.0),
    lights=[SpotLight((80.0, 120.0, 140.0), target=(0.0, 0.0, 0.0), color=(1e4, 1.05e4, 1.25e4))],
    background="#1b2029",
)
