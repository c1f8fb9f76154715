"""Scene code that uses everything a target could trip over, one image for each corner."""

from __future__ import annotations

from enum import IntEnum

from distal.lang import (
    Buffer,
    Frame,
    Texture2D,
    Texture3D,
    TextureCube,
    abs,
    all,
    any,
    array,
    bvec2,
    bvec3,
    choice,
    clamp,
    color,
    cos,
    determinant,
    dot,
    exp,
    floor,
    func,
    image,
    integer,
    inverse,
    ivec2,
    ivec3,
    length,
    mat2,
    mat3,
    max,
    min,
    mix,
    normalize,
    pcg,
    point,
    sample,
    select,
    sin,
    size,
    slider,
    sqrt,
    struct,
    texel,
    toggle,
    transpose,
    uint,
    uvec2,
    vec2,
    vec3,
    vec4,
)

TABLE = (0.25, 0.5, 0.125, 1.0, 0.75)
filter_strength = slider("Filter", 0.5)
flip = toggle("Flip", True)
mode = choice("Mode", ("one", "two", "three"), "two")
count = integer("Count", 5, low=1, high=9)
tint = color("Tint", "#ff8040")
place = point("Place", (0.25, 0.5))


photo = Texture2D("photo.png", wrap="repeat")
sky = TextureCube("sky.png")
smoke = Texture3D("smoke.raw", wrap="clamp")
heights = Buffer([0.25, 0.5, 0.75, 1.0, 0.125, 0.375, 0.625, 0.875, 0.3125])
counts = Buffer([3, 1, 4])
places = Buffer([(0.1, 0.2, 0.3), (0.4, 0.5, 0.6), (0.7, 0.8, 0.9)])


class Side(IntEnum):
    LEFT = 1
    RIGHT = 2


@struct
class Hit:
    distance: float
    normal: vec3
    weights: array[float, 3]
    material: int


@func
def quotient(a: int, b: int) -> int:
    return a // b + a % b


@func
def nearest(p: vec2) -> Hit:
    hit = Hit(distance=length(p), normal=vec3(p, 1.0), weights=[0.5, 0.25, 0.125], material=1)
    if p.x > 0.5:
        hit.material = 2
        hit.weights[1] = p.y
        hit.normal.xy = hit.normal.yx
    return hit


@func
def collatz(n: int) -> int:
    steps = 0
    while n != 1 and steps < 50:
        steps += 1
        if n % 2 == 0:
            n = n // 2
            continue
        n = 3 * n + 1
    return steps


@func
def sorted_pair(a: float, b: float) -> tuple[float, float]:
    return (a, b) if a < b else (b, a)


@image
def statements(frame: Frame) -> vec3:
    uv = frame.coord / frame.resolution
    hit = nearest(uv)
    total = 0.0
    for i in range(3):
        total += hit.weights[i]
    for i in range(9, -1, -3):
        if i == 3:
            continue
        total += float(i) * 0.01
    for value in TABLE:
        if value > 0.9:
            break
        total += value * 0.1
    low, high = sorted_pair(uv.x, uv.y)
    steps = collatz(int(frame.coord.x) + 1)
    return vec3(total * 0.5, low + high * 0.25, float(steps) / 50.0) * hit.normal.x


@image
def reserved_words(frame: Frame) -> vec3:
    sample = frame.coord / frame.resolution
    texture = sample.x
    half = 0.5
    main = texture * half
    gl_thing = main + 0.25
    sampler = gl_thing * gl_thing
    let = sampler
    var = let
    fn = var
    a__b = fn + filter_strength
    out = vec3(a__b, texture, half)
    return out


@image
def integers(frame: Frame) -> vec3:
    x = int(frame.coord.x) - 40
    y = int(frame.coord.y) - 30
    a = quotient(x, 7) + quotient(x, -3) + x // y + x % y
    b = (x << 3) ^ (y >> 1) | (x & 15)
    c = ~a & 255
    wide = 2147483647 + x
    lowest = -2147483648 - x
    d = ivec2(x, y) * 3 % 5 - ivec2(y, x) // 2
    negative = -x
    e = -negative - -y
    u = uint(x) * uint(2654435761) >> uint(7)
    v = uvec2(u, ~u) << uvec2(3, 5)
    f = int(v.x ^ v.y) & 255
    g = (wide & 7) + (lowest & 7) + d.x - d.y + e
    return vec3(float(a & 255), float((b ^ c) & 255), float((f + g) & 255)) / 255.0


