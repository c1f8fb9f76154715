"""Write the drivers of the runtime: exported functions that take a job (see ``layout``).

``fill`` draws where a tape is negative: intervals in 64 tiles of 64 pixels; for each tile that is
neither inside nor outside, a shorter tape and intervals in its 64 tiles of 8 pixels; for each of
these that is not decided, an even shorter tape at its 64 pixels. Every thread calls the same
function; they take groups of 64 tiles from a shared counter.

Source: M. Keeter, "Massively Parallel Rendering of Complex Closed-Form Implicit Surfaces", ACM
Transactions on Graphics 39 (2020), with lanes of vectors instead of GPU threads.
"""

from __future__ import annotations

from typing import Final

from distal.backends.llvm.lanes import Lanes
from distal.tape.interpreters import vector_type
from distal.tape.layout import (
    ALLOCATE,
    FIELD,
    FILL,
    FLOAT_SLOT,
    FLOATS,
    INTERVAL_SLOT,
    INTERVALS,
    JOB_FIELDS,
    LANES,
    OPERATION_BYTES,
    PRUNE,
    SMALL_TILE,
    TILE,
    TRACE,
    UNALLOCATED,
    VIEW_FIELDS,
    WORKSPACE,
)
from distal.tape.machine_code import POINTER, WORD, FunctionCode, Value

_CHANNELS: Final = "<4 x float>"
_PIXEL_BYTES: Final = 16
_JOB: Final = "ptr noalias %job"


class _ThreadJob:
    """The fields of a job, and the memory of the thread that runs it."""

    def __init__(self, code: FunctionCode, job: Value, workspace: Value) -> None:
        self.code = code
        self.job = job
        self.workspace = workspace

    def word(self, name: str) -> Value:
        """Return a number of the job."""
        return self.code.load(self.job.at(8 * JOB_FIELDS.index(name)))

    def pointer(self, name: str) -> Value:
        """Return a pointer of the job."""
        return self.code.load(self.job.at(8 * JOB_FIELDS.index(name)), POINTER)

    def memory(self, name: str) -> Value:
        """Return the address of a part of the thread's memory."""
        offset = self.pointer("offsets").at(8 * list(WORKSPACE).index(name))
        return self.workspace.at(self.code.load(offset))

    def view(self, name: str) -> Value:
        """Return a number of the view."""
        return self.code.load(self.pointer("view").at(4 * VIEW_FIELDS.index(name)), "float")


def _as_float(code: FunctionCode, number: Value) -> Value:
    return code.value("float", f"sitofp i64 {number.name} to float")


def _coordinate(job: _ThreadJob, axis: str, pixels: Value) -> Value:
    """Return the coordinate of a place in pixels from the upper left corner."""
    return job.view(axis) + pixels * job.view(f"step_{axis}")


def square_code(lanes: Lanes, declarations: set[str]) -> str:
    """Return the function that gives all pixels of a square one color."""
    code = FunctionCode(lanes, declarations)
    job = _ThreadJob(code, code.parameter("job", POINTER), code.parameter("job", POINTER))
    x, y, size = (code.parameter(name) for name in ("x", "y", "size"))
    width, height = job.word("width"), job.word("height")
    right = code.select((x + size) < width, x + size, width)
    bottom = code.select((y + size) < height, y + size, height)
    samples = job.word("samples")
    covered = code.parameter("inside") * samples * samples
    place = job.pointer("colors").at(covered * _PIXEL_BYTES)
    color = code.load(place, _CHANNELS, align=4)
    output = job.pointer("output")
    with code.count(bottom, y) as row:
        line = output.at(row * width * _PIXEL_BYTES)
        with code.count(right, x) as column:
            code.store(color, line.at(column * _PIXEL_BYTES), align=16, streamed=True)
    params = "ptr noalias %job, i64 %x, i64 %y, i64 %size, i64 %inside"
    return code.function("square", params)


