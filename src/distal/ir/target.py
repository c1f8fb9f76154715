"""What a target can do. Passes read it and decompose the rest."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Final

# Numbers. Mesa's Vulkan takes .1 s longer over an array of 64 floats than over a buffer, a second
# over one of 256, and has not compiled 1024 floats, or 256 vec3, after 40 s; its OpenGL takes 4.5 s
# over 48 structs of 8 numbers; SwiftShader 6 s over 4096 vec3.
LARGEST_TABLE: Final = 63


class FramePlace(Enum):
    """Where a target computes the per-frame part."""

    HOST = "host"  # beside the pixel program: the CPU's scalar prelude, a GPU dispatch
    VERTEX = "vertex"  # the vertex stage, passed as at most 15 packed flat vec4
    PIXEL = "pixel"  # at the top of the pixel function: the target has a single stage
    NONE = "none"  # nothing is hoisted (the reference)


@dataclass(frozen=True, slots=True)
class Target:
    """The capabilities of one target.

    Attributes:
        name: As the command line spells it.
        family: The column of the intrinsic table: glsl, glsl100, wgsl, llvm or numpy.
        frame: Where per-frame work is done.
        unsigned: Has 32-bit unsigned integers and bit operations.
        dynamic_loops: Has while and loops whose bounds are not constant.
        dynamic_index: Indexes arrays and vectors by any expression.
        integer_floor: Has floored // and % of ints with x // 0 = x (else the prelude's).
        saturating_cast: Its float to int conversion saturates and gives 0 for NaN.
        texel_fetch: Reads single texels and sizes.
        samples: Filters textures itself (else the prelude's filter over single texels).
        rough: Built-ins whose errors in its drivers a picture may show; the table's ``careful``
            functions replace them, unless a host that has measured its driver trusts it. Texts for
            people and their sites keep the short names.
        inline: Wants small functions inlined.
        predicated: Wants loops without break, continue and return inside (see passes.predicate).
        outlined: Wants very long functions cut into pieces (see passes.outline).
        one_way: Wants no If of two ways of equal length (see passes.one_way).
        largest_table: How many numbers an array of literals may have; larger ones are kept in
            buffers, whose values the interface holds (see passes.tables). None: any, because there
            are no buffers or because arrays are quick.
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
    samples: bool = True
    rough: frozenset[str] = frozenset()
    inline: bool = False
    predicated: bool = False
    outlined: bool = False
    one_way: bool = False
    largest_table: int | None = None
