"""Ten pieces in the way of shader artists: each reads its own past, keys or buttons.

All values stay where floats of all targets agree; the cells of ``life`` are whole numbers.
"""

from __future__ import annotations

from distal.lang import (
    Frame,
    Key,
    Texture2D,
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
    pcg,
    sample,
    sin,
    size,
    slider,
    texel,
    uint,
    vec2,
    vec3,
    vec4,
)

fading = slider("Fading", 0.9)


@func
def here(frame: Frame) -> ivec2:
    return ivec2(frame.coord)


# 1: a comet with a tail


@buffer
def tail(frame: Frame) -> vec4:
    uv = frame.coord / frame.resolution
    head = vec2(0.5) + 0.35 * vec2(cos(frame.time * 9.0), sin(frame.time * 6.0))
    spot = exp(-60.0 * dot(uv - head, uv - head))
    return max(texel(tail, here(frame)) * fading, vec4(spot, spot * spot, 0.5 * spot, 1.0))


@image
def comet(frame: Frame) -> vec3:
    return sample(tail, frame.coord / frame.resolution).rgb


# 2: the game of life, on a torus


@func
def cell(cells: Texture2D, place: ivec2) -> int:
    extent = size(cells)
    wrapped = ivec2(place.x % extent.x, place.y % extent.y)
    return int(texel(cells, wrapped).x + 0.5)


@buffer
def cells(frame: Frame) -> vec4:
    at = here(frame)
    if frame.index == 0:
        return vec4(float(pcg(uint(at.x + 64 * at.y)) % uint(3) == uint(0)))
    around = -cell(cells, at)
    for x in range(-1, 2):
        for y in range(-1, 2):
            around += cell(cells, at + ivec2(x, y))
    lives = around == 3 or (around == 2 and cell(cells, at) == 1)
    return vec4(1.0 if lives else 0.0)


@image
def life(frame: Frame) -> vec3:
    return vec3(texel(cells, here(frame)).x)


# 3: reaction and diffusion


@buffer
def chemicals(frame: Frame) -> vec4:
    at, middle = here(frame), 0.5 * frame.resolution
    if frame.index == 0:
        return vec4(1.0, 0.5 if length(frame.coord - middle) < 4.0 else 0.0, 0.0, 1.0)
    now = texel(chemicals, at).xy
    spread = -4.0 * now
    for step in (ivec2(1, 0), ivec2(-1, 0), ivec2(0, 1), ivec2(0, -1)):
        spread += texel(chemicals, at + step).xy
    made = now.x * now.y * now.y
    change = vec2(0.2 * spread.x - made + 0.04 * (1.0 - now.x), 0.1 * spread.y + made - 0.1 * now.y)
    return vec4(clamp(now + change, vec2(0.0), vec2(1.0)), 0.0, 1.0)


@image
def reaction(frame: Frame) -> vec3:
    return vec3(texel(chemicals, here(frame)).xy, 0.5)


# 4: waves: the height now, and the height of the last frame


@buffer
def heights(frame: Frame) -> vec4:
    at = here(frame)
    now = texel(heights, at)
    sides = texel(heights, at + ivec2(1, 0)).x + texel(heights, at - ivec2(1, 0)).x
    sides += texel(heights, at + ivec2(0, 1)).x + texel(heights, at - ivec2(0, 1)).x
    next = 0.98 * (0.5 * sides - now.y)
    drop = 0.6 * frame.resolution
    if frame.index % 4 == 0 and length(frame.coord - drop) < 2.0:
        next += 0.5
    return vec4(next, now.x, 0.0, 1.0)


@image
def waves(frame: Frame) -> vec3:
    return vec3(0.5 + 0.5 * texel(heights, here(frame)).x)


# 5: a picture inside its own last one


