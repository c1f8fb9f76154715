"""Compiled programs of the scene that is edited, kept by what their text depends on.

Input: pictures, as they are after each edit. Output: their artifacts. While a number of the scene
is dragged the text stays, so only the front end runs again. Needs the standard library alone.
"""

from __future__ import annotations

import hashlib
from collections import OrderedDict
from dataclasses import replace
from typing import Any, Final

from distal.backends.base import Artifact
from distal.backends.clike.interface import plain
from distal.export.page_programs import compiled_module, lowered
from distal.ir.nodes import Module, Origin
from distal.ir.printer import print_identity
from distal.lang.composed import Composed
from distal.lang.functions import Func

PROGRAMS_KEPT: Final = 64


class KeptPrograms:
    """The programs that were compiled last."""

    def __init__(self) -> None:
        self._kept: OrderedDict[str, Artifact] = OrderedDict()

    def compiled(self, image: Func | Composed) -> tuple[Artifact, Module]:
        """Return the text of a picture with its own numbers, and its module."""
        module = lowered(image)
        return self.of(module), module

    def of(self, module: Module, key: str | None = None) -> Artifact:
        """Return the text of a module with its own numbers; ``key`` is ``key_of`` it, if known."""
        key = key or key_of(module)
        artifact = self._kept.pop(key, None)
        if artifact is None:
            artifact = compiled_module(module)
        self._kept[key] = artifact
        if len(self._kept) > PROGRAMS_KEPT:
            self._kept.popitem(last=False)
        # Lines point to the text of that time: they may have moved, but not within a drag.
        return with_numbers(artifact, module)


def key_of(module: Module) -> str:
    """Return a name of the text of a module: equal keys, equal texts."""
    uniforms = tuple(
        replace(u, default=None) if u.origin is Origin.PARAMETER else u for u in module.uniforms
    )
    spans = "\0".join(f"{f.span.line}" for f in module.functions if f.span is not None)
    text = f"{print_identity(replace(module, uniforms=uniforms))}\0{spans}"
    return hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()[:32]


def numbers_of(module: Module) -> dict[str, Any]:
    """Return the values of a module's numbers by name, as JSON values."""
    return {u.name: plain(u.default) for u in module.uniforms if u.origin is Origin.NUMBER}


def with_numbers(artifact: Artifact, module: Module) -> Artifact:
    """Return an artifact whose uniforms have the defaults of a module."""
    defaults = {u.name: plain(u.default) for u in module.uniforms}
    uniforms = [
        entry | {"default": defaults.get(entry.get("parameter", entry["name"]), entry["default"])}
        for entry in artifact.interface["uniforms"]
    ]
    return replace(artifact, interface={**artifact.interface, "uniforms": uniforms})
