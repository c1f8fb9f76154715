"""Remove locals that nothing reads.

Input: the body of a function. Output: the same body without Lets, Vars, assignments, branches and
counted loops on which no result depends. A ``while`` is kept: whether it terminates is part of the
program's behaviour.
"""

from __future__ import annotations

from typing import TypeAlias

from distal.ir.nodes import Assign, Expr, For, If, Let, Read, Stmt, Var, While
from distal.ir.walk import blocks, children, expressions, map_statement, nodes_in, root_of

FreshNames: TypeAlias = frozenset[str]


class ReadNames:
    """The locals that expressions read, cached for each node."""

    def __init__(self) -> None:
        self._found: dict[Expr, FreshNames] = {}

    def of(self, root: Expr) -> FreshNames:
        """Return the names of the Reads in an expression."""
        found = self._found
        known = found.get(root)
        if known is not None:
            return known
        for e in nodes_in(root):
            if e in found:
                continue
            if isinstance(e, Read):
                found[e] = frozenset((e.name,))
                continue
            below = [found[c] for c in children(e)]
            if len(below) == 1:
                found[e] = below[0]
            else:
                found[e] = frozenset().union(*below)
        return found[root]


def remove_dead(body: tuple[Stmt, ...], reads: ReadNames | None = None) -> tuple[Stmt, ...]:
    """Return the body without the locals on which no Return, condition or loop bound depends."""
    reads = reads or ReadNames()
    needs: dict[str, set[str]] = {}
    wanted: set[str] = set()
    _collect(body, reads, needs, wanted)
    stack = list(wanted)
    while stack:
        for name in needs.get(stack.pop(), ()):
            if name not in wanted:
                wanted.add(name)
                stack.append(name)
    return _kept(body, wanted)


def _collect(
    body: tuple[Stmt, ...], reads: ReadNames, needs: dict[str, set[str]], wanted: set[str]
) -> None:
    """Collect the locals that each local depends on, and the locals that are always needed."""
    for stmt in body:
        match stmt:
            case Let(name, value) | Var(name, value):
                needs.setdefault(name, set()).update(reads.of(value))
            case Assign(target, value):
                depends = needs.setdefault(root_of(target).name, set())
                depends |= reads.of(value) | reads.of(target)
            case _:
                for e in expressions(stmt):
                    wanted |= reads.of(e)
                for block in blocks(stmt):
                    _collect(block, reads, needs, wanted)


def _kept(body: tuple[Stmt, ...], wanted: set[str]) -> tuple[Stmt, ...]:
    kept: list[Stmt] = []
    for stmt in body:
        match stmt:
            case Let(name) | Var(name):
                if name not in wanted:
                    continue
            case Assign(target):
                if root_of(target).name not in wanted:
                    continue
            case If() | For() | While():
                stmt = map_statement(stmt, lambda e: e, lambda block: _kept(block, wanted))
                if not isinstance(stmt, While) and not any(blocks(stmt)):
                    continue
            case _:
                pass
        kept.append(stmt)
    return tuple(kept)
