"""Write the driver that finds the first surface along parallel rays, through a box of samples.

A sample has a column, a row and a layer; layers are numbered from the front. ``heights`` evaluates
intervals in 64 cells of 64^3 samples. A cell that may hold a surface gets a shorter tape and is cut
into 64 cells of 16^3 samples, and these into 64 cells of 4^3, whose samples are evaluated. Cells
are entered from the front to the back; a cell whose rays have all hit something is skipped. At the
hits, dual numbers give the normal, and one step of Newton's method the height between two samples.

Source: M. Keeter, "Massively Parallel Rendering of Complex Closed-Form Implicit Surfaces", ACM
Transactions on Graphics 39 (2020), with lanes of vectors instead of GPU threads.
"""

from __future__ import annotations

from distal.backends.llvm.lanes import Lanes
from distal.tape.interpreter_loop import vector_type
from distal.tape.layout import (
    ACROSS,
    CELLS,
    FLOAT_SLOT,
    GRADIENT_PLANE,
    HEIGHTS,
    LANES,
    OPERATION_BYTES,
    POINTS,
    UNALLOCATED,
)
from distal.tape.machine_code import POINTER, WORD, FunctionCode, Value
from distal.tape.sample_places import place_cells, place_hits, place_samples
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

_ALL = 2**POINTS - 1  # the rays of a block of 4x4
_BLOCK_BYTES = 2  # of the mask of the rays of a block that have hit something
_CELL_BLOCKS = (CELLS[1] // CELLS[2]) ** 2  # blocks of a cell of 16x16
# A tape of at most this many operations is not made shorter: writing the tapes would take longer.
_SHORT = 24
_CELL = "ptr noalias %job, ptr %memory, ptr %tape, i64 %length, i64 %column, i64 %row, i64 %layer"


class _CellCode:
    """What the functions of cells share: their parameters, and the rays that have hit something.

    Attributes:
        corner: Column, row and layer of the cell's first sample.
    """

    def __init__(self, lanes: Lanes, declarations: set[str]) -> None:
        code = self.code = FunctionCode(lanes, declarations)
        self.lanes = lanes
        self.job = ThreadJob(
            code, code.parameter("job", POINTER), code.parameter("memory", POINTER)
        )
        self.tape, self.length = code.parameter("tape", POINTER), code.parameter("length")
        self.corner = tuple(code.parameter(name) for name in ("column", "row", "layer"))

    def found(self) -> Value:
        """Return the address of the masks of the cell of 16x16 that the cell is in."""
        column, row, _ = self.corner
        cell = ((row >> 4) & 3) * ACROSS + ((column >> 4) & 3)
        return self.job.memory("found").at(cell * (_CELL_BLOCKS * _BLOCK_BYTES))

    def layers(self, size: int) -> Value:
        """Return the lanes of cells, or samples, that begin in front of the last layer."""
        code = self.code
        rest = (self.job.word("depth") - self.corner[2] + (size - 1)) // size
        some = (code.literal(1) << ((rest & 3) * POINTS)) - 1
        return code.select(rest >= ACROSS, -1, some)

    def allocate(self, name: str) -> Value:
        """Give the tape slots."""
        allocated = self.job.memory(name)
        numbers = [self.job.memory(n) for n in ("last", "slot_of", "free")]
        self.code.call("allocate", self.tape, self.length, allocated, *numbers, result=WORD)
        return allocated


def cell_code(lanes: Lanes, declarations: set[str]) -> str:
    """Return the function that looks into a cell of 64^3 samples."""
    self = _CellCode(lanes, declarations)
    code, found = self.code, self.job.memory("found")
    missing = code.variable(0)
    with code.count(ACROSS * ACROSS) as index:
        cell = found.at(index * (_CELL_BLOCKS * _BLOCK_BYTES))
        words = code.load(cell)
        for offset in range(8, _CELL_BLOCKS * _BLOCK_BYTES, 8):
            words = words & code.load(cell.at(offset))
        bit = code.select(words.same(-1), 0, code.literal(1) << index)
        missing.set(missing.get() | bit)
    _cut(self, 1, missing.get(), "small_cell")
    return code.function("cell", _CELL)


def small_cell_code(lanes: Lanes, declarations: set[str]) -> str:
    """Return the function that looks into a cell of 16^3 samples."""
    self = _CellCode(lanes, declarations)
    code = self.code
    masks = code.load(self.found(), f"<{_CELL_BLOCKS} x i16>", align=2)
    bools = code.value("<16 x i1>", f"icmp ne <16 x i16> {masks.name}, splat (i16 -1)")
    whole = code.value("i16", f"bitcast <16 x i1> {bools.name} to i16")
    _cut(self, 2, code.value(WORD, f"zext i16 {whole.name} to i64"), "samples")
    return code.function("small_cell", _CELL)


def _cut(self: _CellCode, level: int, missing: Value, inner: str) -> None:
    """Look into those of a cell's 64 cells that intervals do not decide.

    Args:
        self: The cell.
        level: Its level.
        missing: The columns of cells that have rays without a hit, 16 bits.
        inner: The function that looks into one of the cells.
    """
    code, job, size = self.code, self.job, CELLS[level]
    with code.when(~missing.same(0)):
        tiles = TileLevel(job, self.lanes, level)
        allocated = self.allocate(f"allocated_{level}")
        place_cells(job, self.lanes, self.corner, size)
        code.call("boxes", job.job, job.workspace, code.literal(size))
        inside, outside = tiles.decide(allocated, self.length)
        here = missing * sum(1 << (POINTS * layer) for layer in range(ACROSS)) & self.layers(size)
        full = inside & here
        hidden = (full << POINTS) | (full << 2 * POINTS) | (full << 3 * POINTS)
        open_cells = here & ~outside & ~hidden
        with code.when(~open_cells.same(0)):
            stride = self.length * OPERATION_BYTES
            is_long = self.length > _SHORT
            with code.when(is_long):
                tiles.write(self.tape, self.length, open_cells, stride)
            with code.bits(open_cells) as lane:
                shorter, count = tiles.tape(lane, stride)
                code.call(
                    inner, job.job, job.workspace,
                    code.select(is_long, shorter, self.tape),
                    code.select(is_long, count, self.length),
                    *(
                        first + ((lane >> 2 * axis) & 3) * size
                        for axis, first in enumerate(self.corner)
                    ),
                )  # fmt: skip


def samples_code(lanes: Lanes, declarations: set[str]) -> str:
    """Return the function that evaluates the samples of a cell of 4^3."""
    self = _CellCode(lanes, declarations)
    code, job = self.code, self.job
    column, row, layer = self.corner
    block = ((row >> 2) & 3) * ACROSS + ((column >> 2) & 3)
    mask = self.found().at(block * _BLOCK_BYTES)
    was = code.load(mask, "i16")
    missing = ~was & _ALL
    with code.when(~missing.same(0)):
        source = code.variable(self.tape)
        with code.when(self.length > UNALLOCATED):
            source.set(self.allocate("allocated_3"))
        place_samples(job, self.lanes, self.corner)
        slots, tape = job.memory("floats"), source.get()
        inputs = job.memory("pixel_inputs")
        code.call("floats", tape, self.length, job.pointer("constants"), slots, inputs)
        result = result_slot(code, tape, self.length, slots, FLOAT_SLOT)
        inside = _negative(code, self.lanes, result) & self.layers(1)
        rest, places = missing, job.memory("hit_inputs").at(3 * GRADIENT_PLANE)
        for number in range(ACROSS):
            hits = (inside >> number * POINTS) & rest
            rest = rest & ~hits
            place = as_float(code, layer + number) + 0.5
            with code.bits(hits) as ray:
                code.store(place, places.at(ray * 4))
        all_hits = missing & ~rest
        with code.when(~all_hits.same(0)):
            code.store(was | all_hits, mask, "i16")
            code.call("hits", job.job, job.workspace, tape, self.length, column, row, all_hits)
    return code.function("samples", _CELL)


def _negative(code: FunctionCode, lanes: Lanes, result: Value) -> Value:
    """Return the lanes with a negative value."""
    width, joined = lanes.width, code.literal(0)
    for number in range(LANES // width):
        bools = code.load(result.at(4 * width * number), vector_type(lanes), align=64) < 0.0
        whole = code.value(f"i{width}", f"bitcast {bools.type} {bools.name} to i{width}")
        word = code.value(WORD, f"zext i{width} {whole.name} to i64")
        joined = joined | (word << (number * width))
    return joined


def hits_code(lanes: Lanes, declarations: set[str]) -> str:
    """Return the function that writes the normals and heights of rays of a block that hit.

    ``layer`` is the mask of the rays; their layers are in ``hit_inputs``.

    Args:
        lanes: The shape of the machine's vectors.
        declarations: Receives the declarations of LLVM intrinsics.
    """
    self = _CellCode(lanes, declarations)
    code, job = self.code, self.job
    column, row, rays = self.corner
    inputs, hits, slots = (job.memory(name) for name in ("hit_inputs", "hits", "floats"))
    place_hits(job, lanes, (column, row))
    code.call("gradients", self.tape, self.length, job.pointer("constants"), slots, inputs)
    result = result_slot(code, self.tape, self.length, slots, FLOAT_SLOT)
    for offset in range(0, GRADIENT_PLANE, 4 * lanes.width):
        value, *slope = (
            code.load(result.at(plane + offset), vector_type(lanes), align=4 * lanes.width)
            for plane in range(0, FLOAT_SLOT, GRADIENT_PLANE)
        )
        place = inputs.at(3 * GRADIENT_PLANE + offset)
        layer = code.load(place, vector_type(lanes), align=4 * lanes.width)
        found = *_normal(code, slope), _height(job, value, slope, layer)
        for number, part in enumerate(found):
            target = hits.at(number * GRADIENT_PLANE + offset)
            code.store(part, target, align=4 * lanes.width)
    with code.bits(rays) as ray:
        pixel = (row + (ray >> 2)) * job.word("width") + column + (ray & 3)
        target = job.pointer("output").at(pixel * PIXEL_BYTES)
        for number in range(4):
            part = code.load(hits.at(ray * 4 + number * GRADIENT_PLANE), "float")
            code.store(part, target.at(4 * number))
    return code.function("hits", _CELL)


def _normal(code: FunctionCode, slope: list[Value]) -> list[Value]:
    """Return a gradient divided by its length; 0 where it has no direction."""

    def magnitude(number: Value) -> Value:
        return code.select(number < 0.0, -number, number)

    zero = code.literal(0.0, slope[0].type)
    largest = zero
    for part in slope:
        largest = code.select(largest < magnitude(part), magnitude(part), largest)
    # Divided by the largest component first: its square is an ordinary number.
    parts = [part / largest for part in slope]
    square = parts[0] * parts[0] + parts[1] * parts[1] + parts[2] * parts[2]
    width = slope[0].type[1:].split(" ", maxsplit=1)[0]
    root = code.intrinsic(f"sqrt.v{width}f32", slope[0].type, square)
    return [code.select(root > 0.0, part / root, zero) for part in parts]


def _height(job: ThreadJob, value: Value, slope: list[Value], layer: Value) -> Value:
    """Return the height of the surface between a sample that is inside and the one before it.

    Args:
        job: The job.
        value: The value at the sample, which is negative.
        slope: The gradient there.
        layer: The layer of the sample.
    """
    code, vector = job.code, value.type

    def spread(name: str) -> Value:
        return code.spread(job.volume(name), vector)

    along = code.literal(0.0, vector)
    for axis, part in zip("xyz", slope, strict=True):
        along = along + part * spread(f"layer_{axis}")
    before = layer - 1.0
    before = code.select(before < 0.0, 0.0, before)
    crossing = layer - value / along
    crossing = code.select(crossing > before, crossing, before)
    # Where the value does not fall along the ray, the surface is taken as midway.
    crossing = code.select(along < 0.0, crossing, layer - 0.5)
    return spread("front") + crossing * spread("step")


def column_code(lanes: Lanes, declarations: set[str]) -> str:
    """Return the function that draws a column of cells of 64x64 rays, from the front to the back.

    ``length`` is the mask of the cells that may hold a surface, and ``layer`` the lane of the first
    cell.

    Args:
        lanes: The shape of the machine's vectors.
        declarations: Receives the declarations of LLVM intrinsics.
    """
    self = _CellCode(lanes, declarations)
    code, job = self.code, self.job
    column, row, lane = self.corner
    found = job.memory("found")
    blocks = (CELLS[0] // ACROSS) ** 2

    def corner(index: Value) -> tuple[Value, Value]:
        cell, block = index // _CELL_BLOCKS, index % _CELL_BLOCKS
        return (
            column + cell % ACROSS * CELLS[1] + block % ACROSS * CELLS[2],
            row + cell // ACROSS * CELLS[1] + block // ACROSS * CELLS[2],
        )

    def within(limit: Value) -> Value:
        low = code.select(limit > 0, limit, code.literal(0))
        return code.select(low < ACROSS, low, code.literal(ACROSS))

    # Rays beyond the picture count as having hit something.
    with code.count(blocks) as index:
        x, y = corner(index)
        columns, rows = within(job.word("width") - x), within(job.word("height") - y)
        line = (code.literal(1) << columns) - 1
        all_lines = code.select(columns.same(0), 0, line * 0x1111)
        valid = all_lines & ((code.literal(1) << rows * ACROSS) - 1)
        code.store(~valid, found.at(index * _BLOCK_BYTES), "i16")
    level, stride = TileLevel(job, lanes, 0), job.word("length") * OPERATION_BYTES
    with code.bits(self.length) as number:
        tape, count = level.tape(lane + number, stride)
        code.call("cell", job.job, job.workspace, tape, count, column, row, number * CELLS[0])
    nothing = job.volume("nothing")
    empty = code.value(
        CHANNELS, f"insertelement {CHANNELS} zeroinitializer, float {nothing.name}, i64 3"
    )
    with code.count(blocks) as index:
        x, y = corner(index)
        left = ~code.load(found.at(index * _BLOCK_BYTES), "i16") & _ALL
        with code.bits(left) as ray:
            pixel = (y + (ray >> 2)) * job.word("width") + x + (ray & 3)
            code.store(empty, job.pointer("output").at(pixel * PIXEL_BYTES), align=4)
    return code.function("column", _CELL)


def heights_code(lanes: Lanes, declarations: set[str]) -> str:
    """Return the exported function that finds the first surface along the rays of a picture.

    Args:
        lanes: The shape of the machine's vectors.
        declarations: Receives the declarations of LLVM intrinsics.
    """
    code = FunctionCode(lanes, declarations)
    job = thread_job(code)
    length, operations = job.word("length"), job.pointer("operations")
    size = CELLS[0]
    across = (job.word("width") + (size - 1)) // size
    columns = across * ((job.word("height") + (size - 1)) // size)
    deep = (job.word("depth") + (size - 1)) // size
    level = TileLevel(job, lanes, 0)
    with code.forever() as loop:
        counter = job.pointer("counter")
        group = code.value("i32", f"atomicrmw add ptr {counter.name}, i32 1 monotonic")
        begin = code.value(WORD, f"zext i32 {group.name} to i64") * job.word("columns")
        code.leave(begin >= columns, loop)
        stop = code.value("i32", f"load volatile i32, ptr {job.pointer('stop').name}")
        stopped = code.value(WORD, f"zext i32 {stop.name} to i64")
        code.leave(~stopped.same(0), loop)
        left = columns - begin
        count = code.select(left < job.word("columns"), left, job.word("columns"))
        corners = job.memory("corners")
        with code.count(LANES) as lane:
            column = begin + code.select(lane // deep < count, lane // deep, count - 1)
            place = column % across * size, column // across * size, lane % deep * size
            for axis, first in enumerate(place):
                code.store(as_float(code, first), corners.at(lane * 4 + axis * FLOAT_SLOT))
        code.call("boxes", job.job, job.workspace, code.literal(size))
        _, outside = level.decide(job.pointer("allocated"), length)
        open_cells = ~outside & _first_bits(code, count * deep)
        with code.when(~open_cells.same(0)):
            level.write(operations, length, open_cells, length * OPERATION_BYTES)
        with code.count(count) as number:
            column, lane = begin + number, number * deep
            code.call(
                "column", job.job, job.workspace, operations,
                (open_cells >> lane) & _first_bits(code, deep),
                column % across * size, column // across * size, lane,
            )  # fmt: skip
    return code.function(HEIGHTS, JOB)


def _first_bits(code: FunctionCode, count: Value) -> Value:
    """Return a word with the first ``count`` bits set, 1 to 64."""
    return code.select(count >= LANES, -1, (code.literal(1) << (count & 63)) - 1)
