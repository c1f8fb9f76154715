"""Collect the values of the per-frame part, and choose those that the target can transfer.

Input: forms (see ``forms``) that should be computed once per frame. Output: the ordered list of the
module's per-frame values, each expressed in terms of earlier ones.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Final, NamedTuple

from distal.ir.contents import contents
from distal.ir.nodes import Builtin, Call, Expr, Let, PerFrame, Read, Return, Stmt, Uniform
from distal.ir.types import Matrix, Scalar, Struct, Type, Vector, component_count
from distal.ir.walk import children, nodes_in, rebuild, substitute
from distal.passes.cost import Costs, node_cost
from distal.passes.naming import FreshNames
from distal.passes.share.split_deep import split_expression

# The least cost of a per-frame value: a division, a square root, or four sums. A value costs a
# register or a load in every pixel, so a product of two uniforms is not moved.
LEAST_COST: Final = 4

MARK: Final = "#"  # first character of the temporary names of values


@cache
def is_carried(type: Type) -> bool:
    """Return whether a per-frame value may have the type."""
    return isinstance(type, Scalar | Vector | Matrix)


@cache
def is_exploded(type: Type) -> bool:
    """Return whether the type is a struct that is passed field by field."""
    return isinstance(type, Struct) and all(is_carried(t) or is_exploded(t) for _, t in type.fields)


class NameHint(NamedTuple):
    """A suggested name for a value, and its quality (see ``FrameValue.rank``)."""

    name: str | None
    rank: int = 0

    def part(self, field: str) -> NameHint:
        """Return the hint for a field of the value."""
        return NameHint(f"{self.name}_{field}" if self.name else field, self.rank)


def suggestion(form: Expr) -> NameHint:
    """Suggest a name such as ``cos_angle`` for a built-in or function of one named value."""
    if isinstance(form, Builtin | Call):
        below = contents(form).below or ()
        leaves = {n.name for n in below if isinstance(n, Read | Uniform)}
        if len(leaves) == 1:
            name = form.name if isinstance(form, Builtin) else form.function
            return NameHint(f"{name}_{leaves.pop()}")
    return NameHint(None)


@dataclass(slots=True)
class FrameValue:
    """A value computed once per frame.

    Attributes:
        form: The expression that computes it.
        name: Its temporary name, until all names are known.
        hint: The suggested final name, or None.
        rank: The quality of the hint: 2 for the author's name of the value itself, 1 for the
            author's name of a parameter.
        weight: The work it saves: its cost, times how often pixels would compute it.
    """

    form: Expr
    name: str
    hint: str | None = None
    rank: int = -1
    weight: int = 0


class FrameValues:
    """All per-frame values of a module.

    ``names`` has the author's names of parts of the values.
    """

    def __init__(self, costs: Costs, names: Mapping[Expr, str]) -> None:
        self.costs = costs
        self._names = names
        self._values: dict[Expr, FrameValue] = {}

    def read(self, form: Expr, hint: NameHint, rate: int) -> Expr:
        """Return a read of the value with this form; add the value if it is new.

        Args:
            form: The form.
            hint: A name for the value.
            rate: How often one pixel would compute it.
        """
        found = self._values.get(form)
        if found is None:
            found = self._values[form] = FrameValue(form, f"{MARK}{len(self._values)}")
        if hint.name is not None and hint.rank > found.rank:
            found.hint, found.rank = hint
        found.weight += self.costs.of(form) * rate
        return PerFrame(found.name, form.type)

    def chosen(self, wanted: set[str], limit: int | None) -> set[str]:
        """Return the wanted values within ``limit`` components: those that save most for each."""
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
        """Return name, name hint and value of everything that the wanted values need, in order."""
        values = [v for v in self._values.values() if v.name in wanted]
        return _FrameEntries(values, self.costs, self._names).entries


class _FrameEntries:
    """Writes forms in terms of each other, and of new values for the parts that they share."""

    def __init__(self, values: list[FrameValue], costs: Costs, names: Mapping[Expr, str]) -> None:
        self.entries: list[tuple[str, str | None, Expr]] = []
        self._costs = costs
        self._names = {s.form: s.name for s in values}
        self._hints = {**names, **{s.form: s.hint for s in values if s.hint}}
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
        if not (is_carried(e.type) or is_exploded(e.type)) or not children(e):
            return False
        if not node_cost(e, self._costs.calls):
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
        """Split a value that is too deep for a shader compiler into several values."""
        before: list[Stmt] = []
        value = split_expression(value, self._deep, before, Return(value))
        steps: dict[Expr, Expr] = {}
        for let in before:
            assert isinstance(let, Let)
            name = f"{MARK}deep{len(self.entries)}"
            self.entries.append((name, None, substitute(let.value, steps, {})))
            steps[Read(let.name, let.value.type)] = PerFrame(name, let.value.type)
        return substitute(value, steps, {}) if steps else value
