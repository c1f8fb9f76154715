"""From a random module's text to its picture on each target."""

from __future__ import annotations

import linecache
from typing import Any

from distal.frontend import lower
from distal.ir.nodes import Module
from tests.random_programs.statements import Sources


def lowered(sources: Sources) -> Module:
    """The picture's module, through the front end like a file of an author's."""
    name = "random_program.py"
    lines = sources.text.splitlines(keepends=True)
    linecache.cache[name] = (len(sources.text), None, lines, name)
    scope: dict[str, Any] = {"__name__": "random_program"}
    exec(compile(sources.text, name, "exec"), scope)
    return lower(scope["picture"])
