"""Parse Python source text, in one thread at a time.

Input: source text. Output: its syntax tree. CPython 3.11 counts the recursion depth of all parsers
in one shared counter (gh-106905): if two threads parse at the same time, one sometimes fails with
"AST constructor recursion depth mismatch".
"""

from __future__ import annotations

import ast
from functools import lru_cache
from typing import Any, Final

from distal.forking import new_lock

TREES_KEPT: Final = 512

_PARSING: Final = new_lock()


def parse(text: str, **options: Any) -> Any:
    """Call ``ast.parse`` while no other thread parses."""
    with _PARSING:
        return ast.parse(text, **options)


@lru_cache(maxsize=TREES_KEPT)
def parse_definitions(text: str) -> ast.Module:
    """Return the tree of the text of a definition; equal texts have one, which nobody changes."""
    tree: ast.Module = parse(text)
    return tree
