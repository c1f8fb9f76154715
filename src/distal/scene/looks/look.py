"""What a look is: numbers that an author can change, and what they light, color and frame.

Input: the author's numbers. Output: a ``Look`` with checked numbers. Does not depend on a scene.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, Literal, TypeAlias

from distal.diagnostics import Span
from distal.fields.guarantees import Limit
from distal.lang import func, vec3
from distal.lang.functions import Func
from distal.lang.immutable import Immutable
from distal.lang.source_places import author_place
from distal.scene.tree.arguments import arguments
from distal.scene.tree.value import AuthorObject, value_of

if TYPE_CHECKING:
    from distal.scene.tree.texts import TextWriter

# How the main light shines: as a lamp at some distance, or as the sun.
Shining: TypeAlias = Literal["lamp", "sun"]

LIMITS: Final = {
    "fov_deg": Limit.POSITIVE,
    "margin": Limit.POSITIVE,
    "exposure": Limit.NOT_NEGATIVE,
    "light_intensity": Limit.NOT_NEGATIVE,
    "light_angle": Limit.NOT_NEGATIVE,
    "rim_intensity": Limit.NOT_NEGATIVE,
    "fill": Limit.NOT_NEGATIVE,
    "haze": Limit.NOT_NEGATIVE,
    "floor_color": Limit.FRACTION,
    "material": Limit.FRACTION,
}
COLORS: Final = ("sky", "ground", "material", "zenith", "horizon")


@func
def look_numbers(
    azimuth: float,
    elevation: float,
    fov_deg: float,
    margin: float,
    exposure: float,
    light_azimuth: float,
    light_elevation: float,
    light_intensity: float,
    light_color: vec3,
    light_angle: float,
    rim_azimuth: float,
    rim_elevation: float,
    rim_intensity: float,
    rim_color: vec3,
    fill: float,
    sky: vec3,
    ground: vec3,
    zenith: vec3,
    horizon: vec3,
    floor_color: vec3,
    material: vec3,
    haze: float,
) -> float:
    """Declare the names, types and order of a look's numbers; never called.

    Args:
        azimuth: The camera's way around the scene, in radians; 0 looks from +z, pi/2 from +x.
        elevation: The camera's elevation, in radians.
        fov_deg: The camera's vertical field of view, in degrees.
        margin: Size of the picture divided by the size of what it shows.
        exposure: A factor on all light.
        light_azimuth: How far the main light is to the right of the camera, in radians.
        light_elevation: Elevation of the main light, in radians.
        light_intensity: What a white matte surface shows that faces the main light.
        light_color: Color of the main light.
        light_angle: Angular size of the main light, in radians.
        rim_azimuth: How far the second light is to the right of the camera, in radians.
        rim_elevation: Elevation of the second light, in radians.
        rim_intensity: What a white matte surface shows that faces the second light.
        rim_color: Color of the second light.
        fill: Intensity of the light from all sides.
        sky: Its color from above.
        ground: Its color from below.
        zenith: Color of the background overhead.
        horizon: Color of the background along the horizon.
        floor_color: Color of the floor.
        material: Color of shapes without ``paint``.
        haze: Density of the fog, for each radius of what the picture shows.
    """
    return azimuth


@dataclass(frozen=True, slots=True, kw_only=True)
class LookRow:
    """A look of the library.

    Attributes:
        doc: What it looks like, in one sentence.
        numbers: The values of ``look_numbers``.
        tone_map: Its tone map.
        main: How the main light shines.
        second: How the second light shines.
        distance: Distance of lamps, in radii of what the picture shows.
        rim_angle: Angular size of the second light, in radians.
        backdrop: ``(direction, …) -> vec3``, a function of some of the numbers and of ``air``.
        air: Further numbers of the backdrop.
        lined: Whether floor and shapes without ``paint`` show lines of equal x, y and z.
    """

    doc: str
    numbers: Mapping[str, Any]
    backdrop: Func
    tone_map: str = "aces"
    main: Shining = "sun"
    second: Shining = "sun"
    distance: float = 9.0
    rim_angle: float = 0.22
    air: Mapping[str, Any] = field(default_factory=dict)
    lined: bool = False


class Look(AuthorObject, Immutable):
    """The light, background, camera, floor and tone map of a scene, where the author gives none.

    A look never changes after construction; ``studio(exposure=1.5)`` makes one with other numbers.

    Args:
        name: "studio", "outdoor" …
        row: The look of the library that it is made of.
        changed: The numbers that the author gives, by name.
        place: The author's line.

    Raises:
        ValueError: A number is out of its range.
        TypeError: There is no such number, or it is of another kind.

    Attributes:
        name: As given.
        row: As given.
        numbers: All numbers, checked, by name.
    """

    __slots__ = ("_changed", "_kept_digest", "name", "numbers", "row")

    name: str
    row: LookRow
    numbers: Mapping[str, Any]
    _changed: Mapping[str, Any]

    def __init__(
        self, name: str, row: LookRow, changed: Mapping[str, Any], place: Span | None
    ) -> None:
        numbers = arguments(
            look_numbers,
            (),
            {**row.numbers, **changed},
            what=name,
            limits=LIMITS,
            colors=COLORS,
            place=place,
        )
        self._keep(name=name, row=row, numbers=numbers, _changed=changed)

    def _keep(self, **attributes: Any) -> None:
        """Set attributes, on construction only."""
        for name, value in attributes.items():
            object.__setattr__(self, name, value)

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"a look does not change; make another: {self.name}(…)")

    @property
    def arguments(self) -> Mapping[str, Any]:
        """All numbers of the look, checked, by name."""
        return MappingProxyType({name: value_of(v) for name, v in self.numbers.items()})

    def _written(self, writer: TextWriter) -> str:
        numbers = self.arguments
        changed = {name: numbers[name] for name in self._changed}
        return writer.call(self.name, changed)

    def _pickled(self) -> Any:
        return _look_of, (self.name, self.row, dict(self._changed), dict(self.numbers))

    def _compared(self) -> tuple[Any, ...]:
        return "look", self.name, self.row, self.numbers

    def _replaced(self, changes: dict[str, Any]) -> Look:
        """Return the look with other numbers."""
        return Look(self.name, self.row, {**self._changed, **changes}, author_place())

    if not TYPE_CHECKING:  # a checker reports an unknown name itself

        def __getattr__(self, name):
            if name.startswith("_") or name not in self.numbers:
                raise AttributeError(f"a look has no '{name}'", name=name, obj=self)
            return value_of(self.numbers[name])

    def __getitem__(self, name: str) -> Any:
        """Return one of the numbers: a float, a tuple, or an expression."""
        return self.numbers[name].value


def _look_of(
    name: str, row: LookRow, changed: Mapping[str, Any], numbers: Mapping[str, Any]
) -> Look:
    """Return a look from a pickle."""
    made = Look.__new__(Look)
    made._keep(name=name, row=row, numbers=numbers, _changed=changed)
    return made
