"""Gears by module and number of teeth: ``Gear``, ``RingGear``, ``Rack``, and pairs that mesh.

Input: the sizes of gears. Output: solids that turn about the z axis, made by extruding the
library's profiles; the positions of two gears that mesh. Does not contain formulas of distances.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Final

from distal.diagnostics import Span
from distal.lang.source_places import author_place
from distal.scene.objects.field import BaseShape
from distal.scene.objects.shape import Shape
from distal.scene.objects.shapes import made_of
from distal.scene.tree.errors import refuse, refuse_kind
from distal.scene.tree.value import recorded

if TYPE_CHECKING:
    from distal.scene.objects.argument_types import Amount

# 20 degrees, as ISO 53.
PRESSURE_ANGLE: Final = math.radians(20.0)
_TIP_GAP: Final = 0.25
# A ring has at least so many teeth more than the gear inside (of 20 degrees, as is usual).
_LEAST_DIFFERENCE: Final = 10
# How much, as a share of the radius, tips may reach beyond the last point of contact.
_TOUCHING: Final = 1e-3
_STEEPEST_HELIX: Final = math.radians(60.0)


class Toothed(Shape):
    """A part with teeth; what ``mesh_gears`` needs to know of it.

    Attributes:
        module: Diameter of the pitch circle divided by the number of teeth.
        teeth: Amount of teeth.
        pressure_angle: Pressure angle in radians.
        helix: Angle of the teeth to the axis in radians.
        pitch_radius: Radius of the pitch circle; 0 for a rack.
    """

    module: float
    teeth: int
    pressure_angle: float
    helix: float
    pitch_radius: float

    def _set(self, made: BaseShape, **known: Any) -> None:
        BaseShape.__init__(self, made.named(type(self).__name__).node)
        self.__dict__.update(known)


@recorded
class Gear(Toothed):
    """Gear with involute teeth that turns about the z axis, centred; one tooth points to +y.

    Args:
        module: Size of the teeth: diameter of the pitch circle divided by the number of teeth.
        teeth: Amount of teeth.
        width: Length along the axis.
        pressure_angle: Pressure angle in radians; None for 20 degrees.
        tip_gap: Gap between a tip and the bottom of the other gear's gap, in modules.
        backlash: By how much each tooth is narrower than half of the distance from tooth to tooth,
            along the pitch circle, in scene units.
        helix: Angle of the teeth to the axis in radians, positive for a right-handed gear; two
            gears that mesh need opposite angles.
        bore_diameter: Diameter of the hole for the shaft; 0 for none.

    Raises:
        CompileError: At the author's line: a number is beyond its limit.
    """

    # The arguments, of which ``recorded`` makes attributes.
    module: Any
    teeth: Any
    width: Any
    pressure_angle: Any
    tip_gap: Any
    backlash: Any
    helix: Any
    bore_diameter: Any

    def __init__(
        self,
        module: float = 1.0,
        teeth: int = 20,
        width: Amount = 6.0,
        *,
        pressure_angle: float | None = None,
        tip_gap: float = _TIP_GAP,
        backlash: Amount = 0.0,
        helix: float = 0.0,
        bore_diameter: Amount = 0.0,
    ) -> None:
        place = author_place()
        angle = _checked(module, teeth, pressure_angle, helix, "Gear", place)
        radius = 0.5 * module * teeth
        numbers = {"addendum": 1.0, "dedendum": 1.0 + tip_gap, "backlash": backlash}
        profile = made_of("GearProfile", radius, count=teeth, pressure_angle=angle, **numbers)
        made = _wide(profile, width, radius, helix)
        if not isinstance(bore_diameter, float | int) or bore_diameter > 0.0:
            made = made - made_of("Circle", 0.5 * bore_diameter).extrude(None)
        self._set(
            made, module=module, teeth=teeth, pressure_angle=angle, helix=helix, pitch_radius=radius
        )


@recorded
class RingGear(Toothed):
    """Ring with teeth inside, around the z axis, for a ``Gear`` with fewer teeth; a gap is at +y.

    Args:
        module: Size of the teeth, that of the gear inside.
        teeth: Amount of teeth.
        width: Length along the axis.
        rim: Thickness of the ring outside of the gaps, in scene units; None for two modules.
        pressure_angle: Pressure angle in radians; None for 20 degrees.
        tip_gap: As for ``Gear``.
        backlash: As for ``Gear``.
        helix: Angle of the teeth to the axis, that of the gear inside.

    Raises:
        CompileError: At the author's line: a number is beyond its limit.
    """

    # The arguments, of which ``recorded`` makes attributes.
    module: Any
    teeth: Any
    width: Any
    rim: Any
    pressure_angle: Any
    tip_gap: Any
    backlash: Any
    helix: Any

    def __init__(
        self,
        module: float = 1.0,
        teeth: int = 60,
        width: Amount = 6.0,
        *,
        rim: Amount | None = None,
        pressure_angle: float | None = None,
        tip_gap: float = _TIP_GAP,
        backlash: float = 0.0,
        helix: float = 0.0,
    ) -> None:
        place = author_place()
        angle = _checked(module, teeth, pressure_angle, helix, "RingGear", place)
        radius = 0.5 * module * teeth
        # The hole has the outline of a gear whose tips reach as far as the ring's gaps.
        numbers = {"addendum": 1.0 + tip_gap, "dedendum": 1.0, "backlash": -backlash}
        hole = made_of("GearProfile", radius, count=teeth, pressure_angle=angle, **numbers)
        outer = radius + (1.0 + tip_gap) * module + (2.0 * module if rim is None else rim)
        if helix == 0.0:
            made = (made_of("Circle", outer) - hole).extrude(width)
        else:
            long = 1.02 * width  # past the ring's faces
            made = made_of("Circle", outer).extrude(width) - _wide(hole, long, radius, helix)
        self._set(
            made, module=module, teeth=teeth, pressure_angle=angle, helix=helix, pitch_radius=radius
        )


@recorded
class Rack(Toothed):
    """Straight bar with teeth along x that point to +y, for a ``Gear`` above it.

    Args:
        module: Size of the teeth, that of the gear.
        teeth: Amount of teeth; of an odd number, the middle one is at x = 0.
        width: Length along z.
        base: Thickness of the bar below the teeth; None for two modules.
        pressure_angle: Pressure angle in radians; None for 20 degrees.
        tip_gap: As for ``Gear``.
        backlash: As for ``Gear``.

    Raises:
        CompileError: At the author's line: a number is beyond its limit.
    """

    # The arguments, of which ``recorded`` makes attributes.
    module: Any
    teeth: Any
    width: Any
    base: Any
    pressure_angle: Any
    tip_gap: Any
    backlash: Any

    def __init__(
        self,
        module: float = 1.0,
        teeth: int = 12,
        width: Amount = 6.0,
        *,
        base: Amount | None = None,
        pressure_angle: float | None = None,
        tip_gap: float = _TIP_GAP,
        backlash: Amount = 0.0,
    ) -> None:
        angle = _checked(module, teeth, pressure_angle, 0.0, "Rack", author_place())
        thick = 2.0 * module if base is None else base
        numbers = (module, thick, backlash, tip_gap, teeth)
        made = made_of("RackProfile", *numbers, pressure_angle=angle).extrude(width)
        self._set(
            made, module=module, teeth=teeth, pressure_angle=angle, helix=0.0, pitch_radius=0.0
        )


def _checked(
    module: Any, teeth: Any, pressure_angle: Any, helix: Any, what: str, place: Span | None
) -> float:
    """Return the pressure angle; what a pair is computed from must be plain numbers."""
    angle = PRESSURE_ANGLE if pressure_angle is None else pressure_angle
    for name, value in (("module", module), ("pressure_angle", angle), ("helix", helix)):
        if isinstance(value, bool) or not isinstance(value, float | int):
            hint = "gears that mesh follow from it; scale the finished shape by a parameter"
            refuse_kind(f"{name} of {what} is a plain number, not {value!r:.40}", hint, place)
    if isinstance(teeth, bool) or not isinstance(teeth, int):
        refuse_kind(f"teeth of {what} is a whole number, not {teeth!r:.40}", None, place)
    if not module > 0.0:
        refuse(f"module of {what} must be above 0", None, place)
    if abs(helix) > _STEEPEST_HELIX:
        refuse(f"helix of {what} must lie between -60 and 60 degrees", "it is in radians", place)
    return float(angle)


def _wide(profile: Any, width: Any, radius: float, helix: float) -> Any:
    """Return the gear of a profile, straight or helical."""
    if helix == 0.0:
        return profile.extrude(width)
    return profile.twist_extrude(width, width * (math.tan(helix) / radius))


def mesh_gears(first: Gear, second: Toothed, turn: Amount = 0.0) -> tuple[Shape, Shape]:
    """Return two parts in mesh: the first turned about the z axis at the origin, the second moved.

    A second gear stands on the side of +x and turns the other way; a ring stays around the first,
    its middle on the side of -x, and turns the same way; a rack lies below and slides along x.

    Args:
        first: The gear that drives.
        second: A ``Gear``, ``RingGear`` or ``Rack`` with the same module and pressure angle.
        turn: Angle of the first gear in radians, counterclockwise: ``turn=0.5 * time``.

    Raises:
        SceneTypeError: The parts are no gears.
        SceneValueError: They do not mesh.
    """
    place = author_place()
    if not isinstance(first, Gear) or not isinstance(second, Toothed):
        hint = "place the shapes that it returns, or paint them; a moved gear is a plain shape"
        refuse_kind("mesh_gears takes a Gear, and a Gear, RingGear or Rack", hint, place)
    _check_pair(first, second, place)
    turned = first.rotate(z=turn)
    radius, quarter = first.pitch_radius, 0.5 * math.pi
    half_step = quarter * first.module  # half of the distance from tooth to tooth
    if isinstance(second, Rack):
        # The gap of the rack that takes the tooth at -y; an odd number has a tooth in the middle.
        start = radius * math.pi - (half_step if second.teeth % 2 else 0.0)
        start -= 2.0 * half_step * round(start / (2.0 * half_step))
        return turned, second.translate(radius * turn + start, -radius, 0.0)
    ratio = radius / second.pitch_radius
    if isinstance(second, RingGear):
        # Both roll at the first gear's point at +x, where a gap takes a tooth.
        start = (ratio - 1.0) * quarter
        there = radius - second.pitch_radius
        return turned, second.rotate(z=start + ratio * turn).translate(there, 0.0, 0.0)
    start = quarter - (radius * quarter + half_step) / second.pitch_radius
    there = radius + second.pitch_radius
    return turned, second.rotate(z=start - ratio * turn).translate(there, 0.0, 0.0)


def _check_pair(first: Gear, second: Toothed, place: Span | None) -> None:
    """Refuse gears that do not mesh."""
    for name in ("module", "pressure_angle"):
        own, other = getattr(first, name), getattr(second, name)
        if not math.isclose(own, other, rel_tol=1e-9):
            refuse(
                f"gears mesh if they have one {name}; these have {own:g} and {other:g}", None, place
            )
    wanted = first.helix if isinstance(second, RingGear) else -first.helix
    if not math.isclose(second.helix, wanted, abs_tol=1e-9):
        hint = f"helix={wanted:g} for the second"
        refuse("the teeth of helical gears must run along each other", hint, place)
    _check_tips(first, second, place)


def _check_tips(first: Gear, second: Toothed, place: Span | None) -> None:
    """Refuse gears whose tips reach into feet.

    Source: the condition that tips touch involutes alone, not beyond the point where the line of
    action touches the other gear's base circle.
    """
    sine, cosine = math.sin(first.pressure_angle), math.cos(first.pressure_angle)
    if isinstance(second, RingGear):
        apart = second.pitch_radius - first.pitch_radius
        limit = math.hypot(second.pitch_radius * cosine, apart * sine)
        if second.teeth - first.teeth < _LEAST_DIFFERENCE:
            hint = f"take at least {_LEAST_DIFFERENCE} teeth less on the gear inside"
            refuse("the tips of the gear and the ring would cut into each other", hint, place)
        if second.pitch_radius - second.module < limit * (1.0 - _TOUCHING):
            _refuse_tips("ring", first.teeth, place)
        return
    if isinstance(second, Rack):
        if second.module > first.pitch_radius * sine * sine * (1.0 + _TOUCHING):
            _refuse_tips("rack", first.teeth, place)
        return
    apart = first.pitch_radius + second.pitch_radius
    for one, other in ((first, second), (second, first)):
        limit = math.hypot(other.pitch_radius * cosine, apart * sine)
        if other.pitch_radius + other.module > limit * (1.0 + _TOUCHING):
            _refuse_tips(f"gear with {other.teeth} teeth", one.teeth, place)


def _refuse_tips(other: str, teeth: int, place: Span | None) -> None:
    refuse(
        f"the tips of the {other} would cut into the feet of the gear with {teeth} teeth",
        "take more teeth there, or pressure_angle=25 * deg for both",
        place,
    )
