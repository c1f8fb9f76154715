"""Four more primitives, and the four effects that a second march gives."""

from distal import (
    Camera,
    Capsule,
    Cone,
    Cylinder,
    DistantLight,
    HemisphereLight,
    Material,
    Plane,
    Scene,
    Torus,
    checker,
)
from distal.lang import slider

gloss = slider("Specular", 0.35, low=0.0, high=0.7, help="How much each body mirrors.")
width = slider("Shadow softness", 0.1, low=0.0, high=0.6, help="How large the sun looks.")
fill = slider("Sky light", 0.5, low=0.0, high=1.5, help="Light from everywhere.")
lean = slider("Lean", 0.5, low=0.0, high=1.5, help="How far the ring leans, in radians.")


def painted(color: str) -> Material:
    """A glossy paint; the sliders move its two shares."""
    return Material(color, diffuse=0.9 - gloss, specular=gloss, roughness=0.0)


cylinder = Cylinder(radius=0.5, height=1.0).translate(x=-2.1, y=0.5).paint(painted("#d8553d"))
ring = Torus(0.5, 0.18).rotate(x=lean).translate(x=-0.7, y=0.55).paint(painted("#e2a63b"))
cone = Cone(radius=0.55, height=1.2).translate(x=0.75, y=0.6).paint(painted("#3f9d6a"))
pill = Capsule(radius=0.32, length=0.7).translate(x=2.1, y=0.67).paint(painted("#4471c9"))
floor = Plane(y=0.0).paint(checker("#c9c4bb", "#8d8a86", size=0.7))

scene = Scene(
    cylinder | ring | cone | pill | floor,
    lights=[
        DistantLight((-0.5, 0.8, 0.6), intensity=2.0, angle=width),
        HemisphereLight(sky="#bcd2ff", ground="#6f6253", intensity=fill),
    ],
    camera=Camera((0.0, 2.3, 6.0), target=(0.0, 0.45, 0.0), fov_deg=38.0),
    background="#a9c3e6",
    bounces=2,
)
