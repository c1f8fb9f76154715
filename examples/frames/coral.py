"""Two chemicals that react and spread (Gray and Scott, 1983) grow a coral; it is lit from the side.

Four buffers are four steps of each frame: each reads the one before it, the first one the last
frame. Press the mouse to seed; space dissolves all but a spot. Try: ``--set Feed=0.03``.
"""

from distal.lang import (
    Frame,
    Key,
    Texture2D,
    buffer,
    clamp,
    func,
    image,
    ivec2,
    key_pressed,
    length,
    mix,
    normalize,
    pcg,
    size,
    slider,
    smoothstep,
    texel,
    uint,
    vec2,
    vec3,
    vec4,
)

feed = slider("Feed", 0.037, 0.01, 0.08, help="How fast food flows in.")
decay = slider("Decay", 0.06, 0.045, 0.07, help="How fast the coral dissolves.")

SIDES = (ivec2(1, 0), ivec2(-1, 0), ivec2(0, 1), ivec2(0, -1))
CORNERS = (ivec2(1, 1), ivec2(-1, 1), ivec2(1, -1), ivec2(-1, -1))


@func
def at(cells: Texture2D, place: ivec2) -> vec2:
    """Food and coral of a cell; the edges of the picture are joined."""
    extent = size(cells)
    return texel(cells, ivec2(place.x % extent.x, place.y % extent.y)).xy


@func
def grown(cells: Texture2D, place: ivec2) -> vec4:
    """One step of the reaction."""
    now = at(cells, place)
    around = -now
    for side in SIDES:
        around += 0.2 * at(cells, place + side)
    for corner in CORNERS:
        around += 0.05 * at(cells, place + corner)
    eaten = now.x * now.y * now.y
    change = vec2(feed * (1.0 - now.x) - eaten, eaten - (feed + decay) * now.y)
    return vec4(clamp(now + vec2(1.0, 0.5) * around + change, 0.0, 1.0), 0.0, 1.0)


@buffer
def first(frame: Frame) -> vec4:
    place = ivec2(frame.coord)
    if frame.index == 0 or key_pressed(Key.SPACE):
        tile = place // 24
        middle = ivec2(frame.resolution) // 48
        is_seed = pcg(uint(tile.x + 131 * tile.y)) % uint(9) == uint(0)
        is_seed = is_seed or (tile.x == middle.x and tile.y == middle.y)
        inside = length(vec2(place % 24) - 12.0) < 5.0
        return vec4(1.0, 0.5 if is_seed and inside else 0.0, 0.0, 1.0)
    cell = grown(fourth, place)
    if frame.buttons == 1 and length(frame.coord - frame.mouse.xy) < 6.0:
        cell = vec4(cell.x, 0.5, 0.0, 1.0)
    return cell


@buffer
def second(frame: Frame) -> vec4:
    return grown(first, ivec2(frame.coord))


@buffer
def third(frame: Frame) -> vec4:
    return grown(second, ivec2(frame.coord))


@buffer
def fourth(frame: Frame) -> vec4:
    return grown(third, ivec2(frame.coord))


@image
def coral(frame: Frame) -> vec3:
    place = ivec2(frame.coord)
    height = at(fourth, place).y
    slope = vec2(
        at(fourth, place + SIDES[0]).y - at(fourth, place + SIDES[1]).y,
        at(fourth, place + SIDES[2]).y - at(fourth, place + SIDES[3]).y,
    )
    normal = normalize(vec3(-9.0 * slope, 1.0))
    sun = clamp(normal.x * -0.5 + normal.y * 0.6 + normal.z * 0.62, 0.0, 1.0)
    depth = smoothstep(0.02, 0.34, height)
    deep, shallow = vec3(0.004, 0.018, 0.045), vec3(0.005, 0.10, 0.14)
    water = mix(deep, shallow, smoothstep(0.35, 0.85, at(fourth, place).x) * 0.7)
    flesh = mix(vec3(0.75, 0.16, 0.12), vec3(1.0, 0.66, 0.42), smoothstep(0.16, 0.38, height))
    light = mix(water * (0.75 + 0.25 * sun), flesh * (0.25 + 0.95 * sun), depth)
    gleam = clamp(sun - 0.86, 0.0, 1.0) * 3.0 * depth
    return (light + gleam) ** vec3(0.4545)
