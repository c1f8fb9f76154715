"""Keep the texts of programs on disk, beside the kernels of the CPU.

Input: a module before the passes, and a target. Output: the program, made or found. The key is all
that the text depends on: the printed module, the places of its functions and statements (without
the folders of files), and the compiler's sources.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import PurePath
from typing import TYPE_CHECKING, Any, Final

from distal.backends import TEXT_TARGETS
from distal.backends.base import Artifact
from distal.ir.nodes import Module
from distal.ir.printer import print_module
from distal.ir.target import Target
from distal.ir.walk import statements_in
from distal.lang.lazy_module import LazyModule

if TYPE_CHECKING:
    from distal.devices import cache, kernel_key
else:
    cache = LazyModule("distal.devices.cache")
    kernel_key = LazyModule("distal.devices.kernel_key")

_PACKAGE: Final = os.path.dirname(os.path.dirname(os.path.abspath(__file__))) + os.sep
# What writes the author's data into its text.
_WITH_DATA = frozenset({"isf"})


def kept_text(module: Module, target: Target, make: Callable[[], Artifact]) -> Artifact:
    """Return the program of a module for a target; ``make`` makes it if it is not kept."""
    if TEXT_TARGETS.get(target.name) is not target or target.name in _WITH_DATA:
        return make()  # a target with instruments of its own
    folder = None if sys.platform == "emscripten" else cache.default_folder()
    if folder is None:
        return make()
    store = cache.Cache(folder)
    files: dict[str, int] = {}
    places = [(files.setdefault(f, len(files)), line) for f, line in _places(module)]
    names = [PurePath(f.replace("\\", "/")).name for f in files]
    sources = [(type(r.source).__name__, getattr(r.source, "shown", "")) for r in module.resources]
    key = kernel_key.text_key(target.name, print_module(module), repr((places, names, sources)))
    found = store.load(key)
    if found is not None:
        return _read(json.loads(found), list(files))
    made = make()
    others = {p[0] for p in (*made.lines, *made.vertex_lines) if p is not None} - files.keys()
    if all(file.startswith(_PACKAGE) for file in others):  # functions that the passes have linked
        text = json.dumps(_written(made, files))
        if json.loads(text)["interface"] == made.interface:
            store.store(key, text.encode())
    return made


def _places(module: Module) -> Iterator[tuple[str, int]]:
    for function in module.functions:
        if function.span is not None:
            yield function.span.file, function.span.line
        for stmt in statements_in(function.body):
            if stmt.span is not None:
                yield stmt.span.file, stmt.span.line


def _written(made: Artifact, files: dict[str, int]) -> dict[str, Any]:
    def rows(lines: tuple[tuple[str, int] | None, ...]) -> list[Any]:
        return [
            None if p is None else (files.get(p[0], p[0].removeprefix(_PACKAGE)), p[1])
            for p in lines
        ]

    return {
        "text": made.text,
        "interface": made.interface,
        "vertex": made.vertex,
        "lines": rows(made.lines),
        "vertex_lines": rows(made.vertex_lines),
    }


def _read(row: dict[str, Any], files: list[str]) -> Artifact:
    def lines(rows: list[Any]) -> tuple[tuple[str, int] | None, ...]:
        return tuple(None if p is None else (file(p[0]), p[1]) for p in rows)

    def file(name: int | str) -> str:
        return _PACKAGE + name if isinstance(name, str) else files[name]

    found = Artifact(row["text"], row["interface"], row["vertex"])
    return replace(found, lines=lines(row["lines"]), vertex_lines=lines(row["vertex_lines"]))
