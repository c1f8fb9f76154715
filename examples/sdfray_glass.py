"""Clear shapes turn over a checker while the camera orbits: a glass box, cylinder and ball.

5 % diffuse, 10 % specular, 85 % transmitted, index of refraction 1.4. Direct lighting knows no
caustics: clear shapes cast shadows here as if they were solid. Ported from the film in the article
"Raytracing and Raycasting with Signed Distance Functions" (sdfray); an orbit takes 2 pi seconds.
"""

import numpy as np

from distal import Box, Camera, Cylinder, Material, Plane, PointLight, Scene, Sphere, checker, time
from distal.lang import slider

ior = slider("Index of refraction", 1.4, low=1.0, high=2.4)
height = slider("Camera height", 1.2, low=0.0, high=5.0)

clear = Material(diffuse=0.05, specular=0.1, transmission=0.85, ior=ior)
ball = Sphere(0.75)
box = Box(1.5).rotate(y=3.0 * time, z=2.0 * time).translate(x=-2.0)
cylinder = Cylinder(radius=0.75, height=1.5).rotate(y=3.0 * time, z=time).translate(x=2.0)
floor = Plane(y=-1.0).paint(checker((0.95,) * 3, (0.05,) * 3, size=0.25))

scene = Scene(
    (ball | box | cylinder).paint(clear) | floor,
    lights=[
        PointLight((2.0, 2.5, -2.0), intensity=50.0, color="#f00"),
        PointLight((-2.0, 2.5, 0.0), intensity=50.0, color="#0f0"),
        PointLight((2.0, 2.5, 2.0), intensity=50.0, color="#00f"),
    ],
    camera=Camera(
        (10.0 * np.sin(time), height, -10.0 * np.cos(time)),
        target=(0.0, -0.1, 0.0),
        fov_deg=28.0,
        mirrored=True,
    ),
    background="#000",
    ambient_occlusion=0.0,
    bounces=8,
    exposure=0.6,
    tone_map="aces",
)
