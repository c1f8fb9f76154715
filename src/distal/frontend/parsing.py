"""Parse Python source text, in one thread at a time.

Input: source text. Output: its syntax tree. CPython 3.11 counts the recursion depth of all parsers
in one shared counter (gh-106905): if two threads parse at the same time, one sometimes fails with
"AST constructor recursion depth mismatch".
"""

from __future__ import annotations

import ast
import threading
from typing import Any, Final

_PARSING: Final = threading.Lock()


def parse(text: str, **options: Any) -> Any:
    """Call ``ast.parse`` while no other thread parses."""
    with _PARSING:
        return ast.parse(text, **options)
