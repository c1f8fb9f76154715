"""Scope analysis: find the block that declares each local of a function.

Input: the syntax tree of one function. Output: the locals of each block, and whether each may
change. Works with names only; does not depend on types.

A local belongs to the innermost block that contains all its uses. If several inner blocks use the
same name and none reads a value that another one wrote, each gets a separate local. For example,
``d`` in two consecutive loops becomes two constants instead of one variable.
"""

from __future__ import annotations

import ast
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field

_EVERYTHING = frozenset({"*"})


@dataclass(frozen=True, slots=True)
class BlockLocal:
    """A local of a block; ``changes`` if a Var is needed instead of a Let."""

    name: str
    changes: bool


@dataclass(slots=True)
class _BlockUses:
    """Uses of names in one block, without its inner blocks."""

    statements: list[ast.stmt]
    hidden: frozenset[str] = frozenset()  # the loop variables, which are no locals of this block
    reads: set[str] = field(default_factory=set)
    whole: dict[str, int] = field(default_factory=lambda: defaultdict(int))
    partial: set[str] = field(default_factory=set)
    inner: list[_BlockUses] = field(default_factory=list)
    _exposed: set[str] | None = None

    @property
    def exposed(self) -> set[str]:
        """The names that the block may read before it assigns them."""
        if self._exposed is None:
            self._exposed = exposed_reads(self.statements)
        return self._exposed


@dataclass(frozen=True, slots=True)
class ScopeAnalysis:
    """The locals of a function.

    Attributes:
        blocks: Locals by block (the identity of its statement list).
        names: Every name that is a local or a parameter somewhere.
        loops: Every name that is a loop variable somewhere.
        changed_parameters: Parameters that are assigned to.
    """

    blocks: dict[int, list[BlockLocal]]
    names: frozenset[str]
    loops: frozenset[str]
    changed_parameters: frozenset[str]


def analyse_scopes(statements: list[ast.stmt], parameters: set[str]) -> ScopeAnalysis:
    """Find the locals of a function with this body."""
    captures: dict[str, set[str]] = {}
    root = _collect(statements, captures, frozenset())
    # Assignment to a part does not make a name local: in Python it changes the outer object.
    stored = _stored(root) | (_partly_stored(root) & parameters)
    blocks: dict[int, list[BlockLocal]] = defaultdict(list)
    for name in sorted(stored - parameters):
        _place(root, name, blocks)
    names = frozenset(stored | parameters)
    loops = frozenset(_loop_names(root)) - names
    return ScopeAnalysis(dict(blocks), names, loops, frozenset(stored & parameters))


def _loop_names(block: _BlockUses) -> Iterator[str]:
    for inner in block.inner:
        yield from inner.hidden
        yield from _loop_names(inner)


def _collect(
    statements: list[ast.stmt], captures: dict[str, set[str]], hidden: frozenset[str]
) -> _BlockUses:
    block = _BlockUses(statements, hidden)
    for stmt in statements:
        match stmt:
            case ast.If(test, body, orelse):
                _uses(test, block, captures)
                block.inner.append(_collect(body, captures, frozenset()))
                if orelse:
                    block.inner.append(_collect(orelse, captures, frozenset()))
            case ast.While(test, body):
                _uses(test, block, captures)
                block.inner.append(_collect(body, captures, frozenset()))
            case ast.For(target, iterable, body):
                _uses(iterable, block, captures)
                plain = list(_flat_targets(target))
                if not all(isinstance(t, ast.Name) for t in plain):
                    _uses(target, block, captures)
                names = frozenset(t.id for t in plain if isinstance(t, ast.Name))
                block.inner.append(_collect(body, captures, names))
            case ast.FunctionDef(name):
                free = free_names(stmt)
                captures[name] = free
                block.whole[name] += 1
                block.reads |= free
            case ast.Assign([ast.Name(name)], ast.Lambda() as value):
                captures[name] = free_names(value)
                _uses(stmt, block, captures)
            case _:
                _uses(stmt, block, captures)
    return block


def _uses(node: ast.AST, block: _BlockUses, captures: dict[str, set[str]]) -> None:
    """Record every name in a statement or expression that has no inner blocks."""
    match node:
        case ast.Name(name, ast.Load()):
            block.reads.add(name)
            block.reads |= captures.get(name, set())
        case ast.Name(name):
            block.whole[name] += 1
        case ast.AugAssign(ast.Name(name), _, value):
            # It reads the old value, so it is never the only assignment.
            block.whole[name] += 1
            block.reads.add(name)
            _uses(value, block, captures)
        case ast.AnnAssign(target, _, value):
            if value is not None or not isinstance(target, ast.Name):
                _uses(target, block, captures)
            else:
                block.reads.add(target.id)  # without a value, it only declares the local
            if value is not None:
                _uses(value, block, captures)
        case ast.Subscript(base, index, ast.Store()):
            _part(base, block, captures)
            _uses(index, block, captures)
        case ast.Attribute(base, _, ast.Store()):
            _part(base, block, captures)
        case ast.Lambda():
            for name in free_names(node):
                block.reads.add(name)
                block.reads |= captures.get(name, set())
        case _:
            for child in ast.iter_child_nodes(node):
                _uses(child, block, captures)


def _part(base: ast.expr, block: _BlockUses, captures: dict[str, set[str]]) -> None:
    while isinstance(base, ast.Attribute | ast.Subscript):
        if isinstance(base, ast.Subscript):
            _uses(base.slice, block, captures)
        base = base.value
    if isinstance(base, ast.Name):
        block.partial.add(base.id)
    else:
        _uses(base, block, captures)


