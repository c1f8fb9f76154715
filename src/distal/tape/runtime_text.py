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
from distal.tape import fill_driver, heights_driver, pruning, sample_places, value_drivers
from distal.tape.elementary import elementary
from distal.tape.elementary_code import elementary_code, slopes_code
from distal.tape.float_interpreter import float_code
from distal.tape.gradient_interpreter import gradient_code
from distal.tape.interval_interpreter import interval_code
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
    program.define(elementary_code(program))
    program.define(slopes_code(program))
    program.define(sample_places.offsets_table())
    for write in (
        float_code,
        gradient_code,
        interval_code,
        pruning.liveness_code,
        pruning.writer_code,
        pruning.allocation_code,
        fill_driver.square_code,
        fill_driver.pixels_code,
        fill_driver.tile_code,
        fill_driver.fill_code,
        sample_places.boxes_code,
        heights_driver.hits_code,
        heights_driver.samples_code,
        heights_driver.small_cell_code,
        heights_driver.cell_code,
        heights_driver.column_code,
        heights_driver.heights_code,
        value_drivers.allocate_code,
        value_drivers.floats_code,
        value_drivers.gradients_code,
        value_drivers.intervals_code,
        value_drivers.prune_code,
        value_drivers.trace_code,
    ):
        program.define(write(one, program.declarations))
    return program.program("tape").text() + "\n!1 = !{i32 1}\n"
