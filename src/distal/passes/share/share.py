"""Share: bind a value that is computed more than once to a Let.

Input: any module after inline. Output: functions with the same values, in which common
subexpressions are bound, loop-invariant values are bound before the loop, and no expression is
deeper than shader compilers accept.

A value is bound in the outermost block where its operands exist and where every execution would
compute it anyway: nothing moves out of a branch, out of a loop that may have no iteration, or
before an exit that may skip it. An operand that a Select or ``and`` may skip is bound only when it
is cheap. The author's names are kept: a shared value that the author named keeps that name, others
are called ``shared_0``, ``shared_1`` ...
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final

from distal.ir.contents import contents
from distal.ir.kept import kept
from distal.ir.nodes import (
    Assign,
    Compose,
    Construct,
    Expr,
    Field,
    Function,
    Index,
    Let,
    Logical,
    Module,
    Read,
    Select,
    Stmt,
    Swizzle,
)
from distal.ir.types import is_static
from distal.ir.walk import (
    children,
    expressions,
    map_indices,
    map_statement,
    nodes_in,
    rebuild,
    roots_in,
)
from distal.passes.context import Context
from distal.passes.cost import Costs, function_costs, node_cost
from distal.passes.naming import FreshNames, local_names, module_names
from distal.passes.regions import (
    Region,
    UseSite,
    UseSites,
    cleared,
    first_position,
    in_loop,
    is_certain,
    within,
)
from distal.passes.share.split_deep import SHARED, split_deep
from distal.passes.versions import Versions, plain

WORTH_A_NAME: Final = 3  # the least cost; a sum is as short as a name for it
WORTH_LEAVING_A_LOOP: Final = 4
CHEAP: Final = 40  # the largest cost of a value that may be computed but not used
MOST_ROUNDS: Final = 3  # a Let that left a loop may allow others to leave in the next round


def run(module: Module, context: Context) -> Module:
    """Share values within every function."""
    costs = function_costs(module.functions)
    taken = frozenset(name for name in module_names(module) if name.startswith(SHARED))
    functions = tuple(_shared(f, _callee_costs(f, costs), taken) for f in module.functions)
    return replace(module, functions=functions)


def _callee_costs(function: Function, costs: Mapping[str, int]) -> tuple[tuple[str, int], ...]:
    """Return the costs of the functions that a function calls."""
    called = dict.fromkeys(n for root in roots_in(function.body) for n in contents(root).callees)
    return tuple((name, costs[name]) for name in called if name in costs)


@kept
def _shared(
    function: Function, calls: tuple[tuple[str, int], ...], taken: frozenset[str]
) -> Function:
    """Return what ``share_function`` makes; the new names are all that could be taken."""
    return share_function(function, dict(calls), set(taken))


def share_function(function: Function, calls: Mapping[str, int], taken: set[str]) -> Function:
    """Share values within one function.

    Args:
        function: The function.
        calls: The cost of each function.
        taken: The names of the module, which new Lets must not hide.
    """
    names = FreshNames(taken | set(local_names(function)))
    for _ in range(MOST_ROUNDS):
        sharing = _Sharing(function, calls)
        function = sharing.function(names)
        if not sharing.left_a_loop:
            break
    return replace(function, body=split_deep(function.body, names))


@dataclass(eq=False, slots=True)
class _EarlyLet:
    """A value bound before a statement; ``let`` is the author's Let if it is moved there."""

    value: Expr
    region: Region
    position: int
    let: Let | None
    name: str = ""


