"""Photons: light that mirrors, glass and metals bundle on other surfaces (caustics).

Input: the functions of a scene, the box around what bundles light, random numbers. Output:
``Deposit``s, sorted by the runtime into tables, and from these the light that a surface gets
(``gathered``). Paths leave to photons exactly the light that comes from a lamp over one or more
surfaces that bundle it to one that does not (``photon_aim``): each path of light is counted by one
of both.

The light at a place is that of the photons within a radius, which shrinks from pass to pass, so
that the mean of all passes is **consistent**: its expected error goes to 0 as a whole, with the
square of the radius.

Source: Toshiya Hachisuka and Henrik Wann Jensen, "Stochastic Progressive Photon Mapping" (2009);
    Claude Knaus and Matthias Zwicker, "Progressive Photon Mapping: A Probabilistic Approach"
    (2011), for passes that are independent of each other.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from distal.fields.guarantees import Bounds
from distal.lang import (
    Buffer,
    Field3,
    abs,
    clamp,
    dot,
    exp,
    floor,
    func,
    length,
    max,
    min,
    pcg,
    select,
    struct,
    uint,
    vec2,
    vec3,
    vec4,
)
from distal.lang.functions import apart
from distal.render.camera import Ray
from distal.render.dispersion import color_of, wavelength_of
from distal.render.footprint import THIN, Footprint, pixel_cone
from distal.render.lights import LightSample
from distal.render.march import Hit, March
from distal.render.material import Surface, brightest
from distal.render.normals import EXACT
from distal.render.paths import LIKELIEST, MOST_SEGMENTS, SURE
from distal.render.photon_aim import TARGET_DECISIONS, WAVELENGTH, bundles, departure
from distal.render.sampling.points import Stream, reversed_bits, single, triple
from distal.render.scatter import Meeting, Response, Scattering, meet
from distal.render.shade import Shading
from distal.render.surroundings import DirectionSample
from distal.render.vertices import Start, Vertex, start_from, straight_on, vertex_at

PI = 3.14159265358979
# The first radius in pixels at the middle of the target, and its limits as parts of the target.
FIRST_PIXELS = 1.25
LEAST_PART = 0.0005
LARGEST_PART = 0.015
# The radius of pass i: its square falls with this power of the number of samples before it. The
# error by the radius, and the noise, then fall alike.
SHRINKING = -0.3333333333
# Photons whose distance from the tangent plane is larger, in radii, are on another surface.
FLATNESS = 0.25
# Photons for each pixel and sample, and the least and most of them in a pass. Those of a page cross
# from the GPU to the host and back: fewer at most.
OF_A_SAMPLE: Final = 0.3
FEWEST: Final = 2**14
MOST: Final = 2**21
MOST_OF_A_PAGE: Final = 2**18
# Decisions of a segment of a photon, and the one that a path takes for a photon.
DECISIONS = 3
DIRECTION = 0
ENDING = 1
ROULETTE = 2
WHICH_PHOTON: Final = 2**20
# The slot of a photon that met no surface on which it ends, and of one that goes on.
NOWHERE: Final = -1
UNFINISHED: Final = -2
# The uniforms of a pass, which the runtime sets.
LOW: Final = "Photons_low"
HIGH: Final = "Photons_high"
RADIUS: Final = "Photons_radius"
SLOTS: Final = "Photons_slots"
MAPS: Final = "Photons_maps"
SHARE: Final = "Photons_share"
SEED: Final = "Photons_seed"
MOST_FOLLOWED: Final = "Photons_most"
FRAME_INDEX: Final = "Photons_index"
# The data of these buffers is replaced for each pass.
PLACES: Final = Buffer([vec4(0.0)])
ARRIVALS: Final = Buffer([vec4(0.0)])
STARTS: Final = Buffer([0])


@struct
class PhotonCells:
    """The grid in which photons are sorted; a hash maps its cells to slots.

    Attributes:
        radius: The radius within which photons count; cells are twice as large.
        slots: How many slots there are, a power of two.
        maps: Into how many maps the photons of a pass are divided; each sample of a pixel reads one
            of them.
        share: The reciprocal of the number of photons of a map, with those that met nothing.
    """

    radius: float
    slots: int
    maps: int
    share: float


@struct
class Deposit:
    """A photon on the surface at which it ended.

    Attributes:
        place: The place.
        arrival: Unit direction to where it came from.
        power: Its power, times the number of photons.
        slot: The slot of its cell; ``NOWHERE`` if it met no such surface, ``UNFINISHED`` if it
            goes on after the segments that were asked for.
    """

    place: vec3
    arrival: vec3
    power: vec3
    slot: int


@struct
class DepositImage:
    """A photon as a pixel of three pictures, which are drawn at once.

    Attributes:
        place: Its place, and its slot.
        arrival: The direction to where it came from, and 0.
        power: Its power, and 0.
    """

    place: vec4
    arrival: vec4
    power: vec4


@struct
class PlanImage:
    """What the photons of a pass depend on, as a pixel of two pictures.

    Attributes:
        low: The lower corner of the target, and the radius of the pass.
        high: Its upper corner, and 0.
    """

    low: vec4
    high: vec4


@struct
class PhotonPlan:
    """What the photons of a picture depend on.

    Attributes:
        low: The lower corner of the target.
        high: Its upper corner.
        radius: The radius within which photons of the first pass count.
    """

    low: vec3
    high: vec3
    radius: float


@func
def photon_plan(target: Bounds, camera: Callable[[vec2], Ray], resolution: vec2) -> PhotonPlan:
    """Return the plan of a picture.

    Args:
        target: The box around what bundles light.
        camera: Ray of a place in the picture.
        resolution: Size of the picture in pixels.
    """
    eye = camera(vec2(0.0))
    pixel = pixel_cone(camera, vec2(0.0), 2.0 / resolution.y)
    away = length(0.5 * (target.low + target.high) - eye.origin)
    size = length(target.high - target.low)
    wide = FIRST_PIXELS * (pixel.width + pixel.spread * away)
    first = clamp(wide, LEAST_PART * size, LARGEST_PART * size)
    return PhotonPlan(target.low, target.high, first)


@func
def shrunk(radius: float, first_sample: int) -> float:
    """Return the radius of a pass.

    Args:
        radius: That of the first pass.
        first_sample: The number of the first sample of the pass.
    """
    part: float = max(float(first_sample), 1.0) ** (0.5 * SHRINKING)
    return radius * part


@func
def plan_image(plan: PhotonPlan, first_sample: int) -> PlanImage:
    """Return what the photons of a pass depend on.

    Args:
        plan: The plan of the picture.
        first_sample: The number of the first sample of the pass.
    """
    return PlanImage(
        vec4(plan.low, shrunk(plan.radius, first_sample)),
        vec4(plan.high, 0.0),
    )


@func
def photon_at(coord: vec2, width: float) -> int:
    """Return the number of the photon that a pixel follows.

    Args:
        coord: Middle of the pixel, in pixels.
        width: Width of the picture in pixels.
    """
    return int(floor(coord.y)) * int(width) + int(floor(coord.x))


@func
def deposit_image(found: Deposit) -> DepositImage:
    """Return a photon as a pixel; its slot is a whole number below 2 ** 24."""
    return DepositImage(
        vec4(found.place, float(found.slot)),
        vec4(found.arrival, 0.0),
        vec4(found.power, 0.0),
    )


@func
def slot_of(cell: vec3, slots: int) -> int:
    """Return the slot of a cell; neighbors along x have successive slots."""
    row = pcg(uint(int(cell.y)) + pcg(uint(int(cell.z))))
    return int((row + uint(int(cell.x))) & uint(slots - 1))


@apart
@func
def deposit(
    number: int,
    target: Bounds,
    cells: PhotonCells,
    next_hit: Callable[[Ray, int, float, int], Hit],
    field: Field3,
    field_of: Callable[[vec3, int], float],
    surface: Callable[[vec3, Footprint, int], Surface],
    scatter: Callable[[Meeting, vec3], Scattering],
    bodies: int,
    common: int,
    lights: Callable[[int, vec3], LightSample],
    light_count: int,
    around: Callable[[vec3], vec3],
    directions: Callable[[vec3], DirectionSample],
    has_directions: bool,
    bounds: Bounds,
    numbers: March,
    look: Shading,
    seed: int,
    index: int,
    first_sample: int,
    most: int,
    normals: int = EXACT,
    normal_step: float = 1e-3,
) -> Deposit:
    """Follow a photon from a light over surfaces that bundle its light to one that scatters it.

    Args:
        number: The number of the photon in its pass.
        target: The box that photons cross.
        cells: The grid.
        next_hit: The next surface along a ray from a surface (``paths.path_light``).
        field: Signed distance to the scene.
        field_of: Signed distance near a surface of a part.
        surface: The material at a point of a part, averaged over a footprint.
        scatter: A random direction; as for ``paths.path_light``.
        bodies: How many bodies the scene has (``media``); a constant.
        common: The body of shapes without a priority; a constant.
        lights: The light with a given index, from 0, at a point.
        light_count: How many lights there are.
        around: Ambient light from a direction.
        directions: Random directions for ambient light, by three random numbers.
        has_directions: Whether there are such directions; a constant.
        bounds: The box of the scene.
        numbers: The parameters of the march.
        look: The density of fog.
        seed: Selects one of many sets of random numbers.
        index: The number of the frame, whose random numbers are others.
        first_sample: The number of the first sample of the pass.
        most: How many segments are followed; a photon that goes on is ``UNFINISHED``.
        normals: The method for normals; a constant of ``normals``.
        normal_step: Step of the normals' differences, in scene units at distance 1.
    """
    of_pass = pcg(pcg(pcg(uint(seed)) + uint(index)) + uint(first_sample))
    stream = Stream(of_pass, reversed_bits(uint(number)))
    begin = departure(
        target, lights, light_count, around, directions, has_directions, bounds, numbers.far, stream
    )
    power = begin.power
    left = 1.0  # the share of the power that is left, for the roulette
    wavelength = wavelength_of(single(stream, WAVELENGTH))
    is_tinted = False  # whether the power has the color of the wavelength
    bundled = False  # whether a surface that bundles light lies behind
    start = Start(begin.ray, 0, 0.0, -1)
    found = Deposit(vec3(0.0), vec3(0.0), vec3(0.0), NOWHERE)
    if brightest(power) <= 0.0 or field(begin.ray.origin) < 0.0:
        return found
    for i in range(MOST_SEGMENTS):
        if i >= most:
            found.slot = UNFINISHED
            break
        here = start.ray
        hit = next_hit(here, start.within, start.slope, start.part)
        if not hit.found:
            break
        vertex = vertex_at(
            here, hit, start.within, field_of, surface, THIN, numbers, normals, normal_step,
            bodies, common, wavelength,
        )  # fmt: skip
        met = vertex.interface
        material = met.surface
        if start.within != 0:
            power = power * exp(-met.absorption * vertex.t)
        elif bundled:
            power = power * exp(-look.fog_density * vertex.t)
        if bodies > 1 and not met.is_boundary:
            start = straight_on(vertex, here.direction)
            continue
        meeting = meet(material, -here.direction, vertex.shown, met.inside)
        if material.dispersion > 0.0 and not is_tinted:
            power = power * color_of(wavelength)
            is_tinted = True
        decision = TARGET_DECISIONS + DECISIONS * i
        onward = scatter(meeting, triple(stream, decision + DIRECTION))
        ending = single(stream, decision + ENDING)
        if dot(onward.direction, vertex.shown) * dot(onward.direction, vertex.n) < 0.0:
            break
        if not bundles(material):
            # It ends where a path would scatter, and goes on where a path would be mirrored.
            mirror = meeting.lobes.mirror_specular
            mixed = not mirror and meeting.lobes.through_specular and material.transmission > 0.0
            ends = ending < 0.5 if mixed else not onward.specular
            own = material.bsdf_share
            even = own + (1.0 - own) * meeting.lobes.even
            chance = select(mixed, 0.5, select(mirror, even, 1.0))
            if ends or not onward.specular:
                if ends and bundled:
                    cell = floor(vertex.p * (0.5 / cells.radius))
                    slot = slot_of(cell, cells.slots)
                    found = Deposit(vertex.p, -here.direction, power / max(chance, 1e-6), slot)
                break
            power = power * select(mixed, 2.0, 1.0)
        power = power * onward.weight
        left *= brightest(onward.weight)
        likely = 1.0
        if i >= SURE:
            likely = min(left, LIKELIEST)
        if left <= 0.0 or (i >= SURE and single(stream, decision + ROULETTE) >= likely):
            break
        power = power / likely
        left /= likely
        bundled = True
        start = start_from(vertex, onward.direction)
    return found


@func
def gathered(
    places: Buffer[vec4],
    arrivals: Buffer[vec4],
    starts: Buffer[int],
    cells: PhotonCells,
    vertex: Vertex,
    meeting: Meeting,
    respond: Callable[[Meeting, vec3], Response],
    stream: Stream,
) -> vec3:
    """Return the light of photons that a surface sends to the eye.

    One of the photons within the radius is chosen at random, by their power and distance; the
    surface responds to its direction. The weight is 1 at the place and 0 at the radius.

    Args:
        places: Place and brightness of each photon, sorted by map and slot.
        arrivals: Two for each photon: the direction to where it came from; its color.
        starts: The first photon of each slot; one slot more than ``cells.slots`` in each map, which
            repeats the first one.
        cells: The grid.
        vertex: The surface.
        meeting: The surface and the direction to the eye, for its response.
        respond: The response; as for ``paths.path_light``.
        stream: The random numbers of the path.

    Source: V. A. Epanechnikov, "Non-Parametric Estimation of a Multivariate Probability Density"
        (1969), for the weight.
    """
    p = vertex.p
    scale = 0.5 / cells.radius
    narrow = 1.0 / (cells.radius * cells.radius)
    corner = floor(p * scale - 0.5)
    sample = reversed_bits(stream.place)
    base = int(sample % uint(cells.maps)) * (cells.slots + 1)
    u = single(stream, WHICH_PHOTON)
    total = 0.0
    chosen = -1
    for row in range(4):
        cell = corner + vec3(0.0, float(row % 2), float(row // 2))
        slot = base + slot_of(cell, cells.slots)
        for k in range(starts[slot], starts[slot + 2]):
            at = places[k]
            away = at.xyz - p
            near = 1.0 - dot(away, away) * narrow
            own = floor(at.yz * scale)
            same = own.x == cell.y and own.y == cell.z
            flat = abs(dot(away, vertex.n)) < FLATNESS * cells.radius
            weight = select(same and flat and near > 0.0, near * at.w, 0.0)
            total += weight
            # A photon replaces the chosen one by its share; what is left of u is uniform again.
            part = weight / max(total, 1e-30)
            taken = u < part
            chosen = select(taken, k, chosen)
            u = select(taken, u / max(part, 1e-30), (u - part) / max(1.0 - part, 1e-7))
    if chosen < 0:
        return vec3(0.0)
    direction = arrivals[2 * chosen].xyz
    color = arrivals[2 * chosen + 1].xyz
    cosine = max(abs(dot(direction, vertex.n)), 1e-3)
    response = respond(meeting, direction).value / cosine
    # Photons carry power; radiance counts divided by the square of the index (``scatter``).
    index = vertex.interface.index
    return response * color * (total * cells.share * narrow * (2.0 / PI) / (index * index))


@func
def none_gathered() -> vec3:
    """Return the light of photons if there are none."""
    return vec3(0.0)