def pixels_code(lanes: Lanes, declarations: set[str]) -> str:
    """Return the function that evaluates a tape at the pixels of a small tile and writes them."""
    code = FunctionCode(lanes, declarations)
    job = _ThreadJob(code, code.parameter("job", POINTER), code.parameter("memory", POINTER))
    tape, length = code.parameter("tape", POINTER), code.parameter("length")
    left, top = code.parameter("x"), code.parameter("y")
    source = code.variable(tape)
    with code.when(length > UNALLOCATED):
        allocated = job.memory("allocated_2")
        numbers = [job.memory(name) for name in ("last", "slot_of", "free")]
        code.call("allocate", tape, length, allocated, *numbers, result=WORD)
        source.set(allocated)
    coverage, inputs, slots = (job.memory(name) for name in ("coverage", "pixel_inputs", "floats"))
    vector, samples = vector_type(lanes), job.word("samples")
    offsets = range(0, FLOAT_SLOT, 4 * lanes.width)
    for offset in offsets:
        code.store(code.literal(0.0, vector), coverage.at(offset), align=64)
    step = code.literal(1.0, "float") / _as_float(code, samples)
    with code.count(samples) as down, code.count(samples) as across:
        shift_x, shift_y = (
            (_as_float(code, n) + code.literal(0.5, "float")) * step for n in (across, down)
        )
        with code.count(SMALL_TILE) as n:
            at_x = _coordinate(job, "x", _as_float(code, left + n) + shift_x)
            at_y = _coordinate(job, "y", _as_float(code, top + n) + shift_y)
            with code.count(SMALL_TILE) as m:
                code.store(at_x, inputs.at((m * SMALL_TILE + n) * 4))
                code.store(at_y, inputs.at((n * SMALL_TILE + m) * 4 + FLOAT_SLOT))
        code.call("floats", source.get(), length, job.pointer("constants"), slots, inputs)
        result = _result(code, source.get(), length, slots, FLOAT_SLOT)
        for offset in offsets:
            inside = code.load(result.at(offset), vector, align=64) < 0.0
            added = code.select(inside, 1.0, code.literal(0.0, vector))
            total = code.load(coverage.at(offset), vector, align=64) + added
            code.store(total, coverage.at(offset), align=64)
    _write_pixels(job, coverage, (left, top))
    params = "ptr noalias %job, ptr %memory, ptr %tape, i64 %length, i64 %x, i64 %y"
    return code.function("pixels", params)


def _write_pixels(job: _ThreadJob, coverage: Value, corner: tuple[Value, Value]) -> None:
    """Write the colors of a small tile; the number of samples that are inside selects each."""
    code = job.code
    left, top = corner
    width, height, output = job.word("width"), job.word("height"), job.pointer("output")
    colors = job.pointer("colors")
    rows, columns = (
        code.select((limit - at) < SMALL_TILE, limit - at, code.literal(SMALL_TILE))
        for limit, at in ((height, top), (width, left))
    )
    with code.count(rows) as row:
        line = output.at(((top + row) * width + left) * _PIXEL_BYTES)
        with code.count(columns) as column:
            covered = code.load(coverage.at((row * SMALL_TILE + column) * 4), "float")
            number = code.value(WORD, f"fptosi float {covered.name} to i64")
            color = code.load(colors.at(number * _PIXEL_BYTES), _CHANNELS, align=4)
            code.store(color, line.at(column * _PIXEL_BYTES), align=16, streamed=True)


def _result(code: FunctionCode, operations: Value, length: Value, slots: Value, size: int) -> Value:
    """Return the address of the slot of a tape's last operation."""
    last = operations.at((length - 1) * OPERATION_BYTES)
    return slots.at(code.load(last.at(FIELD["result"]), "i16") * size)


