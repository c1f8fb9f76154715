"""The LLVM backend: vector code for the CPU, as LLVM text, with one lane per pixel.

Input: a module after the passes, and the shape of the machine's vectors. Output: LLVM text with the
kernels of ``distal.backends.llvm.kernels``. Does not need LLVM: the CPU device compiles the text to
machine code.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

from distal.backends.base import Artifact
from distal.backends.llvm.lanes import Lanes
from distal.backends.llvm.layout import description
from distal.ir.nodes import Module
from distal.ir.target import FramePlace, Target

# The least mean length of the modules of one program, in characters: they take .15 s to compile.
LEAST_LENGTH: Final = 300_000

TARGET = Target(
    name="llvm",
    family="llvm",
    frame=FramePlace.HOST,
    integer_floor=True,
    saturating_cast=True,
    samples=False,
    inline=True,
    predicated=True,
    outlined=True,
)


def emit_for(module: Module, lanes: Lanes) -> Artifact:
    """Return the LLVM text of a module for one shape of vectors."""
    (text,), interface = emit_modules(module, lanes, most=1)
    return Artifact(text, interface)


def emit_modules(
    module: Module, lanes: Lanes, *, most: int
) -> tuple[Sequence[str], dict[str, Any]]:
    """Return a module as texts of LLVM modules to be compiled at the same time, and its interface.

    Args:
        module: The module after the passes.
        lanes: The shape of vectors.
        most: The largest number of LLVM modules.
    """
    # Imported here, because a kernel from the cache needs none of it.
    from distal.backends.llvm.kernels import kernels  # noqa: PLC0415
    from distal.backends.llvm.program import LaneProgram  # noqa: PLC0415

    program = LaneProgram(module, lanes)
    frame_apart = kernels(program)
    interface = description(module)
    interface["target"] = TARGET.name
    interface["frame_apart"] = frame_apart
    return program.program(module.entry).texts(most, LEAST_LENGTH), interface


def emit(module: Module, target: Target) -> Artifact:
    """Return the LLVM text of a module, for two vectors of eight floats per value."""
    assert target.family == TARGET.family
    return emit_for(module, Lanes())


__all__ = ["TARGET", "Lanes", "emit", "emit_for", "emit_modules"]
