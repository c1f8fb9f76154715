"""How normals of triangles are joined at a corner, as scene code.

Input: normals and areas of triangles. Output: normals of corners. One row for each pair. Needs no
field.
"""

from __future__ import annotations

import math
from typing import Final

from distal.lang import dot, func, select, vec3
from distal.mesh.arithmetic import unit_or_zero

# Below this cosine between a point's normal and a triangle's, or between two triangles', the edge
# between them is seen: 30 degrees.
SMOOTH: Final = math.cos(math.radians(30.0))


@func
def is_smooth(face: vec3, normal: vec3) -> bool:
    """Return whether a triangle may be lit by the normal of its corner."""
    return dot(face, normal) > SMOOTH


@func
def joined(face: vec3, other: vec3, area: float) -> vec3:
    """Return the share of another triangle in the normal of a corner; 0 beyond an edge.

    Args:
        face: The normal of the corner's triangle.
        other: That of the other triangle.
        area: The other's area.
    """
    return select(is_smooth(face, other), other * area, vec3(0.0))


@func
def unit(total: vec3, face: vec3) -> vec3:
    """Return the direction of a sum, or the normal of the triangle where the sum is 0."""
    return select(dot(total, total) > 0.0, unit_or_zero(total), face)
