"""Every solid of the library, by one import.

What flows in: the modules ``solids_*``, one theme each. What flows out: their shapes' functions.
"""

from __future__ import annotations

from distal.fields.solids_boxes import (
    box,
    box_cheap,
    box_frame,
    chamfer_box,
    corner,
    round_box,
    round_frame,
)
from distal.fields.solids_cones import (
    capped_cone,
    capped_cone_between,
    cone,
    cone_between,
    cone_cheap,
    infinite_cone,
    round_cone,
    round_cone_between,
)
from distal.fields.solids_cuts import (
    cut_hollow_sphere,
    cut_sphere,
    death_star,
    solid_angle,
    vesica_between,
    vesica_solid,
)
from distal.fields.solids_cylinders import (
    capsule,
    capsule_between,
    cylinder,
    cylinder_between,
    infinite_cylinder,
    rounded_cylinder,
)
from distal.fields.solids_polyhedra import (
    convex_polyhedron,
    octahedron,
    pyramid,
    tetrahedron,
)
from distal.fields.solids_prisms import (
    hex_prism,
    octagon_prism,
    prism,
    rhombus,
    tri_prism,
)
from distal.fields.solids_regular import (
    dodecahedron,
    icosahedron,
    octahedron_cheap,
    truncated_icosahedron,
    truncated_octahedron,
)
from distal.fields.solids_rings import (
    capped_torus,
    circle_line,
    disc,
    link,
    torus,
)
from distal.fields.solids_round import (
    blob,
    ellipsoid,
    sphere,
    superellipsoid,
)
from distal.fields.solids_smoothed import (
    smooth_dodecahedron,
    smooth_icosahedron,
    smooth_octahedron,
    smooth_truncated_icosahedron,
    smooth_truncated_octahedron,
)
from distal.fields.solids_surfaces import (
    half_space,
    plane,
    quad,
    slab,
    triangle,
    wedge,
)

__all__ = [
    "blob",
    "box",
    "box_cheap",
    "box_frame",
    "capped_cone",
    "capped_cone_between",
    "capped_torus",
    "capsule",
    "capsule_between",
    "chamfer_box",
    "circle_line",
    "cone",
    "cone_between",
    "cone_cheap",
    "convex_polyhedron",
    "corner",
    "cut_hollow_sphere",
    "cut_sphere",
    "cylinder",
    "cylinder_between",
    "death_star",
    "disc",
    "dodecahedron",
    "ellipsoid",
    "half_space",
    "hex_prism",
    "icosahedron",
    "infinite_cone",
    "infinite_cylinder",
    "link",
    "octagon_prism",
    "octahedron",
    "octahedron_cheap",
    "plane",
    "prism",
    "pyramid",
    "quad",
    "rhombus",
    "round_box",
    "round_cone",
    "round_cone_between",
    "round_frame",
    "rounded_cylinder",
    "slab",
    "smooth_dodecahedron",
    "smooth_icosahedron",
    "smooth_octahedron",
    "smooth_truncated_icosahedron",
    "smooth_truncated_octahedron",
    "solid_angle",
    "sphere",
    "superellipsoid",
    "tetrahedron",
    "torus",
    "tri_prism",
    "triangle",
    "truncated_icosahedron",
    "truncated_octahedron",
    "vesica_between",
    "vesica_solid",
    "wedge",
]
