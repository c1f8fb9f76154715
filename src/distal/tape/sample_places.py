"""Write where the samples of a volume are: the points of samples, and the boxes of cells.

Input: a job with a view of a volume (``layout.VOLUME_FIELDS``), and the columns, rows and layers of
samples. Output: the inputs of the interpreters, in the memory of the thread.

A coordinate is ``((first + column * c) + row * r) + layer * l``, where c, r and l are the number of
a sample plus 0.5. Products and sums are rounded to nearest, so they never decrease where the exact
result increases: the same operations on the ends of c, r and l bound the coordinates of all samples
between them, to the bit.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from distal.backends.llvm.lanes import Lanes
from distal.tape.interpreter_loop import vector_type
from distal.tape.layout import ACROSS, FLOAT_SLOT, GRADIENT_PLANE, INTERVAL_SLOT, LANES
from distal.tape.machine_code import POINTER, FunctionCode, Value
from distal.tape.thread_job import ThreadJob, as_float

_DIRECTIONS: Final = ("column", "row", "layer")
_TABLE: Final = "@lane_offsets"


def offsets_table() -> str:
    """Return the table of the column, row and layer of each lane in a cube of 4^3."""
    places = [[lane // ACROSS**axis % ACROSS for lane in range(LANES)] for axis in range(3)]
    rows = ", ".join(f"float {float(place):.1f}" for axis in places for place in axis)
    return f"{_TABLE} = private unnamed_addr constant [{3 * LANES} x float] [{rows}], align 64"


def _offset(code: FunctionCode, lanes: Lanes, axis: int, offset: int) -> Value:
    table = Value(code, POINTER, _TABLE).at(axis * FLOAT_SLOT + offset)
    return code.load(table, vector_type(lanes), align=4 * lanes.width)


def place_cells(job: ThreadJob, lanes: Lanes, corner: Sequence[Value], size: int) -> None:
    """Write the corners of the 64 cells of a cell.

    Args:
        job: The job.
        lanes: The shape of the machine's vectors.
        corner: Column, row and layer of the first sample.
        size: Samples along the side of one of the 64.
    """
    code, corners = job.code, job.memory("corners")
    for axis, first in enumerate(corner):
        begin = code.spread(as_float(code, first), vector_type(lanes))
        for offset in range(0, FLOAT_SLOT, 4 * lanes.width):
            place = begin + _offset(code, lanes, axis, offset) * float(size)
            code.store(place, corners.at(axis * FLOAT_SLOT + offset), align=64)


def boxes_code(lanes: Lanes, declarations: set[str]) -> str:
    """Return the function that writes the intervals of the samples in 64 cells.

    Args:
        lanes: The shape of the machine's vectors.
        declarations: Receives the declarations of LLVM intrinsics.
    """
    code = FunctionCode(lanes, declarations)
    job = ThreadJob(code, code.parameter("job", POINTER), code.parameter("memory", POINTER))
    corners, inputs = job.memory("corners"), job.memory("tile_inputs")
    vector = vector_type(lanes)
    extent = code.spread(as_float(code, code.parameter("size") - 1), vector)
    view = {
        f"{name}_{axis}": code.spread(job.volume(f"{name}_{axis}"), vector)
        for axis in "xyz"
        for name in ("first", *_DIRECTIONS)
    }
    with code.count(FLOAT_SLOT, 0, 4 * lanes.width) as offset:
        ends = []
        for axis in range(3):
            chunk = corners.at(offset + axis * FLOAT_SLOT)
            first = code.load(chunk, vector, align=64) + 0.5
            ends.append((first, first + extent))
        for number, of in enumerate("xyz"):
            low = high = view[f"first_{of}"]
            for name, pair in zip(_DIRECTIONS, ends, strict=True):
                p, q = (end * view[f"{name}_{of}"] for end in pair)
                low = low + code.select(q < p, q, p)
                high = high + code.select(p < q, q, p)
            target = inputs.at(offset + number * INTERVAL_SLOT)
            code.store(low, target, align=64)
            code.store(high, target.at(FLOAT_SLOT), align=64)
    return code.function("boxes", "ptr noalias %job, ptr %memory, i64 %size")


def place_samples(job: ThreadJob, lanes: Lanes, corner: Sequence[Value]) -> None:
    """Write the points of a cube of 4^3 samples.

    Args:
        job: The job.
        lanes: The shape of the machine's vectors.
        corner: Column, row and layer of the first sample.
    """
    code, target = job.code, job.memory("pixel_inputs")
    begin = [code.spread(as_float(code, c) + 0.5, vector_type(lanes)) for c in corner]
    for offset in range(0, FLOAT_SLOT, 4 * lanes.width):
        places = [b + _offset(code, lanes, axis, offset) for axis, b in enumerate(begin)]
        for number, axis in enumerate("xyz"):
            point = _coordinate(job, axis, places)
            code.store(point, target.at(number * FLOAT_SLOT + offset), align=64)


def place_hits(job: ThreadJob, lanes: Lanes, corner: Sequence[Value]) -> None:
    """Write the points of the rays of a block at the layers that stand behind the points' memory.

    Args:
        job: The job.
        lanes: The shape of the machine's vectors.
        corner: Column and row of the first ray.
    """
    code, target = job.code, job.memory("hit_inputs")
    vector, align = vector_type(lanes), 4 * lanes.width
    begin = [code.spread(as_float(code, c) + 0.5, vector) for c in corner]
    for offset in range(0, GRADIENT_PLANE, 4 * lanes.width):
        places = [b + _offset(code, lanes, axis, offset) for axis, b in enumerate(begin)]
        layers = target.at(3 * GRADIENT_PLANE + offset)
        places.append(code.load(layers, vector, align=align))
        for number, axis in enumerate("xyz"):
            point = _coordinate(job, axis, places)
            code.store(point, target.at(number * GRADIENT_PLANE + offset), align=align)


def _coordinate(job: ThreadJob, axis: str, places: Sequence[Value]) -> Value:
    """Return a coordinate of samples by their columns, rows and layers."""
    code, vector = job.code, places[0].type
    total = code.spread(job.volume(f"first_{axis}"), vector)
    for name, place in zip(_DIRECTIONS, places, strict=True):
        total = total + place * code.spread(job.volume(f"{name}_{axis}"), vector)
    return total
