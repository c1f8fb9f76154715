"""The halo around what is brighter than white, added to a picture.

Input: linear light. Output: the halo as linear light, computed in a few small pictures by the scene
code of ``render.glow``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, ClassVar, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from distal.frontend import Assembly
from distal.ir.build import field
from distal.ir.nodes import EntryKind, Param, Read, Return
from distal.ir.types import BOOL, FLOAT, FRAME, VEC2, VEC4, Type
from distal.lang.composed import Composed
from distal.lang.functions import Func
from distal.render import glow

Light: TypeAlias = NDArray[np.float32]
# Renders a step: of a size, with its numbers by the names of their uniforms, which start with a
# capital letter, of the light in its buffer.
Run: TypeAlias = "Callable[[Composed, tuple[int, int], Mapping[str, Any], Light], Light]"


class GlowStep(Composed):
    """One of the steps, as a picture.

    Args:
        function: The scene function of the step.
        numbers: Names, types and values of numbers that it takes besides those of the picture.
    """

    kind: ClassVar[EntryKind] = EntryKind.IMAGE
    signature = (("frame", FRAME),)
    result = VEC4

    def __init__(self, function: Any, *numbers: tuple[str, Type, Any]) -> None:
        self.name = function.name
        self._function: Func = function
        self._numbers = numbers

    def compose(self, assembly: Assembly) -> str:
        """Add the function that maps the frame to a pixel, and return its name."""
        frame = Read("frame", FRAME)
        given = {
            "coord": field(frame, "coord"),
            "resolution": field(frame, "resolution"),
            **{name: assembly.number(name, type, value) for name, type, value in self._numbers},
        }
        color = assembly.call(self._function, given)
        return assembly.define("step", (Param("frame", FRAME),), VEC4, (Return(color),))


BLOCKS: Final = GlowStep(glow.brightest_blocks, ("size", VEC2, (1.0, 1.0)))
BLURRED: Final = GlowStep(
    glow.blurred, ("is_across", BOOL, True), ("deviation", FLOAT, glow.NARROW)
)
ENLARGED: Final = GlowStep(glow.enlarged, ("size", VEC2, (1.0, 1.0)))
# Standard deviation and weight of each Gaussian.
GAUSSIANS: Final = (
    (glow.NARROW, glow.NARROW_WEIGHT),
    (glow.WIDE, 1.0 - glow.NARROW_WEIGHT),
)


def halo(light: Light, run: Run) -> Light:
    """Return the halo around what is brighter than white; its alpha is 0.

    Args:
        light: Linear light, (height, width, 4).
        run: Renders a step.
    """
    height, width, _ = light.shape
    blocks = (-(-width // glow.BLOCK_PX), -(-height // glow.BLOCK_PX))
    bright = run(BLOCKS, blocks, {"Size": (float(width), float(height))}, light)
    if not bright[..., :3].any():
        return np.zeros_like(light)
    total = np.zeros_like(bright)
    for deviation, weight in GAUSSIANS:
        blurred = bright
        for is_across in (True, False):
            numbers = {"Is_across": is_across, "Deviation": deviation}
            blurred = run(BLURRED, blocks, numbers, blurred)
        total += np.float32(weight) * blurred
    return run(ENLARGED, (width, height), {"Size": tuple(map(float, blocks))}, total)
