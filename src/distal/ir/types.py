"""The types of the IR. Equal types are the same object.

A value type is a scalar, vector, matrix, struct or array. Textures, buffers and functions are
static types: they may be passed to functions, but the specialise pass replaces each such parameter
by the argument passed.
"""

from __future__ import annotations

from collections.abc import Iterator
from enum import Enum
from typing import Final, TypeAlias

from distal.ir.interning import Interned, interned


class Kind(Enum):
    """The kind of a component. The value of a member is its spelling."""

    __hash__ = object.__hash__

    FLOAT = "float"
    INT = "int"
    UINT = "uint"
    BOOL = "bool"


_VECTOR_PREFIX: Final = {Kind.FLOAT: "vec", Kind.INT: "ivec", Kind.UINT: "uvec", Kind.BOOL: "bvec"}


@interned
class Scalar(Interned):
    """A single number or bool."""

    kind: Kind

    def __str__(self) -> str:
        return self.kind.value


@interned
class Vector(Interned):
    """A vector of 2 to 4 components of one kind."""

    kind: Kind
    size: int

    def __str__(self) -> str:
        return f"{_VECTOR_PREFIX[self.kind]}{self.size}"


@interned
class Matrix(Interned):
    """A square float matrix of ``size`` columns; ``m[i]`` is column i."""

    size: int

    def __str__(self) -> str:
        return f"mat{self.size}"


@interned
class Struct(Interned):
    """A value with named fields.

    A returned tuple is a struct with ``is_tuple`` set and the fields item0, item1 ...

    Attributes:
        name: Its name in the module.
        fields: The names and types of its fields.
        is_tuple: Whether it is a returned tuple.
        owner: The class that has its methods; None without methods.
    """

    name: str
    fields: tuple[tuple[str, Type], ...]
    is_tuple: bool
    owner: type | None = None

    def __new__(
        cls,
        name: str,
        fields: tuple[tuple[str, Type], ...],
        is_tuple: bool,
        owner: type | None = None,
    ) -> Struct:
        """Return the struct; without ``owner`` it has no methods."""
        return Interned.__new__(cls, name, fields, is_tuple, owner)

    def field(self, name: str) -> Type | None:
        """Return the type of a field; None if there is no such field."""
        return dict(self.fields).get(name)

    def __str__(self) -> str:
        if self.is_tuple:
            return f"tuple[{', '.join(str(t) for _, t in self.fields)}]"
        return self.name


@interned
class Array(Interned):
    """An array of ``length`` values of one type; the length is at least 1."""

    element: Type
    length: int

    def __str__(self) -> str:
        return f"array[{self.element}, {self.length}]"


class TextureShape(Enum):
    """The shape of a texture. The value of a member is the name of its type in the language."""

    FLAT = "Texture2D"
    CUBE = "TextureCube"
    VOLUME = "Texture3D"


@interned
class Texture(Interned):
    """A read-only texture of vec4 texels, sampled at a vec2 (2D) or a vec3 (cube, 3D)."""

    shape: TextureShape

    def __str__(self) -> str:
        return self.shape.value


@interned
class Buffer(Interned):
    """A read-only sequence of scalars or float vectors; its length is known when data is bound."""

    element: Type

    def __str__(self) -> str:
        return f"Buffer[{self.element}]"


@interned
class FunctionType(Interned):
    """The type of a function that is passed to a function. Exists at compile time only."""

    params: tuple[Type, ...]
    result: Type

    def __str__(self) -> str:
        return f"Callable[[{', '.join(map(str, self.params))}], {self.result}]"


Type: TypeAlias = Scalar | Vector | Matrix | Struct | Array | Texture | Buffer | FunctionType

