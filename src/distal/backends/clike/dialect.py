"""What a C-like language writes in its own way: methods that GLSL and WGSL define."""

from __future__ import annotations

from abc import ABC, abstractmethod

from distal.backends.clike.code import Code
from distal.ir.nodes import (
    Binary,
    BinaryOp,
    Compare,
    Const,
    Construct,
    Index,
    PerFrame,
    Resource,
    Select,
    Unary,
    Uniform,
)
from distal.ir.types import Type


class Dialect(ABC):
    """What a language writes in its own way. ``family`` is its column of the intrinsic table."""

    family: str

    @abstractmethod
    def type_name(self, type: Type) -> str:
        """A value type."""

    @abstractmethod
    def constant(self, e: Const) -> Code:
        """A literal."""

    @abstractmethod
    def uniform(self, e: Uniform) -> Code:
        """A read of a uniform."""

    @abstractmethod
    def per_frame(self, e: PerFrame) -> Code:
        """A read of a per-frame value."""

    @abstractmethod
    def declaration(self, name: str, value: Code, type: Type, *, mutable: bool) -> str:
        """The binding of a local to a value."""

    @abstractmethod
    def unset_declaration(self, name: str, type: Type) -> str:
        """The binding of a local that is assigned in each branch that follows."""

    @abstractmethod
    def arguments(self, args: list[Code]) -> str:
        """Arguments of a call."""

    @abstractmethod
    def chosen(self, e: Select, condition: Code, yes: Code, no: Code) -> Code | None:
        """A choice by a bool as an expression, or None where only ``if`` will do."""

    @abstractmethod
    def chosen_by_components(self, e: Select) -> Code:
        """A choice by a bvec."""

    @abstractmethod
    def vector_compare(self, e: Compare) -> Code:
        """A comparison of vectors."""

    @abstractmethod
    def bool_vector_binary(self, op: BinaryOp, lhs: Code, rhs: Code, type: Type) -> Code:
        """AND, OR, XOR of bvecs."""

    @abstractmethod
    def unary_special(self, e: Unary) -> Code | None:
        """A sign or inversion that has no plain prefix operator here."""

    @abstractmethod
    def shift(self, e: Binary) -> Code:
        """A shift; the count is below 32 in the IR, or is a constant."""

    @abstractmethod
    def matrix_scale(self, e: Binary) -> Code | None:
        """A matrix beside a splat where the plain operator does not exist."""

    @abstractmethod
    def scalar_arguments(self, name: str) -> tuple[int, ...]:
        """Arguments of a built-in that may stay scalar beside vectors."""

    @abstractmethod
    def array_text(self, e: Construct) -> Code:
        """An array's constructor, written where it stands."""

    @abstractmethod
    def element(self, e: Index) -> Code:
        """An element of an array, a column or a component, as a value."""

    @abstractmethod
    def buffer_element(self, resource: Resource, index: Code) -> Code:
        """An element of a buffer, the index clamped."""

    @abstractmethod
    def sample(self, resource: Resource, coord: Code) -> Code:
        """A filtered texture value at level 0."""

    @abstractmethod
    def texel(self, resource: Resource, index: Code) -> Code:
        """One texel, the index clamped."""

    @abstractmethod
    def size(self, resource: Resource) -> Code:
        """Extent of a texture or count of a buffer."""
