"""Guidance of a camera that a person moves: it never enters a solid, and it frames the scene.

Input: the five numbers of a camera and those that a gesture asks for, or a view that a key asks
for; the safe field, the box of the finite parts. Output: the five numbers that the camera
gets, and where it then is. Called once for each event, by windows, pages and notebooks.

The eye moves along the way that the gesture asks for, in steps that are shorter than the distance
to the nearest surface, so that it passes through no wall. Where a step would come too close, the
same step is tried without zoom, without pitch, without yaw, and then with one of the three alone:
the camera slides along the wall or goes around it. If all are blocked, it stops.
"""

from __future__ import annotations

from distal.fields.guarantees import ENDLESS, UNBOUNDED, Bounds
from distal.lang import (
    Field3,
    abs,
    asin,
    atan2,
    clamp,
    cross,
    dot,
    exp,
    float_bits_to_int,
    floor,
    func,
    length,
    log,
    max,
    min,
    normalize,
    round,
    select,
    struct,
    vec2,
    vec3,
    vec4,
)
from distal.render.steer import Lens, Steer, moved_eye, rig, rotation

# What a person asks for: to go to a goal, to see the whole scene, or to see it from an axis.
ACTIONS = ("go", "frame", "front", "back", "right", "left", "top", "bottom")
GO, FRAME, FRONT, BACK, RIGHT, LEFT, TOP, BOTTOM = range(len(ACTIONS))
# The numbers that hosts get, in the order of ``number_of``.
NUMBERS = (
    *("yaw", "pitch", "zoom", "pan_x", "pan_y", "arrived", "clearance", "opening", "height"),
    *("eye_x", "eye_y", "eye_z", "target_x", "target_y", "target_z", "up_x", "up_y", "up_z"),
)
# The eye keeps this fraction of its distance from the pivot, but no less than this fraction of the
# author's distance, and no more than this fraction of the clearance that the author's camera has.
_CLEAR = 0.02
_LEAST_CLEAR = 0.004
_OF_START = 0.8
# The shortest step, as a fraction of the distance: a camera that starts on a surface leaves it.
_LEAST_STRIDE = 1e-3
# Field evaluations in one event. A drag along a wall advances by half of the clearance each time.
_ROUNDS = 320
# The parts of a step to try, three bits each from the last: yaw with the horizontal part of a pan
# (1), pitch with the vertical part (2), zoom (4). All, then without zoom, pitch, yaw, then alone.
_PARTS = 0o4216537
_PARTS_COUNT = 7
_STILL = 1e-5
# A part that is so many times larger than the box of all others is their ground.
_GROUND = 6.0
# The box fills the picture but for this margin.
_MARGIN = 1.12
_NEAREST, _FARTHEST = 0.015625, 64.0
# A view from an axis whose eye is inside a solid, such as the ground, is raised by such steps.
_RISE = 0.12
_RISES = 24
_PI = 3.14159265358979
_LEVEL = 1e-4


@struct
class Guided:
    """The movement that a camera gets, and where it then is.

    Attributes:
        steer: The five numbers.
        arrived: Whether they are those of the goal.
        eye: Position of the camera.
        target: The point that it looks at, at the distance of its pivot.
        up: The direction that is up in its picture.
        opening: The angle from the bottom of its picture to the top, in degrees.
        height: Height of what it sees without perspective; 0 in perspective.
        clearance: Distance of the eye from the nearest surface, at least; negative inside a solid.
    """

    steer: Steer
    arrived: bool
    eye: vec3
    target: vec3
    up: vec3
    opening: float
    height: float
    clearance: float


# The box of the finite parts


@struct
class FiniteParts:
    """The boxes of the finite parts that were found so far.

    Attributes:
        largest: The largest box.
        others: The box around all others.
    """

    largest: Bounds
    others: Bounds


@func
def no_parts() -> FiniteParts:
    """Return the boxes of no part."""
    nothing = Bounds(vec3(UNBOUNDED), vec3(-UNBOUNDED))
    return FiniteParts(nothing, nothing)


@func
def joined(a: Bounds, b: Bounds) -> Bounds:
    """Return the box around two boxes."""
    return Bounds(min(a.low, b.low), max(a.high, b.high))


@func
def extent(box: Bounds) -> float:
    """Return the length of a box's diagonal; 0 for the box of nothing."""
    return length(max(box.high - box.low, 0.0))


