"""The scene returns the distance and the material of what is nearest."""

from distal.lang import (
    Frame,
    color,
    dot,
    func,
    image,
    integer,
    length,
    max,
    normalize,
    slider,
    toggle,
    vec2,
    vec3,
)

size = slider("Green radius", 0.6, low=0.2, high=1.6, help="The ball in the middle.")
paint = color("Green paint", (0.2, 0.7, 0.3))
compare = toggle("Compare", True, help="Keep the nearest; else the last shape always wins.")
shift = integer("Material shift", 0, low=0, high=3, help="Added to the material of every hit.")

FAR = 100.0

NOTHING, GROUND, RED, GREEN, BLUE = -1, 0, 1, 2, 3


@func
def sd_sphere(p: vec3, radius: float) -> float:
    return length(p) - radius


@func
def scene(p: vec3) -> tuple[float, int]:
    """The distance to the nearest surface, and its material."""
    nearest = p.y
    material = GROUND
    red = sd_sphere(p - vec3(-1.5, 0.8, 2.0), 0.8)
    green = sd_sphere(p - vec3(0.5, size, 1.0), size)
    blue = sd_sphere(p - vec3(2.0, 1.0, 3.0), 1.0)
    if red < nearest:
        nearest, material = red, RED
    if green < nearest:
        nearest, material = green, GREEN
    if blue < nearest:
        nearest, material = blue, BLUE
    if not compare:
        material = BLUE
    return nearest, material


@func
def distance_to_scene(p: vec3) -> float:
    nearest, _ = scene(p)
    return nearest


@func
def surface_normal(p: vec3) -> vec3:
    e = vec2(0.001, 0.0)
    return normalize(
        vec3(
            distance_to_scene(p + e.xyy) - distance_to_scene(p - e.xyy),
            distance_to_scene(p + e.yxy) - distance_to_scene(p - e.yxy),
            distance_to_scene(p + e.yyx) - distance_to_scene(p - e.yyx),
        )
    )


@func
def march(origin: vec3, direction: vec3) -> tuple[float, int]:
    t = 0.0
    for _ in range(160):
        d, material = scene(origin + direction * t)
        if d < 0.001:
            return t, material
        if t > FAR:
            break
        t += d
    return t, NOTHING


@func
def albedo(material: int) -> vec3:
    if material == RED:
        return vec3(0.9, 0.2, 0.2)
    if material == GREEN:
        return paint
    if material == BLUE:
        return vec3(0.3, 0.4, 0.9)
    return vec3(0.4, 0.4, 0.35)


@image
def materials(frame: Frame) -> vec3:
    uv = (frame.coord - 0.5 * frame.resolution) / frame.resolution.y
    eye = vec3(0.0, 2.5, -5.0)
    direction = normalize(vec3(uv, 1.2))
    t, material = march(eye, direction)
    if t >= FAR:
        return vec3(0.05, 0.05, 0.12)
    normal = surface_normal(eye + direction * t)
    diffuse = max(dot(normal, normalize(vec3(1.0, 1.2, -0.8))), 0.0)
    shown = (material + shift) % 4 if material >= 0 else GROUND
    return albedo(shown) * (diffuse + 0.12)
