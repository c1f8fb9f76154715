"""A small scene with something of everything, so that its texts stay short enough to read."""

from __future__ import annotations

from distal.lang import (
    Frame,
    abs,
    clamp,
    cos,
    func,
    image,
    length,
    mat2,
    max,
    min,
    mix,
    round,
    sin,
    slider,
    struct,
    toggle,
    vec2,
    vec3,
)

softness = slider("Filter", 0.25, low=0.01, high=1.0)
outline = toggle("Outline", True)

PALETTE = (0.2, 0.9, 0.4)


@struct
class Nearest:
    distance: float
    number: int


@func
def rotated(p: vec2, angle: float) -> vec2:
    return mat2(vec2(cos(angle), sin(angle)), vec2(-sin(angle), cos(angle))) @ p


@func
def ring(p: vec2, radius: float) -> float:
    return abs(length(p) - radius) - 0.05


@func
def nearest(p: vec2, time: float) -> Nearest:
    found = Nearest(distance=1000.0, number=-1)
    for i in range(3):
        center = rotated(vec2(0.5, 0.0), time + 2.0 * float(i))
        d = ring(p - center, 0.25)
        if d < found.distance:
            found.distance = d
            found.number = i
    return found


@image
def rings(frame: Frame) -> vec3:
    p = (2.0 * frame.coord - frame.resolution) / frame.resolution.y
    p *= 1.0 + 0.25 * sin(frame.time)
    found = nearest(p, frame.time)
    if found.number < 0:
        return vec3(0.0, 0.0, 0.0)
    shade = clamp(0.5 - found.distance / softness, 0.0, 1.0)
    if outline and abs(found.distance) < 0.01:
        shade = max(round(shade), min(shade, 0.5))
    return mix(vec3(0.1, 0.1, 0.2), vec3(PALETTE[found.number], 0.5, 0.3), shade)
