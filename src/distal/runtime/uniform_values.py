"""The value of every uniform of a run: the frame's, the parameters', a scene's numbers.

Input: modules, and what a caller gave: time, parameters by name, settings. Output: checked plain
numbers by the names that kernels know. Knows no device.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from distal.ir.nodes import Module, Origin, UniformDeclaration
from distal.ir.types import BOOL, FLOAT, INT, Vector
from distal.lang.chosen_values import checked_values
from distal.lang.parameter_values import as_bool, as_float, as_int, as_point
from distal.lang.parameters import Parameter
from distal.lang.render_options import RenderOptions
from distal.passes.entry import renamed_parameters


class DeclaredUniforms:
    """The parameters and numbers of modules that are run together.

    They are collected once: a scene of a thousand numbers is rendered frame by frame.

    Attributes:
        parameters: The parameters that they read, by first use.
        numbers: The scene's numbers by name, with their own values.
    """

    def __init__(self, modules: Sequence[Module]) -> None:
        uniforms = [u for module in modules for u in module.uniforms]
        by_name = {u.name: u.source for u in uniforms if u.origin is Origin.PARAMETER}
        self.parameters: list[Parameter] = list(by_name.values())
        self._numbers = {u.name: u for u in uniforms if u.origin is Origin.NUMBER}
        self.numbers = {name: u.default for name, u in self._numbers.items()}
        self._renamed = [renamed_parameters(module.uniforms) for module in modules]

    def parameter_values(self, params: Mapping[str, Any]) -> dict[str, Any]:
        """The value of each parameter: as given, checked, or its default.

        Keys are parameters' names or labels.

        Raises:
            ValueError: A name is unknown, or a value outside its range.
            TypeError: A value is of another kind.
        """
        defaults: dict[str, Any] = {p.name: p.default for p in self.parameters}
        return {**defaults, **checked_values(self.parameters, params)}

    def number_values(self, settings: Mapping[str, Any]) -> dict[str, Any]:
        """The value of each number of a scene: its own, or that of a setting.

        Raises:
            ValueError: No number is called like a setting, or a value is out of reach.
            TypeError: A value is of another kind.
        """
        changed = {}
        for name, value in settings.items():
            if name not in self._numbers:
                raise ValueError(f"there is no number '{name}' in the scene")
            changed[name] = _checked_number(self._numbers[name], value)
        return {**self.numbers, **changed}

    def for_kernel(
        self, position: int, parameters: Mapping[str, Any], others: Mapping[str, Any]
    ) -> dict[str, Any]:
        """Everything by the names that the kernel of one of the modules knows.

        ``others`` are the frame's values and the numbers; a parameter that is called like one of
        the frame's has another name in the kernel (``distal.passes.entry``).
        """
        renamed = self._renamed[position]
        return {**others, **{renamed.get(name, name): v for name, v in parameters.items()}}


def _checked_number(uniform: UniformDeclaration, value: Any) -> Any:
    if uniform.type is FLOAT:
        return as_float(uniform.name, value)
    if uniform.type is INT:
        return as_int(uniform.name, value)
    if uniform.type is BOOL:
        return as_bool(uniform.name, value)
    assert isinstance(uniform.type, Vector), f"{uniform.type} is no setting"
    return as_point(uniform.name, value, (uniform.type.size,))


def frame_values(options: RenderOptions) -> dict[str, Any]:
    """The frame's uniforms."""
    width, height = options.size
    return {
        "resolution": (float(width), float(height)),
        "time": options.time,
        "mouse": options.mouse,
        "index": (options.index + 2**31) % 2**32 - 2**31,
        "seed": options.seed & 0xFFFFFFFF,
    }
