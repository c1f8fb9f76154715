"""A box that scatters, a glass ball and a cylinder that mirrors, in a row on a fine checker.

Three materials with the same three weights: diffuse, specular, transmission. From the article
"Raytracing and Raycasting with Signed Distance Functions" (sdfray), seen from a little higher.
"""

from distal import Box, Camera, Cylinder, Material, Plane, PointLight, Scene, Sphere, checker
from distal.lang import slider

transmission = slider("Transmission", 0.9, high=0.9, help="Share of light that the ball lets in.")
ior = slider("Index of refraction", 1.4, low=1.0, high=2.4, help="Of the ball.")
height = slider("Camera height", 1.4, low=0.0, high=5.0)

box = Box(1.4).translate(-1.5, -0.2, 0.0)
ball = Sphere(0.7).translate(0.0, -0.2, 0.0)
cylinder = Cylinder(radius=0.7, height=1.4).translate(1.5, -0.2, 0.0)
floor = Plane(y=-1.0)

scene = Scene(
    [
        box.paint(Material(diffuse=0.9, specular=0.1)),
        ball.paint(Material(diffuse=0.05, specular=0.05, transmission=transmission, ior=ior)),
        cylinder.paint(Material(diffuse=0.1, specular=0.9)),
        floor.paint(checker((0.95,) * 3, (0.05,) * 3, size=0.25)),
    ],
    lights=[
        PointLight((2.0, 2.5, -2.0), intensity=25.0, color="#f00"),
        PointLight((-2.0, 2.5, 0.0), intensity=25.0, color="#0f0"),
        PointLight((2.0, 2.5, 2.0), intensity=25.0, color="#00f"),
    ],
    camera=Camera((0.0, height, -10.0), target=(0.0, -0.2, 0.0), fov_deg=24.0, mirrored=True),
    background="#000",
    ambient_occlusion=0.0,
    exposure=0.8,
    tone_map="aces",
)
