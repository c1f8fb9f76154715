"""The differences between the C-like languages: abstract methods that GLSL and WGSL implement."""

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
    """The text of everything that the languages write differently.

    Attributes:
        family: The language's column in the table of intrinsics.
    """

    family: str

    @abstractmethod
    def type_name(self, type: Type) -> str:
        """Return the name of a value type."""

    @abstractmethod
    def constant(self, e: Const) -> Code:
        """Return a literal."""

    @abstractmethod
    def uniform(self, e: Uniform) -> Code:
        """Return a read of a uniform."""

    @abstractmethod
    def per_frame(self, e: PerFrame) -> Code:
        """Return a read of a per-frame value."""

    @abstractmethod
    def declaration(self, name: str, value: Code, type: Type, *, mutable: bool) -> str:
        """Return the declaration of a local with a value.

        Args:
            name: The local's name.
            value: Its initial value.
            type: Its type.
            mutable: Whether it is assigned again.
        """

    @abstractmethod
    def unset_declaration(self, name: str, type: Type) -> str:
        """Return the declaration of a local without a value; all following branches assign it."""

    @abstractmethod
    def arguments(self, args: list[Code]) -> str:
        """Return the arguments of a call, as text between the brackets."""

    @abstractmethod
    def chosen(self, e: Select, condition: Code, yes: Code, no: Code) -> Code | None:
        """Return a selection by a bool as an expression; None if an ``if`` statement is needed.

        Args:
            e: The selection.
            condition: The text of its condition.
            yes: The text of the value if the condition is true.
            no: The text of the value if the condition is false.
        """

    @abstractmethod
    def chosen_by_components(self, e: Select) -> Code:
        """Return a selection by a bvec, component by component."""

    @abstractmethod
    def vector_compare(self, e: Compare) -> Code:
        """Return a comparison of vectors."""

    @abstractmethod
    def bool_vector_binary(self, op: BinaryOp, lhs: Code, rhs: Code, type: Type) -> Code:
        """Return AND, OR or XOR of bvecs.

        Args:
            op: The operator.
            lhs: The left operand.
            rhs: The right operand.
            type: The type of both operands.
        """

    @abstractmethod
    def unary_special(self, e: Unary) -> Code | None:
        """Return a negation or inversion that has no prefix operator here; else None."""

    @abstractmethod
    def shift(self, e: Binary) -> Code:
        """Return a shift; the count is below 32 in the IR, or is a constant."""

    @abstractmethod
    def matrix_scale(self, e: Binary) -> Code | None:
        """Return an operation of a matrix and a splat that has no operator here; else None."""

    @abstractmethod
    def scalar_arguments(self, name: str) -> tuple[int, ...]:
        """Return the positions of a built-in's arguments that may be scalars beside vectors."""

    @abstractmethod
    def array_text(self, e: Construct) -> Code:
        """Return an array's constructor."""

    @abstractmethod
    def element(self, e: Index) -> Code:
        """Return an element of an array, a column or a component, as a value."""

    @abstractmethod
    def buffer_element(self, resource: Resource, index: Code) -> Code:
        """Return an element of a buffer; the index is clamped."""

    @abstractmethod
    def sample(self, resource: Resource, coord: Code) -> Code:
        """Return a filtered texture value at level 0."""

    @abstractmethod
    def texel(self, resource: Resource, index: Code) -> Code:
        """Return one texel; the index is clamped."""

    @abstractmethod
    def size(self, resource: Resource) -> Code:
        """Return the size of a texture, or the number of elements of a buffer."""
