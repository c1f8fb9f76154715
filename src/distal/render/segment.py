"""Segments of rays: from the eye or from a surface to the next crossing of a signed field.

Input: a field, a ray, the side of the surface on which it runs, and how it leaves the surface on
which it starts. Output: a ``Hit``. A surface is where the field changes its sign by more than its
rounding error, and nowhere else: where faces of two solids cancel (``a - b`` with a common face)
the field comes to zero and goes back, and the ray goes on. So the side is a state; a path that
follows segments is on the side that it believes to be on, in solids a few rounding errors thick
too.

One loop with one evaluation of the field (drivers write a field out at each place) leaves the
surface, travels and encloses the crossing:

* A step is accepted if the free balls at its ends touch: nothing is between them.
* Near a surface such steps are too short for rays along it. There a step is accepted too if its end
  agrees with the parabola through the last three values to a few rounding errors, and the parabola
  has no root before it. The length of steps follows this error. The first step from a surface is of
  this kind; its parabola is the line given by the slope with which the ray leaves.
* Steps aim a little behind the root of the parabola: behind a surface the next value is negative,
  while at a zero that is only touched it is positive, and the free balls at both ends touch.
* A change of sign encloses the crossing; false position ends at it.

Values are not divided by the bound on the slope, ``divisor``: a field that is steep in one place
would lose its surfaces elsewhere in the rounding error. A rounding error is a length; times the
slope along the ray it is that of a value.

Does not depend on materials, lights or cameras.
"""

from __future__ import annotations

from distal.fields.guarantees import Bounds
from distal.lang import (
    Field3,
    abs,
    clamp,
    dot,
    func,
    gradient,
    length,
    max,
    min,
    select,
    sqrt,
    struct,
    vec2,
    vec3,
)
from distal.render.camera import Ray
from distal.render.march import MOST_STEPS, OUT_OF_STEPS, PASSED, TOO_FAR, Hit, March, crossing
from distal.render.normals import unit_or_up

# The rounding error of a field, for each unit of the coordinates and of the ray's length: 2.1 units
# in the last place. Values below it are on neither side.
ROUNDING = 2.5e-7
# A first step is so long that the field is to be as many rounding errors at its end.
START = 256.0
# The largest distance between a value and the parabola, in rounding errors.
AGREEMENT = 3.0
# A ray begins by so much of the box's distance before the box.
BEFORE = 4e-6
# The longest step by the parabola: in rounding errors, and as a share of the field's box. 30 units
# from the origin the first alone skipped 4e-5 to 6e-4 of a shell and of a gyroid.
REACH = 4096.0
SHARE = 0.002
# Near is what is nearer than so many times the first of these lengths, and than the second. Farther
# away such steps leapt over towers of a city: values along a street agree behind a tower too. A
# ray that has used three quarters of its steps takes the risk up to so many times as far.
FARTHEST = 4.0
LATE = 8.0
# It grows by this factor with each such step as long, and with each step after some: a ray along a
# flat face ends too.
WIDENING = 1.25
PATIENCE = 16
# The fraction of the predicted next ball that a step crosses, and the largest predicted radius, as
# a multiple of the previous ball's radius.
RELAXATION = 0.95
LONGEST = 12.0
# Steps aim so far behind a surface: a part of the length to which a crossing has to be known.
AIM = 0.1
# When steps run out, a surface ahead is hit that is closer than so many of these lengths.
FORGIVING = 4.0
# The least slope with which a ray leaves a surface: 0 says that it does not start on one.
FLATTEST = 1e-9
# Steps of Newton's method to a place on a surface, and the slope along a ray, as a share of the
# gradient, below which they follow the normal.
LANDING_STEPS = 2
FLAT = 0.1


@struct
class Landing:
    """A place on a surface.

    Attributes:
        p: The place.
        n: The unit normal, outwards.
        slope: |gradient| of the field.
        t: Its distance along the ray.
    """

    p: vec3
    n: vec3
    slope: float
    t: float


