"""One level of tiles or cells: intervals, and shorter tapes for those that are not decided.

Input: the memory of a thread, where the boxes of 64 lanes are written. Output: the signs of the
lanes, and their tapes.
"""

from __future__ import annotations

from distal.backends.llvm.lanes import Lanes
from distal.tape.interpreter_loop import vector_type
from distal.tape.layout import FLOAT_SLOT, INTERVAL_SLOT, LANES
from distal.tape.machine_code import WORD, FunctionCode, Value
from distal.tape.thread_job import ThreadJob, result_slot


class TileLevel:
    """One level of tiles: intervals, the decided tiles, and shorter tapes for the others."""

    def __init__(self, job: ThreadJob, lanes: Lanes, level: int) -> None:
        self.job, self.code, self.lanes = job, job.code, lanes
        self.level = level

    def memory(self, name: str) -> Value:
        """Return a part of the memory that each level has for itself."""
        return self.job.memory(f"{name}_{self.level}")

    def decide(self, operations: Value, length: Value) -> tuple[Value, Value]:
        """Evaluate the intervals; return the tiles that are inside, and those that are outside."""
        code, job = self.code, self.job
        slots = job.memory("intervals")
        code.call(
            "intervals", operations, length, job.pointer("constants"), slots,
            job.memory("tile_inputs"), self.memory("first"), self.memory("second"),
        )  # fmt: skip
        result = result_slot(code, operations, length, slots, INTERVAL_SLOT)
        return signs(code, self.lanes, result)

    def write(self, operations: Value, length: Value, tiles: Value, stride: Value) -> None:
        """Write a shorter tape for each of some tiles."""
        code = self.code
        first, second, live = (self.memory(n) for n in ("first", "second", "live"))
        names, tapes, lengths = (self.memory(n) for n in ("names", "tapes", "lengths"))
        code.call("liveness", operations, length, first, second, tiles, live)
        code.call(
            "write_tapes", operations, length, first, second, live, names, tapes, stride, lengths
        )

    def tape(self, tile: Value, stride: Value) -> tuple[Value, Value]:
        """Return the tape of a tile, and its length."""
        length = self.code.load(self.memory("lengths").at(tile * 8))
        return self.memory("tapes").at(tile * stride), length


def signs(code: FunctionCode, lanes: Lanes, result: Value) -> tuple[Value, Value]:
    """Return the lanes whose interval is negative, and those where it is nowhere negative.

    Both ends must be finite: else nothing is known of the value.
    """
    vector, width = vector_type(lanes), lanes.width
    masks = [code.literal(0), code.literal(0)]
    for number in range(LANES // width):
        low = code.load(result.at(4 * width * number), vector, align=64)
        high = code.load(result.at(FLOAT_SLOT + 4 * width * number), vector, align=64)
        negative = (high < 0.0) & (low > float("-inf"))
        not_negative = (low >= 0.0) & (high < float("inf"))
        for i, bools in enumerate((negative, not_negative)):
            whole = code.value(f"i{width}", f"bitcast {bools.type} {bools.name} to i{width}")
            word = code.value(WORD, f"zext i{width} {whole.name} to i64")
            masks[i] = masks[i] | (word << (number * width))
    return masks[0], masks[1]
