"""A cube rounded by a sphere, and three cylinders cut out of it: constructive solid geometry.

From the article "Raytracing and Raycasting with Signed Distance Functions" (sdfray). There it is
seen from the front; here a camera orbits it, and two sliders change the parts.
"""

import math

from distal import (
    AmbientLight,
    Box,
    Cylinder,
    DistantLight,
    OrbitCamera,
    PointLight,
    Scene,
    Sphere,
    time,
)
from distal.lang import slider

rounding = slider("Sphere", 1.2, low=1.0, high=1.75, help="Radius of what rounds the cube.")
bore = slider("Bore", 0.5, low=0.1, high=0.8, help="Radius of the three holes.")

cut_y = Cylinder(radius=bore, height=3.0)
cut_x = cut_y.rotate(z=math.pi / 2)
cut_z = cut_y.rotate(x=math.pi / 2)
body = (Box(2.0) & Sphere(rounding)) - cut_x - cut_y - cut_z

scene = Scene(
    body,
    lights=[
        PointLight((2.0, 2.5, -2.0), intensity=10.0, color="#f00"),
        PointLight((-2.0, 2.5, 0.0), intensity=10.0, color="#0f0"),
        DistantLight((2.0, 2.5, 2.0), intensity=1.5, color="#00f"),
        AmbientLight(0.1),
    ],
    camera=OrbitCamera(
        10.0, azimuth=math.pi + 0.6 + 0.3 * time, elevation=0.45, fov_deg=20.0, mirrored=True
    ),
    background="#000",
    default_material=(0.8, 0.8, 0.8),
    ambient_occlusion=0.4,
    tone_map="none",
)
