"""Python's parser, for one thread at a time.

Input: source text. Output: its tree. CPython 3.11 counts the depth of all trees
that are being built in one place (gh-106905): two threads that parse at once fail now and then
with "AST constructor recursion depth mismatch".
"""

from __future__ import annotations

import ast
import threading
from typing import Any, Final

_PARSING: Final = threading.Lock()


def parse(text: str, **options: Any) -> Any:
    """``ast.parse``, waiting for other threads that parse."""
    with _PARSING:
        return ast.parse(text, **options)
