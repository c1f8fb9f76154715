"""Remove locals that nothing reads.

Input: the body of a function. Output: the same body without Lets, Vars, assignments, branches and
counted loops on which no result depends. A ``while`` is kept: whether it terminates is part of the
program's behaviour.
"""

from __future__ import annotations

from distal.ir.contents import contents
from distal.ir.nodes import Assign, For, If, Let, Stmt, Var, While
from distal.ir.walk import blocks, expressions, map_statement, root_of


def remove_dead(body: tuple[Stmt, ...]) -> tuple[Stmt, ...]:
    """Return the body without the locals on which no Return, condition or loop bound depends."""
    needs: dict[str, set[str]] = {}
    wanted: set[str] = set()
    _collect(body, needs, wanted)
    stack = list(wanted)
    while stack:
        for name in needs.get(stack.pop(), ()):
            if name not in wanted:
                wanted.add(name)
                stack.append(name)
    return _kept(body, wanted)


def _collect(body: tuple[Stmt, ...], needs: dict[str, set[str]], wanted: set[str]) -> None:
    """Collect the locals that each local depends on, and the locals that are always needed."""
    for stmt in body:
        match stmt:
            case Let(name, value) | Var(name, value):
                needs.setdefault(name, set()).update(contents(value).reads)
            case Assign(target, value):
                depends = needs.setdefault(root_of(target).name, set())
                depends |= contents(value).reads | contents(target).reads
            case _:
                for e in expressions(stmt):
                    wanted |= contents(e).reads
                for block in blocks(stmt):
                    _collect(block, needs, wanted)


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
