"""The value of every uniform of a run: the frame's, the parameters', a scene's numbers.

Input: modules, and what a caller gave: time, parameters by name, settings. What flows out:
checked plain numbers by the names that kernels know. A mistake of the caller's is a ``TypeError``
or ``ValueError`` that names it. Knows no device.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Mapping, Sequence
from typing import Any, Final

from distal.ir.limits import LARGEST_TIME
from distal.ir.nodes import Module, Origin, UniformDeclaration
from distal.ir.types import BOOL, FLOAT, INT, Vector
from distal.lang.chosen_values import checked_values
from distal.lang.parameter_values import as_bool, as_float, as_int, as_point
from distal.lang.parameters import Parameter
from distal.passes.entry import renamed_parameters

LARGEST_SIDE_PX: Final = 16384


class Declared:
    """What modules that are run together ask for, sorted out once.

    A scene of a thousand numbers is rendered frame by frame: no frame goes through them again.

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


def frame_values(
    size: tuple[int, int], seconds: float, mouse: Any, index: Any, seed: Any
) -> dict[str, Any]:
    """The frame's uniforms; ``size`` and ``seconds`` are checked already."""
    return {
        "resolution": (float(size[0]), float(size[1])),
        "time": seconds,
        "mouse": _checked_mouse(mouse),
        "index": (_checked_int("index", index) + 2**31) % 2**32 - 2**31,
        "seed": _checked_int("seed", seed) & 0xFFFFFFFF,
    }


def checked_size(size: Any) -> tuple[int, int]:
    """Width and height in pixels."""
    try:
        width, height = map(operator.index, size)
    except (TypeError, ValueError):
        raise TypeError(f"size is (width, height) in pixels, not {size!r}") from None
    if not (1 <= width <= LARGEST_SIDE_PX and 1 <= height <= LARGEST_SIDE_PX):
        raise ValueError(f"each side has 1 to {LARGEST_SIDE_PX} pixels, not {width}x{height}")
    return width, height


def checked_time(seconds: Any) -> float:
    """A time in seconds that 32 bits still tell from its neighbours."""
    try:
        value = float(seconds)
    except (TypeError, ValueError):
        raise TypeError(f"time is a number of seconds, not {seconds!r}") from None
    except OverflowError:
        value = math.inf
    if not math.isfinite(value):
        raise ValueError(f"time is finite, not {value}")
    if abs(value) > LARGEST_TIME:
        raise ValueError(
            f"time is within {LARGEST_TIME:.0f} seconds (12 days) of 0, not {value:g}: floats of "
            "32 bits are too far apart there"
        )
    return value


def _checked_mouse(mouse: Any) -> tuple[float, ...]:
    try:
        values = tuple(float(part) for part in mouse)
    except (TypeError, ValueError):
        values = ()
    if len(values) != 4 or not all(map(math.isfinite, values)):
        raise ValueError(f"mouse is four finite numbers, not {mouse!r}")
    return values


def _checked_int(name: str, value: Any) -> int:
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"{name} is a whole number, not {value!r}") from None
    return number
