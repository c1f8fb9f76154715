"""Refraction to play with: a ball of glass in a ring of pillars, by day.

Change the index of refraction from air's to diamond's, hollow the ball out to a bubble, tint the
glass. The first interactive page of the article "Raytracing and Raycasting with Signed Distance
Functions" (sdfray) showed such a scene.
"""

from distal import Box, OrbitCamera, Plane, Scene, Sky, Sphere, checker, glass, matte, time
from distal.lang import color, max, slider

ior = slider("Index of refraction", 1.5, low=1.0, high=2.4, help="Air 1, water 1.33, diamond 2.4.")
hollow = slider("Hollow", 0.0, high=0.95, help="Radius of the hole inside, as a share.")
tint = color("Tint", "#cfeee6", help="What white light becomes on one unit of way inside.")

SUN = (-0.5, 0.9, 0.6)

ball = Sphere(1.0) - Sphere(max(hollow, 0.001))
pillars = Box(0.6, 3.0, 0.6).translate(6.5, 0.5, 0.0).repeat_polar(11).paint(matte("#c9603f"))
floor = Plane(y=-1.0).paint(checker("#e8e4da", "#3c4a57", size=0.5))

scene = Scene(
    ball.paint(glass(ior=ior, color=tint)) | pillars | floor,
    lights=[Sky(SUN, ground=(0.8, 0.85, 0.9), intensity=0.5)],
    camera=OrbitCamera(5.0, azimuth=0.3 + 0.2 * time, elevation=0.2, fov_deg=38.0),
    fog=(0.4, 0.425, 0.45),
    fog_density=0.03,
    ambient_occlusion=0.4,
    bounces=8,
    tone_map="aces",
)
