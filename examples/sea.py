"""Sunset on the sea: rays take long steps over the waves, then search for the surface in between.

``--view steps`` shows the cost of each pixel: ``sea_sphere_tracing`` evaluates the waves several
times as often for the same picture. After "Sunset on the sea" of a graphics blog.
"""

from typing import Any

from distal import Background, Camera, DistantLight, HemisphereLight, Material, Scene, Shape, time
from distal.lang import (
    cos,
    dot,
    exp,
    func,
    max,
    mix,
    normalize,
    sin,
    slider,
    smoothstep,
    sqrt,
    vec2,
    vec3,
)

swell = slider("Swell", 0.5, low=0.1, high=1.0, help="How high the waves are.")
sun_height = slider("Sun height", 0.09, low=0.03, high=0.4, help="How high the sun stands.")

WAVES = 9
LONGEST, HIGHEST = 0.9, 0.3  # wave number and amplitude of the first wave
SHORTER, FLATTER = 1.42, 0.62  # from a wave to the next
SPREAD = 1.1  # how far waves turn from the wind, in radians
GRAVITY = 2.5

# Upper bounds of sums of waves. A wave is exp(sin(x) - 1), 0.135 to 1, 0.466 on average, and its
# derivative at most 0.537.
AMPLITUDES = HIGHEST * (1.0 - FLATTER**WAVES) / (1.0 - FLATTER)
CREST, TROUGH = 0.534 * AMPLITUDES, -0.331 * AMPLITUDES
SHRINKING = SHORTER * FLATTER
STEEPEST = 0.537 * HIGHEST * LONGEST * (1.0 - SHRINKING**WAVES) / (1.0 - SHRINKING)

SUN = (-0.12, sun_height, -1.0)
EYE, TARGET, FOV, FAR = (0.0, 2.4, 8.0), (0.0, 1.85, 0.0), 0.7, 400.0
ENDLESS = 1e18


@func
def height(at: vec2, swell: float, time: float) -> float:
    """Crests are sharp and troughs wide; short waves run slower, as in deep water."""
    total = 0.0
    number = LONGEST
    amplitude = HIGHEST * swell
    for i in range(WAVES):
        angle = 0.5 + SPREAD * sin(2.4 * float(i))
        along = dot(vec2(sin(angle), cos(angle)), at)
        phase = number * along + sqrt(GRAVITY * number) * time + 3.7 * float(i)
        total += amplitude * (exp(sin(phase) - 1.0) - 0.466)
        number *= SHORTER
        amplitude *= FLATTER
    return total


@func
def water(p: vec3, swell: float, time: float) -> float:
    return p.y - height(p.xz, swell, time)


@func
def sky(direction: vec3, sun: vec3) -> vec3:
    """Fire along the horizon, blue above, the sun and its glow."""
    up = max(direction.y, 0.0)
    facing = max(dot(direction, normalize(sun)), 0.0)
    air = mix(vec3(0.95, 0.36, 0.12), vec3(0.34, 0.27, 0.42), smoothstep(0.0, 0.25, up))
    air = mix(air, vec3(0.07, 0.14, 0.36), smoothstep(0.12, 0.8, up))
    glow = vec3(0.9, 0.36, 0.1) * facing**14.0 + vec3(1.0, 0.65, 0.25) * facing**220.0
    disc = smoothstep(0.99935, 0.9996, facing)
    return air * (0.35 + 0.45 * facing) + 0.7 * glow + vec3(12.0, 7.5, 3.0) * disc


def sea(**march: Any) -> Scene:
    """The sea by one march or another."""
    waves = Shape.from_function(
        water,
        slope=sqrt(1.0 + (STEEPEST * swell) ** 2),
        bounds=((-ENDLESS, TROUGH * swell, -ENDLESS), (ENDLESS, CREST * swell, ENDLESS)),
        swell=swell,
        time=time,
    )
    brine = Material("#12525c", diffuse=0.4, specular=0.6, ior=1.33, fresnel=1.0)
    return Scene(
        waves.paint(brine).named("sea"),
        lights=[
            HemisphereLight(sky="#c0705a", ground="#101820"),
            DistantLight(SUN, intensity=1.5, color="#ff9a50", angle=0.03),
        ],
        camera=Camera(EYE, target=TARGET, fov=FOV),
        background=Background(sky, sun=SUN),
        fog="#d98348",
        fog_density=0.006,
        shadows=False,
        ambient_occlusion=0.0,
        bounces=4,
        tone_map="aces",
        far=FAR,
        **march,
    )


scene = sea(march="heightfield", normals="forward", steps=128)
