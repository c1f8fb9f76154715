"""Sphere tracing seen from the side: circles of safe distance along one ray. The mouse aims."""

from distal.lang import (
    Frame,
    abs,
    atan2,
    clamp,
    cos,
    dot,
    exp,
    func,
    image,
    integer,
    length,
    max,
    min,
    mix,
    sin,
    slider,
    smoothstep,
    vec2,
    vec3,
)

steps = integer("Steps", 24, low=1, high=40, help="How many steps the ray may take.")
aim = slider("Aim", 0.05, low=-0.6, high=0.6, help="The direction of the ray; drag in the picture.")
factor = slider("Step factor", 1.0, low=0.2, high=2.0, help="Times the distance that is safe.")

EYE = vec2(-1.7, 0.1)
FAR = 4.0


@func
def rectangle(p: vec2, half: vec2) -> float:
    q = abs(p) - half
    return length(max(q, 0.0)) + min(max(q.x, q.y), 0.0)


@func
def scene(p: vec2) -> float:
    ball = length(p - vec2(-0.15, 0.62)) - 0.4
    block = rectangle(p - vec2(0.25, -0.72), vec2(0.35, 0.42))
    wall = 1.55 - p.x
    return min(wall, min(ball, block))


@func
def line(d: float, pixel: float) -> float:
    """How much a line at a distance covers of a pixel."""
    return 1.0 - smoothstep(0.6 * pixel, 1.8 * pixel, d)


@image
def marching(frame: Frame) -> vec3:
    scale = 2.6 / frame.resolution.y
    p = scale * (frame.coord - 0.5 * frame.resolution)
    angle = aim
    if frame.mouse.x > 0.0:
        to = scale * (frame.mouse.xy - 0.5 * frame.resolution) - EYE
        angle = clamp(atan2(to.y, to.x), -1.2, 1.2)
    direction = vec2(cos(angle), sin(angle))

    d = scene(p)
    color = mix(vec3(0.13, 0.15, 0.19), vec3(0.17, 0.20, 0.25), exp(-3.0 * abs(d)))
    color = vec3(0.42, 0.47, 0.55) if d < 0.0 else color

    t = 0.0
    hit = False
    for i in range(steps):
        at = EYE + direction * t
        safe = scene(at)
        if safe < 0.005:
            hit = safe > -0.02
            break
        shade = 1.0 - 0.6 * float(i) / float(steps)
        ring = line(abs(length(p - at) - safe), scale)
        color = mix(color, vec3(0.35, 0.75, 0.95) * shade, 0.85 * ring)
        color = mix(color, vec3(0.98, 0.85, 0.45), line(length(p - at) - 0.014, scale))
        t += factor * safe
        if t > FAR:
            break
    along = clamp(dot(p - EYE, direction), 0.0, t)
    color = mix(color, vec3(0.98, 0.85, 0.45), line(length(p - EYE - direction * along), scale))
    end = vec3(0.45, 0.95, 0.55) if hit else vec3(1.0, 0.35, 0.35)
    return mix(color, end, line(length(p - EYE - direction * t) - 0.035, scale))
