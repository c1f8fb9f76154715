"""Types of authors' arguments for signatures, editors and type checkers.

Input: nothing. Output: type aliases. Each describes what ``scene.tree.conversion`` accepts.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from os import PathLike
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias

from distal.lang import vec2, vec3, vec4
from distal.lang.expressions import Expression
from distal.lang.functions import Func
from distal.lang.parameters import Parameter
from distal.lang.resources import Buffer, TextureCube, TextureValue
from distal.scene.tree.calls import Pattern

if TYPE_CHECKING:
    from distal.images.picture import Picture


class ArrayLike(Protocol):
    """A NumPy number or array, or an object that converts to Python numbers in the same way."""

    def tolist(self) -> Any:
        """Return a number, or nested lists of numbers."""


# A number: a constant, a parameter, or an expression of parameters and time.
Number: TypeAlias = "float | Parameter | Expression | ArrayLike"
# Two or three numbers.
Vector: TypeAlias = "Sequence[Number] | vec2 | vec3 | vec4 | Parameter | Expression | ArrayLike"
# "#rrggbb", a CSS name, linear red, green and blue, or one number for a grey.
Color: TypeAlias = "str | Vector | Number"
# A list of points or of numbers.
Points: TypeAlias = "Sequence[Vector] | Sequence[float] | Buffer | ArrayLike"
# A column: one number, vector or color for each row.
Columns: TypeAlias = "Iterable[Vector] | Iterable[Number] | Iterable[str] | ArrayLike"
# A picture: its file, an array, or a texture.
Image: TypeAlias = "str | PathLike[str] | ArrayLike | Picture | TextureValue"
Images: TypeAlias = "Iterable[Image] | TextureCube"
# A value that varies over a surface: a pattern, or a @func of a place.
Varying: TypeAlias = "Pattern | Func"
