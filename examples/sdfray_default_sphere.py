"""A sphere under a red, a green and a blue light, and a little light from all around.

The first picture of the article "Raytracing and Raycasting with Signed Distance Functions"
(sdfray): two point lights and a distant one; the camera is 10 units away and its lens narrow.
"""

import math

from distal import AmbientLight, Camera, DistantLight, PointLight, Scene, Sphere
from distal.lang import slider

brightness = slider("Point lights", 10.0, high=30.0, help="Of the red and the green one.")
ambient = slider("Ambient", 0.1, high=0.5, help="Light from all around.")

scene = Scene(
    Sphere(),
    lights=[
        PointLight((2.0, 2.5, -2.0), intensity=brightness, color="#f00"),
        PointLight((-2.0, 2.5, 0.0), intensity=brightness, color="#0f0"),
        DistantLight((2.0, 2.5, 2.0), intensity=1.5, color="#00f"),
        AmbientLight(ambient),
    ],
    camera=Camera.yaw_pitch_roll(
        (0.0, 0.0, -10.0), yaw=math.pi, screen_height=0.05, screen_distance=0.1, mirrored=True
    ),
    background="#000",
    default_material=(0.8, 0.8, 0.8),
    ambient_occlusion=0.0,
    tone_map="none",
)
