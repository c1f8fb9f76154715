"""A nearly perfect mirror over a checkered floor under three lights: reflections of reflections.

The cut-up rounded cube of ``sdfray_rounded_csg`` with 5 % diffuse and 85 % specular reflection.
From the article "Raytracing and Raycasting with Signed Distance Functions" (sdfray).
"""

import math

from distal import Box, Camera, Cylinder, Material, Plane, PointLight, Scene, Sphere, checker, time
from distal.lang import slider

specular = slider("Specular", 0.85, high=0.95, help="Share of light that the body mirrors.")
turn = slider("Turn", 0.5, low=-3.14, high=3.14, help="The body turned about the upright axis.")

cut_y = Cylinder(radius=0.5, height=3.0)
cuts = cut_y | cut_y.rotate(z=math.pi / 2) | cut_y.rotate(x=math.pi / 2)
body = ((Box(2.0) & Sphere(1.2)) - cuts).rotate(y=turn + 0.2 * time)
floor = Plane(y=-1.0).paint(checker((0.05,) * 3, (0.95,) * 3))

scene = Scene(
    body.paint(Material(diffuse=0.05, specular=specular)) | floor,
    lights=[
        PointLight((2.0, 2.5, -2.0), intensity=50.0, color="#f00"),
        PointLight((-2.0, 2.5, 0.0), intensity=50.0, color="#0f0"),
        PointLight((2.0, 2.5, 2.0), intensity=50.0, color="#00f"),
    ],
    camera=Camera((0.0, 2.2, -9.7), target=(0.0, -0.1, 0.0), fov_deg=24.0, mirrored=True),
    background="#000",
    ambient_occlusion=0.0,
    exposure=0.5,
    tone_map="aces",
)