@image
def booleans(frame: Frame) -> vec3:
    p = frame.coord / frame.resolution
    a = p.x < 0.5
    b = (p.y > 0.25 and not a) or p.x > 0.75
    both = bvec2(a, b)
    c = all(both) or any(both) != a
    d = bvec3(a, b, c)
    e = select(d, vec3(0.25, 0.5, 0.75), vec3(p, 1.0))
    f = select(d, ivec3(1, 2, 3), ivec3(4, 5, 6))
    g = select(both, both, bvec2(c, a))
    h = 0.5 if a == b else 0.25 if flip else 0.125
    chained = 0.1 < p.x < 0.9
    i = p < vec2(0.3, 0.6)
    j = (a & b) ^ (b | c)
    more = any(i & both) or all(i | both) or any(i ^ g) or j
    k = float(f.x + f.y * 2 + f.z * 4) / 64.0
    return e * h + vec3(float(chained), float(more), k) * 0.25


@image
def matrices(frame: Frame) -> vec3:
    p = frame.coord / frame.resolution
    c = cos(frame.time)
    s = sin(frame.time)
    turn = mat2(vec2(c, s), vec2(-s, c))
    m = mat3(vec3(2.0, p.x, 0.5), vec3(0.25, 3.0, p.y), vec3(0.125, p.x, 4.0))
    n = transpose(inverse(m)) * 2.0 / 3.0 + m - m @ m * 0.125
    column = n[int(p.x * 3.0)]
    n[1] = column * 0.5
    n[int(p.y * 3.0)].x = 0.25
    v = m @ vec3(turn @ p, 1.0) + vec3(p, 1.0) @ n
    v[int(p.y * 3.0)] = determinant(m) * 0.01
    v.zx = v.xy
    return abs(v) * 0.125


@func
def bump(cells: array[float, 4], at: int) -> array[float, 4]:
    changed = cells
    changed[at] = cells[at] + 1.0
    return changed


@image
def arrays(frame: Frame) -> vec3:
    p = frame.coord / frame.resolution
    cells = bump([0.1, 0.2, 0.3, 0.4], int(p.x * 4.0))
    grid = [[1.0, 2.0], [3.0, p.x], [5.0, p.y]]
    grid[1][int(p.y * 2.0)] = 0.5
    other = bump(cells, 2) if p.x > 0.5 else cells
    picked = cells[int(p.y * 8.0)] + other[2] + TABLE[int(p.x * 5.0)]
    return vec3(picked * 0.25, grid[int(p.x * 3.0)][int(p.y * 2.0)] * 0.2, other[3])


@func
def heavy(x: float) -> float:
    total = 0.0
    for i in range(20):
        total += sin(x + float(i)) * exp(-0.1 * float(i))
        if total > 4.0:
            return total
    return total


@image
def choices(frame: Frame) -> vec3:
    p = frame.coord / frame.resolution
    a = heavy(p.x) if p.y > 0.5 else (heavy(p.y) if p.x > 0.5 else 0.25)
    ok = p.x > 0.3 and (heavy(p.x) if p.y > 0.2 else 0.0) > 1.0
    b = 1.0 if ok else 0.0
    i = 0
    while (heavy(float(i)) if i < 3 else 0.5) > 0.25 and i < 6:
        i += 1
    return vec3(a * 0.25, b, float(i) * 0.125)


@image
def per_frame(frame: Frame) -> vec3:
    p = frame.coord / frame.resolution
    phase = sin(frame.time * 2.0) * 0.5 + 0.5
    axis = normalize(vec3(cos(frame.time), sin(frame.time), 0.5))
    turn = mat2(vec2(cos(frame.time), sin(frame.time)), vec2(-sin(frame.time), cos(frame.time)))
    beat = int(frame.time * 4.0) * 77 % 5
    on = sin(frame.time * 3.0) > 0.0
    noise = pcg(uint(frame.index + 7))
    q = turn @ (p - place)
    shade = dot(axis, vec3(q, phase)) + float(beat) * 0.125
    extra = float(noise & uint(255)) / 255.0
    return tint * (shade if on else 1.0 - shade) + extra * 0.25 * float(mode) * sqrt(float(count))


