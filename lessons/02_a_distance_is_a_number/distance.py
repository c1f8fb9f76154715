"""The distance to two flat shapes, drawn as a map: lines of equal distance, zero in white."""

from distal.lang import (
    Frame,
    abs,
    choice,
    exp,
    fract,
    func,
    image,
    length,
    max,
    min,
    mix,
    slider,
    smoothstep,
    vec2,
    vec3,
)

radius = slider("Circle radius", 0.5, low=0.1, high=1.0)
joined = choice(
    "Joined by", ["union", "intersection", "difference"], help="min, max, or max(a, -b)."
)
offset = slider("Take off", 0.0, low=-0.3, high=0.3, help="A number taken off every distance.")
stretch = slider("Stretch", 1.0, low=0.4, high=2.5, help="The whole plane, stretched sideways.")


@func
def circle(p: vec2, r: float) -> float:
    return length(p) - r


@func
def rectangle(p: vec2, half: vec2) -> float:
    q = abs(p) - half
    return length(max(q, 0.0)) + min(max(q.x, q.y), 0.0)


@func
def scene(p: vec2) -> float:
    a = rectangle(p - vec2(0.35, -0.1), vec2(0.5, 0.4))
    b = circle(p - vec2(-0.3, 0.15), radius)
    d = min(a, b)
    if joined == 1:
        d = max(a, b)
    if joined == 2:
        d = max(a, -b)
    return d - offset


@image
def distance(frame: Frame) -> vec3:
    p = 2.6 * (frame.coord - 0.5 * frame.resolution) / frame.resolution.y
    d = scene(vec2(p.x / stretch, p.y))
    pixel = 2.6 / frame.resolution.y
    color = vec3(0.93, 0.56, 0.25) if d > 0.0 else vec3(0.27, 0.55, 0.85)
    color *= 1.0 - exp(-4.0 * abs(d)) * 0.7
    to_line = 0.1 * abs(fract(10.0 * d + 0.5) - 0.5)
    color *= mix(0.72, 1.0, smoothstep(pixel, 2.5 * pixel, to_line))
    return mix(vec3(1.0), color, smoothstep(pixel, 2.5 * pixel, abs(d)))