class _Level:
    """One level of tiles: intervals, the decided tiles, and shorter tapes for the others."""

    def __init__(self, job: _ThreadJob, lanes: Lanes, level: int, size: int) -> None:
        self.job, self.code, self.lanes = job, job.code, lanes
        self.level, self.size = level, size

    def memory(self, name: str) -> Value:
        """Return a part of the memory that each level has for itself."""
        return self.job.memory(f"{name}_{self.level}")

    def place(self, lane: Value, left: Value, top: Value) -> None:
        """Set the interval of a lane to a tile.

        Args:
            lane: The lane.
            left: Pixels from the left edge of the picture to the tile.
            top: Pixels from its upper edge.
        """
        code, job = self.code, self.job
        inputs = job.memory("tile_inputs").at(lane * 4)
        # From the first to the last sample of the tile's pixels.
        margin = code.literal(0.5, "float") / _as_float(code, job.word("samples"))
        for axis, corner in (("x", left), ("y", top)):
            first = _coordinate(job, axis, _as_float(code, corner) + margin)
            end = _as_float(code, corner + self.size)
            last = _coordinate(job, axis, end - margin)
            address = inputs.at("xyz".index(axis) * INTERVAL_SLOT)
            code.store(code.select(last < first, last, first), address)
            code.store(code.select(last < first, first, last), address.at(FLOAT_SLOT))

    def decide(self, operations: Value, length: Value) -> tuple[Value, Value]:
        """Evaluate the intervals; return the tiles that are inside, and those that are outside."""
        code, job = self.code, self.job
        slots = job.memory("intervals")
        code.call(
            "intervals", operations, length, job.pointer("constants"), slots,
            job.memory("tile_inputs"), self.memory("first"), self.memory("second"),
        )  # fmt: skip
        result = _result(code, operations, length, slots, INTERVAL_SLOT)
        return _signs(code, self.lanes, result)

    def draw(self, tiles: Value, inside: Value, corner: tuple[Value, Value], across: Value) -> None:
        """Give decided tiles their color.

        Args:
            tiles: The decided tiles.
            inside: The tiles that are inside.
            corner: Pixels from the picture's upper left corner to the first tile.
            across: The number of tiles in a row.
        """
        code = self.code
        with code.bits(tiles) as tile:
            x = corner[0] + tile % across * self.size
            y = corner[1] + tile // across * self.size
            code.call("square", self.job.job, x, y, code.literal(self.size), (inside >> tile) & 1)

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


def _signs(code: FunctionCode, lanes: Lanes, result: Value) -> tuple[Value, Value]:
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


