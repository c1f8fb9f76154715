"""A box for electronics, ready to print: shell, posts for screws, vents, and a lid with a label.

Everything follows from a few sizes. Try: the wall, the posts, and how far the lid is open.
"""

from distal import (
    Box,
    Camera,
    Circle,
    Cylinder,
    Plane,
    Ring,
    RoundBox,
    RoundedCylinder,
    RoundedRectangle,
    Scene,
    brass,
)
from distal.lang import slider

wall = slider("Wall", 0.08, low=0.04, high=0.16)
post = slider("Post", 0.14, low=0.11, high=0.2, help="Radius of the posts for the screws.")
opened = slider("Open", 0.55, low=0.0, high=1.2, help="How high the lid floats above the box.")

WIDTH, HEIGHT, DEPTH = 2.4, 0.9, 1.6
QUARTER = 1.5707963

body = RoundBox((WIDTH, HEIGHT, DEPTH), 0.18)
room = RoundBox((WIDTH - 2.0 * wall, HEIGHT - 2.0 * wall, DEPTH - 2.0 * wall), 0.1)
below = Box(3.0, 1.0, 3.0).translate(y=-0.2)

# The base: a shell without its upper part, four posts, vents in front, an opening for the cable.
posts = (Cylinder(post, HEIGHT) - Cylinder(0.06, 1.0)).translate(0.93, 0.0, 0.53).symmetry("xz")
vents = Box(0.05, 0.3, 0.4).repeat(0.14, 1.0, 1.0, count=(9, 1, 1)).translate(0.0, -0.05, 0.8)
plug = RoundedRectangle((0.5, 0.26), 0.08).extrude(0.6).rotate(y=QUARTER).translate(x=-1.2)
base = ((body - room) | (posts & body)) & below

# The lid: the upper part of the same body, with countersunk holes above the posts.
hole = Cylinder(0.07, 1.0) | Cylinder(0.13, 0.1).translate(y=0.46)
lid = (body - below) - hole.translate(0.93, 0.0, 0.53).symmetry("xz")

# The label stands on the lid: a sender and its waves.
waves = (
    Circle(0.06)
    | Ring(0.2, thickness=0.06, opening=1.6)
    | Ring(0.34, thickness=0.06, opening=1.6)
    | Ring(0.48, thickness=0.06, opening=1.6)
)
label = waves.extrude(0.03).rotate(x=-QUARTER)
label = label.on(body, gap=-0.005)

screw = (RoundedCylinder(0.11, 0.07, 0.02) | Cylinder(0.05, 0.4).translate(y=-0.2)) - Box(
    0.2, 0.06, 0.03
).translate(y=0.04)
screws = screw.translate(0.93, 0.0, 0.53).symmetry("xz")

case = (
    (base - vents - plug).paint("#31465c")
    | (lid.paint("#e8e2d4") | label.paint("#c8553d")).translate(y=opened)
    | screws.translate(y=0.42 + 1.7 * opened).paint(brass())
)

scene = Scene(
    case.named("enclosure") | Plane(y=-0.45).paint("#bdb6aa"),
    camera=Camera((3.0, 2.9, 5.0), target=(0.0, 0.3, 0.0), fov_deg=33.0),
)
