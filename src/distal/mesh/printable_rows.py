"""The rows of a mesh that a page makes, as scene code: what a pixel of each pass computes.

Input: a field, a lattice and the number of a row; buffers that the page fills between passes.
Output: numbers of 32 bits, one row for each pixel. The arithmetic is that of ``arithmetic``; this
module only gathers its arguments. Which rows belong together is decided by the page
(``web/src/print``).
"""

from __future__ import annotations

from typing import Final

from distal.lang import (
    Buffer,
    Field3,
    clamp,
    floor,
    func,
    max,
    min,
    struct,
    vec3,
    vec4,
)
from distal.lang.srgb import encode_srgb
from distal.mesh.accuracy import CELLS_AROUND
from distal.mesh.arithmetic import (
    CREASE_COSINE,
    OFF_FACE,
    cosine,
    crease_point,
    distance_to_field,
    kept_in_region,
    root_on_edge,
    smooth_point,
    unit_or_zero,
)
from distal.mesh.face_arithmetic import (
    diagonal_fits,
    face_point,
    largest_miss,
    lost_surface,
    middle_distance,
    passes_face,
    way_of,
    way_out,
)
from distal.mesh.places import REGION_MARGIN
from distal.mesh.printable_lattice import (
    PrintLattice,
    lattice_place,
    lattice_point,
    turned,
    unit_of,
)
from distal.mesh.surface_arithmetic import shown_color
from distal.mesh.triangle_arithmetic import (
    chosen_diagonal,
    distance_to_pair,
    distance_to_triangle,
    middle,
)
from distal.mesh.triangulate import TIE
from distal.render.material import Surface

# Numbers of 32 bits: gradients are taken so far off the surface, as a share of an edge, that the
# place differs by some units in the last place.
OFF_SURFACE_32 = 4e-3
FAR = 1e30
# How close to the surface a point of it is, as a share of a cell.
CLOSE_32 = 1e-3

# The data of these buffers is replaced for each pass. Edges, cells and faces have two numbers each:
# that of a lattice point, x runs first, then y; and what the passes say.
EDGES: Final = Buffer([0])
VALUES: Final = Buffer([0.0])
ROOTS: Final = Buffer([vec4(0.0)])
KEPT: Final = Buffer([vec4(0.0)])
SLOPES: Final = Buffer([vec4(0.0)])
CELLS: Final = Buffer([0])
USES: Final = Buffer([0])
PLANES: Final = Buffer([vec4(0.0)])
POINTS: Final = Buffer([vec4(0.0)])
FACES: Final = Buffer([0])
ENDS: Final = Buffer([0])
AROUND: Final = Buffer([0])
PLACES: Final = Buffer([vec4(0.0)])
TRIANGLES: Final = Buffer([0])


@struct
class Reach:
    """How far a cell may be left.

    Attributes:
        below: How many cells it reaches towards low ends; whole numbers that are not positive.
        above: How many towards high ends.
        looks: Whether it reaches to all sides, to find the direction that it needs.
    """

    below: vec3
    above: vec3
    looks: bool


@struct
class RootImage:
    """The root on an edge as a pixel of three pictures.

    Attributes:
        place: Its place, and its share of the edge.
        kept: The place, at least the margin away from the ends of the edge, and 0.
        slope: The gradient there, and 0.
    """

    place: vec4
    kept: vec4
    slope: vec4


@func
def value_row(field: Field3, lattice: PrintLattice, row: int) -> vec4:
    """Return the field at four lattice points."""
    found = [0.0, 0.0, 0.0, 0.0]
    for i in range(4):
        found[i] = field(lattice_place(lattice, lattice_point(lattice, 4 * row + i)))
    return vec4(found[0], found[1], found[2], found[3])


@func
def middle_row(field: Field3, lattice: PrintLattice, row: int) -> vec4:
    """Return the field in the middle of an ambiguous face.

    ``FACES`` has the cell below each face, and its axis.
    """
    middle = 0.5 + 0.5 * unit_of(FACES[2 * row + 1])
    point = lattice_point(lattice, FACES[2 * row]) + middle
    return vec4(field(lattice_place(lattice, point)), 0.0, 0.0, 0.0)