def fill_code(lanes: Lanes, declarations: set[str]) -> str:
    """Return the exported function that fills a picture.

    Args:
        lanes: The shape of the machine's vectors.
        declarations: Receives the declarations of LLVM intrinsics.
    """
    code = FunctionCode(lanes, declarations)
    job = _thread(code)
    _set_depth(job)
    length, operations = job.word("length"), job.pointer("operations")
    width, height = job.word("width"), job.word("height")
    across = (width + (TILE - 1)) // TILE
    tiles = across * ((height + (TILE - 1)) // TILE)
    level = _Level(job, lanes, 0, TILE)
    # An odd number of cache lines from tape to tape, so that they do not share sets of the cache.
    stride = code.literal(OPERATION_BYTES) * length
    with code.forever() as loop:
        counter = job.pointer("counter")
        group = code.value("i32", f"atomicrmw add ptr {counter.name}, i32 1 monotonic")
        begin = code.value(WORD, f"zext i32 {group.name} to i64") * LANES
        code.leave(begin >= tiles, loop)
        stop = code.value("i32", f"load volatile i32, ptr {job.pointer('stop').name}")
        stopped = code.value(WORD, f"zext i32 {stop.name} to i64")
        code.leave(~stopped.same(0), loop)
        with code.count(LANES) as lane:
            tile = code.select((begin + lane) < tiles, begin + lane, tiles - 1)
            level.place(lane, tile % across * TILE, tile // across * TILE)
        inside, outside = level.decide(job.pointer("allocated"), length)
        rest = tiles - begin
        some = (code.literal(1) << (rest & 63)) - 1
        here = code.select(rest >= LANES, -1, some)
        decided = (inside | outside) & here
        with code.bits(decided) as lane:
            tile = begin + lane
            x, y = tile % across * TILE, tile // across * TILE
            code.call("square", job.job, x, y, code.literal(TILE), (inside >> lane) & 1)
        open_tiles = here & ~decided
        level.write(operations, length, open_tiles, stride)
        with code.bits(open_tiles) as lane:
            tape, count = level.tape(lane, stride)
            tile = begin + lane
            code.call(
                "tile", job.job, job.workspace, tape, count,
                tile % across * TILE, tile // across * TILE,
            )  # fmt: skip
    return code.function(FILL, _JOB)


def tile_code(lanes: Lanes, declarations: set[str]) -> str:
    """Return the function that fills a tile that intervals did not decide."""
    code = FunctionCode(lanes, declarations)
    job = _ThreadJob(code, code.parameter("job", POINTER), code.parameter("memory", POINTER))
    tape, length = code.parameter("tape", POINTER), code.parameter("length")
    left, top = code.parameter("x"), code.parameter("y")
    level = _Level(job, lanes, 1, SMALL_TILE)
    allocated = job.memory("allocated_1")
    numbers = [job.memory(name) for name in ("last", "slot_of", "free")]
    code.call("allocate", tape, length, allocated, *numbers, result=WORD)
    across = code.literal(TILE // SMALL_TILE)
    here = code.variable(0)
    with code.count(LANES) as lane:
        x, y = left + lane % across * SMALL_TILE, top + lane // across * SMALL_TILE
        level.place(lane, x, y)
        in_picture = (x < job.word("width")) & (y < job.word("height"))
        bit = code.literal(1) << lane
        here.set(here.get() | code.select(in_picture, bit, code.literal(0)))
    inside, outside = level.decide(allocated, length)
    decided = (inside | outside) & here.get()
    level.draw(decided, inside, (left, top), across)
    open_tiles = here.get() & ~decided
    with code.when(~open_tiles.same(0)):
        stride = length * OPERATION_BYTES
        level.write(tape, length, open_tiles, stride)
        with code.bits(open_tiles) as lane:
            shorter, count = level.tape(lane, stride)
            x, y = left + lane % across * SMALL_TILE, top + lane // across * SMALL_TILE
            code.call("pixels", job.job, job.workspace, shorter, count, x, y)
    params = "ptr noalias %job, ptr %memory, ptr %tape, i64 %length, i64 %x, i64 %y"
    return code.function("tile", params)


def _thread(code: FunctionCode) -> _ThreadJob:
    """Return the job with the memory of this thread, which is the next that no thread has taken."""
    job = _ThreadJob(code, code.parameter("job", POINTER), code.parameter("job", POINTER))
    workers = job.pointer("workers")
    number = code.value("i32", f"atomicrmw add ptr {workers.name}, i32 1 monotonic")
    index = code.value(WORD, f"zext i32 {number.name} to i64")
    job.workspace = job.pointer("workspace").at(index * job.word("workspace_bytes"))
    return job


def _set_depth(job: _ThreadJob) -> None:
    """Set z, which is the same in the whole picture."""
    code, z = job.code, job.view("z")
    tiles = job.memory("tile_inputs").at(2 * INTERVAL_SLOT)
    pixels = job.memory("pixel_inputs").at(2 * FLOAT_SLOT)
    with code.count(2 * LANES) as lane:
        code.store(z, tiles.at(lane * 4))
    with code.count(LANES) as lane:
        code.store(z, pixels.at(lane * 4))


def allocate_code(lanes: Lanes, declarations: set[str]) -> str:
    """Return the exported function that gives a whole tape slots; their number goes to ``output``.

    Args:
        lanes: The shape of the machine's vectors.
        declarations: Receives the declarations of LLVM intrinsics.
    """
    code = FunctionCode(lanes, declarations)
    job = _ThreadJob(code, code.parameter("job", POINTER), code.parameter("job", POINTER))
    # The workspace is the numbers of three arrays, one after the other.
    bytes_of_one, numbers = job.word("workspace_bytes"), job.pointer("workspace")
    arrays = [numbers.at(bytes_of_one * i) for i in range(3)]
    used = code.call(
        "allocate", job.pointer("operations"), job.word("length"), job.pointer("allocated"),
        *arrays, result=WORD,
    )  # fmt: skip
    code.store(used, job.pointer("output"))
    return code.function(ALLOCATE, _JOB)


def floats_code(lanes: Lanes, declarations: set[str]) -> str:
    """Return the exported function that evaluates a tape at points.

    ``view`` points to 64 x, 64 y and 64 z for each pass, ``height`` is the number of passes, and
    ``output`` receives 64 values for each.

    Args:
        lanes: The shape of the machine's vectors.
        declarations: Receives the declarations of LLVM intrinsics.
    """
    code = FunctionCode(lanes, declarations)
    job = _thread(code)
    operations, length = job.pointer("allocated"), job.word("length")
    slots = job.memory("floats")
    with code.count(job.word("height")) as index:
        source = job.pointer("view").at(index * (3 * FLOAT_SLOT))
        code.call("floats", operations, length, job.pointer("constants"), slots, source)
        result = _result(code, operations, length, slots, FLOAT_SLOT)
        target = job.pointer("output").at(index * FLOAT_SLOT)
        _copy(code, lanes, result, target, FLOAT_SLOT)
    return code.function(FLOATS, _JOB)


def intervals_code(lanes: Lanes, declarations: set[str]) -> str:
    """Return the exported function that evaluates a tape with intervals in boxes.

    ``view`` points to the lower and upper ends of x, y and z of 64 boxes for each pass, ``height``
    is the number of passes, and ``output`` receives 64 lower and 64 upper ends for each.

    Args:
        lanes: The shape of the machine's vectors.
        declarations: Receives the declarations of LLVM intrinsics.
    """
    code = FunctionCode(lanes, declarations)
    job = _thread(code)
    operations, length = job.pointer("allocated"), job.word("length")
    slots = job.memory("intervals")
    choices = job.memory("first_0"), job.memory("second_0")
    with code.count(job.word("height")) as index:
        source = job.pointer("view").at(index * (3 * INTERVAL_SLOT))
        constants = job.pointer("constants")
        code.call("intervals", operations, length, constants, slots, source, *choices)
        result = _result(code, operations, length, slots, INTERVAL_SLOT)
        target = job.pointer("output").at(index * INTERVAL_SLOT)
        _copy(code, lanes, result, target, INTERVAL_SLOT)
    return code.function(INTERVALS, _JOB)


def trace_code(lanes: Lanes, declarations: set[str]) -> str:
    """Return the exported function that gives the intervals of all operations in 64 boxes.

    ``view`` points to the boxes as for ``intervals_code``; ``output`` receives a slot for each
    operation.

    Args:
        lanes: The shape of the machine's vectors.
        declarations: Receives the declarations of LLVM intrinsics.
    """
    code = FunctionCode(lanes, declarations)
    job = _thread(code)
    code.call(
        "intervals", job.pointer("operations"), job.word("length"), job.pointer("constants"),
        job.pointer("output"), job.pointer("view"), job.memory("first_0"), job.memory("second_0"),
    )  # fmt: skip
    return code.function(TRACE, _JOB)


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
    job = _thread(code)
    length, stride = job.word("length"), job.word("length") * OPERATION_BYTES
    level = _Level(job, lanes, 0, TILE)
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
        result = _result(code, allocated, count, slots, FLOAT_SLOT)
        _copy(code, lanes, result, output.at(lane * FLOAT_SLOT), FLOAT_SLOT)
        code.store(count, output.at(lane * 8 + LANES * FLOAT_SLOT))
    return code.function(PRUNE, _JOB)


def _copy(code: FunctionCode, lanes: Lanes, source: Value, target: Value, size: int) -> None:
    vector = vector_type(lanes)
    for offset in range(0, size, 4 * lanes.width):
        chunk = code.load(source.at(offset), vector, align=64)
        code.store(chunk, target.at(offset), align=4)