@struct
class Precision:
    """How exactly a field is known at a place of a ray.

    Attributes:
        divisor: The bound on the slope: a value divided by it is the radius of a free ball.
        slope: How fast values change along the ray there.
        noise: The rounding error of the place, in scene units.
        near: How near a surface is that steps by the parabola are made.
        enough: The length to which a crossing has to be known.
    """

    divisor: float
    slope: float
    noise: float
    near: float
    enough: float


@struct
class SegmentState:
    """The state of a segment.

    Attributes:
        t: The last accepted place, as a distance along the ray.
        free: The value of the field there, positive.
        rise: The first divided difference of the last two values along the ray.
        bend: The second of the last three; 0 if there are fewer.
        last: The length of the last accepted step; 0 if there was none.
        step: The length of the next step.
        reach: The longest step by the parabola.
        high: If positive, the crossing is between ``t`` and ``t + high``.
        below: The value at ``t + high``, negated.
        found: Whether the crossing is known to a rounding error.
    """

    t: float
    free: float
    rise: float
    bend: float
    last: float
    step: float
    reach: float
    high: float
    below: float
    found: bool


@func
def rounding_of(p: vec3) -> float:
    """Return the rounding error of a field at a place."""
    return ROUNDING * (abs(p.x) + abs(p.y) + abs(p.z))


@func
def leaving_slope(slope: float, n: vec3, direction: vec3) -> float:
    """Return how fast a field of this |gradient| grows along a ray from a surface, above 0."""
    return max(slope * abs(dot(direction, n)), FLATTEST)


@func
def segment(
    field: Field3,
    ray: Ray,
    side: float,
    slope: float,
    bounds: Bounds,
    numbers: March,
    steps: int,
) -> Hit:
    """Return the next crossing of a field along a ray.

    Args:
        field: Signed distance.
        ray: Ray.
        side: 1 if the ray runs outside, -1 inside; 0 if that is not known.
        slope: How fast the absolute value of the field grows along the ray, if the ray starts on a
            surface: a positive number. 0 if it does not start on one.
        bounds: Box around the surface with a margin (``settings.grown_bounds``); rays end at its
            sides.
        numbers: The parameters of the march.
        steps: Maximum number of evaluations of the field.
    """
    sides = bounds.high - bounds.low
    extent = max(sides.x, max(sides.y, sides.z))
    return segment_between(field, ray, side, slope, crossing(ray, bounds), extent, numbers, steps)


@func
def segment_between(
    field: Field3,
    ray: Ray,
    side: float,
    slope: float,
    span: vec2,
    extent: float,
    numbers: March,
    steps: int,
) -> Hit:
    """Return the next crossing of a field between two places of a ray.

    Args:
        field: Signed distance.
        ray: Ray.
        side: As for ``segment``.
        slope: As for ``segment``.
        span: Where the box around the surface begins and ends, along the ray.
        extent: The longest side of that box.
        numbers: The parameters of the march.
        steps: Maximum number of evaluations of the field.
    """
    starts = slope > 0.0
    # A ray from afar begins just before the box: rounding errors are those of places there.
    begin = select(starts, 0.0, max(span.x * (1.0 - BEFORE), numbers.near))
    origin = ray.origin + begin * ray.direction
    end = min(span.y, numbers.far) - begin
    nearby = rounding_of(origin)
    reach = min(REACH * nearby, SHARE * extent)
    # A steep field has short free balls everywhere: there steps rest on agreement from afar.
    steepness = numbers.divisor * numbers.steepest
    start = clamp(START * nearby / max(slope, 1e-6), nearby, max(reach, nearby))
    first = select(starts, start, 0.0)
    # A crossing in a first step as short as this is the next face.
    shortest = select(starts, 4.0 * nearby / max(slope, 1e-3), first)
    way = SegmentState(0.0, 0.0, slope, 0.0, 0.0, first, reach, 0.0, 0.0, False)
    around = side
    taken = 0
    for _ in range(min(steps, MOST_STEPS)):
        if way.t > end or way.found:
            break
        at = way.t + way.step
        value = field(origin + at * ray.direction)
        taken += 1
        if around == 0.0:
            around = select(value < 0.0, -1.0, 1.0)
        along = clamp(abs(way.rise), 1.0 / numbers.steepest, numbers.divisor)
        enough = numbers.threshold * (begin + at)
        noise = nearby + ROUNDING * at
        late = select(4 * taken > 3 * steps, LATE, 1.0)
        near = late * min(FARTHEST * REACH * noise, SHARE * extent)
        here = Precision(numbers.divisor, along, noise, near * steepness, enough)
        way = moved(way, around * value, here, end, shortest, taken > PATIENCE)
    lost = PASSED
    if not way.found and way.high == 0.0:
        cut_short = way.t > end and numbers.far < span.y and way.rise < 0.0
        lost = select(way.t > end, select(cut_short, TOO_FAR, PASSED), OUT_OF_STEPS)
    # If steps end while the crossing is enclosed, it is where the line through both values is 0.
    t = begin + clamp(way.t + way.high * share_of(way.free, way.below), 0.0, max(end, 0.0))
    # If they end close to a surface ahead, as at a horizon, that is hit.
    ahead = way.rise < 0.0 and way.free < FORGIVING * numbers.threshold * t
    if lost == OUT_OF_STEPS and ahead:
        return Hit(t, True, taken, around, PASSED)
    return Hit(t, way.found or way.high > 0.0, taken, around, lost)


