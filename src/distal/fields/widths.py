"""Widths of shapes: the side of the largest cubic cells that find them.

Input: the numbers of a shape. Output: its width. A lattice of cells of this side, wherever it lies
and however it is turned, has corners inside and outside of the shape that tell its topology: how
many pieces it has, how many holes, how many voids. What is thinner than its cells is found by
chance.

A sheet or a slit is found by cells as wide as it is thick: each line of the lattice that crosses it
has a corner in it. A ball, a rod or a bore needs a corner in each ball of its radius: cells of its
diameter over the root of 3. Tips and sharp edges may be cut: that changes no topology.

The functions are shared by shapes whose numbers have the same names.
"""

from __future__ import annotations

from typing import Final

from distal.fields.constants import HALF_ROOT, PI, ROOT_THREE
from distal.lang import (
    Buffer,
    abs,
    cos,
    func,
    length,
    max,
    min,
    pow,
    select,
    sin,
    size,
    sqrt,
    vec2,
    vec3,
    vec4,
)

# The share of its thickness that finds a sheet, with a margin for what is cut at its edges.
SHEET: Final = 0.95
# Cells of a ball's radius times this have a corner in it.
ROD: Final = 1.1547


@func
def both_widths(width: float, thickness: float) -> float:
    """Return the width of what is cut out of a thing of one width by a sheet of a thickness.

    Where both are alike, it is a rod.
    """
    sheet = SHEET * thickness
    return min(min(width, sheet), max(width, thickness) / ROOT_THREE)


# Balls, rods, bores


@func
def radius_width(radius: float) -> float:
    """Return the width of a ball or a rod."""
    return ROD * radius


@func
def minor_width(minor: float) -> float:
    """Return the width of the tube of a ring."""
    return ROD * minor


@func
def ring_width(major: float, minor: float) -> float:
    """Return the width of a ring: of its tube or of its hole."""
    return ROD * min(minor, max(major - minor, 0.1 * minor))


@func
def half_width(width: float) -> float:
    """Return the width of what is as wide as a rod."""
    return 0.5 * ROD * width


@func
def radii_width(radii: vec3) -> float:
    """Return the width of an ellipsoid."""
    return ROD * min(min(radii.x, radii.y), radii.z)


@func
def end_radii_width(start_radius: float, end_radius: float) -> float:
    """Return the width of a tube whose ends have radii of their own."""
    return ROD * min(start_radius, end_radius)


# Boxes, sheets, slits


@func
def rectangle_width(size: vec2) -> float:
    """Return the width of a bar with a rectangle for its section."""
    low, high = min(size.x, size.y), max(size.x, size.y)
    return min(SHEET * low, high / ROOT_THREE)


@func
def box_width(size: vec3) -> float:
    """Return the width of a box: of a sheet, or of a bar if two of its sides are small."""
    low = min(min(size.x, size.y), size.z)
    high = max(max(size.x, size.y), size.z)
    # The middle one, also where sides are infinite.
    middle = max(min(size.x, size.y), min(max(size.x, size.y), size.z))
    return min(SHEET * low, min(middle, high) / ROOT_THREE)


@func
def thickness_width(thickness: float) -> float:
    """Return the width of a sheet."""
    return SHEET * thickness


@func
def bar_width(thickness: float) -> float:
    """Return the width of a bar as thick as it is wide."""
    return thickness / ROOT_THREE


# Rods with ends


@func
def cylinder_width(radius: float, height: float) -> float:
    """Return the width of a rod, or of a disc."""
    return both_widths(ROD * radius, height)


@func
def prism_width(inradius: float, height: float) -> float:
    """Return the width of a prism over a regular polygon."""
    return both_widths(ROD * inradius, height)


@func
def rhombus_prism_width(diagonals: vec2, height: float, rounding: float) -> float:
    """Return the width of a prism over a rhombus with round edges."""
    inner = 0.5 * diagonals.x * diagonals.y / length(diagonals)
    return both_widths(ROD * (inner + rounding), height)


@func
def between_width(start: vec3, end: vec3, radius: float) -> float:
    """Return the width of a rod between two points, with flat ends."""
    return both_widths(ROD * radius, length(end - start))