@func
def lost_row(field: Field3, lattice: PrintLattice, row: int) -> vec4:
    """Return 1 if the surface is near a lattice point and the mesh is not.

    ``USES`` has lattice points whose cells have no change of sign. A point of the surface is
    searched from each; the signs at the corners of the cells around it say whether the mesh is
    there.
    """
    p = lattice_place(lattice, lattice_point(lattice, USES[row]))
    found, q = lost_surface(field, p, lattice.step, 0.0, CLOSE_32)
    if not found:
        return vec4(0.0)
    home = floor((q - lattice.origin) / lattice.step) - float(CELLS_AROUND)
    side = 2 * CELLS_AROUND + 2
    inside = 0
    for i in range(side * side * side):
        point = vec3(float(i % side), float(i // side % side), float(i // (side * side)))
        inside += 1 if field(lattice_place(lattice, home + point)) < 0.0 else 0
    apart = inside == 0 or inside == side * side * side
    return vec4(1.0 if apart else 0.0, 0.0, 0.0, 0.0)


@func
def root_row(field: Field3, lattice: PrintLattice, row: int) -> RootImage:
    """Return the root on an edge.

    ``EDGES`` has its lower end and its axis, ``VALUES`` the field at both ends.
    """
    start = lattice_place(lattice, lattice_point(lattice, EDGES[2 * row]))
    way = unit_of(EDGES[2 * row + 1]) * lattice.step
    first = VALUES[2 * row]
    share, slope = root_on_edge(field, start, way, first, VALUES[2 * row + 1], OFF_SURFACE_32)
    kept = start + way * clamp(share, lattice.margin, 1.0 - lattice.margin)
    return RootImage(vec4(start + way * share, share), vec4(kept, 0.0), vec4(slope, 0.0))


@func
def reach_of(code: int) -> Reach:
    """Return how far a cell may be left in the direction of a code; to all sides for 0."""
    way = way_of(float(code))
    if code == 0:
        return Reach(vec3(-1.0), vec3(1.0), True)
    return Reach(min(way, 0.0), max(way, 0.0), False)


@func
def point_row(field: Field3, lattice: PrintLattice, row: int) -> vec4:
    """Return the point of a component of a cell, and what is known of it.

    ``CELLS`` has the lowest corner of the cell and a number: the component's region; 0 for a point
    that is alone in its cell; or, less 4, the code of the direction in which the cell may be left,
    0 for all. The fourth number is 0 on a smooth surface, 1 at a crease, 2 at a crease that leaves
    the cell; where the cell may be left to all sides, the code of the direction that is needed.
    Where a direction is given, ``POINTS`` has the point within the cell.
    """
    cell = lattice_point(lattice, CELLS[2 * row])
    region = CELLS[2 * row + 1]
    points = [vec3(0.0)] * 12
    slopes = [vec3(0.0)] * 12
    weights = [0.0] * 12
    total = vec3(0.0)
    normal = vec3(0.0)
    count = 0.0
    for i in range(12):
        edge = USES[12 * row + i]
        if edge >= 0:
            points[i] = ROOTS[edge].xyz
            slopes[i] = SLOPES[edge].xyz
            weights[i] = 1.0
            total += KEPT[edge].xyz
            normal += unit_or_zero(slopes[i])
            count += 1.0
    mean = total / max(count, 1.0)
    average = unit_or_zero(normal)
    least = 1.0
    for i in range(12):
        if weights[i] > 0.0:
            least = min(least, cosine(unit_or_zero(slopes[i]), average))
    reach = Reach(vec3(0.0), vec3(0.0), False)
    margin = lattice.margin
    if region < 0:
        reach = reach_of(region + 4)
        margin = 0.0 if reach.looks else margin
    low = lattice_place(lattice, cell + reach.below + margin)
    high = lattice_place(lattice, cell + reach.above + (1.0 - margin))
    creased = least < CREASE_COSINE
    found = mean
    if creased:
        found = crease_point(field, points, slopes, weights, mean, low, high, OFF_SURFACE_32)
    else:
        found = smooth_point(field, mean, low, high)
    if region > 0:
        planes = [vec4(0.0)] * 8
        for i in range(8):
            planes[i] = PLANES[8 * region + i]
        margin = max(REGION_MARGIN, lattice.margin)
        corner = lattice_place(lattice, cell)
        found = kept_in_region(mean, found, corner, lattice.step, planes, margin)
    if reach.looks:
        return vec4(found, way_beyond(lattice, found, cell, cell + 1.0))
    off = distance_to_field(field, found)
    least_off = lattice.margin * lattice.step
    if region < 0:
        before = POINTS[row].xyz
        return vec4(found if off < distance_to_field(field, before) - least_off else before, 0.0)
    return vec4(found, (2.0 if off > least_off else 1.0) if creased else 0.0)


@func
def way_beyond(lattice: PrintLattice, p: vec3, low: vec3, high: vec3) -> float:
    """Return the code of the direction in which a place is outside of a box of lattice points."""
    margin = lattice.margin
    return way_out(p, lattice_place(lattice, low - margin), lattice_place(lattice, high + margin))


@func
def face_row(field: Field3, lattice: PrintLattice, row: int) -> vec4:
    """Return the point of a segment on its face, and 1 if the mesh needs it there.

    ``FACES`` has the lowest corner of the face, and its axis plus three times a number: 1 if the
    face or one of its cells belongs to several components, then the point stays on the line between
    the roots; or, less 5, the code of the direction in which both cells of the face may be left, 0
    for all. Then the fourth number is the code of the direction that is needed. ``ENDS`` has the
    points below and above the face, and the two edges at which the segment ends.
    """
    face = lattice_point(lattice, FACES[2 * row])
    kind = FACES[2 * row + 1] // 3
    several = kind == 1
    axis = FACES[2 * row + 1] % 3
    below = POINTS[ENDS[4 * row]].xyz
    above = POINTS[ENDS[4 * row + 1]].xyz
    a = ENDS[4 * row + 2]
    b = ENDS[4 * row + 3]
    found = 0.5 * (KEPT[a].xyz + KEPT[b].xyz)
    if several:
        return vec4(found, 1.0)
    reach = Reach(vec3(0.0), vec3(0.0), False)
    if kind > 1:
        reach = reach_of(kind - 5)
    corner = lattice_place(lattice, face)
    margin = 0.0 if reach.looks else lattice.margin
    p = turned((below - corner) / lattice.step, axis)
    q = turned((above - corner) / lattice.step, axis)
    miss = middle_distance(field, below, above)
    low = turned(reach.below + 0.5 * margin, axis)
    high = turned(reach.above + (1.0 - 0.5 * margin), axis)
    closed = passes_face(p, q, low, high) and miss <= lattice.tolerance
    if miss <= OFF_FACE * lattice.step if reach.looks else closed:
        return vec4(found, 0.0)
    normal = unit_of(axis)
    side = 1.0 - normal
    found = face_point(
        field,
        KEPT[a].xyz,
        KEPT[b].xyz,
        SLOPES[a].xyz,
        SLOPES[b].xyz,
        normal,
        lattice_place(lattice, face + (reach.below + margin) * side),
        lattice_place(lattice, face + (reach.above + (1.0 - margin)) * side),
        OFF_SURFACE_32,
    )
    if reach.looks:
        return vec4(found, way_beyond(lattice, found, face - normal, face + 1.0))
    return vec4(found, 1.0)


@func
def diagonal_row(field: Field3, lattice: PrintLattice, row: int) -> vec4:
    """Return which diagonal splits the four points around an edge: 0, 1, or 2 for neither."""
    start = lattice_place(lattice, lattice_point(lattice, EDGES[2 * row]))
    axis = EDGES[2 * row + 1]
    corners = [vec3(0.0)] * 4
    near = [vec3(0.0)] * 4
    for i in range(4):
        corners[i] = POINTS[AROUND[4 * row + i]].xyz
        near[i] = turned((corners[i] - start) / lattice.step, axis)
    margin = lattice.margin
    fits = vec3(0.0)
    misses = vec3(FAR)
    root = ROOTS[row].xyz
    if diagonal_fits(near[0], near[2], near[1], near[3], margin):
        fits.x = 1.0
        back = distance_to_pair(root, corners[0], corners[1], corners[2], corners[3])
        misses.x = max(middle_distance(field, corners[0], corners[2]), back)
    if diagonal_fits(near[1], near[3], near[2], near[0], margin):
        fits.y = 1.0
        back = distance_to_pair(root, corners[1], corners[2], corners[3], corners[0])
        misses.y = max(middle_distance(field, corners[1], corners[3]), back)
    which = chosen_diagonal(corners, fits, misses, lattice.tolerance, TIE * lattice.step)
    return vec4(float(which), 0.0, 0.0, 0.0)


@func
def miss_row(field: Field3, row: int) -> vec4:
    """Return how far a triangle is from the surface, and the root of its edge from the triangle.

    The numbers are the largest and the mean distance of its points, 1 if a value is not a number,
    and the distance of the root. ``TRIANGLES`` has three points and an edge for each triangle.
    """
    a = PLACES[TRIANGLES[4 * row]].xyz
    b = PLACES[TRIANGLES[4 * row + 1]].xyz
    c = PLACES[TRIANGLES[4 * row + 2]].xyz
    root = ROOTS[TRIANGLES[4 * row + 3]].xyz
    misses = largest_miss(field, a, b, c, OFF_SURFACE_32)
    return vec4(misses, distance_to_triangle(root, a, b, c))


@func
def point_of_row(row: int) -> vec3:
    """Return a point of the mesh."""
    return PLACES[row].xyz


@func
def middle_of_row(row: int) -> vec3:
    """Return the middle of a triangle."""
    a = PLACES[TRIANGLES[4 * row]].xyz
    b = PLACES[TRIANGLES[4 * row + 1]].xyz
    return middle(a, b, PLACES[TRIANGLES[4 * row + 2]].xyz)


@func
def color_codes(surface: Surface) -> vec4:
    """Return the sRGB codes of a surface's color as one number of 24 bits: red, green, blue."""
    codes = floor(clamp(encode_srgb(shown_color(surface)), 0.0, 1.0) * 255.0 + 0.5)
    return vec4(codes.x * 65536.0 + codes.y * 256.0 + codes.z, 0.0, 0.0, 0.0)
