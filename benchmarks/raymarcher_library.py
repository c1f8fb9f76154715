"""The picture of ``raymarcher_objects``, written as a shader that calls the library's functions.

It writes out what a scene object does by itself: the distance to the shapes, their materials, the
lights, how far rays go, and how linear light is encoded for a display.
"""

from distal.fields.combine.smooth import cubic
from distal.fields.guarantees import UNBOUNDED, Bounds
from distal.fields.place.solid import rotated_y, translated
from distal.fields.solids.rings import torus
from distal.fields.solids.round import sphere
from distal.fields.solids.surfaces import plane
from distal.lang import (
    Frame,
    atan,
    clamp,
    cos,
    dot,
    func,
    image,
    max,
    min,
    mix,
    normalize,
    sin,
    slider,
    vec2,
    vec3,
    vec4,
)
from distal.render.ambient import hemisphere_light
from distal.render.bounce import seen_plain
from distal.render.camera import Ray, look_at
from distal.render.footprint import Footprint, pixel_cone
from distal.render.lights import LightSample, distant_light
from distal.render.material import Surface, matte
from distal.render.patterns import checker, linear_gradient
from distal.render.settings import hit_threshold, march_numbers
from distal.render.shade import Shading, ambient_occlusion
from distal.render.shadows import shadow_beside_planes
from distal.render.tonemap import ACES, decode_srgb, display
from distal.render.trace import plane_crossing, segment_or_plane

softness = slider("Softness", 0.05, high=0.2, help="How far sphere and torus melt.")

SUN = vec3(-0.4, 0.8, -0.5)
FOG = vec3(0.52, 0.455, 0.515)
DARK = vec3(77.0, 87.0, 97.0) / 255.0
LIGHT = vec3(242.0, 235.0, 217.0) / 255.0
EVERYWHERE = vec3(UNBOUNDED)


@func
def blob(p: vec3, time: float) -> float:
    """A sphere that bobs and a torus that orbits, melting where they meet."""
    ball = sphere(translated(p, vec3(0.0, 0.2 * sin(1.5 * time), 0.0)), 0.55)
    ring = torus(translated(rotated_y(p, 0.8 * time), vec3(1.0, 0.0, 0.0)), 0.32, 0.12)
    return cubic(ball, ring, softness)


@func
def floor(p: vec3) -> float:
    """The floor."""
    return plane(p, -0.5)


@func
def scene(p: vec3, time: float) -> float:
    """Both shapes and the floor."""
    return min(blob(p, time), floor(p))


@func
def blob_color(p: vec3, time: float) -> vec3:
    """A color that changes with time, a little darker below."""
    phase = 0.6 * time
    top = (vec3(0.6, 0.45, 0.4) + 0.4 * cos(vec3(phase, phase + 0.8, phase + 1.6))) ** 2.2
    share = linear_gradient(p, vec3(0.0, -0.5, 0.0), vec3(0.0, 0.5, 0.0))
    return mix(0.7 * top, top, share)


@func
def material(p: vec3, sides: Footprint, time: float) -> Surface:
    """The material at a point on the surface."""
    if floor(p) < blob(p, time):
        return matte(mix(decode_srgb(DARK), decode_srgb(LIGHT), checker(p, 1.0, sides)))
    return matte(blob_color(p, time))


@func
def sun(p: vec3) -> LightSample:
    """A sun so wide that the edge of a shadow blurs by 1/32 of the distance to its caster."""
    return distant_light(p, SUN, 0.85, vec3(1.0), 2.0 * atan(1.0 / 32.0))


@func
def sky(direction: vec3) -> vec3:
    """Warm below, blue above, and a glow around the sun."""
    height = clamp(0.5 * direction.y + 0.5, 0.0, 1.0)
    air = mix(vec3(0.87, 0.57, 0.34), vec3(0.17, 0.34, 0.69), height)
    return air + vec3(1.0, 0.69, 0.32) * max(dot(direction, normalize(SUN)), 0.0) ** 64.0


@func
def camera(uv: vec2, time: float) -> Ray:
    """A camera that circles the origin."""
    angle = 0.4 * time
    eye = vec3(3.0 * cos(angle), 0.8 + 0.2 * sin(0.3 * time), 3.0 * sin(angle))
    fov = 2.0 * atan(1.0 / 1.6)
    return look_at(uv, eye, vec3(0.0), vec3(0.0, 1.0, 0.0), fov=fov, mirrored=True)


@image
def picture(frame: Frame) -> vec4:
    """The picture."""
    time = frame.time
    uv = (2.0 * frame.coord - frame.resolution) / frame.resolution.y
    bounds = Bounds(-EVERYWHERE, EVERYWHERE)
    threshold = hit_threshold(frame.resolution, bounds, lambda at: camera(at, time))
    numbers = march_numbers(1.0, 0.001, 60.0, threshold)
    seen = seen_plain(
        camera(uv, time),
        lambda ray: segment_or_plane(
            lambda p: blob(p, time),
            floor,
            lambda ray: plane_crossing(floor, ray),
            ray,
            0.0,
            0.0,
            bounds,
            numbers,
            60.0,
            160,
        ),
        lambda p, part: scene(p, time),
        lambda p, sides, part: material(p, sides, time),
        lambda p, n, slope: ambient_occlusion(lambda q: scene(q, time), p, n, 0.4, slope),
        lambda i, p: sun(p),
        lambda n: hemisphere_light(n, vec3(0.5), vec3(0.25), 1.0),
        sky,
        lambda direction: FOG,
        lambda origin, light, i, n: shadow_beside_planes(
            lambda p: blob(p, time), floor, origin, light, bounds, numbers, 320, False, i, n
        ),
        numbers,
        Shading(0.4, 0.06),
        light_count=1,
        cone=pixel_cone(lambda at: camera(at, time), uv, 2.0 / frame.resolution.y),
    )
    return display(vec4(seen.xyz, 1.0), 1.0, ACES)