@func
def frustum_width(bottom: float, top: float, height: float) -> float:
    """Return the width of a cone without its tip: that of the ball in the whole cone at least."""
    wide = max(bottom, top)
    ball = wide * height / (wide + length(vec2(wide, height)))
    return both_widths(ROD * max(min(bottom, top), ball), height)


@func
def frustum_between_width(start: vec3, end: vec3, start_radius: float, end_radius: float) -> float:
    """Return the width of a cone without its tip between two points."""
    return frustum_width(start_radius, end_radius, length(end - start))


@func
def cone_width(radius: float, height: float) -> float:
    """Return the width of a cone."""
    return frustum_width(radius, 0.0, height)


@func
def cone_between_width(start: vec3, end: vec3, radius: float) -> float:
    """Return the width of a cone between two points."""
    return frustum_width(radius, 0.0, length(end - start))


@func
def ends_width(bottom: float, top: float) -> float:
    """Return the width of a rod whose ends have radii of their own."""
    return ROD * min(bottom, top)


# Polyhedra and polygons, by the largest ball inside


@func
def inradius_width(inradius: float) -> float:
    """Return the width of a solid by the largest ball inside."""
    return ROD * inradius


@func
def octahedron_width(radius: float) -> float:
    """Return the width of an octahedron."""
    return 0.57735 * ROD * radius


@func
def tetrahedron_width(radius: float) -> float:
    """Return the width of a tetrahedron."""
    return ROD * radius / 3.0


@func
def round_solid_width(radius: float) -> float:
    """Return the width of a solid of many faces with corners at a radius, or of a hexagon."""
    return 0.77 * ROD * radius


@func
def pyramid_width(size: float, height: float) -> float:
    """Return the width of a pyramid over a square."""
    return cone_width(0.5 * size, height)


@func
def polygon_width(radius: float, count: int) -> float:
    """Return the width of a regular polygon."""
    return ROD * radius * cos(PI / float(count))


@func
def star_width(radius: float, inner: float, count: int) -> float:
    """Return the width of a star: of its middle; its points may be cut."""
    return ROD * inner * cos(PI / float(count))


@func
def pentagram_width(radius: float) -> float:
    """Return the width of the pentagon in a pentagram."""
    return 0.309 * ROD * radius


@func
def half_radius_width(radius: float) -> float:
    """Return the width of what has a ball of half of its radius inside."""
    return 0.5 * ROD * radius


@func
def equilateral_width(size: float) -> float:
    """Return the width of an equilateral triangle."""
    return 0.2887 * ROD * size


@func
def corners_width(a: vec2, b: vec2, c: vec2) -> float:
    """Return the width of a triangle."""
    u, v = b - a, c - a
    around = length(u) + length(v) + length(u - v)
    return ROD * abs(u.x * v.y - u.y * v.x) / max(around, 1e-12)


@func
def isosceles_width(width: float, height: float) -> float:
    """Return the width of an isosceles triangle."""
    return corners_width(vec2(0.0, 0.0), vec2(width, 0.0), vec2(0.5 * width, height))


@func
def rhombus_width(diagonals: vec2) -> float:
    """Return the width of a rhombus with these diagonals."""
    return 0.5 * ROD * diagonals.x * diagonals.y / length(diagonals)


@func
def trapezoid_width(bottom: float, top: float, height: float) -> float:
    """Return the width of a trapezoid."""
    return max(
        rectangle_width(vec2(min(bottom, top), height)),
        isosceles_width(max(bottom, top), height),
    )


@func
def parallelogram_width(width: float, height: float, skew: float) -> float:
    """Return the width of a parallelogram."""
    return rectangle_width(vec2(width * height / length(vec2(height, skew)), height))


# Other outlines


@func
def chamfered_width(size: vec2, bevel: float) -> float:
    """Return the width of a rectangle whose corners are cut."""
    across = (0.5 * (size.x + size.y) - bevel) * HALF_ROOT
    return min(rectangle_width(size), ROD * across)


@func
def chamfered_box_width(size: vec3, bevel: float) -> float:
    """Return the width of a box whose edges are cut."""
    low = min(min(size.x, size.y), size.z)
    return min(box_width(size), ROD * max(low - bevel, 0.5 * low) * HALF_ROOT)