FLOAT: Final = Scalar(Kind.FLOAT)
INT: Final = Scalar(Kind.INT)
UINT: Final = Scalar(Kind.UINT)
BOOL: Final = Scalar(Kind.BOOL)
VEC2, VEC3, VEC4 = (Vector(Kind.FLOAT, n) for n in (2, 3, 4))
IVEC2, IVEC3, IVEC4 = (Vector(Kind.INT, n) for n in (2, 3, 4))
UVEC2, UVEC3, UVEC4 = (Vector(Kind.UINT, n) for n in (2, 3, 4))
BVEC2, BVEC3, BVEC4 = (Vector(Kind.BOOL, n) for n in (2, 3, 4))
MAT2, MAT3, MAT4 = (Matrix(n) for n in (2, 3, 4))
TEXTURE_2D: Final = Texture(TextureShape.FLAT)
TEXTURE_CUBE: Final = Texture(TextureShape.CUBE)
TEXTURE_3D: Final = Texture(TextureShape.VOLUME)

# The parameter of an @image. The entry pass turns coord into a parameter, the rest into uniforms.
FRAME: Final = Struct(
    "Frame",
    (
        ("coord", VEC2),
        ("resolution", VEC2),
        ("time", FLOAT),
        ("mouse", VEC4),
        ("index", INT),
        ("seed", UINT),
        ("delta", FLOAT),
        ("date", VEC4),
        ("buttons", INT),
    ),
    False,
)


def tuple_type(items: tuple[Type, ...]) -> Struct:
    """Return the struct that represents a returned tuple; its name contains the items' types."""
    name = "Tuple_" + "_".join(_plain(t) for t in items)
    return Struct(name, tuple((f"item{i}", t) for i, t in enumerate(items)), True)


def _plain(type: Type) -> str:
    match type:
        case Array(element, length):
            return f"{_plain(element)}x{length}"
        case Struct(name):
            return name
        case _:
            return str(type)


def kind_of(type: Type) -> Kind | None:
    """Return the kind of the components of a scalar, vector or matrix; None for other types."""
    match type:
        case Scalar(kind) | Vector(kind):
            return kind
        case Matrix():
            return Kind.FLOAT
        case _:
            return None


def with_kind(type: Type, kind: Kind) -> Type:
    """Return the scalar or vector type of the same size with components of another kind.

    Raises:
        AssertionError: The type is neither scalar nor vector.
    """
    match type:
        case Scalar():
            return Scalar(kind)
        case Vector(_, size):
            return Vector(kind, size)
        case _:
            raise AssertionError(f"{type} has no kind to change")


def vector_of(kind: Kind, size: int) -> Type:
    """Return the vector type with ``size`` components, or the scalar type when ``size`` is 1."""
    return Scalar(kind) if size == 1 else Vector(kind, size)


def component_count(type: Type) -> int:
    """Return the number of scalars in a scalar, vector or matrix.

    Raises:
        AssertionError: The type has no components.
    """
    match type:
        case Scalar():
            return 1
        case Vector(_, size):
            return size
        case Matrix(size):
            return size * size
        case _:
            raise AssertionError(f"{type} has no components")


def index_count(type: Type) -> int | None:
    """Return the number of elements that an index selects from; None for a buffer (known later).

    Raises:
        AssertionError: The type cannot be indexed.
    """
    match type:
        case Array(_, length):
            return length
        case Vector(_, size) | Matrix(size):
            return size
        case Buffer():
            return None
        case _:
            raise AssertionError(f"{type} takes no index")


def is_static(type: Type) -> bool:
    """Return whether values of the type exist at compile time only (function, texture, buffer)."""
    return isinstance(type, Texture | Buffer | FunctionType)


def is_targets(type: Type) -> bool:
    """Return whether a value is a pixel of several pictures: a struct of vec4."""
    return isinstance(type, Struct) and all(field is VEC4 for _, field in type.fields)


def contained_structs(type: Type) -> Iterator[Struct]:
    """Yield every struct contained in ``type``, innermost first, possibly several times."""
    match type:
        case Struct(_, fields):
            for _, field_type in fields:
                yield from contained_structs(field_type)
            yield type
        case Array(element) | Buffer(element):
            yield from contained_structs(element)
        case _:
            return
