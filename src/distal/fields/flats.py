"""Every flat shape of the library, by one import.

What flows in: the modules ``flats_*``, one theme each. What flows out: their shapes' functions.
"""

from __future__ import annotations

from distal.fields.flats_boxes import (
    chamfered_rectangle,
    cross_shape,
    half_plane,
    oriented_rectangle,
    rectangle,
    rounded_rectangle,
    stairs,
    tunnel,
)
from distal.fields.flats_conics import (
    blobby_cross,
    ellipse,
    hyperbola,
    parabola,
    parabola_segment,
    quadratic_circle,
)
from distal.fields.flats_curved import (
    circle_cross,
    egg,
    heart,
    moon,
    oriented_vesica,
    rounded_x,
    uneven_capsule,
    vesica,
)
from distal.fields.flats_curves import (
    cubic_bezier,
    quadratic_bezier,
    segment,
    spline_path,
)
from distal.fields.flats_lines import (
    archimedean_spiral,
    circle_wave,
    cool_s,
    logarithmic_spiral,
)
from distal.fields.flats_points import (
    polygon,
    polyline,
    rounded_polygon,
)
from distal.fields.flats_polygons import (
    equilateral_triangle,
    hexagon,
    hexagram,
    isosceles_triangle,
    octagon,
    pentagon,
    pentagram,
    regular_polygon,
    regular_star,
    triangle2,
)
from distal.fields.flats_profiles import (
    arc_cam,
    gear_profile,
    image_field,
    tangent_cam,
)
from distal.fields.flats_round import (
    annulus,
    arc,
    circle,
    cut_disk,
    horseshoe,
    pie,
    ring,
)
from distal.fields.flats_slanted import (
    isosceles_trapezoid,
    parallelogram,
    rhombus2,
)

__all__ = [
    "annulus",
    "arc",
    "arc_cam",
    "archimedean_spiral",
    "blobby_cross",
    "chamfered_rectangle",
    "circle",
    "circle_cross",
    "circle_wave",
    "cool_s",
    "cross_shape",
    "cubic_bezier",
    "cut_disk",
    "egg",
    "ellipse",
    "equilateral_triangle",
    "gear_profile",
    "half_plane",
    "heart",
    "hexagon",
    "hexagram",
    "horseshoe",
    "hyperbola",
    "image_field",
    "isosceles_trapezoid",
    "isosceles_triangle",
    "logarithmic_spiral",
    "moon",
    "octagon",
    "oriented_rectangle",
    "oriented_vesica",
    "parabola",
    "parabola_segment",
    "parallelogram",
    "pentagon",
    "pentagram",
    "pie",
    "polygon",
    "polyline",
    "quadratic_bezier",
    "quadratic_circle",
    "rectangle",
    "regular_polygon",
    "regular_star",
    "rhombus2",
    "ring",
    "rounded_polygon",
    "rounded_rectangle",
    "rounded_x",
    "segment",
    "spline_path",
    "stairs",
    "tangent_cam",
    "triangle2",
    "tunnel",
    "uneven_capsule",
    "vesica",
]
