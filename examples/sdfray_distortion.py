"""Distortions to play with: a rounded box tapered, twisted and covered with running waves.

Each slider distorts space or the distance itself; the scene's own bounds on how steep the field
gets keep the march safe. The second interactive page of the article "Raytracing and Raycasting with
Signed Distance Functions" (sdfray) showed what such distortions can do.
"""

from distal import (
    DistantLight,
    HemisphereLight,
    Material,
    OrbitCamera,
    Plane,
    RoundBox,
    Scene,
    Shape,
    checker,
    time,
)
from distal.lang import func, sin, slider, vec3

twist = slider("Twist", 1.0, low=-1.5, high=1.5, help="Radians for each unit of height.")
taper = slider("Taper", 0.7, low=0.5, high=1.3, help="Width at the top against that below.")
waves = slider("Waves", 0.03, high=0.06, help="How high the waves on the surface are.")

RIPPLES = 8.0  # radians for each unit; also the bound on the slope of a product of three sines


@func
def ripple(p: vec3, phase: float) -> float:
    """Waves of height 1 that run upwards."""
    return sin(RIPPLES * p.x) * sin(RIPPLES * p.y - phase) * sin(RIPPLES * p.z)


column = RoundBox((1.3, 2.4, 1.3), rounding=0.2).taper(-1.2, 1.2, taper).twist(twist)
field = Shape.from_function(ripple, slope=RIPPLES, phase=2.0 * time)
floor = Plane(y=-1.3).paint(checker("#d9d4c8", "#46525e", size=0.75))

scene = Scene(
    column.displace(field, waves).paint(Material("#d2552a", diffuse=0.85, specular=0.1)) | floor,
    lights=[
        DistantLight((-0.6, 1.0, 0.8), intensity=0.85, color="#fff1dd", angle=0.06),
        HemisphereLight(sky=(0.6, 0.72, 0.9), ground=(0.35, 0.3, 0.26), intensity=0.55),
    ],
    camera=OrbitCamera(7.0, azimuth=0.5 + 0.25 * time, elevation=0.3, fov_deg=30.0),
    background=(0.42, 0.47, 0.55),
    fog=(0.42, 0.47, 0.55),
    fog_density=0.03,
    ambient_occlusion=0.4,
    steps=400,
    tone_map="aces",
    exposure=1.15,
)