@func
def with_part(parts: FiniteParts, bounds: Bounds) -> FiniteParts:
    """Return the boxes with that of another part, unless the part is infinite."""
    size = max(abs(bounds.low), abs(bounds.high))
    larger = extent(bounds) > extent(parts.largest)
    smaller = joined(parts.others, bounds)
    displaced = joined(parts.others, parts.largest)
    largest = Bounds(
        select(larger, bounds.low, parts.largest.low),
        select(larger, bounds.high, parts.largest.high),
    )
    others = Bounds(
        select(larger, displaced.low, smaller.low), select(larger, displaced.high, smaller.high)
    )
    finite = max(size.x, max(size.y, size.z)) < ENDLESS
    return FiniteParts(
        Bounds(
            select(finite, largest.low, parts.largest.low),
            select(finite, largest.high, parts.largest.high),
        ),
        Bounds(
            select(finite, others.low, parts.others.low),
            select(finite, others.high, parts.others.high),
        ),
    )


@func
def box_of(parts: FiniteParts) -> Bounds:
    """Return the box of the scene: of all finite parts, without one that is only their ground."""
    size = extent(parts.others)
    ground = size > 0.0 and extent(parts.largest) > _GROUND * size
    whole = joined(parts.others, parts.largest)
    return Bounds(
        select(ground, parts.others.low, whole.low), select(ground, parts.others.high, whole.high)
    )


# Framing


@func
def framed(lens: Lens, box: Bounds, aspect: float, yaw: float, pitch: float) -> Steer:
    """Return the numbers of a camera that shows a whole box, as large as the picture allows.

    At the distance of a corner the picture is ``spread * zoom + tangent * distance`` high, which
    gives the least zoom for it; the zoom is the largest of the eight.

    Args:
        lens: The author's camera.
        box: The box; without volume, the author's distance is kept.
        aspect: Width of the picture divided by its height.
        yaw: Angle of the orbit to the right, in radians.
        pitch: Angle of the orbit upwards, in radians.
    """
    turn = rotation(lens, yaw, pitch)
    across, upward, ahead = turn @ lens.across, turn @ lens.upward, turn @ lens.ahead
    wide, high = length(across), length(upward)
    middle = 0.5 * (box.low + box.high) - lens.pivot
    half = 0.5 * (box.high - box.low)
    zoom = 0.0
    for corner in range(8):
        sign = vec3(float(corner & 1), float((corner >> 1) & 1), float(corner >> 2)) * 2.0 - 1.0
        aside = half * sign
        beyond = dot(middle + aside, ahead)
        need = max(abs(dot(aside, across)) / (wide * aspect), abs(dot(aside, upward)) / high)
        fitting = (_MARGIN * need - lens.tangent * beyond) / high
        zoom = max(zoom, max(fitting, (0.1 * length(half) - beyond) / lens.depth))
    zoom = clamp(zoom, _NEAREST, _FARTHEST)
    pan = vec2(dot(middle, across) / (wide * wide), dot(middle, upward) / (high * high))
    nothing = box.high.x < box.low.x
    return Steer(yaw, pitch, select(nothing, 1.0, zoom), select(nothing, vec2(0.0), -pan / zoom))


@func
def axis_of(action: int, axis: vec3) -> vec3:
    """Return the direction from the scene to the eye of a view from an axis.

    The top is in the direction of ``axis``; the right is +x, and the front is +z if y is up, -y if
    z is up.
    """
    level = vec3(1.0, 0.0, 0.0) - axis * axis.x
    rolled = vec3(0.0, 0.0, 1.0) - axis * axis.z
    right = normalize(select(dot(level, level) > _LEVEL, level, rolled))
    front = cross(right, axis)
    found = select(action < RIGHT, front, select(action < TOP, right, axis))
    return select(action % 2 == 1, -found, found)


@func
def wrapped(angle: float) -> float:
    """Return an angle between -pi and pi, in radians."""
    return angle - 2.0 * _PI * round(angle / (2.0 * _PI))


