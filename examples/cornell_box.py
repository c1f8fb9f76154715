"""A room with one lamp: all other light comes from wall to wall.

Mode "path" follows it: red and green walls color the blocks, and glass gathers light on the floor.
The lamp is a shape that emits light. Try: mode="direct", which knows no light between surfaces.
"""

from distal import Box, Camera, Scene, Sphere, emissive, glass, matte

white, red, green = matte((0.73, 0.73, 0.72)), matte((0.6, 0.06, 0.05)), matte((0.13, 0.43, 0.09))

floor = Box((2.0, 0.1, 2.0)).translate(y=-0.05).paint(white)
ceiling = Box((2.0, 0.1, 2.0)).translate(y=2.05).paint(white)
back = Box((2.0, 2.2, 0.1)).translate(y=1.0, z=-1.05).paint(white)
left = Box((0.1, 2.2, 2.1)).translate(x=-1.05, y=1.0, z=-0.05).paint(red)
right = Box((0.1, 2.2, 2.1)).translate(x=1.05, y=1.0, z=-0.05).paint(green)
lamp = Box((0.6, 0.02, 0.5)).translate(y=1.985).paint(emissive((1.0, 0.83, 0.6), 26.0))

tall = Box((0.58, 1.2, 0.58)).rotate(y=0.3).translate(-0.36, 0.6, -0.35).paint(white)
ball = Sphere(0.34).translate(0.42, 0.34, 0.3).paint(glass(1.5))

scene = Scene(
    floor | ceiling | back | left | right | lamp | tall | ball,
    lights=[],
    background=(0.0, 0.0, 0.0),
    camera=Camera((0.0, 1.0, 4.55), target=(0.0, 1.0, 0.0), fov_deg=32.0),
    mode="path",
    floor=False,
    tone_map="aces",
)
