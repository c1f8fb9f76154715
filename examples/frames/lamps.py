"""Light in a plane: glass, mirrors and lamps, by paths whose mean gets better with each frame.

Each frame adds four random paths to each pixel. Drag the mouse to move a lamp: the mean begins
again. Left alone, the picture is finished after a few hundred frames.
"""

from distal.lang import (
    Frame,
    buffer,
    clamp,
    cos,
    dot,
    exp,
    func,
    gradient,
    image,
    ivec2,
    length,
    max,
    min,
    normalize,
    pcg,
    sin,
    slider,
    texel,
    uint,
    vec2,
    vec3,
    vec4,
)

glow = slider("Glow", 0.55, 0.1, 3.0, help="How bright the lamps are.")

PATHS = 4
BOUNCES = 4
STEPS = 40
CLOSE = 0.0015
FAR = 5.0


@func
def disc(p: vec2, middle: vec2, radius: float) -> float:
    return length(p - middle) - radius


@func
def slab(p: vec2, middle: vec2, half: vec2, angle: float) -> float:
    d = p - middle
    q = vec2(cos(angle) * d.x + sin(angle) * d.y, cos(angle) * d.y - sin(angle) * d.x)
    apart = abs(q) - half
    return length(max(apart, 0.0)) + min(max(apart.x, apart.y), 0.0) - 0.015


@func
def mirrors(p: vec2) -> float:
    """The distance to what light bounces from."""
    left = slab(p, vec2(-0.95, -0.1), vec2(0.04, 0.5), 0.35)
    wall = min(left, slab(p, vec2(0.62, -0.45), vec2(0.4, 0.03), 0.5))
    pearls = min(disc(p, vec2(-0.35, -0.42), 0.2), disc(p, vec2(0.12, 0.05), 0.13))
    return min(wall, pearls, slab(p, vec2(0.85, 0.42), vec2(0.16, 0.16), 0.4))


@func
def lamp(p: vec2, hand: vec2) -> vec4:
    """The color of the nearest lamp, and its distance."""
    warm, cold = disc(p, vec2(-0.55, 0.48), 0.1), disc(p, vec2(0.5, 0.15), 0.05)
    moved = disc(p, hand, 0.04)
    if moved < min(warm, cold):
        return vec4(3.6, 0.9, 2.6, moved)
    if warm < cold:
        return vec4(3.4, 1.7, 0.6, warm)
    return vec4(0.7, 2.6, 5.2, cold)


@func
def random(state: uint) -> float:
    return float(state >> uint(8)) / 16777216.0


@func
def arriving(start: vec2, hand: vec2, seed: uint) -> vec3:
    """The light that comes to a place along one random path."""
    state = pcg(seed)
    angle = 6.2831853 * random(state)
    p, direction, share = start, vec2(cos(angle), sin(angle)), vec3(1.0)
    for bounce in range(BOUNCES):
        t, is_lit, is_hit = 0.0, False, False
        for _ in range(STEPS):
            q = p + t * direction
            source, solid = lamp(q, hand), mirrors(q)
            if source.w < CLOSE:
                is_lit = True
                break
            if solid < CLOSE:
                is_hit = True
                break
            t += min(source.w, solid)
            if t > FAR:
                break
        p = p + t * direction
        if is_lit:
            return share * lamp(p, hand).rgb
        if not is_hit:
            return share * vec3(0.012, 0.016, 0.03)
        normal = normalize(gradient(mirrors, p))
        state = pcg(state + uint(bounce))
        # Half of the light is mirrored, half is scattered: towards the normal and a random side.
        turn = 6.2831853 * random(state)
        state = pcg(state + uint(77))
        mirrored = direction - 2.0 * dot(direction, normal) * normal
        scattered = normalize(normal + 0.98 * vec2(cos(turn), sin(turn)))
        direction = mirrored if random(state) < 0.5 else scattered
        share = share * vec3(0.86, 0.84, 0.8)
        p = p + 3.0 * CLOSE * normal
    return vec3(0.0)


@func
def place_of(pixel: vec2, resolution: vec2) -> vec2:
    return (2.0 * pixel - resolution) / resolution.y


@func
def hand_of(frame: Frame) -> vec2:
    """Where the lamp is that the mouse moves."""
    is_moved = frame.mouse.x != 0.0 or frame.mouse.y != 0.0
    return place_of(frame.mouse.xy, frame.resolution) if is_moved else vec2(-0.1, -0.72)


@buffer
def sums(frame: Frame) -> vec4:
    pixel = ivec2(frame.coord)
    before = texel(sums, pixel)
    if frame.index == 0 or frame.buttons == 1:
        before = vec4(0.0)
    seed = pcg(uint(pixel.x) + uint(4099) * uint(pixel.y)) + uint(frame.index * PATHS)
    total = vec3(0.0)
    for i in range(PATHS):
        first, second = pcg(seed + uint(i)), pcg(seed + uint(i + 7919))
        jitter = vec2(random(first), random(second)) - 0.5
        start = place_of(frame.coord + jitter, frame.resolution)
        total += arriving(start, hand_of(frame), first + second)
    return before + vec4(total, float(PATHS))


@image
def picture(frame: Frame) -> vec3:
    total = texel(sums, ivec2(frame.coord))
    light = glow * total.rgb / total.w
    p = place_of(frame.coord, frame.resolution)
    inside = clamp(0.5 - mirrors(p) * frame.resolution.y * 0.5, 0.0, 1.0)
    body = vec3(0.03, 0.032, 0.04) * (1.0 - inside) + inside * vec3(0.045, 0.05, 0.065)
    outside = light * (0.35 + light) * (1.0 - inside)
    return (1.0 - exp(-1.6 * outside - 0.3 * body)) ** vec3(0.4545)
