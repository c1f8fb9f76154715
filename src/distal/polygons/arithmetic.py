"""Distances to triangles and winding numbers: scene code, run for many points by the CPU.

Input: a point, and triangles in buffers. Output: the nearest triangle, the side of it on which the
point lies, the winding number. All in units of the grid. Does not depend on files or grids.
"""

from __future__ import annotations

from typing import Final

from distal.lang import (
    Buffer,
    atan2,
    clamp,
    cross,
    dot,
    func,
    length,
    max,
    min,
    select,
    sqrt,
    struct,
    vec3,
    vec4,
)

# The data of these buffers is replaced for each mesh.
# The corners of each triangle.
FIRST: Final = Buffer([vec3(0.0)])
SECOND: Final = Buffer([vec3(0.0)])
THIRD: Final = Buffer([vec3(0.0)])
# The triangles in the cells of a grid, and the first one of each cell and of one cell more.
MEMBERS: Final = Buffer([0])
STARTS: Final = Buffer([0])
# The numbers of the eight cells about each node.
ABOUT: Final = Buffer([0])
# The steps of one cell and of one node along y and z.
CELL_STEPS: Final = Buffer([0])
NODE_STEPS: Final = Buffer([0])
# The nearest triangle of each node plus 1; 0 is unknown.
NEAREST: Final = Buffer([0])
# The colors of the corners of each triangle.
FIRST_COLOR: Final = Buffer([vec3(0.0)])
SECOND_COLOR: Final = Buffer([vec3(0.0)])
THIRD_COLOR: Final = Buffer([vec3(0.0)])
# The normals of each triangle's seven features.
NORMALS: Final = Buffer([vec3(0.0)])
# The tree: center and radius of each node; sum of the areas' normals; the node that follows its
# subtree; its first triangle and the one after its last, equal if it is no leaf.
BALLS: Final = Buffer([vec4(0.0)])
AREAS: Final = Buffer([vec3(0.0)])
FOLLOWING: Final = Buffer([0])
BEGINS: Final = Buffer([0])
ENDS: Final = Buffer([0])

# Features of a triangle: its face, its edges from each corner, its corners.
FACE: Final = 0
EDGE: Final = 1
CORNER: Final = 4
FEATURES: Final = 7
FAR: Final = 3.0e38
TINY: Final = 1e-30
FULL_TURN: Final = 12.566370614359172
# A part of the mesh is one dipole at this distance in its radii: the winding number is then within
# 0.02 on the meshes of the tests.
REACH: Final = 2.5


@struct
class Foot:
    """The nearest point of a triangle or an edge.

    Attributes:
        offset: The vector from it to the point.
        feature: On which feature of the triangle it is.
    """

    offset: vec3
    feature: int


@struct
class NearestTriangle:
    """The nearest triangle so far.

    Attributes:
        squared: The square of its distance.
        triangle: Its number plus 1; 0 if there is none.
    """

    squared: float
    triangle: int


@func
def foot_on_edge(p: vec3, a: vec3, b: vec3, number: int) -> Foot:
    """Return the nearest point of the edge from corner ``number`` of a triangle."""
    along = b - a
    from_a = p - a
    t = clamp(dot(from_a, along) / max(dot(along, along), TINY), 0.0, 1.0)
    ends = select(t <= 0.0, CORNER + number, CORNER + (number + 1) % 3)
    return Foot(from_a - along * t, select(t > 0.0 and t < 1.0, EDGE + number, ends))


@func
def nearer(a: Foot, b: Foot) -> Foot:
    """Return the nearer of two points; the first one if they are equally near."""
    keep = dot(a.offset, a.offset) <= dot(b.offset, b.offset)
    return Foot(select(keep, a.offset, b.offset), select(keep, a.feature, b.feature))


@func
def foot_on_triangle(p: vec3, a: vec3, b: vec3, c: vec3) -> Foot:
    """Return the nearest point of a triangle.

    It is the foot of the perpendicular if that lies within all edges, else the nearest point of the
    edges; a triangle without area has edges only.
    """
    normal = cross(b - a, c - a)
    inside = min(
        min(dot(cross(normal, b - a), p - a), dot(cross(normal, c - b), p - b)),
        dot(cross(normal, a - c), p - c),
    )
    edges = nearer(
        nearer(foot_on_edge(p, a, b, 0), foot_on_edge(p, b, c, 1)), foot_on_edge(p, c, a, 2)
    )
    height = normal * (dot(normal, p - a) / max(dot(normal, normal), TINY))
    return Foot(
        select(inside > 0.0, height, edges.offset), select(inside > 0.0, FACE, edges.feature)
    )


