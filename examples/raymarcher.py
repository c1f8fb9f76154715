"""A sphere and an orbiting torus melt into each other above a checkered floor.

Our first scene: soft shadow, hemisphere light, rim, fog and a sun disc, tone-mapped; all of it
moves with time. Ported from the daslang tutorial "Signed-Distance-Field Raymarcher".
"""

from distal.lang import (
    Frame,
    clamp,
    cos,
    cross,
    dot,
    exp,
    floor,
    func,
    image,
    length,
    max,
    min,
    mix,
    normalize,
    sin,
    vec2,
    vec3,
)

STEPS = 96
FAR = 60.0
HIT = 0.001
SHADOW_STEPS = 48
SHADOW_SHARPNESS = 32.0

BLOB = 0  # materials
GROUND = 1


@func
def smooth_union(a: float, b: float, k: float) -> float:
    """Cubic smooth minimum: the surfaces melt where they are within k of each other."""
    overlap = max(k - abs(a - b), 0.0) / k
    return min(a, b) - overlap**3 * k * (1.0 / 6.0)


@func
def sd_sphere(p: vec3, radius: float) -> float:
    return length(p) - radius


@func
def sd_torus(p: vec3, major: float, minor: float) -> float:
    return length(vec2(length(p.xz) - major, p.y)) - minor


@func
def sd_plane(p: vec3, height: float) -> float:
    return p.y - height


@func
def turn(p: vec2, angle: float) -> vec2:
    c = cos(angle)
    s = sin(angle)
    return vec2(c * p.x - s * p.y, s * p.x + c * p.y)


@func
def blob(p: vec3, time: float) -> float:
    sphere = sd_sphere(p - vec3(0.0, 0.2 * sin(1.5 * time), 0.0), 0.55)
    xz = turn(p.xz, 0.8 * time)
    torus = sd_torus(vec3(xz.x - 1.0, p.y, xz.y), 0.32, 0.12)
    return smooth_union(sphere, torus, 0.3)


@func
def scene(p: vec3, time: float) -> float:
    return min(sd_plane(p, -0.5), blob(p, time))


@func
def surface_normal(p: vec3, time: float) -> vec3:
    """Forward differences: four evaluations."""
    step = 0.001
    here = scene(p, time)
    return normalize(
        vec3(
            scene(p + vec3(step, 0.0, 0.0), time) - here,
            scene(p + vec3(0.0, step, 0.0), time) - here,
            scene(p + vec3(0.0, 0.0, step), time) - here,
        )
    )


@func
def march(origin: vec3, direction: vec3, time: float) -> float:
    """The distance to the surface along a ray; beyond FAR when there is none."""
    t = 0.0
    for _ in range(STEPS):
        d = scene(origin + direction * t, time)
        if d < HIT:
            return t
        t += d
        if t > FAR:
            break
    return FAR + 1.0


@func
def soft_shadow(origin: vec3, direction: vec3, time: float) -> float:
    """1 in full light, 0 in full shadow; rays that pass close by are dimmed."""
    light = 1.0
    t = 0.05
    for _ in range(SHADOW_STEPS):
        d = scene(origin + direction * t, time)
        if d < HIT:
            return 0.0
        light = min(light, SHADOW_SHARPNESS * d / t)
        t += clamp(d, 0.02, 1.0)
        if t > 10.0:
            break
    return clamp(light, 0.0, 1.0)


@func
def sky(direction: vec3, sun: vec3) -> vec3:
    height = clamp(0.5 * direction.y + 0.5, 0.0, 1.0)
    gradient = mix(vec3(0.94, 0.78, 0.62), vec3(0.45, 0.62, 0.85), height)
    return gradient + vec3(1.0, 0.85, 0.6) * max(dot(direction, sun), 0.0) ** 64.0


@func
def ground_color(p: vec3) -> vec3:
    parity = (floor(p.x) + floor(p.z)) % 2.0
    return mix(vec3(0.95, 0.92, 0.85), vec3(0.30, 0.34, 0.38), parity)


@func
def blob_color(p: vec3, time: float) -> vec3:
    phase = 0.6 * time
    palette = vec3(0.6, 0.45, 0.4) + 0.4 * cos(vec3(phase, phase + 0.8, phase + 1.6))
    return palette * (0.85 + 0.15 * clamp(p.y + 0.5, 0.0, 1.0))


@func
def lit(p: vec3, eye: vec3, sun: vec3, time: float) -> vec3:
    normal = surface_normal(p, time)
    material = GROUND if sd_plane(p, -0.5) < blob(p, time) else BLOB
    albedo = ground_color(p) if material == GROUND else blob_color(p, time)
    key = max(dot(normal, sun), 0.0)
    shadow = soft_shadow(p + 0.001 * normal, sun, time)
    ambient = 0.25 + 0.25 * (0.5 * normal.y + 0.5)
    rim = (1.0 - max(dot(normal, normalize(eye - p)), 0.0)) ** 3.0
    return albedo * (ambient + 0.85 * key * shadow) + vec3(1.0, 0.9, 0.75) * (0.2 * rim)


@image
def raymarcher(frame: Frame) -> vec3:
    time = frame.time
    uv = (2.0 * frame.coord - frame.resolution) / frame.resolution.y

    angle = 0.4 * time
    eye = vec3(3.0 * cos(angle), 0.8 + 0.2 * sin(0.3 * time), 3.0 * sin(angle))
    forward = normalize(-eye)
    right = normalize(cross(vec3(0.0, 1.0, 0.0), forward))
    up = cross(forward, right)
    direction = normalize(1.6 * forward + uv.x * right + uv.y * up)
    sun = normalize(vec3(-0.4, 0.8, -0.5))

    color = sky(direction, sun)
    t = march(eye, direction, time)
    if t < FAR:
        fog = clamp(1.0 - exp(-0.02 * t * t), 0.0, 1.0)
        color = mix(lit(eye + direction * t, eye, sun, time), color, fog)
    return color / (1.0 + color)
