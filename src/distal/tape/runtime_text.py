"""Put together the LLVM text of the tape runtime, for one CPU level.

Input: the shape of the machine's vectors. Output: one module, with the functions that ``layout``
names exported. It is compiled once for a machine and stored in the cache of kernels.
"""

from __future__ import annotations

from dataclasses import replace

from distal.backends.llvm import TARGET
from distal.backends.llvm.lanes import Lanes
from distal.backends.llvm.program import LaneProgram
from distal.compiler.driver import run_passes
from distal.frontend import lower
from distal.tape import driver, interpreters, pruning
from distal.tape.elementary import elementary
from distal.tape.layout import LANES


def runtime_text(lanes: Lanes) -> str:
    """Return the LLVM text.

    Args:
        lanes: The vector shape of the CPU level; its number of chunks is not used.
    """
    module = run_passes(lower(elementary()), TARGET)
    # The elementary functions compute several registers at once, but at most 64 lanes.
    chunks = min(lanes.chunks, LANES // lanes.width)
    program = LaneProgram(module, replace(lanes, chunks=chunks))
    one = lanes.one_chunk()
    program.define(pruning.shapes_table())
    program.define(interpreters.elementary_code(program))
    for write in (
        interpreters.float_code,
        interpreters.interval_code,
        pruning.liveness_code,
        pruning.writer_code,
        pruning.allocation_code,
        driver.square_code,
        driver.pixels_code,
        driver.tile_code,
        driver.fill_code,
        driver.allocate_code,
        driver.floats_code,
        driver.intervals_code,
        driver.prune_code,
        driver.trace_code,
    ):
        program.define(write(one, program.declarations))
    return program.text("tape") + "\n!1 = !{i32 1}\n"
