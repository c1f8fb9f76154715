"""The number of steps of each ray as a color: blue is cheap, yellow is dear."""

from distal.lang import (
    Frame,
    abs,
    clamp,
    func,
    image,
    integer,
    length,
    max,
    min,
    mix,
    normalize,
    slider,
    toggle,
    vec2,
    vec3,
)

steps = integer("Max steps", 100, low=4, high=100, help="How often a ray steps before it gives up.")
height = slider("Eye height", 1.2, low=0.1, high=4.0, help="How high the camera is.")
gap = slider("Gap", 0.5, low=0.02, high=1.5, help="The space between the pillars.")
ceiling = toggle("Bound", False, help="Go first, in one step, to the height of the pillars.")

FAR = 40.0
TALL = 1.2


@func
def scene(p: vec3) -> float:
    half = 0.35
    period = 2.0 * half + gap
    x = p.x - period * clamp((p.x / period + 0.5) // 1.0, -2.0, 2.0)
    q = abs(vec3(x, p.y - 0.5 * TALL, p.z)) - vec3(half, 0.5 * TALL, half)
    pillars = length(max(q, 0.0)) + min(max(q.x, max(q.y, q.z)), 0.0)
    return min(pillars, p.y)


@func
def start(origin: vec3, direction: vec3) -> float:
    """Where the march begins: above the pillars nothing can be hit."""
    if not ceiling or origin.y <= TALL:
        return 0.0
    if direction.y >= 0.0:
        return FAR + 1.0
    return (TALL - origin.y) / direction.y


@func
def march(origin: vec3, direction: vec3) -> vec2:
    """How far the ray went, and how many steps it took."""
    t = start(origin, direction)
    count = 0.0
    for _ in range(steps):
        if t > FAR:
            break
        d = scene(origin + direction * t)
        if d < 0.001:
            break
        t += d
        count += 1.0
    return vec2(t, count)


@func
def heat(share: float) -> vec3:
    low = mix(vec3(0.05, 0.07, 0.2), vec3(0.15, 0.45, 0.75), clamp(3.0 * share, 0.0, 1.0))
    middle = mix(low, vec3(0.95, 0.85, 0.35), clamp(3.0 * share - 1.0, 0.0, 1.0))
    return mix(middle, vec3(1.0, 1.0, 0.95), clamp(3.0 * share - 2.0, 0.0, 1.0))


@image
def cost(frame: Frame) -> vec3:
    uv = (frame.coord - 0.5 * frame.resolution) / frame.resolution.y
    eye = vec3(0.4, height, 4.2)
    tilt = 0.25 * (0.6 - height)
    direction = normalize(vec3(uv.x, uv.y + tilt, -1.1))
    marched = march(eye, direction)
    t = marched.x
    count = marched.y
    return heat(count / 60.0) if t >= 0.0 else vec3(0.0)