@image
def literals(frame: Frame) -> vec4:
    p = frame.coord / frame.resolution
    tiny = 1e-7 * p.x
    huge = 1e20 * p.y
    exact = 16777217.0 - 16777216.0 + 0.1 + 3.0e-5
    side = Side.RIGHT if p.x > 0.5 else Side.LEFT
    return vec4(tiny * 1e6, huge * 1e-20, mix(exact, 123456.789, p.x) * 1e-6, float(side) * 0.5)


@image
def clamps(frame: Frame) -> vec3:
    p = frame.coord / frame.resolution - 0.5
    v = vec3(p, -p.x)
    w = clamp(v, 0.0, 1.0) + min(v, 0.25) * max(v, -0.25) - floor(v * 4.0) * 0.125
    return abs(w - (-v)) * 0.5


@image
def textures(frame: Frame) -> vec4:
    p = frame.coord / frame.resolution
    around = sample(photo, p * 1.5 - 0.25)
    single = texel(photo, ivec2(int(p.x * 6.0) - 1, int(p.y * 4.0)))
    # Within a face: GPUs filter across its edge, the prelude does not.
    ray = normalize(vec3(0.9 * (p - 0.5), 1.0))
    within = sample(smoke, vec3(p, 0.3)) + texel(smoke, ivec3(1, 9, 0))
    face = texel(sky, ivec3(int(p.x * 2.0), int(p.y * 2.0), int(p.x * 6.0)))
    shape = size(photo)
    depth = size(smoke)
    count = float(shape.x + shape.y * 2 + depth.z * 4 + size(sky).x) * 0.01
    return (around + single + sample(sky, ray) * 0.5 + within + face) * 0.2 + count


@image
def buffers(frame: Frame) -> vec3:
    p = frame.coord / frame.resolution
    i = int(p.x * 14.0) - 2
    total = heights[i] + float(counts[int(p.y * 5.0)]) * 0.1 + float(size(heights)) * 0.01
    return places[i] * total


@func
def wave(i: int, time: float) -> vec4:
    """Four per-frame numbers, and their number alone is what differs."""
    return vec4(sin(time + float(i)), cos(time * float(i)), exp(-time * float(i)), sqrt(time))


@image
def crowded(frame: Frame) -> vec3:
    p = vec4(frame.coord / frame.resolution, 0.5, 1.0)
    t = frame.time
    turn = mat3(wave(1, t).xyz, wave(2, t).yzw, wave(3, t).xzw)
    total = dot(p, wave(4, t)) + dot(p, wave(5, t)) + dot(p, wave(6, t)) + dot(p, wave(7, t))
    total += dot(p, wave(8, t)) + dot(p, wave(9, t)) + dot(p, wave(10, t)) + dot(p, wave(11, t))
    total += dot(p, wave(12, t)) + dot(p, wave(13, t)) + dot(p, wave(14, t))
    beat = int(sin(t) * 1000.0) // 3
    seed = pcg(uint(beat)) ^ uint(frame.index)
    signs = wave(15, t).xyz < wave(16, t).xyz
    pattern = float((int(frame.coord.x) ^ beat) & 7) + float((uint(frame.coord.y) ^ seed) & uint(7))
    shade = select(signs, vec3(total * 0.125), turn @ p.xyz)
    return abs(shade) * 0.25 + pattern * 0.03125


@image
def far_loops(frame: Frame) -> vec3:
    p = frame.coord / frame.resolution
    x = int(p.x * 4.0)
    total = 0
    for i in range(2147483640 + x, 2147483647, 3):
        total += i & 15
    for i in range(-2147483640 + x, -2147483647, -5):
        if i & 1 == 0:
            continue
        total += i & 31
    for i in range(x, 40 + x, 7):
        total += i
    for _ in range(5, x):
        total += 1000
    return vec3(float(total & 255), float(total >> 8), p.y) / 255.0
