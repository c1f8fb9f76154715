"""The list of all passes, in the order in which they run."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final, TypeAlias

from distal.ir.nodes import Module
from distal.passes import bounds, entry, one_way, outline, predicate, split_structs
from distal.passes.context import Context
from distal.passes.decompose import decompose
from distal.passes.fold import fold
from distal.passes.gradient import gradient
from distal.passes.inline import inline
from distal.passes.per_frame import frequency
from distal.passes.share import share
from distal.passes.specialise import specialise
from distal.passes.tables import tables

Pass: TypeAlias = Callable[[Module, Context], Module]

# Specialise runs twice because decompose adds prelude functions that take a texture. Frequency runs
# before inline: across functions it finds 9 per-frame values in the raymarcher; after inlining it
# would find 42 in the copies, and the passes take two thirds of the time. Fold runs again to
# simplify the inlined code.
PIPELINE: Final[tuple[tuple[str, Pass], ...]] = (
    ("entry", entry.run),
    ("specialise", specialise.run),
    ("gradient", gradient.run),
    ("decompose", decompose.run),
    ("specialise-prelude", specialise.run),
    ("bounds", bounds.run),
    ("fold", fold.run),
    ("frequency", frequency.run),
    ("inline", inline.run),
    ("fold-inlined", fold.run),
    ("tables", tables.run),
    ("share", share.run),
    ("split-structs", split_structs.run),
    ("predicate", predicate.run),
    ("outline", outline.run),
    ("one-way", one_way.run),
)

PASS_NAMES: Final = tuple(name for name, _ in PIPELINE)