@func
def oriented_width(start: vec2, end: vec2, thickness: float) -> float:
    """Return the width of a bar between two points."""
    return rectangle_width(vec2(length(end - start), thickness))


@func
def cross_width(span: float, thickness: float) -> float:
    """Return the width of crossed bars."""
    return rectangle_width(vec2(span, thickness))


@func
def tunnel_width(width: float, height: float) -> float:
    """Return the width of half a disc on a rectangle."""
    return rectangle_width(vec2(width, height + 0.5 * width))


@func
def steps_width(step: vec2) -> float:
    """Return the width of stairs: of their highest step."""
    return min(SHEET * step.x, step.y)


@func
def segment_width(width: float, height: float) -> float:
    """Return the width of a bow on a base."""
    return 0.3 * ROD * min(width, height)


@func
def blobby_width(radius: float, depth: float) -> float:
    """Return the width of a star with hollow sides."""
    return ROD * max(HALF_ROOT * radius - depth, 0.1 * radius)


@func
def ellipse_width(radii: vec2) -> float:
    """Return the width of an ellipse."""
    return ROD * min(radii.x, radii.y)


@func
def gap_width(radius: float) -> float:
    """Return the width of a gap of two radii."""
    return 2.0 * SHEET * radius


@func
def moon_width(radius: float, cut_radius: float, shift: float) -> float:
    """Return the width of a crescent: of half of its thickness, since its tips are thin."""
    return 0.5 * SHEET * (radius + shift - cut_radius)


@func
def heart_width(height: float) -> float:
    """Return the width of a heart."""
    return 0.3 * ROD * height


@func
def annulus_width(radius: float, thickness: float) -> float:
    """Return the width of a ring in the plane: of its line, or of its hole."""
    return min(SHEET * thickness, ROD * max(radius - 0.5 * thickness, 0.1 * thickness))


@func
def sector_width(radius: float, opening: float) -> float:
    """Return the width of a sector of a disc or a ball."""
    s = sin(0.5 * min(opening, PI))
    return ROD * radius * s / (1.0 + s)


@func
def cut_width(radius: float, height: float) -> float:
    """Return the width of the part of a disc or a ball above a height."""
    across = select(height > 0.0, sqrt(max(radius * radius - height * height, 0.0)), radius)
    return both_widths(ROD * across, radius - height)


@func
def bitten_width(radius: float, cut_radius: float, distance: float) -> float:
    """Return the width of a ball from which another is cut."""
    return both_widths(ROD * radius, min(radius + distance - cut_radius, 2.0 * radius))


@func
def gear_width(radius: float, count: int) -> float:
    """Return the width of a gear: of half of a tooth, which is thinner at its tip."""
    return 0.5 * PI * radius / float(count)


@func
def rack_width(module: float) -> float:
    """Return the width of a rack: of half of a tooth."""
    return 0.5 * module


@func
def wall_width(wall: float) -> float:
    """Return the width of walls between cells."""
    return SHEET * wall


@func
def spiral_width(inner: float, outer: float, turns: int, radius: float) -> float:
    """Return the width of a spiral: of its line, or of the gap between its turns."""
    gap = (outer - inner) / float(turns) - 2.0 * radius
    return min(ROD * radius, SHEET * max(gap, 0.25 * radius))


@func
def growing_spiral_width(inner: float, outer: float, turns: int, radius: float) -> float:
    """Return the width of a spiral that grows: of its line, or of the gap of its first turn."""
    gap = inner * (pow(outer / inner, 1.0 / float(turns)) - 1.0) - 2.0 * radius
    return min(ROD * radius, SHEET * max(gap, 0.25 * radius))


# Other solids


@func
def frame_width(size: vec3, thickness: float) -> float:
    """Return the width of the frame of a box: of its bars, or of its windows."""
    window = min(min(size.x, size.y), size.z) - 2.0 * thickness
    return min(thickness, max(window, 0.25 * thickness)) / ROOT_THREE


@func
def coil_width(major: float, minor: float, pitch: float) -> float:
    """Return the width of a coil: of its tube, or of the gap between its turns."""
    around = 2.0 * PI * major
    gap = pitch * around / length(vec2(around, pitch)) - 2.0 * minor
    return min(ROD * minor, SHEET * max(gap, 0.25 * minor))


