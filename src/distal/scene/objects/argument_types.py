"""Types of authors' arguments for signatures, editors and type checkers.

Input: nothing. Output: type aliases. Each describes what ``scene.tree.conversion`` accepts.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from os import PathLike
from typing import TYPE_CHECKING, Any, Literal, Protocol, TypeAlias, TypedDict

from distal.lang import vec2, vec3, vec4
from distal.lang.expressions import Expression
from distal.lang.functions import Func
from distal.lang.parameters import Parameter
from distal.lang.resources import Buffer, TextureCube, TextureValue
from distal.scene.tree.calls import Pattern

if TYPE_CHECKING:
    from distal.images.picture import Picture
    from distal.scene.objects.materials import Material


class ArrayLike(Protocol):
    """A NumPy number or array, or an object that converts to Python numbers in the same way."""

    def tolist(self) -> Any:
        """Return a number, or nested lists of numbers."""


# A number: a constant, a parameter, or an expression of parameters and time.
Number: TypeAlias = "float | Parameter | Expression | ArrayLike"
# A number that the library computes with before it is checked.
Amount: TypeAlias = "float | Parameter | Expression"
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
# A material, or what a matte one is made of.
Painted: TypeAlias = "Material | Color | Varying"
# Rows of whole numbers or of numbers, such as the corners of triangles.
Rows: TypeAlias = "Sequence[Sequence[float]] | Sequence[Sequence[Sequence[float]]] | ArrayLike"
# Two opposite corners of a box, (low, high).
Corners: TypeAlias = "tuple[Vector, Vector] | Sequence[Sequence[float]] | ArrayLike"
# The corners of a box that was computed: (low, high).
Box: TypeAlias = "tuple[tuple[float, ...], tuple[float, ...]]"
# One point in the plane, one in space.
Place2: TypeAlias = "vec2 | tuple[float, float]"
Place3: TypeAlias = "vec3 | tuple[float, float, float] | list[float]"
# What an author's own function may take.
Argument: TypeAlias = "Number | Color | Image | Points | Varying | Material"
# Values of parameters by name.
ParameterValue: TypeAlias = "float | str | Sequence[float] | vec2 | vec3 | vec4 | ArrayLike"
ParameterValues: TypeAlias = "Mapping[str, ParameterValue]"
# What the axes of a volume are, from the outermost to the innermost.
AxisOrder: TypeAlias = Literal["zyx", "zxy", "yzx", "yxz", "xzy", "xyz"]


class BlendNumbers(TypedDict, total=False):
    """Numbers of some forms of blends."""

    count: int
