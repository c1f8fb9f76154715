"""The memory layout of tapes and of the runtime's work.

Read by the writers of machine code and by the host. An operation is six numbers of 16 bits.
"""

from __future__ import annotations

from typing import Final

LANES: Final = 64  # tiles, or pixels, that one pass over a tape evaluates
OPERATION_FIELDS: Final = ("operation", "result", "a", "b", "c", "spare")
FIELD: Final = {name: 2 * i for i, name in enumerate(OPERATION_FIELDS)}
OPERATION_BYTES: Final = 2 * len(OPERATION_FIELDS)
MOST_OPERATIONS: Final = 65_535  # results and slots are numbers of 16 bits
FLOAT_SLOT: Final = 4 * LANES
INTERVAL_SLOT: Final = 2 * FLOAT_SLOT
TILE: Final = 64  # pixels: sides of the first tiles
SMALL_TILE: Final = 8  # pixels: sides of the tiles in a tile; its pixels are one pass
CELLS: Final = (64, 16, 4)  # samples along the sides of the cells of a volume, at each level
ACROSS: Final = 4  # cells of the next level along each side of a cell
POINTS: Final = 16  # the points whose values and gradients one pass computes
GRADIENT_PLANE: Final = 4 * POINTS  # bytes of the values, then of the derivatives along x, y and z

# A tape of at most this many operations keeps each value in a slot of its own; giving them slots
# that are reused costs more than it saves.
UNALLOCATED: Final = 64

# The fields of a job: eight bytes each, in this order. Pointers are to memory of the host.
JOB_FIELDS: Final = (
    "counter",  # pointer: the next group of 64 tiles
    "stop",  # pointer: not 0 stops the work
    "workers",  # pointer: the number of threads that have begun
    "output",  # pointer: four floats for each pixel
    "width",  # pixels
    "height",  # pixels
    "depth",  # samples along the rays of a volume
    "columns",  # of first cells that are a group
    "samples",  # in each direction of a pixel
    "view",  # pointer to floats: ``VIEW_FIELDS`` or ``VOLUME_FIELDS``
    "colors",  # pointer to four floats for each number of samples inside, from 0 to all
    "constants",  # pointer to the tape's constants
    "operations",  # pointer: operation i writes value i
    "allocated",  # pointer: the same operations with slots
    "length",  # operations of the tape
    "workspace",  # pointer to the memory of the first thread
    "workspace_bytes",  # of each thread
    "offsets",  # pointer to the offset of each part of a thread's memory
)
VIEW_FIELDS: Final = ("x", "step_x", "y", "step_y", "z")  # position of the upper left corner
# For each axis: the position of the first corner, its change from column to column, from row to row
# and from layer to layer. Then the height of the front, its change from layer to layer, and what is
# written where nothing is found.
VOLUME_FIELDS: Final = (
    *(f"{name}_{axis}" for axis in "xyz" for name in ("first", "column", "row", "layer")),
    "front",
    "step",
    "nothing",
)

# The memory of a thread, in this order: bytes for each operation of the tape, for each slot, and a
# fixed number of bytes. Levels are those of tiles, or of cells.
WORKSPACE: Final = {
    "tile_inputs": (0, 0, 3 * INTERVAL_SLOT),
    "pixel_inputs": (0, 0, 3 * FLOAT_SLOT),
    "coverage": (0, 0, FLOAT_SLOT),
    "lengths_0": (0, 0, 8 * LANES),
    "lengths_1": (0, 0, 8 * LANES),
    "lengths_2": (0, 0, 8 * LANES),
    "corners": (0, 0, 3 * FLOAT_SLOT),
    "found": (0, 0, 2 * (TILE // ACROSS) ** 2),
    "hit_inputs": (0, 0, FLOAT_SLOT),
    "hits": (0, 0, FLOAT_SLOT),
    "intervals": (0, INTERVAL_SLOT, 0),
    "floats": (0, FLOAT_SLOT, UNALLOCATED * FLOAT_SLOT),
    "first_0": (8, 0, 0),
    "second_0": (8, 0, 0),
    "live_0": (8, 0, 0),
    "first_1": (8, 0, 0),
    "second_1": (8, 0, 0),
    "live_1": (8, 0, 0),
    "first_2": (8, 0, 0),
    "second_2": (8, 0, 0),
    "live_2": (8, 0, 0),
    "allocated_1": (OPERATION_BYTES, 0, 0),
    "allocated_2": (OPERATION_BYTES, 0, 0),
    "allocated_3": (OPERATION_BYTES, 0, 0),
    "last": (2, 0, 0),
    "slot_of": (2, 0, 0),
    "free": (2, 0, 0),
    "names_0": (2 * LANES, 0, 0),
    "names_1": (2 * LANES, 0, 0),
    "names_2": (2 * LANES, 0, 0),
    "tapes_0": (OPERATION_BYTES * LANES, 0, 0),
    "tapes_1": (OPERATION_BYTES * LANES, 0, 0),
    "tapes_2": (OPERATION_BYTES * LANES, 0, 0),
}
FILL: Final = "distal_tape_fill"
HEIGHTS: Final = "distal_tape_heights"
GRADIENTS: Final = "distal_tape_gradients"
ALLOCATE: Final = "distal_tape_allocate"
FLOATS: Final = "distal_tape_floats"
INTERVALS: Final = "distal_tape_intervals"
PRUNE: Final = "distal_tape_prune"
TRACE: Final = "distal_tape_trace"


def workspace(length: int, slots: int) -> tuple[dict[str, int], int]:
    """Return the offset of each part of a thread's memory, and its size, in bytes.

    Args:
        length: The number of operations of the tape.
        slots: The number of slots of the tape.
    """
    offsets, at = {}, 0
    for name, (operation, slot, fixed) in WORKSPACE.items():
        offsets[name] = at
        at += -(-(operation * length + slot * slots + fixed) // 64) * 64
    # An odd number of cache lines, so that the threads' memory does not share sets of the cache.
    return offsets, at + 64 * (1 - at // 64 % 2)
