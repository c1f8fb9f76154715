"""Vectors and matrices as plain Python values.

A scene module can compute constants with them (``SKY = vec3(0.4, 0.6, 0.9) * 0.5``); in scene code
the same classes are the types. Components are Python floats, and are rounded to the precision of
the target when a constant is captured. Imports no third-party package.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterator
from typing import Any, ClassVar

from distal.ir.types import FRAME, UINT, Kind, Matrix, Type, Vector, vector_of
from distal.lang.expressions import Symbolic, composed_value, is_symbolic

_LETTERS = {c: i for letters in ("xyzw", "rgba") for i, c in enumerate(letters)}


class uint(int):  # noqa: N801
    """A 32-bit unsigned integer."""

    __distal_type__: ClassVar[Type] = UINT

    def __new__(cls, value: Any = 0) -> uint:
        """Keep the low 32 bits of ``value``."""
        return super().__new__(cls, int(value) & 0xFFFFFFFF)


_CONVERT: dict[Kind, Callable[[Any], Any]] = {
    Kind.FLOAT: float,
    Kind.INT: lambda x: (int(x) + 2**31) % 2**32 - 2**31,
    Kind.UINT: uint,
    Kind.BOOL: bool,
}


def _is_number(value: object) -> bool:
    if isinstance(value, Symbolic):
        return False
    return isinstance(value, int | float) or hasattr(value, "__float__")


class VectorValue:
    """Base class of vec2 to bvec4; immutable."""

    __slots__ = ("_components",)

    __distal_type__: ClassVar[Type]
    _components: tuple[Any, ...]

    def __new__(cls, *parts: Any) -> Any:
        """Return an expression if one of the parts is symbolic."""
        if any(map(is_symbolic, parts)):
            return composed_value(str(cls.__distal_type__), parts)
        return super().__new__(cls)

    def __init__(self, *parts: Any) -> None:
        type = self._vector()
        flat: list[Any] = []
        for part in parts:
            if isinstance(part, VectorValue | tuple | list):
                flat.extend(part)
            elif _is_number(part):
                flat.append(part)
            else:
                raise TypeError(f"{type} is made of numbers and vectors, not {part!r}")
        if len(flat) == 1 and _is_number(parts[0]):
            flat *= type.size
        if len(flat) != type.size:
            raise TypeError(f"{type} has {type.size} components, not {len(flat)}")
        object.__setattr__(self, "_components", tuple(map(_CONVERT[type.kind], flat)))

    @classmethod
    def _vector(cls) -> Vector:
        assert isinstance(cls.__distal_type__, Vector)
        return cls.__distal_type__

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"a {self._vector()} does not change outside scene code")

    def __getattr__(self, name: str) -> Any:
        lanes = [_LETTERS.get(c, 4) for c in name]
        if not 1 <= len(lanes) <= 4 or max(lanes) >= len(self._components):
            raise AttributeError(f"a {self._vector()} has no component '{name}'")
        picked = [self._components[i] for i in lanes]
        if len(picked) == 1:
            return picked[0]
        return VALUE_CLASSES[vector_of(self._vector().kind, len(picked))](*picked)

    def __len__(self) -> int:
        return len(self._components)

    def __iter__(self) -> Iterator[Any]:
        return iter(self._components)

    def __getitem__(self, index: int) -> Any:
        return self._components[index]

    def __repr__(self) -> str:
        return f"{self._vector()}({', '.join(map(repr, self._components))})"

    def __hash__(self) -> int:
        return hash((self._vector(), self._components))

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), self._components

    def _apply(self, other: Any, operation: Callable[[Any, Any], Any], *, swap: bool) -> Any:
        if isinstance(other, VectorValue):
            if type(other) is not type(self):
                types = f"these are {self._vector()} and {other._vector()}"
                raise TypeError(f"the operands must be of one type, but {types}")
            others = other._components
        elif _is_number(other):
            others = (other,) * len(self._components)
        else:
            return NotImplemented
        pairs = zip(self._components, others, strict=True)
        results = [operation(b, a) if swap else operation(a, b) for a, b in pairs]
        kind = self._vector().kind
        if operation is operator.truediv:
            kind = Kind.FLOAT
        elif operation in _COMPARISONS:
            kind = Kind.BOOL
        return VALUE_CLASSES[vector_of(kind, len(results))](*results)

    def __neg__(self) -> Any:
        return type(self)(*(-c for c in self._components))


_OPERATORS = {
    "add": operator.add,
    "sub": operator.sub,
    "mul": operator.mul,
    "truediv": operator.truediv,
    "floordiv": operator.floordiv,
    "mod": operator.mod,
    "and": operator.and_,
    "or": operator.or_,
    "xor": operator.xor,
    "lshift": operator.lshift,
    "rshift": operator.rshift,
}
_COMPARISONS = {
    operator.eq: "eq",
    operator.ne: "ne",
    operator.lt: "lt",
    operator.le: "le",
    operator.gt: "gt",
    operator.ge: "ge",
}


def _add_operators() -> None:
    def forward(operation: Callable[[Any, Any], Any], *, swap: bool) -> Callable[[Any, Any], Any]:
        return lambda self, other: self._apply(other, operation, swap=swap)

    for name, operation in _OPERATORS.items():
        setattr(VectorValue, f"__{name}__", forward(operation, swap=False))
        setattr(VectorValue, f"__r{name}__", forward(operation, swap=True))
    for comparison, name in _COMPARISONS.items():
        setattr(VectorValue, f"__{name}__", forward(comparison, swap=False))


_add_operators()


class MatrixValue:
    """Base class of mat2 to mat4: columns of floats; immutable."""

    __slots__ = ("columns",)

    __distal_type__: ClassVar[Type]
    columns: tuple[VectorValue, ...]

    def __new__(cls, *parts: Any) -> Any:
        """Return an expression if one of the parts is symbolic."""
        if any(map(is_symbolic, parts)):
            return composed_value(str(cls.__distal_type__), parts)
        return super().__new__(cls)

    def __init__(self, *parts: Any) -> None:
        size = self._size()
        if len(parts) == 1 and _is_number(parts[0]):
            parts = tuple(parts[0] * (i == j) for i in range(size) for j in range(size))
        flat = [n for p in parts for n in (p if isinstance(p, VectorValue | tuple | list) else [p])]
        if len(flat) != size * size:
            raise TypeError(f"mat{size} has {size * size} components, not {len(flat)}")
        column = VALUE_CLASSES[vector_of(Kind.FLOAT, size)]
        columns = tuple(column(*flat[i * size : (i + 1) * size]) for i in range(size))
        object.__setattr__(self, "columns", columns)

    @classmethod
    def _size(cls) -> int:
        assert isinstance(cls.__distal_type__, Matrix)
        return cls.__distal_type__.size

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"a mat{self._size()} does not change outside scene code")

    def __len__(self) -> int:
        return len(self.columns)

    def __iter__(self) -> Iterator[VectorValue]:
        return iter(self.columns)

    def __getitem__(self, index: int) -> VectorValue:
        return self.columns[index]

    def __repr__(self) -> str:
        return f"mat{self._size()}({', '.join(map(repr, self.columns))})"

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), self.columns

    def __matmul__(self, other: Any) -> Any:
        if isinstance(other, MatrixValue) and type(other) is type(self):
            return type(self)(*(self @ column for column in other))
        if isinstance(other, VectorValue) and len(other) == self._size():
            products = [c * x for c, x in zip(self.columns, other, strict=True)]
            total = products[0]
            for product in products[1:]:
                total = total + product
            return total
        return NotImplemented

    def __mul__(self, factor: float) -> Any:
        if not _is_number(factor):
            return NotImplemented
        return type(self)(*([n * factor for n in column] for column in self))

    __rmul__ = __mul__


class Frame:
    """The argument of an image.

    Its values: coord (in pixels, from the lower left), resolution (pixels), time and delta
    (seconds), index (the number of the frame, from 0), mouse (as in Shadertoy), buttons
    (bits), date (year, month from 0, day, seconds of the day; 0 in files) and seed.
    """

    __distal_type__: ClassVar[Type] = FRAME

    def __init__(self) -> None:
        raise TypeError("a Frame is made by the renderer; call .render() on the image")


def _value_class(type: Type, base: type[VectorValue] | type[MatrixValue], doc: str) -> Any:
    members = {
        "__slots__": (),
        "__distal_type__": type,
        "__doc__": doc,
        "__module__": "distal.lang",
    }
    return __builtins_type(str(type), (base,), members)


__builtins_type = type
VALUE_CLASSES: dict[Type, Any] = {
    t: _value_class(t, VectorValue, f"{size} components of {kind.value}.")
    for kind in Kind
    for size in (2, 3, 4)
    for t in (vector_of(kind, size),)
}
VALUE_CLASSES.update(
    (t, _value_class(t, MatrixValue, f"A {t.size} by {t.size} float matrix, made of columns."))
    for t in map(Matrix, (2, 3, 4))
)
