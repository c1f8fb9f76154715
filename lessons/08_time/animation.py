"""A bouncing ball, a checkered floor and a camera that circles them."""

from distal.lang import (
    Frame,
    abs,
    cos,
    cross,
    dot,
    floor,
    func,
    image,
    length,
    max,
    min,
    normalize,
    select,
    sin,
    slider,
    toggle,
    vec2,
    vec3,
)

leap = slider("Bounce height", 1.5, low=0.0, high=3.0, help="How high the ball jumps.")
speed = slider("Bounce speed", 2.0, low=0.0, high=6.0)
orbit = slider("Orbit speed", 0.3, low=-2.0, high=2.0, help="How fast the camera circles.")
folded = toggle("Absolute value", True, help="Whether the sine is folded upwards.")

FAR = 100.0


@func
def sd_sphere(p: vec3, radius: float) -> float:
    return length(p) - radius


@func
def scene(p: vec3, time: float) -> float:
    wave = sin(speed * time)
    bounce = leap * select(folded, abs(wave), wave)
    return min(sd_sphere(p - vec3(0.0, 0.8 + bounce, 0.0), 0.8), p.y)


@func
def surface_normal(p: vec3, time: float) -> vec3:
    e = vec2(0.001, 0.0)
    return normalize(
        vec3(
            scene(p + e.xyy, time) - scene(p - e.xyy, time),
            scene(p + e.yxy, time) - scene(p - e.yxy, time),
            scene(p + e.yyx, time) - scene(p - e.yyx, time),
        )
    )


@func
def march(origin: vec3, direction: vec3, time: float) -> float:
    t = 0.0
    for _ in range(200):
        d = scene(origin + direction * t, time)
        if d < 0.001 or t > FAR:
            break
        t += d
    return t


@image
def animation(frame: Frame) -> vec3:
    uv = (frame.coord - 0.5 * frame.resolution) / frame.resolution.y

    angle = orbit * frame.time
    eye = vec3(5.0 * sin(angle), 3.0, 5.0 * cos(angle))
    forward = normalize(vec3(0.0, 1.0, 0.0) - eye)
    right = normalize(cross(vec3(0.0, 1.0, 0.0), forward))
    up = cross(forward, right)
    direction = normalize(uv.x * right + uv.y * up + 1.2 * forward)

    t = march(eye, direction, frame.time)
    if t >= FAR:
        return vec3(0.05, 0.05, 0.1)
    p = eye + direction * t
    diffuse = max(dot(surface_normal(p, frame.time), normalize(vec3(1.0, 1.0, -0.5))), 0.0)
    checker = (floor(p.x) + floor(p.z)) % 2.0
    albedo = vec3(0.3 + 0.2 * checker) if p.y < 0.01 else vec3(0.8, 0.3, 0.25)
    return albedo * (diffuse + 0.15)
