"""A sound as a flower: petals are its spectrum, the ring is its wave, and both leave trails.

The sound is a file of the examples; a name without ``example:`` is one beside this file. Videos and
pages play it: ``distal video spectrum.py --duration 4 -o spectrum.mp4``.
"""

import math

from distal.lang import (
    Frame,
    SoundFile,
    buffer,
    clamp,
    cos,
    exp,
    func,
    image,
    length,
    max,
    mix,
    sample,
    slider,
    smoothstep,
    vec2,
    vec3,
    vec4,
)

trails = slider("Trails", 0.93, 0.0, 0.99, help="What is left of a frame after the next one.")

song = SoundFile("example:arpeggio.wav")
PETALS = 72.0


@func
def loudness(share: float) -> float:
    """The spectrum, from low (0) to high (1): low tones have more room, as on a piano."""
    column = 0.012 + 0.5 * share * share
    return sample(song, vec2(column, 0.25)).x


@func
def wave(share: float) -> float:
    """The wave around its rest, from -1 to 1."""
    return 2.0 * sample(song, vec2(0.9 * share, 0.75)).x - 1.0


@func
def rainbow(share: float) -> vec3:
    return 0.5 + 0.5 * cos(6.2832 * (vec3(0.02, 0.36, 0.62) + 0.75 * share))


@func
def drawn(p: vec2) -> vec3:
    """The petals and the ring at a place, in heights of the picture from the middle."""
    away = length(p)
    angle = abs(math.atan2(p.x, p.y)) / math.pi  # mirrored: 0 above, 1 below
    petal = (math.floor(angle * PETALS * 0.5) + 0.5) / (PETALS * 0.5)
    high = loudness(petal)
    across = abs((angle * PETALS * 0.5) % 1.0 - 0.5)
    tip = 0.17 + 0.27 * high * high
    bar = smoothstep(0.42, 0.34, across) * smoothstep(tip + 0.004, tip, away)
    bar *= smoothstep(0.155, 0.16, away)
    ring = abs(away - 0.12 - 0.05 * wave(angle) * (1.0 - angle))
    line = exp(-ring * ring * 90000.0) + 0.12 * exp(-ring * 90.0)
    glow = 0.35 * loudness(0.0) * exp(-away * 9.0)
    color = rainbow(petal)
    return color * bar * (0.35 + 1.3 * high) + vec3(1.0, 0.9, 0.75) * line + glow * rainbow(0.9)


@buffer
def kept(frame: Frame) -> vec4:
    here = frame.coord / frame.resolution
    # What was there runs outwards.
    before = sample(kept, 0.5 + (here - 0.5) * 0.985).rgb
    p = (frame.coord - 0.5 * frame.resolution) / frame.resolution.y
    return vec4(max(before * trails - 0.0015, drawn(p)), 1.0)


@image
def picture(frame: Frame) -> vec3:
    p = (frame.coord - 0.5 * frame.resolution) / frame.resolution.y
    light = mix(sample(kept, frame.coord / frame.resolution).rgb * 0.55, drawn(p), 0.6)
    shade = clamp(1.15 - length(p), 0.0, 1.0)
    return (1.0 - exp(-1.8 * light) + vec3(0.008, 0.008, 0.014) * shade) ** vec3(0.4545)