@func
def squared_distance(p: vec3, triangle: int) -> float:
    """Return the square of the distance to a triangle."""
    offset = foot_on_triangle(p, FIRST[triangle], SECOND[triangle], THIRD[triangle]).offset
    return dot(offset, offset)


@func
def nearest_in_cells(p: vec3, cell: int) -> NearestTriangle:
    """Return the nearest triangle in the eight cells about a node; ``cell`` is the lowest one.

    If it is within one cell's width, no triangle is nearer.
    """
    best = FAR
    which = 0
    for k in range(2):
        for j in range(2):
            row = cell + j * CELL_STEPS[0] + k * CELL_STEPS[1]
            # The two cells of a row follow each other.
            for at in range(STARTS[row], STARTS[row + 2]):
                triangle = MEMBERS[at]
                squared = squared_distance(p, triangle)
                if squared < best:
                    best = squared
                    which = triangle + 1
    return NearestTriangle(best, which)


@func
def nearest_about(p: vec3, node: int) -> NearestTriangle:
    """Return the nearest triangle in the eight cells about a node, as ``nearest_in_cells``.

    ``node`` is its place in ``ABOUT``, divided by 8.
    """
    best = FAR
    which = 0
    for i in range(8):
        cell = ABOUT[8 * node + i]
        for at in range(STARTS[cell], STARTS[cell + 1]):
            triangle = MEMBERS[at]
            squared = squared_distance(p, triangle)
            if squared < best:
                best = squared
                which = triangle + 1
    return NearestTriangle(best, which)


@func
def nearest_of_neighbors(p: vec3, node: int) -> NearestTriangle:
    """Return the nearest of the triangles that are nearest to a node and its 26 neighbors."""
    best = FAR
    which = 0
    for k in range(3):
        for j in range(3):
            for i in range(3):
                found = NEAREST[node + (i - 1) + (j - 1) * NODE_STEPS[0] + (k - 1) * NODE_STEPS[1]]
                if found > 0 and found != which:
                    squared = squared_distance(p, found - 1)
                    if squared < best:
                        best = squared
                        which = found
    return NearestTriangle(best, which)


@func
def color_of_triangle(p: vec3, triangle: int) -> vec3:
    """Return the color at the nearest point of a triangle, interpolated between its corners."""
    a = FIRST[triangle]
    b = SECOND[triangle]
    c = THIRD[triangle]
    q = p - foot_on_triangle(p, a, b, c).offset
    normal = cross(b - a, c - a)
    whole = max(dot(normal, normal), TINY)
    second = clamp(dot(cross(a - c, q - c), normal) / whole, 0.0, 1.0)
    third = clamp(dot(cross(b - a, q - a), normal) / whole, 0.0, 1.0)
    first = max(1.0 - second - third, 0.0)
    colors = first * FIRST_COLOR[triangle] + second * SECOND_COLOR[triangle]
    return (colors + third * THIRD_COLOR[triangle]) / (first + second + third)


@func
def side_of_triangle(p: vec3, triangle: int) -> float:
    """Return a number that is negative inside a closed mesh; the triangle is the nearest one.

    Source: Baerentzen and Aanaes, Signed Distance Computation Using the Angle Weighted
    Pseudonormal, 2005.
    """
    foot = foot_on_triangle(p, FIRST[triangle], SECOND[triangle], THIRD[triangle])
    return dot(foot.offset, NORMALS[triangle * FEATURES + foot.feature])


@func
def solid_angle(p: vec3, triangle: int) -> float:
    """Return the solid angle of a triangle seen from a point, positive from inside.

    Source: Van Oosterom and Strackee, The Solid Angle of a Plane Triangle, 1983.
    """
    a = FIRST[triangle] - p
    b = SECOND[triangle] - p
    c = THIRD[triangle] - p
    la = length(a)
    lb = length(b)
    lc = length(c)
    below = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb
    return 2.0 * atan2(dot(a, cross(b, c)), below)


@func
def winding_number(p: vec3) -> float:
    """Return how often the mesh surrounds a point: 1 inside, 0 outside if it is closed.

    Parts that are far away count as dipoles.

    Source: Barill et al., Fast Winding Numbers for Soups and Clouds, 2018.
    """
    total = 0.0
    at = 0
    while at >= 0:
        ball = BALLS[at]
        to = vec3(ball.x, ball.y, ball.z) - p
        away = dot(to, to)
        if away > REACH * REACH * ball.w * ball.w:
            total += dot(AREAS[at], to) / (away * sqrt(away))
            at = FOLLOWING[at]
        elif ENDS[at] > BEGINS[at]:
            for triangle in range(BEGINS[at], ENDS[at]):
                total += solid_angle(p, triangle)
            at = FOLLOWING[at]
        else:
            at += 1
    return total / FULL_TURN
