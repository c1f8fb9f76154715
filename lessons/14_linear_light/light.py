"""Light adds up in linear numbers; screens want them encoded. Left as it should be, right not."""

from distal.lang import (
    Frame,
    abs,
    choice,
    exp,
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

overlap = slider("Distance of lamps", 0.6, low=0.0, high=1.2, help="How far apart the spots are.")
power = slider("Power", 0.8, low=0.1, high=3.0, help="How bright each lamp is.")
method = choice("Right half", ["as it is", "encoded too early"], help="What the right half does.")


@func
def channel(linear: float) -> float:
    """The curve of sRGB for one number."""
    x = max(min(linear, 1.0), 0.0)
    return 12.92 * x if x <= 0.0031308 else 1.055 * x ** (1.0 / 2.4) - 0.055


@func
def encoded(light: vec3) -> vec3:
    return vec3(channel(light.x), channel(light.y), channel(light.z))


@func
def lamp(p: vec2, at: vec2, tint: vec3) -> vec3:
    r = length(p - at)
    return tint * (power * exp(-6.0 * r * r))


@image
def light(frame: Frame) -> vec3:
    p = 2.2 * (frame.coord - 0.5 * frame.resolution) / frame.resolution.y
    q = vec2(abs(p.x) - 0.72, p.y)
    half = 0.5 * overlap
    warm = lamp(q, vec2(0.0, half), vec3(1.0, 0.35, 0.1))
    cold = lamp(q, vec2(0.0, -half), vec3(0.1, 0.4, 1.0))
    signal = length(warm + cold)
    right = warm + cold if method == 0 else encoded(warm) + encoded(cold)
    shown = encoded(warm + cold) if p.x < 0.0 else right
    edge = smoothstep(0.004, 0.008, abs(p.x))
    return mix(vec3(0.5), shown, edge) * min(1.0 + 0.0 * signal, 1.0)
