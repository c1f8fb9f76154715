"""Write the exported functions that evaluate a tape at points and in boxes, and give it slots.

Input: a job (see ``layout``) whose fields point to points or boxes. Output: values, intervals and
the lengths of pruned tapes, in the job's output.
"""

from __future__ import annotations

from distal.backends.llvm.lanes import Lanes
from distal.tape.layout import (
    ALLOCATE,
    FLOAT_SLOT,
    FLOATS,
    GRADIENT_PLANE,
    GRADIENTS,
    INTERVAL_SLOT,
    INTERVALS,
    LANES,
    OPERATION_BYTES,
    PRUNE,
    TRACE,
)
from distal.tape.machine_code import POINTER, WORD, FunctionCode
from distal.tape.thread_job import JOB, ThreadJob, copy_slot, result_slot, thread_job
from distal.tape.tile_level import TileLevel


def allocate_code(lanes: Lanes, declarations: set[str]) -> str:
    """Return the exported function that gives a whole tape slots; their number goes to ``output``.

    Args:
        lanes: The shape of the machine's vectors.
        declarations: Receives the declarations of LLVM intrinsics.
    """
    code = FunctionCode(lanes, declarations)
    job = ThreadJob(code, code.parameter("job", POINTER), code.parameter("job", POINTER))
    # The workspace is the numbers of three arrays, one after the other.
    bytes_of_one, numbers = job.word("workspace_bytes"), job.pointer("workspace")
    arrays = [numbers.at(bytes_of_one * i) for i in range(3)]
    used = code.call(
        "allocate", job.pointer("operations"), job.word("length"), job.pointer("allocated"),
        *arrays, result=WORD,
    )  # fmt: skip
    code.store(used, job.pointer("output"))
    return code.function(ALLOCATE, JOB)


def floats_code(lanes: Lanes, declarations: set[str]) -> str:
    """Return the exported function that evaluates a tape at points.

    ``view`` points to 64 x, 64 y and 64 z for each pass, ``height`` is the number of passes, and
    ``output`` receives 64 values for each.

    Args:
        lanes: The shape of the machine's vectors.
        declarations: Receives the declarations of LLVM intrinsics.
    """
    code = FunctionCode(lanes, declarations)
    _evaluate_points(code, lanes, "floats", FLOAT_SLOT)
    return code.function(FLOATS, JOB)


def _evaluate_points(code: FunctionCode, lanes: Lanes, interpreter: str, plane: int) -> None:
    """Write the passes of an interpreter over points.

    Args:
        code: The exported function.
        lanes: The shape of the machine's vectors.
        interpreter: The function that evaluates the tape once.
        plane: Bytes of one coordinate of a pass's points.
    """
    job = thread_job(code)
    operations, length = job.pointer("allocated"), job.word("length")
    slots = job.memory("floats")
    with code.count(job.word("height")) as index:
        source = job.pointer("view").at(index * (3 * plane))
        code.call(interpreter, operations, length, job.pointer("constants"), slots, source)
        result = result_slot(code, operations, length, slots, FLOAT_SLOT)
        target = job.pointer("output").at(index * FLOAT_SLOT)
        copy_slot(code, lanes, result, target, FLOAT_SLOT)


def gradients_code(lanes: Lanes, declarations: set[str]) -> str:
    """Return the exported function that evaluates a tape and its gradient at points.

    ``view`` points to 16 x, 16 y and 16 z for each pass, ``height`` is the number of passes, and
    ``output`` receives 16 values and 16 derivatives along x, y and z for each.

    Args:
        lanes: The shape of the machine's vectors.
        declarations: Receives the declarations of LLVM intrinsics.
    """
    code = FunctionCode(lanes, declarations)
    _evaluate_points(code, lanes, "gradients", GRADIENT_PLANE)
    return code.function(GRADIENTS, JOB)


def intervals_code(lanes: Lanes, declarations: set[str]) -> str:
    """Return the exported function that evaluates a tape with intervals in boxes.

    ``view`` points to the lower and upper ends of x, y and z of 64 boxes for each pass, ``height``
    is the number of passes, and ``output`` receives 64 lower and 64 upper ends for each.

    Args:
        lanes: The shape of the machine's vectors.
        declarations: Receives the declarations of LLVM intrinsics.
    """
    code = FunctionCode(lanes, declarations)
    job = thread_job(code)
    operations, length = job.pointer("allocated"), job.word("length")
    slots = job.memory("intervals")
    choices = job.memory("first_0"), job.memory("second_0")
    with code.count(job.word("height")) as index:
        source = job.pointer("view").at(index * (3 * INTERVAL_SLOT))
        constants = job.pointer("constants")
        code.call("intervals", operations, length, constants, slots, source, *choices)
        result = result_slot(code, operations, length, slots, INTERVAL_SLOT)
        target = job.pointer("output").at(index * INTERVAL_SLOT)
        copy_slot(code, lanes, result, target, INTERVAL_SLOT)
    return code.function(INTERVALS, JOB)


def trace_code(lanes: Lanes, declarations: set[str]) -> str:
    """Return the exported function that gives the intervals of all operations in 64 boxes.

    ``view`` points to the boxes as for ``intervals_code``; ``output`` receives a slot for each
    operation.

    Args:
        lanes: The shape of the machine's vectors.
        declarations: Receives the declarations of LLVM intrinsics.
    """
    code = FunctionCode(lanes, declarations)
    job = thread_job(code)
    code.call(
        "intervals", job.pointer("operations"), job.word("length"), job.pointer("constants"),
        job.pointer("output"), job.pointer("view"), job.memory("first_0"), job.memory("second_0"),
    )  # fmt: skip
    return code.function(TRACE, JOB)


def prune_code(lanes: Lanes, declarations: set[str]) -> str:
    """Return the exported function that evaluates the pruned tapes of boxes, for tests and slices.

    ``view`` points to 64 boxes as for ``intervals_code``, and then to 64 points for each box, as
    for ``floats_code``. ``output`` receives 64 values for each box, and then the lengths of the
    boxes' tapes.

    Args:
        lanes: The shape of the machine's vectors.
        declarations: Receives the declarations of LLVM intrinsics.
    """
    code = FunctionCode(lanes, declarations)
    job = thread_job(code)
    length, stride = job.word("length"), job.word("length") * OPERATION_BYTES
    level = TileLevel(job, lanes, 0)
    boxes = job.pointer("view")
    code.call(
        "intervals", job.pointer("allocated"), length, job.pointer("constants"),
        job.memory("intervals"), boxes, level.memory("first"), level.memory("second"),
    )  # fmt: skip
    level.write(job.pointer("operations"), length, code.literal(-1), stride)
    output, slots = job.pointer("output"), job.memory("floats")
    numbers = [job.memory(name) for name in ("last", "slot_of", "free")]
    with code.count(LANES) as lane:
        tape, count = level.tape(lane, stride)
        allocated = job.memory("allocated_2")
        code.call("allocate", tape, count, allocated, *numbers, result=WORD)
        source = boxes.at(lane * (3 * FLOAT_SLOT) + 3 * INTERVAL_SLOT)
        code.call("floats", allocated, count, job.pointer("constants"), slots, source)
        result = result_slot(code, allocated, count, slots, FLOAT_SLOT)
        copy_slot(code, lanes, result, output.at(lane * FLOAT_SLOT), FLOAT_SLOT)
        code.store(count, output.at(lane * 8 + LANES * FLOAT_SLOT))
    return code.function(PRUNE, JOB)
