"""Scenes as values: their arguments, and scenes with others.

Input: what the author gave a scene, and its checked numbers. Output: arguments by name; attributes
for the numbers. Does not depend on how a scene is made.
"""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, Final, Self

from distal.frontend.problems import did_you_mean
from distal.lang.source_places import author_place
from distal.scene.tree.errors import refuse_kind
from distal.scene.tree.value import AuthorObject, value_of

if TYPE_CHECKING:
    from distal.diagnostics import Span
    from distal.scene.looks.look import Look
    from distal.scene.objects.materials import Material
    from distal.scene.tree.conversion import Number
    from distal.scene.tree.texts import TextWriter


class SceneValue(AuthorObject):
    """The part of a scene that shows what it was made from.

    ``shape``, ``lights``, ``camera`` and ``background`` are those that are drawn: the author's,
    else the look's. ``arguments`` are as given.

    Attributes:
        look: The look that the scene is dressed in.
    """

    look: Look
    material: Material
    has_floor: bool
    numbers: Mapping[str, Number]
    _given: Mapping[str, Any]

    # The arguments that are numbers, which have no attribute of their own.
    number_names: ClassVar[tuple[str, ...]] = (
        "exposure",
        "fog",
        "fog_density",
        "ambient_occlusion",
        "near",
        "far",
        "stride",
        "stride_growth",
    )

    # The arguments that are settings.
    setting_names: ClassVar[tuple[str, ...]] = (
        "tone_map",
        "glow",
        "shadows",
        "mode",
        "bounces",
        "shutter",
        "normals",
        "march",
        "steps",
        "acceleration",
    )

    @property
    def arguments(self) -> Mapping[str, Any]:
        """The arguments by name, as given; None for those that the look decides."""
        names = inspect.signature(type(self)).parameters
        return MappingProxyType({name: self._given[name] for name in names})

    @property
    def floor(self) -> bool:
        """Whether the scene stands on the look's floor."""
        return self.has_floor

    @property
    def default_material(self) -> Material:
        """The material of shapes without ``paint``."""
        return self.material

    def _replaced(self, changes: dict[str, Any]) -> Self:
        """Return the scene with other arguments."""
        place = author_place()
        for name in changes:
            if name not in self._given:
                hint = did_you_mean(name, self._given) or f"it takes {', '.join(self._given)}"
                refuse_kind(f"a scene has no '{name}'", hint, place)
        return self._remade(changes, place)

    def _parts(self) -> Mapping[str, Any]:
        """Return the arguments that were given, and the numbers that the look has chosen."""
        arguments = {
            name: getattr(self, name) if value is None and name in self.number_names else value
            for name, value in self.arguments.items()
        }
        return {name: value for name, value in arguments.items() if value is not None}

    def _written(self, writer: TextWriter) -> str:
        parameters = inspect.signature(type(self)).parameters
        defaults = {name: parameter.default for name, parameter in parameters.items()}
        # Types first: a parameter cannot be compared with a number.
        given = {
            n: v
            for n, v in self.arguments.items()
            if type(v) is not type(defaults[n]) or v != defaults[n]
        }
        return writer.call(type(self), given)

    def _compared(self) -> tuple[Any, ...]:
        names = ("name", "subject", "shape", "lights", "camera", "background", "material", "look")
        drawn = tuple(getattr(self, name) for name in (*names, "numbers", *self.setting_names))
        return "scene", *drawn

    def _remade(self, changes: Mapping[str, Any], place: Span | None) -> Self:
        """Return the scene of other arguments; ``place`` is the line of its messages."""
        raise NotImplementedError


def _number(name: str) -> property:
    return property(
        lambda scene: value_of(scene.numbers.get(name)), doc=f"The argument ``{name}``."
    )


_NUMBERS: Final = {name: _number(name) for name in SceneValue.number_names}
for _name, _property in _NUMBERS.items():
    setattr(SceneValue, _name, _property)