@func
def share_of(free: float, below: float) -> float:
    """Return where the line from ``free`` at 0 to ``-below`` at 1 is 0."""
    return free / max(free + below, 1e-30)


@func
def moved(
    way: SegmentState, value: float, here: Precision, end: float, shortest: float, widening: bool
) -> SegmentState:
    """Return the state of a segment after one more evaluation of the field.

    All choices are between numbers, not between branches: the CPU computes many rays together.

    Args:
        way: The state before; the field was evaluated at its ``step``.
        value: The value there, positive on the side of the ray.
        here: How exactly the place and the value are known.
        end: Where the ray ends.
        shortest: The length of a first step that may enclose a crossing.
        widening: Whether the longest step by the parabola grows.
    """
    divisor, noise = here.divisor, here.noise
    tiny = noise * here.slope
    at = way.t + way.step
    up = value > 0.0
    enclosed = way.high > 0.0
    # Is the step accepted, does it enclose a crossing, or is it taken back?
    expected = way.free + way.step * (way.rise + way.bend * (way.step + way.last))
    error = abs(value - expected)
    # A value that a safe field has divided is that of a place as many times as far away: another
    # part may be nearer than a step that the value allows to be long.
    near = way.free < divisor * min(way.reach, here.near) * min(here.slope, 1.0)
    agrees = near and error <= AGREEMENT * tiny
    crossed = value < -tiny
    touching = divisor * (way.step - 2.0 * noise) <= way.free + abs(value)
    early = way.last == 0.0 and way.step > shortest
    # The hit: the field has changed its sign by more than its rounding error (decision 94).
    enters = not enclosed and crossed and (touching or (near and not early))
    goes = not enclosed and not crossed and (touching or agrees)
    # False position; an end that stays a second time counts half (Illinois). ``rise`` is then the
    # sign of the last value.
    sign = select(up, 1.0, -1.0)
    half = select(way.rise * sign > 0.5, 0.5, 1.0)
    lower = enters or (enclosed and not up)
    below = select(lower, -value, select(enclosed, way.below * half, way.below))
    kept = select(enclosed, select(up, value, way.free * half), way.free)
    free = select(goes, max(value, 0.0), kept)
    high = select(lower, way.step, select(enclosed, way.high - way.step, way.high))
    t = select(goes or (enclosed and up), at, way.t)
    # The parabola.
    last = select(goes, way.step, way.last)
    inverse = 1.0 / max(way.step * (way.step + way.last), 1e-30)
    steeper = (value - way.free) * ((way.step + way.last) * inverse)
    bent = select(way.last > 0.0, (steeper - way.rise) * (way.step * inverse), 0.0)
    bend = select(goes, bent, way.bend)
    rise = select(goes, steeper, select(enclosed, sign, select(enters, 0.0, way.rise)))
    # The next step.
    growth = step_growth(error, tiny)
    longest = min(way.reach, growth * last)
    onward = next_step(free, rise, bend, last, longest, here)
    beyond = goes and t + onward > end
    passes = beyond and (t >= end or divisor * (end - t) < free)
    onward = select(beyond, end - t, onward)
    ball = free / divisor
    shorter = select(near, min(growth, 0.5) * way.step, ball)
    back = max(shorter, max(ball, 2.0 * noise))
    within = high * clamp(share_of(free, below), 0.02, 0.98)
    step = select(high > 0.0, within, select(goes, onward, back))
    wider = goes and (widening or last > 0.9 * way.reach)
    reach = way.reach * select(wider, WIDENING, 1.0)
    # The end: at a crossing that is known well enough, or past the end.
    zero = enclosed and abs(value) < 0.25 * tiny
    short = enclosed and way.high < max(0.5 * noise, here.enough)
    straight = agrees and below * way.step <= 4.0 * noise * (free + below)
    close = enters and (straight or way.step <= here.enough)
    t = select(zero, at, select(passes, end + 1.0, t))
    high = select(zero, 0.0, high)
    return SegmentState(t, free, rise, bend, last, step, reach, high, below, zero or short or close)


