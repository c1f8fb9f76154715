"""Write the functions that apply an elementary function, and its derivatives, to floats in memory.

Input: the module of ``elementary.elementary()`` after the passes of the CPU. Output: the text of
LLVM functions, which the interpreters call.
"""

from __future__ import annotations

from distal.backends.llvm.lanes import Lanes, Leaf
from distal.backends.llvm.program import LaneProgram
from distal.backends.llvm.writer import LlvmWriter
from distal.ir.types import Kind
from distal.tape.layout import GRADIENT_PLANE, LANES, POINTS


def elementary_code(program: LaneProgram) -> str:
    """Return the function that applies an elementary function to 64 floats in memory.

    Args:
        program: The module of ``elementary.elementary()`` after the passes of the CPU.
    """
    return _function(program, "elementary", program.lanes, LANES, leaves=1)


def slopes_code(program: LaneProgram) -> str:
    """Return the function that writes 16 values, derivatives along x, and derivatives along y.

    Args:
        program: The module of ``elementary.elementary()`` after the passes of the CPU.
    """
    return _function(program, "elementary_slopes", program.lanes.one_chunk(), POINTS, leaves=3)


def _function(program: LaneProgram, name: str, lanes: Lanes, count: int, *, leaves: int) -> str:
    """Return a function of ``count`` floats.

    Args:
        program: The module.
        name: The name of the LLVM function.
        lanes: The registers that are computed together.
        count: The number of floats.
        leaves: How many numbers of the result are stored: the value, the derivatives. LLVM removes
            what computes the others.
    """
    arithmetic = program.arithmetic(lanes)
    writer = arithmetic.writer
    entry = program.module.function(program.module.entry)
    # The function uses no uniforms, resources or loops, so the job is never read.
    writer.line("%job = getelementptr i8, ptr %x, i64 0")
    number = writer.value("trunc i64 %number to i32")
    vector, align = lanes.vector(Kind.FLOAT), min(64, 4 * lanes.width)
    for start in range(0, count, lanes.count):
        arithmetic.enter()
        loaded = [
            tuple(
                writer.value(f"load {vector}, ptr {at}, align {align}")
                for at in _chunks(writer, source, start, lanes)
            )
            for source in ("%x", "%y")
        ]
        args = [
            (Leaf(Kind.INT, (number,), True),),
            *((Leaf(Kind.FLOAT, names, False),) for names in loaded),
        ]
        result = program.run(arithmetic, entry, list(args), (False, True, True), None)
        for place, leaf in enumerate(arithmetic.spread_all(result)[:leaves]):
            first = start + place * GRADIENT_PLANE // 4
            for at, found in zip(_chunks(writer, "%target", first, lanes), leaf.names, strict=True):
                writer.line(f"store {vector} {found}, ptr {at}, align {align}")
        arithmetic.leave()
    params = "ptr %target, ptr %x, ptr %y, i64 %number"
    return f"define internal void @{name}({params}) #0 {{\n{arithmetic.text()}\n  ret void\n}}"


def _chunks(writer: LlvmWriter, base: str, start: int, lanes: Lanes) -> list[str]:
    offsets = range(start, start + lanes.count, lanes.width)
    return [writer.value(f"getelementptr i8, ptr {base}, i64 {4 * at}") for at in offsets]
