"""The numbers of a tree as expressions, and the statements they go into.

Input: nodes with checked numbers. Output: a uniform for each float, the author's
expression where one was given, constants for choices.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from distal.fields.guarantees import Operator
from distal.frontend import Assembly
from distal.ir.nodes import Expr, Let, Read, Stmt
from distal.ir.types import BOOL, INT
from distal.lang.resources import Buffer, TextureValue
from distal.scene.tree.calls import expression_of
from distal.scene.tree.node import Node, Rule


@dataclass(slots=True)
class StatementList:
    """The statements of a function in the making."""

    statements: list[Stmt] = field(default_factory=list)
    taken: set[str] = field(default_factory=set)

    def let(self, stem: str, value: Expr) -> Expr:
        """Name a value."""
        if isinstance(value, Read):
            return value
        name, n = stem, 2
        while name in self.taken:
            name, n = f"{stem}_{n}", n + 1
        self.taken.add(name)
        self.statements.append(Let(name, value))
        return Read(name, value.type)


class Values:
    """The numbers of one program's nodes; each node's become expressions once."""

    def __init__(self, assembly: Assembly) -> None:
        self.assembly = assembly
        self._own: dict[int, tuple[Expr, ...]] = {}
        self._all: dict[int, tuple[Expr, ...]] = {}
        self._alive: list[Node] = []  # what is known by its id must stay

    def own(self, node: Node) -> tuple[Expr, ...]:
        """The values of a node's own numbers."""
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

    def all(self, node: Node) -> tuple[Expr, ...]:
        """The values of all numbers of a subtree: its own, then its children's."""
        found = self._all.get(id(node))
        if found is None:
            parts = list(self.own(node))
            for child in node.children:
                parts.extend(self.all(child))
            found = self._all[id(node)] = tuple(parts)
        return found

    def split(
        self, node: Node, values: Sequence[Expr]
    ) -> tuple[dict[str, Expr], list[Sequence[Expr]]]:
        """A subtree's numbers as the node's own by name, and those of each child."""
        own = dict(zip(node.numbers, values, strict=False))
        shares, at = [], len(own)
        for child in node.children:
            count = len(self.all(child))
            shares.append(values[at : at + count])
            at += count
        return self.complete(node.rule, own, node.constants, node.name), shares

    def complete(
        self, rule: Rule, own: Mapping[str, Expr], constants: Mapping[str, Any], stem: str
    ) -> dict[str, Expr]:
        """All that a rule's functions take of its own: numbers, constants, what follows from them.

        Args:
            rule: The primitive or operator.
            own: Its numbers, by name.
            constants: Its choices, textures and buffers, by name.
            stem: The start of the names that resources get.
        """
        given = {**own, **self._constants(constants, stem)}
        if isinstance(rule, Operator):
            given |= self._constants(rule.fixed, stem)
            if rule.copies is not None:
                given["copies"] = self.assembly.call(rule.copies, given)
        return given

    def _constants(self, constants: Mapping[str, Any], stem: str) -> dict[str, Expr]:
        """Choices, textures and buffers as expressions; resources are named after ``stem``."""
        made: dict[str, Expr] = {}
        for name, value in constants.items():
            if isinstance(value, TextureValue | Buffer):
                made[name] = self.assembly.resource(value, f"{stem}_{name}".lower())
            elif isinstance(value, bool):
                made[name] = self.assembly.constant(value, BOOL)
            elif isinstance(value, int):
                made[name] = self.assembly.constant(value, INT)
            else:
                made[name] = self.assembly.constant(value.value, value.type)
        return made


def plain_name(name: str) -> str:
    """A name as an identifier of small letters."""
    return "".join(c if c.isalnum() else "_" for c in name).strip("_").lower() or "shape"
