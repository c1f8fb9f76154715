"""What ``mirror``, ``symmetry`` and the signs of ``scale`` mean: axes, or a plane.

Input: the author's arguments. Output: an operator's numbers; axes that are reflected. Does not make
shapes.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final, NoReturn

from distal.diagnostics import Span
from distal.fields.guarantees import Operator
from distal.fields.place import mirrors
from distal.scene.tree.conversion import is_plain_scalar, unwrapped
from distal.scene.tree.errors import refuse

_LETTERS: Final = "xyz"
# By the method's name: the operator of axes and that of a plane.
_OPERATORS: Final[Mapping[str, tuple[Operator, Operator]]] = {
    "mirror": (mirrors.REFLECT, mirrors.REFLECT_ACROSS),
    "symmetry": (mirrors.SYMMETRY, mirrors.SYMMETRY_ACROSS),
}


@dataclass(frozen=True, slots=True)
class PlaneArguments:
    """The arguments of ``mirror`` and ``symmetry``.

    Attributes:
        method: "mirror" or "symmetry".
        axes: Letters of axes, or None.
        offset: The distance of the plane from the origin.
        across: The normal of the plane, or None.
        flat: Whether the shape lies in the plane.
        place: The author's line.
    """

    method: str
    axes: Any
    offset: Any
    across: Any
    flat: bool
    place: Span | None

    def operator(self) -> tuple[Operator, dict[str, Any]]:
        """Return the operator for solids, and its numbers by name.

        Raises:
            SceneValueError: The arguments name neither axes nor a plane, or both.
        """
        of_axes, of_plane = _OPERATORS[self.method]
        if self.axes is None:
            if self.across is None:
                example = (1, 0) if self.flat else (1, 0, 0)
                hint = f'{self.method}("x"), or {self.method}(across={example}, offset=0.5)'
                self._refuse(f"{self.method} needs an axis or a plane", hint)
            return of_plane, {"across": self.across, "offset": self.offset}
        if self.across is not None:
            hint = "leave out one of them"
            self._refuse(f"{self.method} takes axes or a plane (across=), not both", hint)
        known = _LETTERS[: 2 if self.flat else 3]
        self._check_letters(known)
        if is_plain_scalar(self.offset) and self.offset == 0:
            return of_axes, {axis: axis in self.axes for axis in known}
        if len(self.axes) > 1:
            first, second = self.axes[:2]
            hint = f'one after the other: {self.method}("{first}", …).{self.method}("{second}", …)'
            self._refuse("an offset is that of one plane, and there is one for each axis", hint)
        normal = tuple(float(axis == self.axes) for axis in known)
        return of_plane, {"across": normal, "offset": self.offset}

    def _check_letters(self, known: str) -> None:
        axes = unwrapped(self.axes)
        if isinstance(axes, str):
            once = self.method == "symmetry" or len(set(axes)) == len(axes)
            if axes and set(axes) <= set(known) and once:
                return
        elif isinstance(axes, tuple | list):
            hint = f"symmetry(across={tuple(axes)}) keeps the half that it points to and mirrors it"
            if self.method == "mirror":
                image = f"mirror(across={tuple(axes)}) is the mirror image"
                hint = f"{image}; {hint}, as mirror did before"
            self._refuse(f"{self.method} takes letters of '{known}', and a normal by name", hint)
        self._refuse(f"{self.method} takes letters of '{known}', not {self.axes!r:.40}")

    def _refuse(self, message: str, hint: str | None = None) -> NoReturn:
        refuse(message, hint, self.place)


@dataclass(frozen=True, slots=True)
class Factors:
    """Factors of ``scale`` without the signs of plain numbers.

    Attributes:
        reflected: Letters of the axes whose factors are below 0.
        values: The factors of the axes, as one vector by position or by name.
        uniform: The factor if it is a plain one and the same for all axes, else None.
    """

    reflected: str
    values: tuple[Any, ...]
    uniform: float | None


def without_signs(args: tuple[Any, ...], kwargs: Mapping[str, Any], *, flat: bool) -> Factors:
    """Return the factors of ``scale`` without the signs of plain numbers.

    Args:
        args: The factors by position: one for all, a vector, or one for each axis.
        kwargs: The factors by the letters of axes.
        flat: Whether the shape lies in the plane.
    """
    letters = _LETTERS[: 2 if flat else 3]
    given = tuple(map(unwrapped, args))
    if len(given) == 1 and not kwargs:
        given = given * len(letters) if is_plain_scalar(given[0]) else given[0]
    elif not given and set(kwargs) <= set(letters):
        given = tuple(unwrapped(kwargs.get(letter, 1.0)) for letter in letters)
    if not isinstance(given, tuple | list) or len(given) != len(letters):
        return Factors("", (), None)  # an expression, or a mistake
    negative = [bool(is_plain_scalar(value) and value < 0) for value in given]
    reflected = "".join(c for c, is_so in zip(letters, negative, strict=True) if is_so)
    values = tuple(-v if is_so else v for v, is_so in zip(given, negative, strict=True))
    is_uniform = all(map(is_plain_scalar, values)) and len({*values}) == 1
    return Factors(reflected, values, float(values[0]) if is_uniform else None)