@func
def step_growth(error: float, tiny: float) -> float:
    """Return how much longer the next step may be, by the error of the last and the rounding error.

    The error of a parabola grows with the third power of the step.
    """
    limit = AGREEMENT * tiny
    kept = select(error < limit, 1.0, select(error < 8.0 * limit, 0.5, 0.25))
    return select(error < 0.2 * limit, 2.0, kept)


@func
def next_step(
    free: float, rise: float, bend: float, last: float, longest: float, here: Precision
) -> float:
    """Return the length of the next step.

    The longer of two: to where the ball there touches the free ball here, if the surface ahead is
    flat (Bálint and Valasek, "Accelerating Sphere Tracing", 2018); and, up to a limit, to where the
    parabola through the last values is a little below 0.

    Args:
        free: The last value.
        rise: The first divided difference of the last two values along the ray.
        bend: The second of the last three; 0 if there are only two.
        last: The length of the last step; 0 if there was none.
        longest: The limit of a step by the parabola.
        here: How exactly the place and the value are known.
    """
    divisor = here.divisor
    fall = -(rise + bend * last)
    above = free + 2.0 * here.slope * max(here.noise, AIM * here.enough)
    root = fall * fall - 4.0 * bend * above
    down = fall + sqrt(max(root, 0.0))
    falls = root > 0.0 and down > 0.0
    # One division for both.
    flat = max(divisor - rise, 1e-3 * divisor)
    steep = max(down, 1e-12)
    inverse = 1.0 / (flat * steep)
    ball = free / divisor
    touching = ball * clamp((divisor + rise) * steep * inverse, 0.0, LONGEST)
    reached = ball + select(last > 0.0, RELAXATION * touching, 0.0)
    ahead = select(falls, min(longest, 2.0 * above * flat * inverse), longest)
    return max(max(reached, ahead), 2.0 * here.noise)


@func
def landing(field: Field3, ray: Ray, hit: Hit) -> Landing:
    """Return the place on the surface at the end of a ray, within a rounding error of that place.

    The length of a ray is rounded, and so is the place that it gives: far more than the place's own
    coordinates if the ray is long. Newton's method from there corrects that: along the ray, or
    along the normal if the ray is almost parallel to the surface. The gradient is that just before
    the place, because many fields have none on the surface itself.

    Args:
        field: Signed distance.
        ray: Ray.
        hit: Its end, at a surface.
    """
    p = ray.origin + hit.t * ray.direction
    steepest = vec3(0.0)
    for _ in range(LANDING_STEPS):
        p -= 2.0 * rounding_of(p) * ray.direction
        value = field(p)
        steepest = gradient(field, p)
        squared = max(dot(steepest, steepest), 1e-12)
        along = dot(steepest, ray.direction)
        flat = along * along < FLAT * FLAT * squared
        way = select(flat, steepest / squared, ray.direction / select(flat, 1.0, along))
        p -= value * way
    n = unit_or_up(steepest)
    return Landing(
        p, n, length(steepest), hit.t + dot(p - ray.origin - hit.t * ray.direction, ray.direction)
    )
