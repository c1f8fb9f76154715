"""Write the driver that fills pictures: an exported function that takes a job (see ``layout``).

``fill`` draws where a tape is negative: intervals in 64 tiles of 64 pixels; for each tile that is
neither inside nor outside, a shorter tape and intervals in its 64 tiles of 8 pixels; for each of
these that is not decided, an even shorter tape at its 64 pixels. Every thread calls the same
function; they take groups of 64 tiles from a shared counter.

Source: M. Keeter, "Massively Parallel Rendering of Complex Closed-Form Implicit Surfaces", ACM
Transactions on Graphics 39 (2020), with lanes of vectors instead of GPU threads.
"""

from __future__ import annotations

from distal.backends.llvm.lanes import Lanes
from distal.tape.interpreter_loop import vector_type
from distal.tape.layout import (
    FILL,
    FLOAT_SLOT,
    INTERVAL_SLOT,
    LANES,
    OPERATION_BYTES,
    SMALL_TILE,
    TILE,
    UNALLOCATED,
)
from distal.tape.machine_code import POINTER, WORD, FunctionCode, Value
from distal.tape.thread_job import (
    CHANNELS,
    JOB,
    PIXEL_BYTES,
    ThreadJob,
    as_float,
    result_slot,
    thread_job,
)
from distal.tape.tile_level import TileLevel


def _coordinate(job: ThreadJob, axis: str, pixels: Value) -> Value:
    """Return the coordinate of a place in pixels from the upper left corner."""
    return job.view(axis) + pixels * job.view(f"step_{axis}")


def square_code(lanes: Lanes, declarations: set[str]) -> str:
    """Return the function that gives all pixels of a square one color."""
    code = FunctionCode(lanes, declarations)
    job = ThreadJob(code, code.parameter("job", POINTER), code.parameter("job", POINTER))
    x, y, size = (code.parameter(name) for name in ("x", "y", "size"))
    width, height = job.word("width"), job.word("height")
    right = code.select((x + size) < width, x + size, width)
    bottom = code.select((y + size) < height, y + size, height)
    samples = job.word("samples")
    covered = code.parameter("inside") * samples * samples
    place = job.pointer("colors").at(covered * PIXEL_BYTES)
    color = code.load(place, CHANNELS, align=4)
    output = job.pointer("output")
    with code.count(bottom, y) as row:
        line = output.at(row * width * PIXEL_BYTES)
        with code.count(right, x) as column:
            code.store(color, line.at(column * PIXEL_BYTES), align=16, streamed=True)
    params = "ptr noalias %job, i64 %x, i64 %y, i64 %size, i64 %inside"
    return code.function("square", params)


def pixels_code(lanes: Lanes, declarations: set[str]) -> str:
    """Return the function that evaluates a tape at the pixels of a small tile and writes them."""
    code = FunctionCode(lanes, declarations)
    job = ThreadJob(code, code.parameter("job", POINTER), code.parameter("memory", POINTER))
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
    step = code.literal(1.0, "float") / as_float(code, samples)
    with code.count(samples) as down, code.count(samples) as across:
        shift_x, shift_y = (
            (as_float(code, n) + code.literal(0.5, "float")) * step for n in (across, down)
        )
        with code.count(SMALL_TILE) as n:
            at_x = _coordinate(job, "x", as_float(code, left + n) + shift_x)
            at_y = _coordinate(job, "y", as_float(code, top + n) + shift_y)
            with code.count(SMALL_TILE) as m:
                code.store(at_x, inputs.at((m * SMALL_TILE + n) * 4))
                code.store(at_y, inputs.at((n * SMALL_TILE + m) * 4 + FLOAT_SLOT))
        code.call("floats", source.get(), length, job.pointer("constants"), slots, inputs)
        result = result_slot(code, source.get(), length, slots, FLOAT_SLOT)
        for offset in offsets:
            inside = code.load(result.at(offset), vector, align=64) < 0.0
            added = code.select(inside, 1.0, code.literal(0.0, vector))
            total = code.load(coverage.at(offset), vector, align=64) + added
            code.store(total, coverage.at(offset), align=64)
    _write_pixels(job, coverage, (left, top))
    params = "ptr noalias %job, ptr %memory, ptr %tape, i64 %length, i64 %x, i64 %y"
    return code.function("pixels", params)


def _write_pixels(job: ThreadJob, coverage: Value, corner: tuple[Value, Value]) -> None:
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
        line = output.at(((top + row) * width + left) * PIXEL_BYTES)
        with code.count(columns) as column:
            covered = code.load(coverage.at((row * SMALL_TILE + column) * 4), "float")
            number = code.value(WORD, f"fptosi float {covered.name} to i64")
            color = code.load(colors.at(number * PIXEL_BYTES), CHANNELS, align=4)
            code.store(color, line.at(column * PIXEL_BYTES), align=16, streamed=True)


class _FillLevel(TileLevel):
    """A level of square tiles of a picture."""

    def __init__(self, job: ThreadJob, lanes: Lanes, level: int, size: int) -> None:
        super().__init__(job, lanes, level)
        self.size = size

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
        margin = code.literal(0.5, "float") / as_float(code, job.word("samples"))
        for axis, corner in (("x", left), ("y", top)):
            first = _coordinate(job, axis, as_float(code, corner) + margin)
            end = as_float(code, corner + self.size)
            last = _coordinate(job, axis, end - margin)
            address = inputs.at("xyz".index(axis) * INTERVAL_SLOT)
            code.store(code.select(last < first, last, first), address)
            code.store(code.select(last < first, first, last), address.at(FLOAT_SLOT))

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


def fill_code(lanes: Lanes, declarations: set[str]) -> str:
    """Return the exported function that fills a picture.

    Args:
        lanes: The shape of the machine's vectors.
        declarations: Receives the declarations of LLVM intrinsics.
    """
    code = FunctionCode(lanes, declarations)
    job = thread_job(code)
    _set_depth(job)
    length, operations = job.word("length"), job.pointer("operations")
    width, height = job.word("width"), job.word("height")
    across = (width + (TILE - 1)) // TILE
    tiles = across * ((height + (TILE - 1)) // TILE)
    level = _FillLevel(job, lanes, 0, TILE)
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
    return code.function(FILL, JOB)


def tile_code(lanes: Lanes, declarations: set[str]) -> str:
    """Return the function that fills a tile that intervals did not decide."""
    code = FunctionCode(lanes, declarations)
    job = ThreadJob(code, code.parameter("job", POINTER), code.parameter("memory", POINTER))
    tape, length = code.parameter("tape", POINTER), code.parameter("length")
    left, top = code.parameter("x"), code.parameter("y")
    level = _FillLevel(job, lanes, 1, SMALL_TILE)
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


def _set_depth(job: ThreadJob) -> None:
    """Set z, which is the same in the whole picture."""
    code, z = job.code, job.view("z")
    tiles = job.memory("tile_inputs").at(2 * INTERVAL_SLOT)
    pixels = job.memory("pixel_inputs").at(2 * FLOAT_SLOT)
    with code.count(2 * LANES) as lane:
        code.store(z, tiles.at(lane * 4))
    with code.count(LANES) as lane:
        code.store(z, pixels.at(lane * 4))
