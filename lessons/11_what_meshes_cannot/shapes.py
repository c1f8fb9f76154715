"""Three things that are one number here: a morph, ripples on a surface, endless copies."""

from distal.lang import (
    Frame,
    abs,
    dot,
    exp,
    func,
    image,
    length,
    max,
    min,
    mix,
    normalize,
    round,
    sin,
    slider,
    toggle,
    vec2,
    vec3,
)

morph = slider("Morph", 0.0, low=0.0, high=1.0, help="From a sphere to a cube.")
ripples = slider("Ripples", 0.0, low=0.0, high=0.2, help="Waves added to the distance.")
repeated = toggle("Repeat", False, help="Whether space repeats itself.")
spacing = slider("Spacing", 2.6, low=1.2, high=5.0, help="From copy to copy.")
careful = slider("Step factor", 0.6, low=0.2, high=1.0, help="Times the distance.")

FAR = 40.0
SKY = vec3(0.62, 0.72, 0.84)


@func
def sphere(p: vec3) -> float:
    return length(p) - 0.8


@func
def cube(p: vec3) -> float:
    q = abs(p) - vec3(0.65)
    return length(max(q, 0.0)) + min(max(q.x, max(q.y, q.z)), 0.0)


@func
def scene(p: vec3) -> float:
    q = p
    if repeated:
        q = vec3(p.x - spacing * round(p.x / spacing), p.y, p.z - spacing * round(p.z / spacing))
    waves = sin(9.0 * q.x) * sin(9.0 * q.y) * sin(9.0 * q.z)
    body = mix(sphere(q), cube(q), morph) + ripples * waves
    return min(body, p.y + 0.85)


@func
def surface_normal(p: vec3) -> vec3:
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
    t = 0.0
    for _ in range(200):
        d = scene(origin + direction * t)
        if d < 0.001 or t > FAR:
            break
        t += careful * d
    return t


@image
def shapes(frame: Frame) -> vec3:
    uv = (frame.coord - 0.5 * frame.resolution) / frame.resolution.y
    eye = vec3(1.3, 1.3, 3.4)
    forward = normalize(vec3(0.0, -0.1, 0.0) - eye)
    right = normalize(vec3(-forward.z, 0.0, forward.x))
    up = vec3(
        right.y * forward.z - right.z * forward.y,
        right.z * forward.x - right.x * forward.z,
        right.x * forward.y - right.y * forward.x,
    )
    direction = normalize(uv.x * right + uv.y * up + 1.3 * forward)
    t = march(eye, direction)
    p = eye + direction * t
    normal = surface_normal(p)
    diffuse = max(dot(normal, normalize(vec3(0.4, 0.9, 0.5))), 0.0)
    paint = vec3(0.5, 0.5, 0.47) if p.y < -0.845 else vec3(0.86, 0.42, 0.24)
    lit = paint * (0.25 + 0.75 * diffuse)
    return mix(lit, SKY, 1.0 - exp(-0.004 * t * t)) if t < FAR else SKY
