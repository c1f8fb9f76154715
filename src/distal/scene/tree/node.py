"""The tree of nodes behind a shape: primitives and operators with their numbers.

Input: primitives and operators of the field library, checked numbers, other nodes. Output:
immutable nodes that ``scene.lowering`` turns into functions. A node records where the author wrote
it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeAlias

from distal.diagnostics import Span
from distal.fields.guarantees import EXACT, Guarantee, Operator, Primitive
from distal.lang.functions import Func
from distal.scene.tree.conversion import Number

Rule: TypeAlias = Primitive | Operator


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Node:
    """A node of the tree: one shape.

    Attributes:
        rule: The primitive or operator.
        flat: Whether the shape lies in the plane.
        children: The shapes that an operator is applied to.
        numbers: Values of the floats and vectors, by name.
        constants: Choices (counts, switches), textures and buffers, by name.
        place: The author's line.
        material: The material of this node and everything below it, or None.
        cut_material: The material of faces that this node cuts into other shapes, or None.
        label: The author's name for the shape, or "".
        parts: Number of primitives evaluated for one distance; a primitive evaluated twice counts
            twice.
    """

    rule: Rule
    flat: bool
    children: tuple[Node, ...] = ()
    numbers: Mapping[str, Number] = field(default_factory=dict)
    constants: Mapping[str, Any] = field(default_factory=dict)
    place: Span | None = None
    material: Any = None
    cut_material: Any = None
    label: str = ""
    parts: int = field(init=False, default=1)

    def __post_init__(self) -> None:
        if self.children:
            object.__setattr__(self, "parts", sum(child.parts for child in self.children))

    @property
    def has_rows(self) -> bool:
        """Whether the numbers of its children are rows of a table (``scene.lowering.parts``)."""
        return False

    @property
    def name(self) -> str:
        """The author's name for the shape, else that of the primitive or operator."""
        return self.label or self.rule.name

    @property
    def claims(self) -> frozenset[Guarantee]:
        """The guarantees besides the bound on the slope."""
        rule = self.rule
        if isinstance(rule, Primitive):
            return rule.claims
        inner = [child.claims for child in self.children]
        kept = rule.keeps.intersection(*inner)
        return kept | rule.keeps_exact if all(c >= EXACT for c in inner) else kept

    @property
    def signed(self) -> bool:
        """Whether the shape has an inside."""
        if isinstance(self.rule, Primitive):
            return self.rule.signed
        return all(child.signed for child in self.children) or bool(self.rule.finish)

    @property
    def estimate(self) -> bool:
        """Whether the slope is an estimate (fractals)."""
        if isinstance(self.rule, Primitive):
            return self.rule.estimate
        return any(child.estimate for child in self.children)

    def walk(self) -> Iterator[Node]:
        """Yield this node and all below it, each once, parents first."""
        seen: set[int] = set()
        stack = [self]
        while stack:
            node = stack.pop()
            if id(node) not in seen:
                seen.add(id(node))
                yield node
                stack.extend(reversed(node.children))

    def functions(self) -> Iterator[Func]:
        """Yield the scene functions that this node and all below it call."""
        for node in self.walk():
            rule = node.rule
            if isinstance(rule, Primitive):
                yield rule.distance
            else:
                yield from rule.point_functions
