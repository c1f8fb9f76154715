"""A sphere and a cube that melt into one: the blend is a slider, and so are the march's steps.

Try: steps at 16 (halos at the edges, where the march gave up), blend at 0 (a hard seam) and
above 0.7 (one lump). Ported from the lesson "Raymarching with SDFs".
"""

from distal.lang import (
    Frame,
    abs,
    clamp,
    dot,
    func,
    image,
    integer,
    length,
    max,
    min,
    mix,
    normalize,
    slider,
    vec2,
    vec3,
)

blend = slider("Blend softness", 0.3, low=0.0, high=1.0, help="How far the two shapes melt.")
steps = integer("Max steps", 64, low=1, high=96, help="How often a ray steps before it gives up.")

FAR = 12.0
SKY = vec3(0.07, 0.06, 0.10)


@func
def sd_sphere(p: vec3, radius: float) -> float:
    return length(p) - radius


@func
def sd_box(p: vec3, half: vec3) -> float:
    q = abs(p) - half
    return length(max(q, 0.0)) + min(max(q.x, max(q.y, q.z)), 0.0)


@func
def smooth_union(a: float, b: float, k: float) -> float:
    """Quadratic smooth minimum; k = 0 is the hard minimum."""
    h = clamp(0.5 + 0.5 * (b - a) / max(k, 0.0001), 0.0, 1.0)
    return mix(b, a, h) - k * h * (1.0 - h)


@func
def scene(p: vec3) -> float:
    sphere = sd_sphere(p - vec3(-0.55, 0.0, 0.0), 0.8)
    cube = sd_box(p - vec3(0.55, 0.0, 0.0), vec3(0.6))
    return smooth_union(sphere, cube, blend)


@func
def surface_normal(p: vec3) -> vec3:
    """Central differences: six evaluations."""
    e = vec2(0.001, 0.0)
    return normalize(
        vec3(
            scene(p + e.xyy) - scene(p - e.xyy),
            scene(p + e.yxy) - scene(p - e.yxy),
            scene(p + e.yyx) - scene(p - e.yyx),
        )
    )


@func
def march(origin: vec3, direction: vec3) -> float:
    """The distance to the surface along a ray, or -1 when none is met."""
    t = 0.0
    for _ in range(steps):
        d = scene(origin + direction * t)
        if d < 0.001:
            return t
        t += d
        if t > FAR:
            break
    return -1.0


@image
def melting(frame: Frame) -> vec3:
    uv = (frame.coord - 0.5 * frame.resolution) / min(frame.resolution.x, frame.resolution.y)
    eye = vec3(0.0, 0.4, 3.2)
    direction = normalize(vec3(uv, -1.4))

    t = march(eye, direction)
    if t < 0.0:
        return SKY
    normal = surface_normal(eye + direction * t)
    diffuse = max(dot(normal, normalize(vec3(0.5, 0.9, 0.3))), 0.0)
    rim = (1.0 - max(dot(normal, -direction), 0.0)) ** 2
    return vec3(0.75, 0.55, 0.42) * (0.2 + 0.85 * diffuse) + vec3(0.4, 0.55, 0.9) * (0.35 * rim)
