"""Your turn: every number that you need is a slider, and every one is set wrong."""

from distal.lang import (
    Frame,
    cos,
    cross,
    dot,
    exp,
    floor,
    func,
    image,
    length,
    max,
    mix,
    normalize,
    sin,
    slider,
    struct,
    vec2,
    vec3,
)

distance = slider("Orbit radius", 1.6, low=1.0, high=4.0, step=0.1)
size = slider("Moon radius", 0.8, low=0.2, high=1.0, step=0.05)
density = slider("Fog", 0.0, low=0.0, high=0.12, step=0.01)
tile = slider("Tile size", 3.0, low=0.5, high=4.0, step=0.5)
height = slider("Eye height", 1.5, low=1.0, high=6.0, step=0.5)

FAR = 100.0
FOG = vec3(0.06, 0.06, 0.12)

NOTHING, GROUND, RED, GREEN, BLUE = -1, 0, 1, 2, 3


@struct
class Nearest:
    """What lies closest to a point: how far away, and what it is made of."""

    distance: float
    material: int


@func
def sd_sphere(p: vec3, radius: float) -> float:
    return length(p) - radius


@func
def closer(a: Nearest, b: Nearest) -> Nearest:
    return b if b.distance < a.distance else a


@func
def scene(p: vec3, time: float) -> Nearest:
    t = 0.8 * time
    orbit = vec3(distance * sin(t), 0.5, distance * cos(t))
    nearest = Nearest(p.y, GROUND)
    nearest = closer(nearest, Nearest(sd_sphere(p - vec3(0.0, 1.0, 0.0), 1.0), RED))
    nearest = closer(nearest, Nearest(sd_sphere(p - orbit, size), GREEN))
    return closer(nearest, Nearest(sd_sphere(p - vec3(-2.0, 0.7, 1.5), 0.7), BLUE))


@func
def surface_normal(p: vec3, time: float) -> vec3:
    e = vec2(0.001, 0.0)
    return normalize(
        vec3(
            scene(p + e.xyy, time).distance - scene(p - e.xyy, time).distance,
            scene(p + e.yxy, time).distance - scene(p - e.yxy, time).distance,
            scene(p + e.yyx, time).distance - scene(p - e.yyx, time).distance,
        )
    )


@func
def march(origin: vec3, direction: vec3, time: float) -> Nearest:
    t = 0.0
    for _ in range(80):
        nearest = scene(origin + direction * t, time)
        if nearest.distance < 0.001:
            return Nearest(t, nearest.material)
        if t > FAR:
            break
        t += nearest.distance
    return Nearest(t, NOTHING)


@func
def albedo(p: vec3, material: int) -> vec3:
    if material == RED:
        return vec3(0.85, 0.25, 0.2)
    if material == GREEN:
        return vec3(0.2, 0.75, 0.4)
    if material == BLUE:
        return vec3(0.25, 0.35, 0.85)
    # GROUND, and NOTHING: rays along the floor that ran out of steps just before it.
    checker = (floor(p.x / tile) + floor(p.z / tile)) % 2.0
    return mix(vec3(0.25, 0.25, 0.2), vec3(0.4, 0.4, 0.35), checker)


@image
def exercise(frame: Frame) -> vec3:
    uv = (frame.coord - 0.5 * frame.resolution) / frame.resolution.y

    angle = 0.2 * frame.time
    eye = vec3(6.0 * sin(angle), height, 6.0 * cos(angle))
    forward = normalize(vec3(0.0, 0.8, 0.0) - eye)
    right = normalize(cross(vec3(0.0, 1.0, 0.0), forward))
    up = cross(forward, right)
    direction = normalize(uv.x * right + uv.y * up + 1.2 * forward)

    hit = march(eye, direction, frame.time)
    color = FOG
    if hit.distance < FAR:
        p = eye + direction * hit.distance
        diffuse = max(dot(surface_normal(p, frame.time), normalize(vec3(0.8, 1.0, -0.6))), 0.0)
        color = albedo(p, hit.material) * (diffuse + 0.12)
    return mix(color, FOG, 1.0 - exp(-density * hit.distance))
