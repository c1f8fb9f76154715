"""The rules of the library by name: every primitive and operator of its trees.

Input: the field library. Output: a rule for a name, and the name of a rule, for digests and
pickles. An author's own primitive has no name here.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Final

from distal.fields.combine.alternatives import NOTHING, NOTHING_FLAT, SELECT
from distal.fields.combine.blends import FLAT_UNIONS, PRISMS
from distal.fields.deform.offsets import SECTION
from distal.fields.flats.outlines import OUTLINE
from distal.fields.guarantees import OPERATORS, PRIMITIVES
from distal.fields.place.mirrors import SYMMETRY_PLANES, SYMMETRY_PLANES_FLAT
from distal.fields.place.within import WITHIN, WITHIN_FLAT
from distal.fields.repeat.varied import IN_CELLS
from distal.scene.tree.node import Rule

# Those that are not in the catalogue, because authors do not write them.
_HIDDEN: Final[Mapping[str, Rule]] = {
    "select": SELECT,
    "nothing": NOTHING,
    "flat nothing": NOTHING_FLAT,
    "section": SECTION,
    "Outline": OUTLINE,
    "symmetry planes": SYMMETRY_PLANES,
    "flat symmetry planes": SYMMETRY_PLANES_FLAT,
    "within": WITHIN,
    "flat within": WITHIN_FLAT,
    "in cells": IN_CELLS,
    **{f"flat {rule.name} cut": flat for rule, flat in FLAT_UNIONS.items()},
    **{f"{rule.name} of prisms": solid for rule, (solid, _) in PRISMS.items()},
    **{f"flat {rule.name} of prisms": flat for rule, (_, flat) in PRISMS.items()},
}


@cache
def rules() -> Mapping[str, Rule]:
    """Return the rules of the library by name."""
    return {**PRIMITIVES, **OPERATORS, **_HIDDEN}


@cache
def _names() -> Mapping[int, str]:
    return {id(rule): name for name, rule in rules().items()}


def name_of(rule: Rule) -> str | None:
    """Return the name of a rule of the library; None for an author's own."""
    return _names().get(id(rule))
