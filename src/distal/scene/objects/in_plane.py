"""Table of the operators of solids and their counterparts for flat shapes.

Input: the declared operators. Output: ``IN_PLANE``. Operators that work on both, such as rounding,
are not listed.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from distal.fields.deform import flat as flat_deform
from distal.fields.deform import offsets
from distal.fields.deform import solid as deform
from distal.fields.guarantees import Operator
from distal.fields.place import flat as flat_placing
from distal.fields.place import mirrors
from distal.fields.place import solid as placing
from distal.fields.repeat import along, grid, polar
from distal.fields.repeat import flat as flat_repeat

IN_PLANE: Final[Mapping[Operator, Operator]] = {
    placing.TRANSLATE: flat_placing.TRANSLATE_FLAT,
    placing.SCALE: flat_placing.SCALE_FLAT,
    placing.STRETCH: flat_placing.STRETCH_FLAT,
    placing.SHEAR: flat_placing.SHEAR_FLAT,
    mirrors.REFLECT: flat_placing.REFLECT_FLAT,
    mirrors.REFLECT_ACROSS: flat_placing.REFLECT_ACROSS_FLAT,
    mirrors.SYMMETRY: flat_placing.SYMMETRY_FLAT,
    mirrors.SYMMETRY_ACROSS: flat_placing.SYMMETRY_ACROSS_FLAT,
    mirrors.SYMMETRY_DIAGONAL: flat_placing.SYMMETRY_DIAGONAL_FLAT,
    mirrors.SYMMETRY_OCTANT: flat_placing.SYMMETRY_OCTANT_FLAT,
    mirrors.KALEIDOSCOPE: flat_placing.KALEIDOSCOPE_FLAT,
    deform.ELONGATE: flat_deform.ELONGATE_FLAT,
    deform.BEND: flat_deform.BEND_FLAT,
    offsets.SPLIT_BELOW: offsets.SPLIT_BELOW_FLAT,
    offsets.SPLIT_ABOVE: offsets.SPLIT_ABOVE_FLAT,
    grid.REPEAT: flat_repeat.REPEAT_FLAT,
    grid.REPEAT_NEIGHBORS: flat_repeat.REPEAT_NEIGHBORS_FLAT,
    grid.REPEAT_LIMITED: flat_repeat.REPEAT_LIMITED_FLAT,
    grid.REPEAT_LIMITED_NEIGHBORS: flat_repeat.REPEAT_LIMITED_NEIGHBORS_FLAT,
    grid.REPEAT_MIRRORED: flat_repeat.REPEAT_MIRRORED_FLAT,
    polar.REPEAT_POLAR: flat_repeat.REPEAT_POLAR_FLAT,
    polar.REPEAT_POLAR_ALL: flat_repeat.REPEAT_POLAR_ALL_FLAT,
    polar.REPEAT_POLAR_NEIGHBORS: flat_repeat.REPEAT_POLAR_NEIGHBORS_FLAT,
    along.REPEAT_AT: flat_repeat.REPEAT_AT_FLAT,
}
