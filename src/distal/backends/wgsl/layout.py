"""Compute the layout of a WGSL struct in a uniform buffer.

Input: names and value types. Output: the byte offsets at which the host writes the members (WebGPU
Shading Language, "Alignment and Size"). A bool is stored as a u32, 0 or 1, because WGSL cannot
share bools with the host.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from distal.ir.types import Kind, Matrix, Scalar, Type, Vector, component_count, kind_of


@dataclass(frozen=True, slots=True)
class Member:
    """One member of a struct; ``offset`` and ``size`` are in bytes."""

    name: str
    type: Type
    offset: int
    size: int

    def entry(self) -> dict[str, Any]:
        """Return the member's data for the interface."""
        return {"offset": self.offset, "size": self.size}


@dataclass(frozen=True, slots=True)
class StructLayout:
    """The members of a struct in order, and the size of the whole buffer in bytes."""

    members: tuple[Member, ...]
    size: int

    def has(self, name: str) -> bool:
        """Return whether there is a member with this name."""
        return any(m.name == name for m in self.members)


def _alignment(type: Type) -> int:
    match type:
        case Scalar():
            return 4
        case Vector(_, size) | Matrix(size):
            return 8 if size == 2 else 16
        case _:
            raise AssertionError(f"{type} is not shared with the host")


def _size(type: Type) -> int:
    if isinstance(type, Matrix):
        return type.size * _alignment(type)  # each column occupies its alignment
    return 4 * component_count(type)


def lay_out(members: tuple[tuple[str, Type], ...]) -> StructLayout:
    """Return the layout of members in the given order."""
    placed, end = [], 0
    for name, type in members:
        alignment = _alignment(type)
        offset = -(-end // alignment) * alignment
        placed.append(Member(name, type, offset, _size(type)))
        end = offset + _size(type)
    return StructLayout(tuple(placed), max(16, -(-end // 16) * 16))


def shared_type(type: Type) -> Type:
    """Return the type that represents ``type`` in a buffer."""
    if kind_of(type) is not Kind.BOOL:
        return type
    return Vector(Kind.UINT, type.size) if isinstance(type, Vector) else Scalar(Kind.UINT)
