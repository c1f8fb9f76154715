"""Course, step 3: a normal from six taps, Lambert's cosine and a little ambient light."""

from distal.lang import Frame, dot, func, image, length, max, min, normalize, vec2, vec3

FAR = 100.0


@func
def sd_sphere(p: vec3, radius: float) -> float:
    return length(p) - radius


@func
def scene(p: vec3) -> float:
    return min(sd_sphere(p - vec3(0.0, 1.0, 0.0), 1.0), p.y)


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
    for _ in range(80):
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
    if t >= FAR:
        return vec3(0.05, 0.05, 0.1)
    normal = surface_normal(eye + direction * t)
    diffuse = max(dot(normal, normalize(vec3(1.0, 1.0, -0.5))), 0.0)
    return vec3(0.8, 0.7, 0.6) * (diffuse + 0.15)
