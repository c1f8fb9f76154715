"""The scene of ``raymarcher``, made of objects: a sphere and an orbiting torus melt together.

The same shapes, places, sun and camera as ``raymarcher``, and its colors, read as sRGB: light is
linear here. Marching, shadows, shading and fog are the library's.
Ported from the daslang tutorial "Signed-Distance-Field Raymarcher".
"""

import math

from distal import (
    Background,
    Camera,
    DistantLight,
    HemisphereLight,
    Plane,
    Scene,
    Sphere,
    Torus,
    checker,
    linear_gradient,
    time,
)
from distal.lang import clamp, cos, dot, func, max, mix, normalize, sin, slider, vec3

softness = slider("Softness", 0.05, high=0.2, help="How far sphere and torus melt.")

SUN = (-0.4, 0.8, -0.5)
WARM = vec3(0.87, 0.57, 0.34)
BLUE = vec3(0.17, 0.34, 0.69)
GLOW = vec3(1.0, 0.69, 0.32)


@func
def sky(direction: vec3, sun: vec3) -> vec3:
    """Warm below, blue above, and a glow around the sun."""
    height = clamp(0.5 * direction.y + 0.5, 0.0, 1.0)
    air = mix(WARM, BLUE, height)
    return air + GLOW * max(dot(direction, normalize(sun)), 0.0) ** 64.0


palette = tuple(
    (middle + 0.4 * cos(0.6 * time + phase)) ** 2.2
    for middle, phase in ((0.6, 0.0), (0.45, 0.8), (0.4, 1.6))
)
shaded = tuple(0.7 * channel for channel in palette)

sphere = Sphere(0.55).translate(y=0.2 * sin(1.5 * time))
torus = Torus(0.32, 0.12).translate(x=1.0).rotate(y=0.8 * time)
blob = sphere.union(torus, smooth=softness, blend="cubic")
floor = Plane(y=-0.5).paint(checker("#4d5761", "#f2ebd9"))

scene = Scene(
    blob.paint(linear_gradient(shaded, palette, start=(0, -0.5, 0), end=(0, 0.5, 0))) | floor,
    lights=[
        DistantLight(SUN, intensity=0.85, angle=2 * math.atan(1 / 32)),
        HemisphereLight(sky=(0.5,) * 3, ground=(0.25,) * 3, intensity=1.0),
    ],
    camera=Camera(
        (3.0 * cos(0.4 * time), 0.8 + 0.2 * sin(0.3 * time), 3.0 * sin(0.4 * time)),
        target=(0, 0, 0),
        fov=2 * math.atan(1 / 1.6),
        mirrored=True,
    ),
    background=Background(sky, sun=SUN),
    fog=(0.52, 0.455, 0.515),
    fog_density=0.06,
    ambient_occlusion=0.4,
    tone_map="aces",
    far=60.0,
)