@func
def angles_of(lens: Lens, action: int, now: Steer) -> vec2:
    """Return the yaw and pitch of a view; those that the camera has, if the view only frames."""
    towards = axis_of(action, lens.axis)
    back = -lens.ahead
    height = dot(towards, lens.axis)
    level = back - lens.axis * dot(back, lens.axis)
    right = cross(lens.axis, level)
    turned = atan2(dot(towards, right), dot(towards, level)) * lens.side
    # From the top and from the bottom the picture is turned as from the front.
    front = axis_of(FRONT, lens.axis)
    poled = atan2(dot(front, right), dot(front, level)) * lens.side
    yaw = select(abs(height) > 0.5, poled, turned)
    started = asin(clamp(dot(back, lens.axis), -1.0, 1.0))
    pitch = asin(clamp(height, -1.0, 1.0)) - started
    return select(action == FRAME, vec2(now.yaw, now.pitch), vec2(wrapped(yaw), pitch))


# The way of the eye


@func
def least_clearance(depth: float, zoom: float, start: float) -> float:
    """Return how far the eye must be from surfaces.

    Args:
        depth: The author's distance from the pivot.
        zoom: Factor on it.
        start: Distance of the author's camera from surfaces; not positive if it is inside a solid.
    """
    usual = depth * max(_CLEAR * zoom, _LEAST_CLEAR)
    return select(start > 0.0, min(usual, _OF_START * start), usual)


@func
def remaining(now: Steer, goal: Steer, attempt: int) -> Steer:
    """Return the rest of the way, of the parts that an attempt moves; zoom as its logarithm."""
    parts = _PARTS >> (3 * attempt)
    yaw = select((parts & 1) != 0, 1.0, 0.0)
    pitch = select((parts & 2) != 0, 1.0, 0.0)
    zoom = select((parts & 4) != 0, 1.0, 0.0)
    return Steer(
        wrapped(goal.yaw - now.yaw) * yaw,
        (goal.pitch - now.pitch) * pitch,
        log(goal.zoom / now.zoom) * zoom,
        (goal.pan - now.pan) * vec2(yaw, pitch),
    )


@func
def size_of(rest: Steer) -> float:
    """Return the sum of the rest of the way's parts."""
    return abs(rest.yaw) + abs(rest.pitch) + abs(rest.zoom) + abs(rest.pan.x) + abs(rest.pan.y)


@func
def way_of_eye(lens: Lens, now: Steer, rest: Steer) -> float:
    """Return a bound on the length of the eye's way.

    The eye turns at its distance from the pivot, and a drag moves it beside that.
    """
    zoom = now.zoom * max(exp(rest.zoom), 1.0)
    wide, high = length(lens.across), length(lens.upward)
    across = wide * (abs(now.pan.x) + abs(rest.pan.x))
    upward = high * (abs(now.pan.y) + abs(rest.pan.y))
    arm = length(lens.eye - lens.pivot) + across + upward
    turned = arm * (abs(rest.yaw) + abs(rest.pitch) + abs(rest.zoom))
    return zoom * (turned + wide * abs(rest.pan.x) + high * abs(rest.pan.y))


@func
def advanced(now: Steer, rest: Steer, share: float) -> Steer:
    """Return the numbers after a share of the rest of the way."""
    zoom = now.zoom * exp(rest.zoom * share)
    yaw = now.yaw + rest.yaw * share
    return Steer(wrapped(yaw), now.pitch + rest.pitch * share, zoom, now.pan + rest.pan * share)


@func
def chosen(first: bool, a: Steer, b: Steer) -> Steer:
    """Return ``a`` if ``first`` is true, else ``b``."""
    return Steer(
        select(first, a.yaw, b.yaw),
        select(first, a.pitch, b.pitch),
        select(first, a.zoom, b.zoom),
        select(first, a.pan, b.pan),
    )