class _Sharing:
    def __init__(self, function: Function, calls: Mapping[str, int]) -> None:
        self._function = function
        self._versions = Versions(function)
        self._costs = Costs(calls)
        # The sites of each node, from its users processed so far.
        self._sites: dict[Expr, dict[UseSite, int]] = {}
        self._heights: dict[Expr, int] = {}
        self._homes: dict[Expr, Region] = {}
        self._lets: dict[Expr, list[tuple[Region, int]]] = {}
        self._replaced: dict[tuple[Expr, UseSite], _EarlyLet] = {}
        self._before: dict[tuple[Region, int], list[_EarlyLet]] = {}
        self._moved: set[tuple[Region, int]] = set()
        self.left_a_loop = False

    def function(self, names: FreshNames) -> Function:
        """Return the function with shared values bound."""
        root = self._versions.root
        self._collect(root)
        # Users before operands: an operand of a shared value is used where that value is bound.
        for e in sorted(self._heights, key=self._heights.__getitem__, reverse=True):
            sites = self._sites.get(e)
            if sites and children(e):
                self._place(e, self._homes[e], sites)
                self._hand_down(e, sites)
        self._name(root, names)
        body = self._block(root)
        return self._function if body == self._function.body else replace(self._function, body=body)

    # Find the places where every expression is computed.

    def _collect(self, region: Region) -> None:
        for position, stmt in enumerate(region.body):
            inner = region.inner.get(position, ())
            head = inner[0] if inner and inner[0].is_head else None
            site = UseSite(region, position) if head is None else UseSite(head, 0)
            for root in _computed(stmt):
                self._learn(root)
                self._use(root, site, 1)
            if isinstance(stmt, Let):
                self._lets.setdefault(stmt.value, []).append((region, position))
            for below in head.inner[0] if head is not None else inner:
                self._collect(below)

    def _learn(self, root: Expr) -> None:
        """Record each node's height, and the innermost region that creates one of its locals."""
        heights, homes, top = self._heights, self._homes, self._versions.root
        for e in nodes_in(root):
            if e in heights:
                continue
            height, home = 0, top
            if isinstance(e, Read):
                home = self._versions.births[e.name]
            for c in children(e):
                height = max(height, heights[c] + 1)
                if homes[c].depth > home.depth:
                    home = homes[c]
            heights[e], homes[e] = height, home

    def _use(self, e: Expr, site: UseSite, uses: int) -> None:
        sites = self._sites.setdefault(e, {})
        sites[site] = min(2, sites.get(site, 0) + uses)

    def _hand_down(self, e: Expr, sites: UseSites) -> None:
        """Add to the operands of ``e`` the sites where ``e`` is bound, or else where it is used."""
        bound: set[_EarlyLet] = set()
        for site, uses in sites.items():
            binding = self._replaced.get((e, site))
            if binding is not None:
                if binding in bound:
                    continue
                bound.add(binding)
                site, uses = UseSite(binding.region, binding.position), 1
            for operand, lazy in _operands(e):
                self._use(
                    operand, site._replace(lazy=True) if lazy and not site.lazy else site, uses
                )

    # Decide where a value is bound.

    def _place(self, e: Expr, region: Region, sites: UseSites) -> None:
        """Bind ``e`` in ``region`` if this saves work and never computes an unused value.

        Otherwise try the inner regions that use ``e``. A cheap value may be computed but not used.
        """
        once = sum(sites.values())
        if once < 2 and not any(in_loop(region, s) for s in sites):
            return
        if not _may_be_bound(e, self._costs):
            return
        cost = self._costs.of(e)
        if cost < (WORTH_A_NAME if once > 1 else WORTH_LEAVING_A_LOOP):
            return
        counted = cleared(sites) if cost <= CHEAP else sites
        start = first_position(region, sites)
        if not region.is_head and is_certain(region, counted, start):
            self._bind(e, region, start, sites)
            return
        for inner, some in within(region, sites)[1].items():
            self._place(e, inner, some)

    def _bind(self, e: Expr, region: Region, position: int, sites: UseSites) -> None:
        let = None
        for home, at in self._lets.get(e, ()):
            if UseSite(home, at) in sites:
                named = home.body[at]
                assert isinstance(named, Let)
                let = named
                self._moved.add((home, at))
                self.left_a_loop |= home is not region
                break
        binding = _EarlyLet(e, region, position, let)
        for site in sites:
            self._replaced[e, site] = binding
        self._before.setdefault((region, position), []).append(binding)

    # Write the new body.

    def _name(self, region: Region, names: FreshNames) -> None:
        """Name the bindings in the order of their positions."""
        for position in range(len(region.body)):
            bindings = self._before.get((region, position), [])
            bindings.sort(key=lambda b: self._heights[b.value])
            for binding in bindings:
                binding.name = binding.let.name if binding.let else names.numbered(SHARED)
            for inner in region.inner.get(position, ()):
                for below in inner.inner[0] if inner.is_head else (inner,):
                    self._name(below, names)

    def _block(self, region: Region) -> tuple[Stmt, ...]:
        result: list[Stmt] = []
        for position, stmt in enumerate(region.body):
            site = UseSite(region, position)
            for binding in self._before.get((region, position), ()):
                value = plain(self._rewritten(binding.value, site, is_bound_here=True))
                span = binding.let.span if binding.let else stmt.span
                result.append(Let(binding.name, value, span=span))
            if (region, position) in self._moved:
                continue
            inner = region.inner.get(position, ())
            if inner and inner[0].is_head:
                site, inner = UseSite(inner[0], 0), inner[0].inner[0]
            result.append(self._statement(stmt, site, inner))
        return tuple(result)

    def _statement(self, stmt: Stmt, site: UseSite, inner: tuple[Region, ...]) -> Stmt:
        blocks = iter(inner)

        def expr(e: Expr) -> Expr:
            return plain(self._rewritten(e, site))

        if isinstance(stmt, Assign):
            return Assign(map_indices(stmt.target, expr), expr(stmt.value), span=stmt.span)
        return map_statement(stmt, expr, lambda _: self._block(next(blocks)))

    def _rewritten(self, root: Expr, site: UseSite, is_bound_here: bool = False) -> Expr:
        """Replace bound values by reads, without recursion: sums may be deep."""
        done: dict[tuple[Expr, bool], Expr] = {}
        stack: list[tuple[Expr, bool]] = [(root, site.lazy)]
        while stack:
            key = stack[-1]
            e, lazy = key
            if key in done:
                stack.pop()
                continue
            binding = self._replaced.get((e, site._replace(lazy=lazy)))
            if binding is not None and not (is_bound_here and e is root):
                done[key] = Read(binding.name, e.type)
                continue
            below = [(operand, lazy or skipped) for operand, skipped in _operands(e)]
            waiting = [k for k in below if k not in done]
            if waiting:
                stack.extend(waiting)
                continue
            done[key] = rebuild(e, tuple([done[k] for k in below]))
        return done[root, site.lazy]


def _computed(stmt: Stmt) -> tuple[Expr, ...]:
    """Return the expressions that a statement computes; of an Assign's target, only the indices."""
    if not isinstance(stmt, Assign):
        return expressions(stmt)
    found: list[Expr] = []
    target = stmt.target
    while isinstance(target, Swizzle | Index | Field):
        if isinstance(target, Index):
            found.append(target.index)
        target = target.base
    return (*found, stmt.value)


def _operands(e: Expr) -> list[tuple[Expr, bool]]:
    """Return the operands, each with whether its computation may be skipped."""
    match e:
        case Select(condition, yes, no):
            return [(condition, False), (yes, True), (no, True)]
        case Logical(_, lhs, rhs):
            return [(lhs, False), (rhs, True)]
        case _:
            return [(c, False) for c in children(e)]


def _may_be_bound(e: Expr, costs: Costs) -> bool:
    """Return whether a Let may hold ``e``. A part of a value may not: it is as short as a name."""
    if is_static(e.type):
        return False
    return isinstance(e, Compose | Construct) or node_cost(e, costs.calls) > 0
