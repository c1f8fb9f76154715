"""Names that shapes do not have, and the methods to use instead.

Input: a name that was not found. Output: a message that names the method. Does not import shapes.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

_ROTATE: Final = "rotate(x=…, y=…, z=…), in radians"
_MIRROR: Final = "mirror('x'), or mirror(across=normal)"
_SYMMETRY: Final = "symmetry('x'), or symmetry(across=normal): one half, copied over"
_PAINT: Final = "paint(material or color)"
_UNION: Final = "a | b, or a.union(b, smooth=0.1)"
_DIFFERENCE: Final = "a - b, or a.difference(b)"
_INTERSECTION: Final = "a & b, or a.intersection(b)"
_PICTURE: Final = "render((640, 480)).save(file), and mesh().save(file)"

OTHER_NAMES: Final[Mapping[str, str]] = {
    **dict.fromkeys(
        ("move", "moved", "shift", "translated", "at", "position"), "translate(x, y, z)"
    ),
    **dict.fromkeys(("rotate_x", "rotate_y", "rotate_z", "rotateX", "rotateY", "rotateZ"), _ROTATE),
    **dict.fromkeys(("rotated", "rot", "turn"), _ROTATE),
    **dict.fromkeys(("scaled", "resize"), "scale(factor)"),
    **dict.fromkeys(("color", "colour", "set_material", "with_material"), _PAINT),
    **dict.fromkeys(("add", "join", "fuse", "merge", "smooth_union", "blend"), _UNION),
    **dict.fromkeys(("subtract", "cut", "minus", "smooth_difference"), _DIFFERENCE),
    **dict.fromkeys(("intersect", "common", "smooth_intersection"), _INTERSECTION),
    **dict.fromkeys(("hollow", "onion"), "shell(thickness)"),
    **dict.fromkeys(("rounded", "filleted"), "round(radius), or (a - b).fillet(radius)"),
    **dict.fromkeys(("bevel", "chamfered"), "(a - b).chamfer(size)"),
    **dict.fromkeys(("stack", "place_on", "on_top"), 'on(other, "top")'),
    **dict.fromkeys(("reflect", "reflected", "mirrored", "flip"), _MIRROR),
    **dict.fromkeys(("mirror_x", "mirror_y", "mirror_z", "mirrorX", "flip_x"), _MIRROR),
    **dict.fromkeys(("symmetric", "symmetry_x", "fold", "mirror_copy"), _SYMMETRY),
    **dict.fromkeys(("circular_array", "polar_array"), "repeat_polar(count)"),
    **dict.fromkeys(("sdf", "distance", "evaluate", "eval"), "shape(points)"),
    **dict.fromkeys(("normal", "normals", "grad"), "gradient(points)"),
    **dict.fromkeys(("bounding_box", "bbox"), "bounds()"),
    **dict.fromkeys(("save", "image", "picture"), _PICTURE),
}
_SOLID_ONLY: Final = "for solids; make it one by extrude(height) or revolve()"
_FLAT_ONLY: Final = "for flat shapes; slice() makes one of a solid"


def instead(kind: str, name: str, *, flat: bool, of_others: bool) -> str:
    """Return the message for a name that a shape does not have.

    Args:
        kind: The word for the shape in the message.
        name: The name that was not found.
        flat: Whether the shape is flat.
        of_others: Whether shapes of the other dimension have the name.
    """
    message = f"'{kind}' has no '{name}'"
    if of_others:
        return f"{message}: it is {_SOLID_ONLY if flat else _FLAT_ONLY}"
    return f"{message}; there is {OTHER_NAMES[name]}" if name in OTHER_NAMES else message
