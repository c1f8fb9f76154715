"""A sphere on a plane in the light: a normal from six distances and Lambert's cosine."""

from distal.lang import (
    Frame,
    cos,
    dot,
    func,
    image,
    length,
    max,
    min,
    normalize,
    sin,
    slider,
    vec2,
    vec3,
)

around = slider("Light around", 2.7, low=0.0, high=6.28, help="The direction of the light.")
up = slider("Light up", 0.7, low=0.0, high=1.57, help="How high the light stands.")
ambient = slider("Ambient", 0.15, low=0.0, high=1.0, help="Light from everywhere.")
spread = slider("Spread", 0.001, low=0.001, high=1.0, log=True, help="Between two samples.")

FAR = 100.0


@func
def sd_sphere(p: vec3, radius: float) -> float:
    return length(p) - radius


@func
def scene(p: vec3) -> float:
    return min(sd_sphere(p - vec3(0.0, 1.0, 0.0), 1.0), p.y)


@func
def surface_normal(p: vec3) -> vec3:
    e = vec2(spread, 0.0)
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
    for _ in range(160):
        d = scene(origin + direction * t)
        if d < 0.001 or t > FAR:
            break
        t += d
    return t


@image
def lit(frame: Frame) -> vec3:
    uv = (frame.coord - 0.5 * frame.resolution) / frame.resolution.y
    eye = vec3(0.0, 2.0, -4.0)
    direction = normalize(vec3(uv, 1.0))
    t = march(eye, direction)
    normal = surface_normal(eye + direction * t)
    light = vec3(cos(up) * sin(around), sin(up), cos(up) * cos(around))
    diffuse = max(dot(normal, light), 0.0)
    if t >= FAR:
        return vec3(0.05, 0.05, 0.1)
    return vec3(0.8, 0.7, 0.6) * (diffuse + ambient)
