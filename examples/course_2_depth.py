"""Course, step 2: march along the ray by the distance to the nearest surface; show how far."""

from distal.lang import Frame, func, image, length, min, normalize, vec3

FAR = 100.0


@func
def sd_sphere(p: vec3, radius: float) -> float:
    return length(p) - radius


@func
def scene(p: vec3) -> float:
    return min(sd_sphere(p - vec3(0.0, 1.0, 0.0), 1.0), p.y)


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
def depth(frame: Frame) -> vec3:
    uv = (frame.coord - 0.5 * frame.resolution) / frame.resolution.y
    t = march(vec3(0.0, 2.0, -4.0), normalize(vec3(uv, 1.0)))
    return vec3(1.0 - 0.1 * t) if t < FAR else vec3(0.0)
