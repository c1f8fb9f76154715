"""A glider that leaves light behind: the arrows turn and push it, space changes its color.

Until the first key it flies by itself. Two texels are its state; a buffer is its trail.
"""

from distal.lang import (
    Frame,
    Key,
    buffer,
    clamp,
    cos,
    dot,
    exp,
    func,
    image,
    ivec2,
    key_held,
    key_pressed,
    key_toggled,
    length,
    max,
    mix,
    sample,
    sin,
    slider,
    texel,
    vec2,
    vec3,
    vec4,
)

fading = slider("Fading", 0.996, 0.9, 1.0, help="What is left of the trail after a frame.")


@func
def held(code: int) -> float:
    return 1.0 if key_held(code) else 0.0


@buffer
def state(frame: Frame) -> vec4:
    """The place (in heights of the picture) and the velocity; its neighbor has the angle."""
    is_angle = int(frame.coord.x) == 1
    body, more = texel(state, ivec2(0, 0)), texel(state, ivec2(1, 0))
    if frame.index == 0:
        return vec4(1.2, 0.0, 0.0, 0.0) if is_angle else vec4(0.3, 0.25, 0.25, 0.1)
    any_key = key_pressed(Key.LEFT) or key_pressed(Key.RIGHT) or key_pressed(Key.UP) or more.y > 0.5
    wander = 1.9 * sin(0.9 * frame.time) + 1.4 * sin(2.3 * frame.time + 1.0)
    turn = 3.5 * (held(Key.LEFT) - held(Key.RIGHT)) if any_key else wander
    angle = more.x + turn * frame.delta
    if is_angle:
        return vec4(angle, 1.0 if any_key else 0.0, 0.0, 0.0)
    thrust = held(Key.UP) - 0.5 * held(Key.DOWN) if any_key else 0.8
    velocity = body.zw * exp(-0.9 * frame.delta)
    velocity += thrust * frame.delta * vec2(cos(angle), sin(angle))
    place = body.xy + velocity * frame.delta
    wide = frame.resolution.x / frame.resolution.y
    extent = vec2(wide, 1.0)
    return vec4(place % extent, velocity)


@func
def color_of(seconds: float) -> vec3:
    """The color of the light at a time."""
    hue = 0.35 * seconds + (2.1 if key_toggled(Key.SPACE) else 0.0)
    return 0.55 + 0.45 * cos(vec3(0.0, 2.1, 4.2) + hue)


@func
def apart(p: vec2, place: vec2, wide: float) -> vec2:
    """The shortest way to a place, over the edges of the picture."""
    d = p - place
    return vec2((d.x + 0.5 * wide) % wide - 0.5 * wide, (d.y + 0.5) % 1.0 - 0.5)


@buffer
def trail(frame: Frame) -> vec4:
    extent = frame.resolution
    p, wide = frame.coord / extent.y, extent.x / extent.y
    body = texel(state, ivec2(0, 0))
    d = apart(p, body.xy, wide)
    spark = exp(-dot(d, d) * 9000.0) + 0.05 * exp(-length(d) * 60.0)
    # Light drifts outwards from the middle, as in a wind.
    here = frame.coord / extent
    before = sample(trail, 0.5 + (here - 0.5) * 0.9985).rgb
    return vec4(before * fading + color_of(frame.time) * spark * 0.5, 1.0)


@image
def picture(frame: Frame) -> vec3:
    extent = frame.resolution
    p, wide = frame.coord / extent.y, extent.x / extent.y
    light = sample(trail, frame.coord / extent).rgb
    body, angle = texel(state, ivec2(0, 0)), texel(state, ivec2(1, 0)).x
    d = apart(p, body.xy, wide)
    along = vec2(cos(angle) * d.x + sin(angle) * d.y, cos(angle) * d.y - sin(angle) * d.x)
    hull = max(abs(along.y) * 2.4 + along.x - 0.018, -along.x - 0.014)
    inside = clamp(0.5 - hull * extent.y * 0.5, 0.0, 1.0)
    lines = max(abs((p * 12.0) % 1.0 - 0.5), 0.0)
    grid = clamp((max(lines.x, lines.y) - 0.485) * 80.0, 0.0, 1.0)
    shown = vec3(0.004, 0.006, 0.014) + grid * vec3(0.006, 0.01, 0.02) + light
    return mix(1.0 - exp(-1.7 * shown), vec3(1.0), inside) ** vec3(0.4545)
