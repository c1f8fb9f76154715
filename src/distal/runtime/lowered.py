"""Lowered functions with digests by which their kernels are cached.

Input: recorded functions and composed objects. Output: their IR, its digest, and whether the
constants that they captured have changed since. Runs nothing.
"""

from __future__ import annotations

import hashlib
from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

from distal.frontend import lower_captured
from distal.frontend.freshness import Captured
from distal.ir.nodes import Module, Origin
from distal.ir.printer import print_identity
from distal.ir.types import Type
from distal.lang.composed import Composed
from distal.lang.functions import Func
from distal.lang.names import LangFunction
from distal.passes.numbers import freeze as freeze_numbers

Types: TypeAlias = tuple[Type, ...] | None


@dataclass(frozen=True, slots=True, eq=False)
class Lowered:
    """A lowered function.

    Attributes:
        module: The IR.
        digest: Hash of the printed IR without the values of numbers: equal for functions that
            differ only in these.
        source_hash: Hash of the text of every file that contains its functions.
        captured: Detects whether the captured constants have changed.
    """

    module: Module
    digest: str
    source_hash: str
    captured: Captured

    @staticmethod
    def of(function: Func | Composed | LangFunction, types: Types) -> Lowered:
        """Lower a function for argument types."""
        module, captured = lower_captured(function, types)
        texts = sorted({"".join(o.source.lines) for o in captured.overloads})
        return Lowered(module, _hash(print_identity(module)), _hash("\0".join(texts)), captured)

    @staticmethod
    def elsewhere(module: Module, digest: str, source_hash: str) -> Lowered:
        """Return what another process has lowered, with the hashes that it has computed."""
        return Lowered(module, digest, source_hash, Captured(()))

    def frozen(self, numbers: Mapping[str, Any], kept: Collection[str] = ()) -> Lowered:
        """Return a copy with these values of the scene's numbers as constants, but not ``kept``."""
        uniforms = tuple(
            replace(u, default=numbers[u.name]) if u.origin is Origin.NUMBER else u
            for u in self.module.uniforms
        )
        module = freeze_numbers(replace(self.module, uniforms=uniforms), kept)
        return replace(self, module=module, digest=_hash(print_identity(module)))

    @property
    def resources(self) -> dict[str, Any]:
        """The author's data of textures and buffers, by name."""
        return {r.name: r.source for r in self.module.resources}


def _hash(text: str) -> str:
    return hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()
