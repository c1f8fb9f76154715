"""A flight around a Mandelbulb: over its ridges, down into a valley, and out again.

A fractal has detail at every size. What lies nearer than a third of a pixel is drawn as surface, so
the picture is calm from afar and from near. Try: power=3, more iterations, another pace.
"""

from distal import Camera, DistantLight, HemisphereLight, Mandelbulb, Material, Scene, pattern, time
from distal.lang import cos, func, length, mix, sin, slider, smoothstep, vec3

pace = slider("Pace", 0.15, low=0.0, high=0.6, help="Radians a second around the axis.")
fov = slider("Field of view", 62.0, low=20.0, high=90.0, help="Degrees.")


@func
def depths(p: vec3) -> vec3:
    """Colors from the bottom of the valleys to the highest ridges."""
    r = length(p)
    deep = mix(vec3(0.02, 0.05, 0.11), vec3(0.55, 0.09, 0.03), smoothstep(0.62, 0.86, r))
    high = mix(vec3(0.85, 0.42, 0.13), vec3(0.92, 0.88, 0.78), smoothstep(0.98, 1.14, r))
    return mix(deep, high, smoothstep(0.8, 1.05, r))


bulb = Mandelbulb(8, 5).paint(Material(pattern(depths), diffuse=0.8, specular=0.2, roughness=0.45))

# The path: an ellipse that is near the bulb twice, rising and falling; the eye looks ahead.
along = pace * time
far = 1.5 - 0.22 * cos(2.0 * along)
up = 0.35 + 0.5 * sin(1.3 * along)
ahead = along + 0.35
eye = (far * cos(along), up, far * sin(along))
target = (0.55 * cos(ahead), 0.45 * up, 0.55 * sin(ahead))

scene = Scene(
    bulb,
    lights=[
        DistantLight((0.7, 0.8, -0.4), intensity=2.1, color="#ffe9d0", angle=0.02),
        DistantLight((-0.8, 0.1, 0.6), intensity=0.5, color="#6f9fff", angle=0.1),
        HemisphereLight(sky="#5f7fb0", ground="#40240f", intensity=0.55),
    ],
    camera=Camera(eye, target=target, fov_deg=fov),
    background="#0b0f17",
    fog="#0b0f17",
    fog_density=0.12,
    ambient_occlusion=0.12,
    steps=400,
    tone_map="agx",
    exposure=1.25,
    floor=False,
)
