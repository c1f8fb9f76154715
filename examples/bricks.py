"""A lighthouse built of toy bricks: any shape, cut into layers of bricks by a loop.

Every brick is a shape that is moved and painted, and the model is the union of the list. Try: other
shapes in ``MODEL``, and a finer ``GRID``.
"""

import numpy as np

from distal import (
    Box,
    Camera,
    CappedCone,
    Cone,
    Cylinder,
    DistantLight,
    Ellipsoid,
    Plane,
    RoundBox,
    Scene,
    Sky,
    plastic,
    union,
)

GRID = 36  # studs along each side
LAYERS = 34
TALL = 1.2  # the height of a brick; studs are 1 apart

tower = CappedCone(height=22.0, bottom=4.3, top=2.7).translate(-4.5, 17.0, -3.0)
bands = Box(20.0, 4.8, 20.0).translate(y=11.0).repeat(0.0, 9.6, 0.0, count=(1, 2, 1))
trees = Cone(2.2, 6.5).translate(0.0, 8.4, 0.0)
trees = trees.array([(8.5, 1.2, -6.5), (3.0, 2.4, -9.5), (-10.5, 0.0, 5.5)])

# What is built, in units of studs: the first shape around a place gives its color.
MODEL = {
    "#c4281b": Cone(3.9, 5.4).translate(-4.5, 36.0, -3.0)
    | (tower & bands.translate(y=4.0))
    | Box(7.6, 2.4, 6.4).translate(7.5, 11.4, 4.0),  # a roof
    "#f5c842": Cylinder(2.2, 4.8).translate(-4.5, 31.2, -3.0),  # the lamp
    "#2b2f36": Cylinder(3.9, 1.2).translate(-4.5, 28.2, -3.0),
    "#f4f4f0": tower,
    "#b98a55": Box(6.0, 4.8, 5.0).translate(7.5, 8.0, 4.0),  # a cottage
    "#1f6b35": trees,
    "#5aa845": Ellipsoid((14.2, 6.4, 12.0)).translate(0.0, 0.8, -0.5),
    "#8d9196": Ellipsoid((16.2, 4.0, 14.2)).translate(0.3, 0.2, 0.2),
    "#2d6fc4": Box(90.0, 1.2, 90.0).translate(0.0, 0.6, 0.0),  # the sea
}
SIZES = ((4, 2), (2, 4), (2, 2), (3, 1), (1, 3), (2, 1), (1, 2), (1, 1))


def brick(along, across):
    """A brick with its studs; its lower corner is at the origin."""
    body = RoundBox((along - 0.03, TALL - 0.03, across - 0.03), 0.05)
    stud = Cylinder(0.3, 0.44).repeat(1.0, 0.0, 1.0, count=(along, 1, across))
    stud = stud.translate(y=0.5 * TALL)
    return (body | stud).translate(0.5 * along, 0.5 * TALL, 0.5 * across)


BRICKS = {size: brick(*size) for size in SIZES}


def colors_of_cells():
    """The color of each cell of the grid, as its number in ``MODEL``; -1 where nothing is."""
    steps = np.arange(GRID) + 0.5 - 0.5 * GRID
    y = (np.arange(LAYERS) + 0.5) * TALL
    cells = np.stack(np.meshgrid(steps, y, steps, indexing="ij"), axis=-1)
    found = np.full(cells.shape[:3], -1)
    for number, shape in reversed([*enumerate(MODEL.values())]):
        found[shape(cells) < 0.0] = number
    return found


def built(cells):
    """Bricks that fill the cells, each as large as fits; layers are laid across each other."""
    parts = []
    paints = [plastic(color, 0.2) for color in MODEL]
    for layer in range(LAYERS):
        free = cells[:, layer].copy()
        sizes = SIZES if layer % 2 else [(b, a) for a, b in SIZES]
        for x, z in np.ndindex(GRID, GRID):
            for along, across in sizes if free[x, z] >= 0 else ():
                block = free[x : x + along, z : z + across]
                if block.shape == (along, across) and (block == free[x, z]).all():
                    place = (x - 0.5 * GRID, layer * TALL, z - 0.5 * GRID)
                    color = paints[free[x, z]]
                    parts.append(BRICKS[along, across].translate(place).paint(color))
                    block[:] = -1
                    break
    return parts


bricks = built(colors_of_cells())

scene = Scene(
    union(bricks).named("lighthouse") | Plane().paint("#d8d2c6"),
    lights=[DistantLight((-0.7, 1.0, 0.8), intensity=1.9, color="#fff1dc", angle=0.06)],
    camera=Camera((42.0, 44.0, 66.0), target=(-0.5, 14.5, 0.0), fov_deg=34.0),
    background=Sky(sun_intensity=0.0, light=True, intensity=0.9),
    ambient_occlusion=0.5,
    tone_map="aces",
)
