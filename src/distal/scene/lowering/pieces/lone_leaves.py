"""The pieces of a hard union of leaves: one for each leaf, in the tree of ``parts.box_tree``."""

from __future__ import annotations

import numpy as np

from distal.scene.lowering.parts.box_tree import box_tree
from distal.scene.lowering.pieces.box_order import PieceTree
from distal.scene.lowering.pieces.emission import EmittedPrograms, StepMode
from distal.scene.lowering.pieces.joins import JoinCode
from distal.scene.lowering.pieces.operands import Floats
from distal.scene.lowering.pieces.programs import PieceProgram


def unites_leaves(program: PieceProgram) -> bool:
    """Return whether a program is a hard union of leaves, or one leaf."""
    return all(join.code is JoinCode.UNION and join.is_hard for join in program.joins)


def lone_leaves(program: PieceProgram, low: Floats, high: Floats) -> PieceTree:
    """Return the pieces of a hard union of leaves.

    Args:
        program: The program.
        low: The low corners of the leaves' boxes (n, 3).
        high: The high corners.
    """
    number = np.arange(len(low))
    order = box_tree(low, high, number)
    boxes = order.filled(low, high).astype(np.float64).reshape(-1, 8)
    lows, highs = boxes[:, :3], boxes[:, 4:7]
    skip, part = boxes[:, 3].astype(np.int64), boxes[:, 7].astype(np.int64)
    box = np.flatnonzero(part >= 0)
    piece = np.full(len(skip), -1)
    piece[box] = np.arange(len(box))
    # The children of a box are the halves of its parts; the order is clearest along this axis.
    inner = np.flatnonzero(part < 0)
    middles = lows + highs
    axis = np.full(len(skip), -1)
    axis[inner] = np.argmax(middles[skip[inner + 1]] - middles[inner + 1], axis=1)
    steps = np.full((len(low), 3), -1, np.int32)
    steps[:, 0] = StepMode.LOAD
    steps[:, 1] = number
    programs = EmittedPrograms(steps, number, np.ones_like(number), part[box], 0)
    whole = np.zeros(len(box), bool)
    return PieceTree(lows, highs, skip, axis, piece, box, whole, part[box], programs, program.joins)
