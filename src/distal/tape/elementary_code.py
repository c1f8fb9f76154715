"""Write the function that applies an elementary function to 64 floats in memory.

Input: the module of ``elementary.elementary()`` after the passes of the CPU. Output: the text of
one LLVM function, which the interpreters call.
"""

from __future__ import annotations

from distal.backends.llvm.lanes import Lanes, Leaf
from distal.backends.llvm.program import LaneProgram
from distal.backends.llvm.writer import LlvmWriter
from distal.ir.types import Kind
from distal.tape.layout import LANES


def elementary_code(program: LaneProgram) -> str:
    """Return the function that applies an elementary function to 64 floats in memory.

    Args:
        program: The module of ``elementary.elementary()`` after the passes of the CPU.
    """
    lanes, arithmetic = program.lanes, program.arithmetic()
    writer = arithmetic.writer
    entry = program.module.function(program.module.entry)
    # The function uses no uniforms, resources or loops, so the job is never read.
    writer.line("%job = getelementptr i8, ptr %x, i64 0")
    number = writer.value("trunc i64 %number to i32")
    chunk = 4 * lanes.width
    for start in range(0, LANES, lanes.count):
        arithmetic.enter()
        loaded = [
            tuple(
                writer.value(f"load {lanes.vector(Kind.FLOAT)}, ptr {at}, align 64")
                for at in _chunks(writer, source, start, lanes)
            )
            for source in ("%x", "%y")
        ]
        args = [
            (Leaf(Kind.INT, (number,), True),),
            *((Leaf(Kind.FLOAT, names, False),) for names in loaded),
        ]
        result = program.run(arithmetic, entry, list(args), (False, True, True), None)
        (leaf,) = arithmetic.spread_all(result)
        for name, at in zip(leaf.names, _chunks(writer, "%target", start, lanes), strict=True):
            writer.line(
                f"store {lanes.vector(Kind.FLOAT)} {name}, ptr {at}, align {min(64, chunk)}"
            )
        arithmetic.leave()
    params = "ptr %target, ptr %x, ptr %y, i64 %number"
    return f"define internal void @elementary({params}) #0 {{\n{writer.text()}\n  ret void\n}}"


def _chunks(writer: LlvmWriter, base: str, start: int, lanes: Lanes) -> list[str]:
    offsets = range(start, start + lanes.count, lanes.width)
    return [writer.value(f"getelementptr i8, ptr {base}, i64 {4 * at}") for at in offsets]
