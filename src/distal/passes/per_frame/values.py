"""The per-frame part while it is gathered: its values, and which of them the target can carry.

Input: forms (see ``forms``) that the pixel code wants computed once a frame. Output: the
ordered list of the module's per-frame values, each written over earlier ones.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import Final, NamedTuple

from distal.ir.nodes import Builtin, Call, Expr, Let, PerFrame, Read, Return, Stmt, Uniform
from distal.ir.types import Matrix, Scalar, Struct, Type, Vector, component_count
from distal.ir.walk import children, nodes_in, rebuild, substitute
from distal.passes.cost import Costs, node_cost
from distal.passes.naming import FreshNames
from distal.passes.share.split_deep import split_expression

# The least cost of what is computed once a frame: a division, a square root, or four sums. A value
# costs a register or a load in every pixel, so a product of two uniforms stays where it is.
LEAST_COST: Final = 4

MARK: Final = "#"  # begins the names of values that have no final name yet


def is_carried(type: Type) -> bool:
    """True for types that a per-frame value may have."""
    return isinstance(type, Scalar | Vector | Matrix)


def is_exploded(type: Type) -> bool:
    """True for structs that are passed field by field."""
    return isinstance(type, Struct) and all(is_carried(t) or is_exploded(t) for _, t in type.fields)


class NameHint(NamedTuple):
    """What a value should be called, and how good a name that is (see ``FrameValue.rank``)."""

    name: str | None
    rank: int = 0

    def part(self, field: str) -> NameHint:
        """The hint for a field of the value."""
        return NameHint(f"{self.name}_{field}" if self.name else field, self.rank)


def suggestion(form: Expr) -> NameHint:
    """``cos_angle`` for a built-in or a function of one named thing."""
    if isinstance(form, Builtin | Call):
        leaves = {n.name for n in nodes_in(form) if isinstance(n, Read | Uniform)}
        if len(leaves) == 1:
            name = form.name if isinstance(form, Builtin) else form.function
            return NameHint(f"{name}_{leaves.pop()}")
    return NameHint(None)


@dataclass(slots=True)
class FrameValue:
    """A value computed once a frame.

    Attributes:
        form: What it is.
        name: What code that reads it calls it until all names are known.
        hint: What it should be called, if there is a good name for it.
        rank: How good: 2 for the author's name of the value itself, 1 for that of a parameter.
        weight: What it saves: its cost, times how often pixels would compute it.
    """

    form: Expr
    name: str
    hint: str | None = None
    rank: int = -1
    weight: int = 0


class FrameValues:
    """All per-frame values of a module."""

    def __init__(self, costs: Costs) -> None:
        self.costs = costs
        self._values: dict[Expr, FrameValue] = {}

    def read(self, form: Expr, hint: NameHint, rate: int) -> Expr:
        """A read of the value of that form."""
        found = self._values.get(form)
        if found is None:
            found = self._values[form] = FrameValue(form, f"{MARK}{len(self._values)}")
        if hint.name is not None and hint.rank > found.rank:
            found.hint, found.rank = hint
        found.weight += self.costs.of(form) * rate
        return PerFrame(found.name, form.type)

    def chosen(self, wanted: set[str], limit: int | None) -> set[str]:
        """The wanted values within ``limit``: those that save most for each component."""
        values = [v for v in self._values.values() if v.name in wanted]
        if limit is None or sum(component_count(v.form.type) for v in values) <= limit:
            return {v.name for v in values}
        found: set[str] = set()
        left = limit
        for value in sorted(values, key=lambda v: -v.weight / component_count(v.form.type)):
            size = component_count(value.form.type)
            if size <= left:
                left -= size
                found.add(value.name)
        return found

    def entries(self, wanted: set[str]) -> list[tuple[str, str | None, Expr]]:
        """Name, name hint and value of everything that the wanted values need, in order."""
        values = [v for v in self._values.values() if v.name in wanted]
        return _FrameEntries(values, self.costs).entries


class _FrameEntries:
    """Writes forms over each other, and over values that several of them share."""

    def __init__(self, values: list[FrameValue], costs: Costs) -> None:
        self.entries: list[tuple[str, str | None, Expr]] = []
        self._costs = costs
        self._names = {s.form: s.name for s in values}
        self._hints = {s.form: s.hint for s in values}
        self._done: dict[Expr, Expr] = {}
        self._deep = FreshNames(())
        users: Counter[Expr] = Counter()
        for e in nodes_in(*self._names):
            users.update(set(children(e)))
        self._shared = {e for e, count in users.items() if count > 1 and self._is_worth(e)}
        for value in values:
            for e in nodes_in(value.form):
                self._write(e)

    def _is_worth(self, e: Expr) -> bool:
        if not is_carried(e.type) or not children(e) or not node_cost(e, self._costs.calls):
            return False
        return self._costs.of(e) >= LEAST_COST

    def _write(self, e: Expr) -> None:
        if e in self._done:
            return
        value = rebuild(e, tuple([self._done[c] for c in children(e)]))
        name = self._names.get(e)
        if name is None and e in self._shared:
            name = f"{MARK}shared{len(self.entries)}"
        if name is not None:
            self.entries.append((name, self._hints.get(e), self._cut(value)))
            value = PerFrame(name, e.type)
        self._done[e] = value

    def _cut(self, value: Expr) -> Expr:
        """Values too deep for a shader compiler are written in several steps."""
        before: list[Stmt] = []
        value = split_expression(value, self._deep, before, Return(value))
        steps: dict[Expr, Expr] = {}
        for let in before:
            assert isinstance(let, Let)
            name = f"{MARK}deep{len(self.entries)}"
            self.entries.append((name, None, substitute(let.value, steps, {})))
            steps[Read(let.name, let.value.type)] = PerFrame(name, let.value.type)
        return substitute(value, steps, {}) if steps else value