@image
def tunnel(frame: Frame) -> vec3:
    uv = frame.coord / frame.resolution
    inner = 0.5 + (uv - 0.5) * 1.25
    last = sample(tunnel, inner).rgb
    border = max(abs(uv.x - 0.5), abs(uv.y - 0.5)) > 0.4
    return vec3(uv, 0.5 + 0.5 * sin(frame.time * 8.0)) if border else 0.9 * last.gbr


# 6: a pen; C clears the sheet


@buffer
def sheet(frame: Frame) -> vec4:
    if key_pressed(ord_c):
        return vec4(0.0)
    ink = texel(sheet, here(frame))
    near = length(frame.coord - frame.mouse.xy) < 3.0
    if frame.mouse.z > 0.0 and near:
        ink = vec4(1.0, 0.5 if frame.buttons == 1 else 0.0, 0.0, 1.0)
    return ink


ord_c = ord("C")


@image
def pen(frame: Frame) -> vec3:
    return texel(sheet, here(frame)).rgb


# 7: a ball moved by keys, whose state is one texel


@buffer
def state(frame: Frame) -> vec4:
    ball = texel(state, ivec2(0, 0)).xy
    if frame.index == 0:
        ball = vec2(0.5)
    way = vec2(0.0)
    way.x += float(key_held(Key.RIGHT)) - float(key_held(Key.LEFT))
    way.y += float(key_held(Key.UP)) - float(key_held(Key.DOWN))
    return vec4(clamp(ball + way * frame.delta * 4.0, vec2(0.0), vec2(1.0)), 0.0, 1.0)


@image
def ball(frame: Frame) -> vec3:
    place = texel(state, ivec2(0, 0)).xy * frame.resolution
    glow = exp(-0.05 * dot(frame.coord - place, frame.coord - place))
    return vec3(glow, 0.5 * glow, 1.0 if key_toggled(Key.SPACE) else 0.0)


# 8: the mean of all frames so far


@buffer
def sums(frame: Frame) -> vec4:
    at = here(frame)
    random = pcg(uint(at.x + 61 * at.y) + uint(7919 * frame.index))
    shade = float(random % uint(256)) / 256.0
    return texel(sums, at) + vec4(vec3(shade), 1.0)


@image
def mean(frame: Frame) -> vec3:
    total = texel(sums, here(frame))
    return total.rgb / total.w


# 9: four buffers in a row: each blurs the one before it, along one axis


@func
def blurred(texture: Texture2D, at: ivec2, step: ivec2) -> vec4:
    total = vec4(0.0)
    for i, weight in enumerate((0.25, 0.5, 0.25)):
        total += weight * texel(texture, at + step * (i - 1))
    return total


@buffer
def dots(frame: Frame) -> vec4:
    at = here(frame)
    return vec4(1.0 if (at.x + frame.index) % 8 == 0 and at.y % 6 == 0 else 0.0)


@buffer
def across(frame: Frame) -> vec4:
    return blurred(dots, here(frame), ivec2(1, 0))


@buffer
def upward(frame: Frame) -> vec4:
    return blurred(across, here(frame), ivec2(0, 1))


@buffer
def slow(frame: Frame) -> vec4:
    return mix(texel(slow, here(frame)), texel(upward, here(frame)), 0.25)


@image
def blur(frame: Frame) -> vec3:
    at = here(frame)
    return vec3(texel(upward, at).x, texel(slow, at).x, texel(dots, at).x)


# 10: two buffers that read each other: the first one reads the last frame of the second


@buffer
def ahead(frame: Frame) -> vec4:
    at = here(frame)
    return 0.5 * texel(behind, at + ivec2(1, 0)) + vec4(frame.coord.x / frame.resolution.x * 0.5)


@buffer
def behind(frame: Frame) -> vec4:
    return 1.0 - texel(ahead, here(frame) + ivec2(0, 1))


@image
def chase(frame: Frame) -> vec4:
    at = here(frame)
    return vec4(texel(ahead, at).x, texel(behind, at).x, 0.25, 1.0)


PIECES = (comet, life, reaction, waves, tunnel, pen, ball, mean, blur, chase)