@func
def guided(
    action: int,
    now: Steer,
    goal: Steer,
    lens: Lens,
    size: vec2,
    box: Bounds,
    field: Field3,
) -> Guided:
    """Return the movement that a camera gets.

    A camera that is inside a solid, because the author put it there or the scene moves, goes
    wherever the gesture asks it to.

    Args:
        action: ``GO``, ``FRAME`` or a view from an axis.
        now: The numbers that the camera has.
        goal: The numbers that a gesture asks for; ignored unless ``action`` is ``GO``.
        lens: The author's camera.
        size: Width and height of the picture, in any unit.
        box: The box of the scene's finite parts.
        field: The safe field of the scene: never more than the distance to its surface.
    """
    here = now
    angles = angles_of(lens, action, now)
    # The first round measures the author's place, the second the present one.
    trial = Steer(0.0, 0.0, 1.0, vec2(0.0))
    start = 0.0
    clearance = 0.0
    attempt = 0
    moves = True
    arrived = False
    going = action == GO
    # Without branches: some drivers need twice the time to compile for each.
    for k in range(_ROUNDS):
        distance = field(moved_eye(lens, trial))
        start = select(k == 0, distance, start)
        required = least_clearance(lens.depth, trial.zoom, start)
        # A camera that is too close already, for the scene has moved, comes no closer.
        enough = select(going, min(required, clearance * 0.9999), required)
        taken = moves and k > 0 and (k == 1 or distance >= enough)
        here = chosen(taken, trial, here)
        clearance = select(taken, distance, clearance)
        inside = going and k == 1 and distance <= 0.0
        here = chosen(inside, goal, here)
        attempt = select(k < 2 or taken, 0, attempt + 1)
        through = size_of(remaining(here, goal, 0)) < _STILL
        arrived = select(going, k > 0 and through, k > 1 and taken)
        if arrived or attempt >= select(going, _PARTS_COUNT, _RISES):
            break
        part = remaining(here, goal, min(attempt, _PARTS_COUNT - 1))
        moves = k == 0 or not going or size_of(part) > 0.0
        kept = min(least_clearance(lens.depth, here.zoom, start), clearance)
        least = _LEAST_STRIDE * lens.depth * here.zoom
        stride = max(max(clearance - kept, 0.5 * kept), least)
        share = min(stride / max(way_of_eye(lens, here, part), 1e-20), 1.0)
        pitch = min(angles.y + _RISE * float(attempt), 0.5 * _PI)
        seen = framed(lens, box, size.x / size.y, angles.x, pitch)
        trial = chosen(k == 0, now, chosen(going, advanced(here, part, share), seen))
    return seen_from(lens, here, arrived, clearance)


@func
def seen_from(lens: Lens, steer: Steer, arrived: bool, clearance: float) -> Guided:
    """Return a movement with the place of the camera.

    Args:
        lens: The author's camera.
        steer: The five numbers.
        arrived: Whether the camera is where it was asked to go.
        clearance: Distance of the eye from the nearest surface.
    """
    motion = rig(lens, steer)
    eye = moved_eye(lens, steer)
    ahead = motion.turn @ lens.ahead
    upward = normalize(motion.turn @ lens.upward)
    right = cross(ahead, upward)
    # The author's axis is up, unless the camera is rolled or looks along the axis.
    upright = abs(dot(right, lens.axis)) < _LEVEL and dot(upward, lens.axis) > 1e-3
    return Guided(
        steer,
        arrived,
        eye,
        eye + ahead * (lens.depth * steer.zoom),
        select(upright, lens.axis, upward),
        lens.opening * (180.0 / _PI),
        2.0 * lens.spread * steer.zoom,
        clearance,
    )


# Numbers for hosts


@func
def number_of(guided: Guided, index: int) -> float:
    """Return one of the numbers in the order of ``NUMBERS``."""
    steer = guided.steer
    row = index // 3
    found = vec3(steer.yaw, steer.pitch, steer.zoom)
    arrived = select(guided.arrived, 1.0, 0.0)
    found = select(row == 1, vec3(steer.pan.x, steer.pan.y, arrived), found)
    found = select(row == 2, vec3(guided.clearance, guided.opening, guided.height), found)
    found = select(row == 3, guided.eye, found)
    found = select(row == 4, guided.target, found)
    found = select(row == 5, guided.up, found)
    return found[index % 3]


@func
def bytes_of(number: float) -> vec4:
    """Return the bits of a float as four bytes, the lowest first; 1 stands for 255."""
    bits = float_bits_to_int(number)
    return (
        vec4(
            float(bits & 255),
            float((bits >> 8) & 255),
            float((bits >> 16) & 255),
            float((bits >> 24) & 255),
        )
        / 255.0
    )


@func
def asked(coord: vec2, action: int) -> int:
    """Return the action, as a value of the pixel.

    What is the same for all pixels is moved into the vertex stage of a page, and a struct there is
    computed once for each of its members: the way of the eye would be found eleven times.
    """
    return select(coord.x < 0.0, GO, action)


@func
def pixel_of(guided: Guided, coord: vec2) -> vec4:
    """Return the pixel of a number in the row of all numbers."""
    return bytes_of(number_of(guided, int(floor(coord.x))))
