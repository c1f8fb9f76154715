"""A dark room, and light that falls through its open door: soft shadows and dark corners.

One wide sun makes the beam. There is a little light from all around; ambient occlusion darkens it
in the corners. Try: the door's opening, and the sun's width.
"""

from distal import (
    Box,
    Camera,
    Cylinder,
    DistantLight,
    HemisphereLight,
    Scene,
    Sphere,
    glossy,
    matte,
    noise,
    plastic,
    stripes,
)
from distal.lang import slider

ajar = slider("Door", 1.4, low=0.1, high=1.5, help="How far the door is open, in radians.")
width = slider("Sun", 0.035, low=0.005, high=0.2, help="How wide the sun looks, in radians.")

# The room is 6 wide, 3 high and 7 deep; the door is in the wall at z = -3.5.
WALL = matte("#d8cfc0")
OAK = noise("#a9773f", "#8b5d30", size=0.5)
shell = Box((7.0, 4.0, 8.0)) - Box((6.0, 3.0, 7.0))
opening = Box((1.1, 2.2, 2.0)).translate(0.6, -0.4, -3.6)
room = (shell - opening).paint(WALL)
boards = Box((6.0, 0.04, 7.0)).translate(y=-1.49)
boards = boards.paint(
    stripes(OAK, noise("#94673a", "#7a5029", size=0.4), size=0.24, direction=(1.0, 0.0, 0.0))
)

frame = Box((1.34, 2.32, 0.3)) - Box((1.1, 2.4, 1.0)).translate(y=-0.12)
frame = frame.translate(0.6, -0.34, -3.55).paint("#f1eade")
# The door turns about its hinge at the opening's left side.
panel = Box((1.08, 2.18, 0.06)) - Box((0.7, 0.7, 0.03)).array(
    start=(0.0, -0.5, 0.03), end=(0.0, 0.5, 0.03), count=2
)
knob = Sphere(0.05).translate(0.42, -0.05, 0.08).paint(glossy("#caa24a", 0.4, 0.6, 0.25))
door = (panel.paint("#8d4a38") | knob).translate(x=0.54).rotate(y=-ajar)
door = door.translate(0.05, -0.4, -3.46)

seat = Box((0.7, 0.06, 0.7)).round(0.02).translate(y=0.0)
legs = Cylinder(0.035, 0.75).translate(0.28, -0.4, 0.28).symmetry("xz")
back = Box((0.7, 0.8, 0.05)).round(0.015).translate(0.0, 0.45, -0.33)
chair = (seat | legs | back).paint("#b98a4e").rotate(y=-2.5).translate(1.75, -0.73, -0.6)
ball = Sphere(0.28).translate(0.75, -1.19, 0.35).paint(plastic("#c8382e", roughness=0.15))
frame_on_wall = Box((0.06, 1.1, 1.5)).translate(-2.98, 0.2, -1.2).paint("#2a2420")
picture = Box((0.03, 0.9, 1.3)).translate(-2.94, 0.2, -1.2)
picture = picture.paint(noise("#33576b", "#d9b26a", size=0.6))

scene = Scene(
    room | boards | frame | door | chair | ball | frame_on_wall | picture,
    lights=[
        DistantLight((-0.18, 0.36, -1.0), intensity=6.0, color="#ffdcae", angle=width),
        HemisphereLight(sky=(0.5, 0.6, 0.8), ground=(1.0, 0.85, 0.7), intensity=0.22),
    ],
    camera=Camera((-1.5, 0.25, 3.2), target=(0.5, -0.65, -1.2), fov_deg=52.0),
    background=(1.6, 1.5, 1.3),
    ambient_occlusion=0.9,
    steps=400,
    exposure=1.2,
    tone_map="aces",
)
