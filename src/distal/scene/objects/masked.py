"""A changed shape inside a region, the shape itself outside: operators that act in a region alone.

Input: a shape, a region, the changed shape. Output: a union of three intersections: the shape
outside the region, the changed shape inside it, and what both have in common. The third changes no
surface; without it, the border of the region would be a surface inside the solid. All three are
combinations whose values are safe, so nothing is known here of slopes.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from distal.diagnostics import Span
from distal.fields.guarantees import Limit
from distal.ir.types import FLOAT
from distal.scene.objects.field import BaseShape
from distal.scene.tree.conversion import Asked, number
from distal.scene.tree.errors import refuse, refuse_kind

if TYPE_CHECKING:
    from distal.scene.objects.argument_types import Number


def masked(
    shape: BaseShape,
    region: BaseShape,
    changed: BaseShape | Callable[[Any], BaseShape],
    blend: Number,
    place: Span | None,
) -> Any:
    """Return a shape that is another one inside a region.

    Args:
        shape: The shape.
        region: The region, a shape.
        changed: The shape inside the region, or a function that makes it.
        blend: The size of the fillets where the two meet.
        place: The author's line.

    Raises:
        SceneTypeError: The region or what is changed is no shape.
        SceneValueError: They do not all lie in the plane, or the blend is below 0.
    """
    inside = changed if isinstance(changed, BaseShape) or not callable(changed) else changed(shape)
    for name, given in (("a region", region), ("what is shown there", inside)):
        if not isinstance(given, BaseShape):
            hint = "shape.where(Box(1.0), lambda s: s.bend(0.5))"
            refuse_kind(f"{name} of where is a shape, not {given!r:.60}", hint, place)
        if given.flat != shape.flat:
            kinds = ("a flat shape", "a solid")
            refuse(
                f"{name} of where is {kinds[not given.flat]}; the shape is {kinds[not shape.flat]}",
                None,
                place,
            )
    asked = Asked("blend", "where", FLOAT, Limit.NOT_NEGATIVE, place=place)
    sharp = number(blend, asked).plain == 0.0
    numbers: dict[str, Any] = {} if sharp else {"smooth": blend}
    kept = shape.difference(region, **numbers)
    shown = inside.intersection(region, **numbers)
    return kept.union(shown, **numbers).union(shape.intersection(inside))