def all_parameters(arguments: ast.arguments) -> list[ast.arg]:
    """Return all parameters of a function."""
    starred = [a for a in (arguments.vararg, arguments.kwarg) if a is not None]
    return [*plain_parameters(arguments), *starred]


def plain_parameters(arguments: ast.arguments) -> list[ast.arg]:
    """Return all parameters of a function but those with stars."""
    return [*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs]


def free_names(function: ast.FunctionDef | ast.Lambda) -> set[str]:
    """Return the names that a nested function uses from its enclosing scopes."""
    a = function.args
    own = {p.arg for p in plain_parameters(a)}
    loads: set[str] = set()
    body = function.body if isinstance(function.body, list) else [function.body]
    for node in (n for part in body for n in ast.walk(part)):
        if isinstance(node, ast.Name):
            if isinstance(node.ctx, ast.Load):
                loads.add(node.id)
            else:
                own.add(node.id)
        elif isinstance(node, ast.FunctionDef):
            own.add(node.name)
        elif isinstance(node, ast.arg):
            own.add(node.arg)
    defaults = {
        n.id
        for d in (*a.defaults, *(d for d in a.kw_defaults if d is not None))
        for n in ast.walk(d)
        if isinstance(n, ast.Name)
    }
    return (loads - own) | defaults


def _stored(block: _BlockUses) -> set[str]:
    names = set(block.whole)
    for inner in block.inner:
        names |= _stored(inner) - inner.hidden
    return names


def _partly_stored(block: _BlockUses) -> set[str]:
    names = set(block.partial)
    for inner in block.inner:
        names |= _partly_stored(inner)
    return names


def _mentions(block: _BlockUses, name: str) -> bool:
    if name in block.hidden:
        return False
    direct = name in block.reads or name in block.whole or name in block.partial
    return direct or any(_mentions(inner, name) for inner in block.inner)


def _place(block: _BlockUses, name: str, blocks: dict[int, list[BlockLocal]]) -> None:
    """Find the innermost block for a name, or several blocks if their uses are independent."""
    direct = name in block.reads or name in block.whole or name in block.partial
    holders = [inner for inner in block.inner if _mentions(inner, name)]
    separate = all(name not in h.exposed for h in holders)
    if direct or not (len(holders) == 1 or separate):
        sites = list(_sites(block, name))
        once = sites == [block] and not _partly(block, name)
        blocks[id(block.statements)].append(BlockLocal(name, not once))
        return
    for holder in holders:
        _place(holder, name, blocks)


def _sites(block: _BlockUses, name: str) -> Iterator[_BlockUses]:
    """Yield the block of each assignment to the whole variable."""
    if name in block.hidden:
        return
    for _ in range(block.whole.get(name, 0)):
        yield block
    for inner in block.inner:
        yield from _sites(inner, name)


def _partly(block: _BlockUses, name: str) -> bool:
    if name in block.hidden:
        return False
    return name in block.partial or any(_partly(inner, name) for inner in block.inner)


def exposed_reads(statements: list[ast.stmt]) -> set[str]:
    """Return the names that a block may read before it assigns them."""
    return _flow(statements)[0]


def _flow(statements: list[ast.stmt]) -> tuple[set[str], set[str] | frozenset[str]]:
    """Return (exposed reads, names always assigned at the end; ``*`` if the end is unreachable)."""
    exposed: set[str] = set()
    assigned: set[str] = set()
    for stmt in statements:
        match stmt:
            case ast.If(test, body, orelse):
                one, two = _flow(body), _flow(orelse)
                exposed |= (_loads(test) | one[0] | two[0]) - assigned
                if one[1] is _EVERYTHING and two[1] is _EVERYTHING:
                    return exposed, _EVERYTHING
                if one[1] is _EVERYTHING or two[1] is _EVERYTHING:
                    assigned |= two[1] if one[1] is _EVERYTHING else one[1]
                else:
                    assigned |= one[1] & two[1]
            case ast.While(head, body):
                exposed |= (_loads(head) | _flow(body)[0]) - assigned
            case ast.For(target, head, body):
                inside = _flow(body)[0] - {
                    n.id for n in ast.walk(target) if isinstance(n, ast.Name)
                }
                exposed |= (_loads(head) | inside) - assigned
            case ast.FunctionDef(name):
                exposed |= free_names(stmt) - assigned
                assigned.add(name)
            case _:
                exposed |= _loads(stmt) - assigned
                if isinstance(stmt, ast.Return | ast.Break | ast.Continue):
                    return exposed, _EVERYTHING
                assigned |= _whole_targets(stmt)
    return exposed, assigned


def _loads(node: ast.AST) -> set[str]:
    """Return the names that are read; assigning to a part, or ``+=``, also reads the name."""
    names = [n for n in ast.walk(node) if isinstance(n, ast.Name)]
    targets = _whole_targets(node)
    if targets:
        targets -= {n.id for n in names if isinstance(n.ctx, ast.Load)}
    return {n.id for n in names} - targets


def _whole_targets(node: ast.AST) -> set[str]:
    match node:
        case ast.Assign(targets):
            names = (n for t in targets for n in _flat_targets(t))
            return {n.id for n in names if isinstance(n, ast.Name)}
        case ast.AnnAssign(ast.Name(name), _, value):
            return {name} if value is not None else set()
        case _:
            return set()


def _flat_targets(target: ast.expr) -> Iterator[ast.expr]:
    if isinstance(target, ast.Tuple | ast.List):
        for element in target.elts:
            yield from _flat_targets(element)
    else:
        yield target
