"""Compute the value of every uniform: of the frame, parameters (sliders, …), a scene's numbers.

Input: modules, and the caller's values: time, parameters by name, settings. Output: checked plain
numbers by the uniforms' names in kernels. Does not depend on a device.
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

    They are collected once, because a scene can have a thousand numbers and many frames.

    Attributes:
        parameters: The parameters that the modules read, in order of first use.
        numbers: The scene's numbers by name, with their default values.
    """

    def __init__(self, modules: Sequence[Module]) -> None:
        uniforms = [u for module in modules for u in module.uniforms]
        by_name = {u.name: u.source for u in uniforms if u.origin is Origin.PARAMETER}
        self.parameters: list[Parameter] = list(by_name.values())
        self._numbers = {u.name: u for u in uniforms if u.origin is Origin.NUMBER}
        self.numbers = {name: u.default for name, u in self._numbers.items()}
        self._renamed = [renamed_parameters(module.uniforms) for module in modules]

    def parameter_values(self, params: Mapping[str, Any]) -> dict[str, Any]:
        """Return the value of each parameter: the given one, checked, or its default.

        Keys of ``params`` are names or labels of parameters.

        Raises:
            ValueError: There is no such parameter, or a value is out of its range.
            TypeError: A value has the wrong type.
        """
        defaults: dict[str, Any] = {p.name: p.default for p in self.parameters}
        return {**defaults, **checked_values(self.parameters, params)}

    def number_values(self, settings: Mapping[str, Any]) -> dict[str, Any]:
        """Return the value of each number of the scene: from ``settings``, or its default.

        Raises:
            ValueError: There is no such number, or a value is out of range.
            TypeError: A value has the wrong type.
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
        """Return all values by their names in the kernel of one of the modules.

        A parameter with the same name as a value of the frame has another name in the kernel
        (``distal.passes.entry``).

        Args:
            position: The index of the module.
            parameters: Values of the parameters by name.
            others: Values of the frame and the scene's numbers by name.
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
    """Return the values of the frame's uniforms."""
    width, height = options.size
    return {
        "resolution": (float(width), float(height)),
        "time": options.time,
        "mouse": options.mouse,
        "index": ((options.index or 0) + 2**31) % 2**32 - 2**31,
        "seed": options.seed & 0xFFFFFFFF,
        "delta": options.delta,
        "date": options.date,
        "buttons": options.buttons,
    }


def chosen_uniforms(
    declared: DeclaredUniforms, options: RenderOptions
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the values of the parameters, and those of the frame and of the scene's numbers."""
    values = declared.parameter_values(options.params)
    return values, {**declared.number_values(options.settings), **frame_values(options)}
