"""The capabilities of a target. Passes read them and decompose what the target cannot do."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Final

# The largest number of scalars in a table. Mesa's Vulkan takes 0.1 s longer for an array of 64
# floats than for a buffer, 1 s for one of 256, and does not finish 1024 floats, or 256 vec3, in
# 40 s; its OpenGL takes 4.5 s for 48 structs of 8 numbers; SwiftShader 6 s for 4096 vec3.
LARGEST_TABLE: Final = 63


class FramePlace(Enum):
    """The place where a target computes the per-frame part."""

    HOST = "host"  # outside the pixel program: a scalar prelude (CPU), a dispatch (GPU)
    VERTEX = "vertex"  # the vertex stage, passed as at most 15 packed flat vec4
    PIXEL = "pixel"  # at the start of the pixel function: the target has a single stage
    NONE = "none"  # nothing is hoisted (the reference)


@dataclass(frozen=True, slots=True)
class Target:
    """The capabilities of one target.

    Attributes:
        name: The name used on the command line.
        family: Selects the spelling in each intrinsic: glsl, glsl100, wgsl, llvm or numpy.
        frame: The place where per-frame values are computed.
        unsigned: Has 32-bit unsigned integers and bit operations.
        dynamic_loops: Has while, and loops with bounds that are not constant.
        dynamic_index: Arrays and vectors can be indexed by any expression.
        integer_floor: Has floored // and % of ints with x // 0 = x (else the prelude's are used).
        saturating_cast: Its conversion from float to int saturates and gives 0 for NaN.
        texel_fetch: Can read single texels and texture sizes.
        buffers: Can read buffers.
        samples: Filters textures itself (else the prelude filters single texels).
        rough: Built-ins whose errors in the target's drivers may be visible in a picture. They are
            replaced by the intrinsics' ``careful`` functions, unless the host has measured that its
            driver is accurate. Texts written for people keep the target's own functions.
        inline: Small functions should be inlined.
        predicated: Loops must not contain break, continue and return (see passes.predicate).
        outlined: Very long functions should be cut into pieces (see passes.outline).
        one_way: Should have no If with two branches of equal length (see passes.one_way).
        largest_table: The largest number of scalars in an array of literals; larger arrays are kept
            in buffers, whose values are in the interface (see passes.tables). None: no limit, as
            the target has no buffers or arrays are fast on it.
        targets: How many pictures an image can draw at once, as a struct of vec4.
    """

    name: str
    family: str
    frame: FramePlace
    unsigned: bool = True
    dynamic_loops: bool = True
    dynamic_index: bool = True
    integer_floor: bool = False
    saturating_cast: bool = False
    texel_fetch: bool = True
    buffers: bool = True
    samples: bool = True
    rough: frozenset[str] = frozenset()
    inline: bool = False
    predicated: bool = False
    outlined: bool = False
    one_way: bool = False
    largest_table: int | None = None
    targets: int = 1
