"""The one list that says which passes run, and in which order."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final, TypeAlias

from distal.ir.nodes import Module
from distal.passes import (
    bounds,
    decompose,
    entry,
    fold,
    frequency,
    gradient,
    inline,
    predicate,
    share,
    specialise,
)
from distal.passes.context import Context

Pass: TypeAlias = Callable[[Module, Context], Module]

# Specialise runs twice: decompose brings in prelude functions that take a texture.
PIPELINE: Final[tuple[tuple[str, Pass], ...]] = (
    ("entry", entry.run),
    ("specialise", specialise.run),
    ("gradient", gradient.run),
    ("decompose", decompose.run),
    ("specialise-prelude", specialise.run),
    ("bounds", bounds.run),
    ("inline", inline.run),
    ("fold", fold.run),
    ("share", share.run),
    ("frequency", frequency.run),
    ("predicate", predicate.run),
)

PASS_NAMES: Final = tuple(name for name, _ in PIPELINE)
