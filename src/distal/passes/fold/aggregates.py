"""Simplify vectors, matrices, arrays and structs that are built and then taken apart again.

Input: an expression with simplified operands. Output: an equal expression; the same expression if
no rule applies. All of these rules are exact.
"""

from __future__ import annotations

from distal.ir.nodes import Compose, Construct, Expr, Field, Index, Read, Splat, Swizzle
from distal.ir.types import Array, Matrix, Scalar, Struct, Vector, kind_of, vector_of
from distal.passes.fold.constants import Constants


class Aggregates(Constants):
    """The rules for components, elements and fields, for one function."""

    def compose(self, e: Compose) -> Expr:
        """Flatten nested vectors, and join swizzles of the same vector."""
        type = e.type
        if not isinstance(type, Vector):
            return self._known_columns(e)
        parts: list[Expr] = []
        for part in e.parts:
            inner = part.parts if isinstance(part, Compose) else (part,)
            for piece in inner:
                _join(parts, piece)
        if len(parts) == 1:
            only = parts[0]
            return self.swizzle(only) if isinstance(only, Swizzle) else only
        if all(p is parts[0] for p in parts) and isinstance(parts[0].type, Scalar):
            return Splat(parts[0], type, span=e.span)
        return Compose(tuple(parts), type, span=e.span)

    def _known_columns(self, e: Compose) -> Expr:
        """Replace a matrix built from all columns of a matrix, in order, by that matrix."""
        first = e.parts[0]
        if not isinstance(first, Index) or first.base.type is not e.type:
            return e
        for i, part in enumerate(e.parts):
            if not isinstance(part, Index) or part.base is not first.base:
                return e
            if self.same(part.index) != i:
                return e
        return first.base

    def swizzle(self, e: Swizzle) -> Expr:
        """Take components directly from the vector or scalar that they come from."""
        base, lanes, type = e.base, e.lanes, e.type
        assert isinstance(base.type, Vector)
        if lanes == "xyzw"[: base.type.size]:
            return base
        if isinstance(base, Read):
            base = self._look_through(base, lanes)
        if isinstance(base, Splat):
            return Splat(base.value, type) if isinstance(type, Vector) else base.value
        if isinstance(base, Swizzle):
            picked = "".join(base.lanes["xyzw".index(lane)] for lane in lanes)
            return self.swizzle(Swizzle(base.base, picked, type, span=e.span))
        if isinstance(base, Compose):
            pieces = _lanes(base)
            parts = [pieces["xyzw".index(lane)] for lane in lanes]
            values = [self.swizzle(p) if isinstance(p, Swizzle) else p for p in parts]
            return (
                values[0]
                if len(values) == 1
                else self.compose(Compose(tuple(values), type, span=e.span))
            )
        return e

    def _look_through(self, base: Read, lanes: str) -> Expr:
        """Return the value of a local if its selected components are trivial, else the local."""
        value = self._known.get(base)
        if isinstance(value, Splat) and self.is_trivial(value.value):
            return value
        if isinstance(value, Compose):
            pieces = _lanes(value)
            if all(self.is_trivial(pieces["xyzw".index(lane)]) for lane in lanes):
                return value
        return base

    def index(self, e: Index) -> Expr:
        """Replace an index by the selected part if the index is constant."""
        position = self.same(e.index)
        if position is None:
            return e
        base = e.base
        match base.type:
            case Vector(_, size):
                lane = "xyzw"[min(max(int(position), 0), size - 1)]
                return self.swizzle(Swizzle(base, lane, e.type, span=e.span))
            case Array(_, length) | Matrix(length):
                value = self._known.get(base, base)
                if isinstance(value, Construct | Compose):
                    part = value.parts[min(max(int(position), 0), length - 1)]
                    if value is base or self.is_trivial(part):
                        return part
                return e
            case _:
                return e

    def field(self, e: Field) -> Expr:
        """Replace a field of a struct that was just built by the field's value."""
        base = e.base
        value = self._known.get(base, base)
        if isinstance(value, Construct):
            assert isinstance(base.type, Struct)
            names = [name for name, _ in base.type.fields]
            part = value.parts[names.index(e.name)]
            if value is base or self.is_trivial(part):
                return part
        return e

    def construct(self, e: Construct, parts: tuple[Expr, ...]) -> Expr:
        """Replace a struct built from all fields of a struct, in order, by that struct."""
        first = parts[0] if parts else None
        if not isinstance(e.type, Struct) or not isinstance(first, Field):
            return e
        if first.base.type is not e.type:
            return e
        for part, (name, _) in zip(parts, e.type.fields, strict=True):
            if not isinstance(part, Field) or part.base is not first.base or part.name != name:
                return e
        return first.base


def _join(parts: list[Expr], piece: Expr) -> None:
    """Append a part; consecutive swizzles of one vector become one swizzle."""
    last = parts[-1] if parts else None
    if isinstance(piece, Swizzle) and isinstance(last, Swizzle) and last.base is piece.base:
        lanes = last.lanes + piece.lanes
        kind = kind_of(piece.type)
        assert kind is not None
        parts[-1] = Swizzle(piece.base, lanes, vector_of(kind, len(lanes)), span=last.span)
    else:
        parts.append(piece)


def _lanes(e: Compose) -> list[Expr]:
    """Return the scalars of a Compose of vector type."""
    found: list[Expr] = []
    for part in e.parts:
        if isinstance(part.type, Scalar):
            found.append(part)
            continue
        assert isinstance(part.type, Vector)
        scalar = Scalar(part.type.kind)
        if isinstance(part, Splat):
            found.extend([part.value] * part.type.size)
        elif isinstance(part, Compose):
            found.extend(_lanes(part))
        else:
            found.extend(Swizzle(part, lane, scalar) for lane in "xyzw"[: part.type.size])
    return found