@func
def thread_width(pitch: float) -> float:
    """Return the width of a thread: of a quarter of its pitch, about that of a crest."""
    return 0.25 * pitch


@func
def sponge_width(size: float, iterations: int) -> float:
    """Return the width of a sponge: of its smallest hole."""
    return size / (ROOT_THREE * pow(3.0, float(iterations)))


@func
def superellipsoid_width(radii: vec3, across: float, upward: float) -> float:
    """Return the width of a superellipsoid: with exponents below 2 it is hollow between axes."""
    share = min(min(0.5 * across, 0.5 * upward), 1.0)
    return radii_width(radii) * share * share


@func
def periodic_width(cell_size: float, thickness: float, solid: bool) -> float:
    """Return the width of a periodic surface: of its sheet, or of its tubes."""
    return select(solid, 0.15 * cell_size, SHEET * thickness)


@func
def voronoi_gap_width(gap: float) -> float:
    """Return the width of the gaps between cells."""
    return SHEET * gap


@func
def tapered_width(points: Buffer[vec4]) -> float:
    """Return the width of a tube whose points have radii of their own."""
    least = points[0].w
    for i in range(1, size(points)):
        least = min(least, points[i].w)
    return ROD * least


# Operators


@func
def scaled_width(child_width: float, factor: float) -> float:
    """Return the width of a scaled shape."""
    return child_width * abs(factor)


@func
def stretched_width(child_width: float, factors: vec3) -> float:
    """Return the width of a shape that each axis scales by its own factor."""
    return child_width * min(min(abs(factors.x), abs(factors.y)), abs(factors.z))


@func
def stretched_flat_width(child_width: float, factors: vec2) -> float:
    """Return the width of an outline that each axis scales by its own factor."""
    return child_width * min(abs(factors.x), abs(factors.y))


@func
def deformed_width(child_width: float, stretch: float) -> float:
    """Return the width of a shape that is pressed together where its values become steeper."""
    return child_width / max(stretch, 1.0)


@func
def shell_width(child_width: float, thickness: float) -> float:
    """Return the width of a shell."""
    return min(child_width, SHEET * thickness)


@func
def extruded_width(child_width: float, height: float) -> float:
    """Return the width of an outline with a height."""
    return both_widths(child_width, height)


@func
def moved_width(child_width: float, distance: float) -> float:
    """Return the width of a shape whose surface moves outwards by a distance, or inwards.

    Outwards it becomes no thinner. Inwards a sheet loses twice the distance; what is left of other
    shapes is not known.
    """
    thinner = max(child_width + 2.0 * SHEET * distance, 0.1 * child_width)
    return select(distance < 0.0, thinner, max(child_width, ROD * distance))


@func
def offset_width(child_width: float, distance: float, side: float) -> float:
    """Return the width of an offset shape; ``side`` is -1 for what is cut out."""
    return moved_width(child_width, side * distance)


@func
def eroded_width(child_width: float, distance: float, side: float) -> float:
    """Return the width of an eroded shape; ``side`` is -1 for what is cut out."""
    return moved_width(child_width, -side * distance)


@func
def rounded_width(child_width: float, radius: float, side: float) -> float:
    """Return the width of a rounded shape; ``side`` is -1 for what is cut out."""
    return moved_width(child_width, side * radius)


@func
def groove_width(child_width: float, width: float) -> float:
    """Return the width of a groove or a tongue, or of what it is on."""
    return min(child_width, SHEET * width)


@func
def pipe_width(child_width: float, radius: float) -> float:
    """Return the width of a pipe along an edge, or of what has the edge."""
    return min(child_width, ROD * radius)


@func
def clearance_width(child_width: float, gap: float) -> float:
    """Return the width of a gap around a shape, or of the shapes."""
    return min(child_width, SHEET * gap)


@func
def thickened_width(child_width: float, near_thickness: float, far_thickness: float) -> float:
    """Return the width of a sheet that is thicker at one place than at others."""
    return min(child_width, SHEET * min(near_thickness, far_thickness))


@func
def cam_width(base: float, nose: float) -> float:
    """Return the width of a cam."""
    return ROD * min(base, nose)
