"""The lattice of a mesh that a page makes, as scene code.

Input: a box, how many cells it has along its largest side; the number of a lattice point or of a
pixel. Output: the lattice as a pixel, or why there is none; places. Numbers have 32 bits.
"""

from __future__ import annotations

from distal.fields.guarantees import ENDLESS, Bounds
from distal.lang import ceil, floor, func, max, struct, vec2, vec3, vec4
from distal.mesh.bricks import SUSPICIOUS
from distal.mesh.lattice import BEFORE, BEYOND
from distal.mesh.meshing import DEFAULT_TOLERANCE, STEEP
from distal.mesh.places import SIDE_MARGIN, SMALLEST_MARGIN
from distal.mesh.tree_topology import MOST_MARGIN

# As many lattice points as memory holds.
MOST_POINTS = 2.0**27
# Why there is no mesh: the numbers of the page's messages.
NO_END = 1.0
EMPTY = 2.0
TOO_MANY = 3.0
TOO_FAR = 4.0


@struct
class PrintLattice:
    """A lattice of cubic cells over the box of a shape.

    Attributes:
        origin: The lowest lattice point.
        step: The length of a cell.
        counts: How many lattice points there are along each axis; whole numbers.
        margin: How far from its cell's sides a point must be, in cells.
        tolerance: How far lines between points may be from the surface.
    """

    origin: vec3
    step: float
    counts: vec3
    margin: float
    tolerance: float


@struct
class LatticeImage:
    """A lattice as a pixel of three pictures.

    Attributes:
        begin: The origin, and the length of a cell.
        end: The counts, and the margin.
        more: The tolerance; why there is no mesh: 0 or one of the numbers above; how many lattice
            points there are; and how small a value is at a lattice point beside the surface.
    """

    begin: vec4
    end: vec4
    more: vec4


@func
def lattice_over(bounds: Bounds, slope: float, cells: float, tolerance: float) -> LatticeImage:
    """Return the lattice over a box.

    Args:
        bounds: The box.
        slope: Lipschitz bound (slope) of the shape.
        cells: How many cells there are along the largest side of the box.
        tolerance: How far the mesh may be from the surface; 0 for a share of this side.
    """
    sides = bounds.high - bounds.low
    size = max(sides.x, max(sides.y, sides.z))
    step = size / cells
    origin = bounds.low - BEFORE * step
    counts = ceil((bounds.high + BEYOND * step - origin) / step)
    far = max(abs_of(origin), abs_of(origin + counts * step))
    margin = max(SMALLEST_MARGIN, SIDE_MARGIN * max(far.x, max(far.y, far.z)) / step)
    counts += 1.0
    total = counts.x * counts.y * counts.z
    problem = 0.0
    if margin > MOST_MARGIN:
        problem = TOO_FAR
    if total > MOST_POINTS:
        problem = TOO_MANY
    if not step > 0.0:
        problem = EMPTY
    if not max(max(far.x, max(far.y, far.z)), step) < ENDLESS:
        problem = NO_END
    wanted = tolerance if tolerance > 0.0 else DEFAULT_TOLERANCE * size
    steepest = slope if slope > 0.0 and slope < STEEP else STEEP
    more = vec4(wanted, problem, total, SUSPICIOUS * step * steepest)
    return LatticeImage(vec4(origin, step), vec4(counts, margin), more)


@func
def abs_of(v: vec3) -> vec3:
    """Return the absolute values."""
    return max(v, -v)


@func
def row_at(coord: vec2, width: float) -> int:
    """Return the number of the row that a pixel computes.

    Args:
        coord: Middle of the pixel, in pixels.
        width: Width of the picture in pixels.
    """
    return int(floor(coord.y)) * int(width) + int(floor(coord.x))


@func
def lattice_point(lattice: PrintLattice, number: int) -> vec3:
    """Return the lattice point of a number; x runs first, then y."""
    across = int(lattice.counts.x)
    down = int(lattice.counts.y)
    line = number // across
    return vec3(float(number % across), float(line % down), float(line // down))


@func
def lattice_place(lattice: PrintLattice, point: vec3) -> vec3:
    """Return the place of a lattice point; shares of a cell are allowed."""
    return lattice.origin + point * lattice.step


@func
def unit_of(axis: int) -> vec3:
    """Return the unit vector along an axis."""
    if axis == 0:
        return vec3(1.0, 0.0, 0.0)
    return vec3(0.0, 1.0, 0.0) if axis == 1 else vec3(0.0, 0.0, 1.0)


@func
def turned(v: vec3, axis: int) -> vec3:
    """Return the components along an axis and the next two."""
    if axis == 0:
        return v
    return v.yzx if axis == 1 else v.zxy
