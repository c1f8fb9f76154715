"""Scene code that a strict type checker has nothing to say about."""

from __future__ import annotations

from typing import Literal

from distal.lang import (
    Buffer,
    Field3,
    Floats,
    Frame,
    Key,
    Texture2D,
    abs,
    any,
    array,
    buffer,
    clamp,
    color,
    dot,
    func,
    gradient,
    image,
    integer,
    ivec2,
    key_held,
    length,
    mat2,
    max,
    min,
    mix,
    normalize,
    pcg,
    point,
    pow,
    sample,
    select,
    size,
    slider,
    smoothstep,
    struct,
    texel,
    toggle,
    uint,
    value_and_gradient,
    vec2,
    vec3,
    vec4,
)

softness = slider("Blend softness", 0.3)
steps = integer("Steps", 64)
fancy = toggle("Fancy")
tint = color("Tint", "#ff8800")
place = point("Place", (0.0, 1.0))
photo = Texture2D("a.png")
data = Buffer([1.0, 2.0])
SUN = normalize(vec3(1, 2, 3)) * 2


@struct
class Hit:
    distance: float
    position: vec3 = vec3(0)
    material: int = 0

    @func
    def moved(self, by: vec3, *more: vec3) -> Hit:
        position = self.position + by
        for i, step in enumerate(more):
            position = position + step * float(i)
        return Hit(self.distance, position)


@func
def ball(p: vec3, r: float = 1.0) -> float:
    return length(p) - r


@func
def rotate(angle: float) -> mat2:
    return mat2(1.0, angle, -angle, 1)


@func
def twice(x: Floats) -> Floats:
    return x * 2 + 1


@func
def total(values: array[float, Literal[3]]) -> float:
    s = 0.0
    for v in values:
        s += v
    return s + values[0] + len(values)


@func
def march(field: Field3, o: vec3, d: vec3) -> Hit:
    t = 0.0
    for i in range(steps):
        dist = field(o + d * t)
        if dist < 0.001:
            return Hit(t, o + d * t, material=i)
        t += dist
    return Hit(t)


@func
def hashed(h: uint) -> uint:
    h ^= h >> 16
    h = h * 747796405 + 1
    return pcg(h) & 255


@buffer
def trail(frame: Frame) -> vec4:
    old = texel(trail, ivec2(frame.coord))
    for weight, side in zip((0.5, 0.25), (vec2(0.1, 0.0), vec2(0.0, 0.1)), strict=True):
        old = old + weight * sample(trail, frame.coord / frame.resolution + side)
    return old * frame.delta if key_held(Key.SPACE) else old


@image
def picture(frame: Frame) -> vec3:
    uv = (2.0 * frame.coord - frame.resolution) / frame.resolution.y
    p = vec3(uv, 1)
    p.xz = rotate(frame.time) @ p.xz
    q = abs(p) - 1
    outside = length(max(q, 0)) + min(max(q.x, q.y, q.z), 0)
    hit = march(lambda r: ball(r, 0.5), p, normalize(p))
    n = gradient(ball, p) + gradient(lambda r: ball(r) + outside, p)
    d, g = value_and_gradient(ball, p)
    s = sample(photo, uv).rgb + texel(photo, ivec2(1, 2)).xyz * data[0]
    c = mix(s, tint, clamp(dot(n, SUN), 0, 1)) + select(p > 0, p, 0)
    c += twice(c) + twice(softness) * float(size(photo).x) + smoothstep(0, 1, c)
    if any(p == q) or fancy:
        c *= vec3(place, float(hashed(frame.seed)))
    c[0] = hit.distance + total([1.0, 2.0, 3.0])
    return pow(c, 2.2) + g * d + frame.mouse.xyz
