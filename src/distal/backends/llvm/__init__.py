"""The LLVM backend: vector code for the CPU, as LLVM text, with one lane per pixel.

Input: a module after the passes, and the shape of the machine's vectors. Output: LLVM text with the
kernels of ``distal.backends.llvm.kernels``. Does not need LLVM: the CPU device compiles the text to
machine code.
"""

from __future__ import annotations

from distal.backends.base import Artifact
from distal.backends.llvm.lanes import Lanes
from distal.backends.llvm.layout import description
from distal.ir.nodes import Module
from distal.ir.target import FramePlace, Target

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
    # Imported here, because a kernel from the cache needs none of it.
    from distal.backends.llvm.kernels import kernels  # noqa: PLC0415
    from distal.backends.llvm.program import LaneProgram  # noqa: PLC0415

    program = LaneProgram(module, lanes)
    frame_apart = kernels(program)
    interface = description(module)
    interface["target"] = TARGET.name
    interface["frame_apart"] = frame_apart
    return Artifact(program.text(module.entry), interface)


def emit(module: Module, target: Target) -> Artifact:
    """Return the LLVM text of a module, for two vectors of eight floats per value."""
    assert target.family == TARGET.family
    return emit_for(module, Lanes())


__all__ = ["TARGET", "Lanes", "emit", "emit_for"]
