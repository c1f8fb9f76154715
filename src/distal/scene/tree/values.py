"""The numbers of a tree as IR expressions, and lists of IR statements.

Input: nodes with checked numbers. Output: a uniform for each constant float, the author's
expression if there is one, constants for choices.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

from distal.diagnostics import Span
from distal.fields.guarantees import Operator
from distal.frontend import Assembly
from distal.ir.nodes import Const, Expr, Let, Read, Stmt
from distal.ir.types import BOOL, INT, Type
from distal.lang.places import CELL, POINT
from distal.lang.resources import Buffer, TextureValue
from distal.scene.tree.conversion import NO_VALUES
from distal.scene.tree.node import Node, Rule
from distal.scene.tree.varying import COLUMN, VaryingNumber, expression_of


@dataclass(slots=True)
class StatementList:
    """The statements of a function under construction.

    Attributes:
        taken: Names that are in use.
        place: Where the author wrote what the next statements compute.
        is_shared: Whether shapes of several places share the function: it has none.
        statements: The statements so far.
    """

    taken: set[str] = field(default_factory=set)
    place: Span | None = None
    is_shared: bool = False
    statements: list[Stmt] = field(default_factory=list)
    # The number from which to look for a free name, by stem: a scene has thousands of boxes.
    _next: dict[str, int] = field(default_factory=dict)

    def let(self, stem: str, value: Expr) -> Expr:
        """Add a named value and return the expression that reads it."""
        if isinstance(value, Read | Const):
            return value
        name = self.fresh(stem)
        self.statements.append(Let(name, value, span=self.place))
        return Read(name, value.type)

    def fresh(self, stem: str) -> str:
        """Return a name that is not in use."""
        name, n = stem, self._next.get(stem, 2)
        while name in self.taken:
            name, n = f"{stem}_{n}", n + 1
        self.taken.add(name)
        self._next[stem] = n
        return name

    def block(self) -> StatementList:
        """Return an empty list for a block within these statements; names stay unique."""
        return StatementList(self.taken, self.place, self.is_shared, _next=self._next)

    @contextmanager
    def at(self, place: Span | None) -> Iterator[None]:
        """Give the statements that are added in the block a place; None keeps the one before."""
        before = self.place
        self.place = None if self.is_shared else place or before
        try:
            yield
        finally:
            self.place = before


class Values:
    """The numbers of one program's nodes; each node's numbers become expressions once."""

    def __init__(self, assembly: Assembly, site: Mapping[str, Expr] = NO_VALUES) -> None:
        """Add numbers to a program.

        Args:
            assembly: The program.
            site: What numbers that depend on the cell are emitted for (``VaryingNumber.emit``).
        """
        self.assembly = assembly
        self._site = site
        self._own: dict[int, tuple[Expr, ...]] = {}
        self._all: dict[int, tuple[Expr, ...]] = {}
        self._count: dict[int, int] = {}
        self._alive: list[Node] = []  # keys are ids, so the nodes must stay alive

    @contextmanager
    def at(self, cell: Expr, p: Expr) -> Iterator[None]:
        """Emit numbers that depend on the cell or the place for these, within the block."""
        before = self._site
        self._site = {CELL: cell, POINT: p}
        try:
            yield
        finally:
            self._site = before

    def own(self, node: Node) -> tuple[Expr, ...]:
        """Return the values of a node's own numbers."""
        found = self._own.get(id(node))
        if found is None:
            stem = plain_name(node.name)
            found = tuple(
                expression_of(self.assembly, n, f"{stem}_{name}")
                for name, n in node.numbers.items()
            )
            self._own[id(node)] = found
            self._alive.append(node)
        return found

    def fixed(self, stem: str, type: Type, value: Any) -> Expr:
        """Return a number that no author can change, once for each stem and value.

        Args:
            stem: The start of its name.
            type: Its type.
            value: Its value.
        """
        made, key = self.assembly.made, (Values, stem, value)
        if key not in made:
            made[key] = self.assembly.number(stem, type, value)
        found: Expr = made[key]
        return found

    def all(self, node: Node) -> tuple[Expr, ...]:
        """Return the values of all numbers of a subtree: the node's own, then its children's."""
        found = self._all.get(id(node))
        if found is None:
            parts = list(self.own(node))
            for child in () if node.has_rows else node.children:
                parts.extend(self.all(child))
            found = self._all[id(node)] = tuple(parts)
        return found

    def count(self, node: Node) -> int:
        """Return how many numbers a subtree has."""
        found = self._count.get(id(node))
        if found is None:
            inner = () if node.has_rows else node.children
            found = len(node.numbers) + sum(map(self.count, inner))
            self._count[id(node)] = found
            self._alive.append(node)
        return found

    def has_columns(self, node: Node) -> bool:
        """Return whether numbers of a subtree are columns of a row that its caller knows."""
        if node.has_rows:
            return False
        made = self.assembly.made
        own = any((COLUMN, id(number)) in made for number in node.numbers.values())
        return own or any(map(self.has_columns, node.children))

    def split(
        self, node: Node, values: Sequence[Expr]
    ) -> tuple[dict[str, Expr], list[Sequence[Expr]]]:
        """Split a subtree's values into the node's own, by name, and those of each child."""
        own = dict(zip(node.numbers, values, strict=False))
        shares, at = [], len(own)
        for child in node.children:
            count = self.count(child)
            shares.append(values[at : at + count])
            at += count
        return self.complete(node.rule, own, node.constants, node.name), shares

    def complete(
        self, rule: Rule, own: Mapping[str, Expr], constants: Mapping[str, Any], stem: str
    ) -> dict[str, Expr]:
        """Return all values that a rule's functions take: numbers, constants and derived values.

        Args:
            rule: The primitive or operator.
            own: The numbers, by name.
            constants: The choices, textures and buffers, by name.
            stem: The start of the names of resources.
        """
        given = {**own, **self._constants(constants, stem)}
        if isinstance(rule, Operator):
            given |= self._constants(rule.fixed, stem)
            if rule.copies is not None:
                given["copies"] = self.assembly.call(rule.copies, given)
        return given

    def _constants(self, constants: Mapping[str, Any], stem: str) -> dict[str, Expr]:
        """Return choices, textures and buffers as expressions; resources are named by ``stem``."""
        made: dict[str, Expr] = {}
        for name, value in constants.items():
            if isinstance(value, VaryingNumber):
                made[name] = value.emit(self, self._site)
            elif isinstance(value, TextureValue | Buffer):
                made[name] = self.assembly.resource(value, f"{stem}_{name}".lower())
            elif isinstance(value, bool):
                made[name] = self.assembly.constant(value, BOOL)
            elif isinstance(value, int):
                made[name] = self.assembly.constant(value, INT)
            else:
                made[name] = self.assembly.constant(value.value, value.type)
        return made


def plain_name(name: str) -> str:
    """Return a name as an identifier in lower case."""
    return "".join(c if c.isalnum() else "_" for c in name).strip("_").lower() or "shape"
