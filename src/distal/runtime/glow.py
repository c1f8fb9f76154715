"""The halo around what is brighter than white, added to a picture.

Input: linear light. Output: the halo as linear light, computed in a few small pictures by the scene
code of ``render.glow``.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar, Final, TypeAlias, cast

import numpy as np
from numpy.typing import NDArray

from distal.frontend import Assembly
from distal.ir.build import field
from distal.ir.nodes import EntryKind, Param, Read, Return
from distal.ir.types import FRAME, VEC2, VEC4
from distal.lang.composed import Composed
from distal.lang.functions import Func
from distal.render import glow

SIZE: Final = "Size"

Light: TypeAlias = NDArray[np.float32]
# Renders a step: of a size, with the size and the data of the buffer.
Run: TypeAlias = "Callable[[Composed, tuple[int, int], tuple[int, int], Light], Light]"


class GlowStep(Composed):
    """One of the steps, as a picture."""

    kind: ClassVar[EntryKind] = EntryKind.IMAGE
    signature = (("frame", FRAME),)
    result = VEC4

    def __init__(self, function: Func) -> None:
        self.name = function.name
        self._function = function

    def compose(self, assembly: Assembly) -> str:
        """Add the function that maps the frame to a pixel, and return its name."""
        frame = Read("frame", FRAME)
        given = {
            "coord": field(frame, "coord"),
            "resolution": field(frame, "resolution"),
            "size": assembly.number(SIZE, VEC2, (1.0, 1.0)),
        }
        color = assembly.call(self._function, given)
        return assembly.define("step", (Param("frame", FRAME),), VEC4, (Return(color),))


def _step(function: Any) -> GlowStep:
    return GlowStep(cast(Func, function))


BLOCKS: Final = _step(glow.brightest_blocks)
NARROW: Final = (_step(glow.narrow_across), _step(glow.narrow_along))
WIDE: Final = (_step(glow.wide_across), _step(glow.wide_along))
ENLARGED: Final = _step(glow.enlarged)


def halo(light: Light, run: Run) -> Light:
    """Return the halo around what is brighter than white; its alpha is 0.

    Args:
        light: Linear light, (height, width, 4).
        run: Renders a step.
    """
    height, width, _ = light.shape
    picture = (width, height)
    blocks = (-(-width // glow.BLOCK_PX), -(-height // glow.BLOCK_PX))
    bright = run(BLOCKS, blocks, picture, light)
    if not bright[..., :3].any():
        return np.zeros_like(light)
    total = np.zeros_like(bright)
    for across, along in (NARROW, WIDE):
        total += run(along, blocks, blocks, run(across, blocks, blocks, bright))
    return run(ENLARGED, picture, blocks, total)
