"""Ink in water: two jets stir a fluid, and the mouse pushes it.

One buffer holds the flow (its velocity and how dense it is), one the ink that it carries. Dense
places push the flow away, which keeps it nearly incompressible. Try: ``--set Swirl=0.9``.
"""

from distal.lang import (
    Frame,
    Texture2D,
    buffer,
    clamp,
    cos,
    dot,
    exp,
    func,
    image,
    length,
    max,
    mix,
    sample,
    sin,
    slider,
    vec2,
    vec3,
    vec4,
)

swirl = slider("Swirl", 0.25, 0.0, 1.0, help="How much small whirls are fed.")
fading = slider("Fading", 0.9985, 0.95, 1.0, help="What is left of the ink after a frame.")

PRESSURE = 0.22
VISCOSITY = 0.12
NOZZLE = 0.03  # of the picture's height
SPEED = 7.0  # pixels in a frame, of a picture 360 pixels high


@func
def flowing(field: Texture2D, place: vec2, resolution: vec2) -> vec4:
    """The field at a place in pixels."""
    return sample(field, place / resolution)


@func
def nozzle(i: int, seconds: float, resolution: vec2) -> vec4:
    """Where a jet is, in pixels, and its direction."""
    angle = seconds * (0.7 + 0.2 * float(i)) + 3.14159 * float(i)
    place = resolution * 0.5 + 0.3 * resolution.y * vec2(cos(angle), sin(angle))
    turn = angle + 2.1 + 0.8 * sin(1.9 * seconds)
    return vec4(place, cos(turn), sin(turn))


@func
def near(place: vec2, middle: vec2, resolution: vec2) -> float:
    """How much of a nozzle is at a place, from 0 to 1."""
    apart = (place - middle) / (NOZZLE * resolution.y)
    return exp(-dot(apart, apart))


@buffer
def flow(frame: Frame) -> vec4:
    here, extent = frame.coord, frame.resolution
    if frame.index == 0:
        return vec4(0.0, 0.0, 1.0, 0.0)
    come = here - flowing(flow, here, extent).xy
    now = flowing(flow, come, extent)
    right, left = flowing(flow, come + vec2(1, 0), extent), flowing(flow, come - vec2(1, 0), extent)
    up, down = flowing(flow, come + vec2(0, 1), extent), flowing(flow, come - vec2(0, 1), extent)
    spread = 0.25 * (right + left + up + down) - now
    escaping = 0.5 * (right.x - left.x + up.y - down.y)
    curl = 0.5 * (right.y - left.y - up.x + down.x)
    whirls = 0.5 * vec2(abs(up.w) - abs(down.w), abs(left.w) - abs(right.w))
    push = -PRESSURE * 0.5 * vec2(right.z - left.z, up.z - down.z)
    velocity = now.xy + VISCOSITY * spread.xy + push
    velocity += swirl * now.w * whirls / (length(whirls) + 0.01)
    scale = SPEED * extent.y / 360.0
    for i in range(2):
        jet = nozzle(i, frame.time, extent)
        velocity = mix(velocity, scale * jet.zw, 0.5 * near(here, jet.xy, extent))
    if frame.buttons == 1:
        pull = frame.mouse.xy - frame.mouse.zw
        push_to = scale * pull / (length(pull) + 8.0)
        velocity = mix(velocity, push_to, 0.5 * near(here, frame.mouse.xy, extent))
    wall = clamp(min(here.x, here.y, extent.x - here.x, extent.y - here.y) / 6.0, 0.0, 1.0)
    dense = clamp(now.z + 0.5 * spread.z - 0.6 * escaping, 0.5, 3.0)
    return vec4(clamp(velocity * 0.999 * wall, -12.0, 12.0), dense, curl)


@buffer
def ink(frame: Frame) -> vec4:
    here, extent = frame.coord, frame.resolution
    if frame.index == 0:
        return vec4(0.0)
    color = fading * flowing(ink, here - flowing(flow, here, extent).xy, extent)
    for i in range(2):
        share = 0.5 * near(here, nozzle(i, frame.time, extent).xy, extent)
        warm, cold = vec4(1.6, 0.34, 0.03, 1.0), vec4(0.02, 0.42, 1.7, 1.0)
        color = mix(color, warm if i == 0 else cold, share)
    if frame.buttons == 1:
        color = mix(color, vec4(0.9, 0.9, 0.7, 1.0), 0.3 * near(here, frame.mouse.xy, extent))
    return color


@image
def picture(frame: Frame) -> vec3:
    here, extent = frame.coord, frame.resolution
    color = flowing(ink, here, extent).rgb
    # The surface of the ink catches light from the upper left.
    right, up = vec2(1.0, 0.0), vec2(0.0, 1.0)
    across = flowing(ink, here + right, extent) - flowing(ink, here - right, extent)
    along = flowing(ink, here + up, extent) - flowing(ink, here - up, extent)
    slope = vec2(dot(across.rgb, vec3(1.0)), dot(along.rgb, vec3(1.0)))
    gleam = max(dot(slope, vec2(-0.7, 0.7)), 0.0)
    light = vec3(0.006, 0.007, 0.012) + color * (0.5 + color) + gleam * 0.35 * color
    return (1.0 - exp(-1.6 * light)) ** vec3(0.4545)
