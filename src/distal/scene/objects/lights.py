"""Lights of a scene.

Input: the lights declared in ``render``. Output: a class for each. Its arguments are positions,
directions, colors and intensities; all may be parameters or change with time. A light illuminates
a point from a position or direction (``sample``), or a surface by its normal from all sides
(``ambient``). A point light of intensity 1 at distance 1, perpendicular to a white matte surface,
makes it appear white (radiance 1).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, ClassVar, Final

from distal.lang.functions import Func
from distal.lang.source_places import author_place
from distal.render import ambient as _ambient  # noqa: F401 (declares lights)
from distal.render import lights as _lights
from distal.render.declarations import LIGHTS, Family
from distal.scene.objects.declared import declared_call, declared_class, given_arguments
from distal.scene.objects.scene_object import PlacedObject
from distal.scene.tree.arguments import slots_of
from distal.scene.tree.calls import FunctionCall
from distal.scene.tree.own_functions import FALLOFF
from distal.scene.tree.value import recorded


@recorded
class Light(PlacedObject):
    """The base class of lights.

    A light never changes after construction. Its methods place it as those of a shape: its
    position and direction move, and its brightness stays.

    Attributes:
        sample: ``(p) -> LightSample``, the light that arrives at a point; None for light from all
            sides.
        ambient: ``(n) -> vec3``, the light that a surface with normal n receives from all sides;
            else None.
        radiance: ``(direction) -> vec3``, the light from a direction, where there is ``ambient``;
            else None.
    """

    __slots__ = ("ambient", "radiance", "sample")

    noun: ClassVar[str] = "light"
    family: ClassVar[Family] = LIGHTS
    sample: FunctionCall | None
    ambient: FunctionCall | None
    radiance: FunctionCall | None

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        place, what = author_place(), type(self).__name__
        given = given_arguments(self.declaration, args, kwargs, what, place)
        call = declared_call(self.declaration, given, place, what=what)
        if given.get("falloff") is not None:
            shaped = {"light": call, "falloff": FALLOFF.checked(given["falloff"], place)}
            call = FunctionCall(call.what, _lights.with_falloff, shaped, place)
        everywhere = any(slot.name == "n" for slot in slots_of(call.func))
        self._keep(
            sample=None if everywhere else call,
            ambient=call if everywhere else None,
            radiance=call_of_part(call, self.declaration.radiance),
        )

    @property
    def directions(self) -> tuple[FunctionCall, FunctionCall] | None:
        """Random directions for ``radiance``, if it is too uneven for those of a surface.

        ``(u) -> DirectionSample`` and the density, ``(direction) -> float``.
        """
        return None

    def _checked(self) -> Iterator[Mapping[str, Any]]:
        for call in (self.radiance, self.sample, self.ambient):
            if call is not None:
                yield _without_falloff(call).values

    def _compared(self) -> tuple[Any, ...]:
        return self.noun, self.sample, self.ambient, self.radiance

    def functions(self) -> Iterator[Func]:
        """Yield the scene functions that the light calls."""
        for call in (self.sample, self.ambient):
            if call is not None:
                yield from call.functions()


def _without_falloff(call: FunctionCall) -> FunctionCall:
    inner = call.values.get("light")
    return inner if isinstance(inner, FunctionCall) else call


def call_of_part(whole: FunctionCall, function: Func | None) -> FunctionCall | None:
    """Return a call of a function that takes some of another call's values; None of none."""
    if function is None:
        return None
    taken = {slot.name for slot in slots_of(function)}
    values = {name: value for name, value in whole.values.items() if name in taken}
    return FunctionCall(whole.what, function, values, whole.place)


CLASSES: Final = {name: declared_class(found, Light) for name, found in LIGHTS.members.items()}
globals().update(CLASSES)
