"""Write the kernels: loops over the tiles of a picture or over points, and the per-frame part.

Input: a ``LaneProgram``. Output: exported LLVM functions that take a job (see ``layout``). Every
thread calls the same kernel once. It takes tiles from a shared counter until none is left or the
stop flag is set.
"""

from __future__ import annotations

from distal.backends.llvm.arithmetic import LaneArithmetic
from distal.backends.llvm.expressions import LaneExpressions
from distal.backends.llvm.lanes import Lanes, Leaf, Leaves, Stored, leaf_kinds
from distal.backends.llvm.layout import (
    BATCH,
    FRAME,
    JOB_OFFSET,
    PIXELS,
    RENDER,
    TILE_BLOCKS,
    TILE_HEIGHT,
    TILE_WIDTH,
)
from distal.backends.llvm.modules import LlvmFunction
from distal.backends.llvm.pixels import channels, chunk_pixels, interleaved, pixel_address
from distal.backends.llvm.program import LaneProgram, prologue
from distal.backends.llvm.storage import Storage
from distal.backends.llvm.uniformity import Uniformity
from distal.backends.llvm.writer import LlvmWriter
from distal.ir.nodes import EntryKind, Expr, Function, PerFrame
from distal.ir.types import FLOAT, VEC4, Kind, Scalar

# The length of the per-frame values that one function computes, in nodes. The time of LLVM's
# instruction selection grows with the square of a block's stores: 12900 lines took 2.9 s.
FRAME_LENGTH = 1000

_JOB = (("ptr noalias", "%job"),)


def kernels(program: LaneProgram) -> bool:
    """Define the module's kernels; return whether the per-frame kernel must run in a thread."""
    frame_apart = False
    if program.module.frame:
        _frame(program)
        frame_apart = program.may_be_long()
    if program.module.kind is EntryKind.IMAGE:
        _render(program)
    elif _maps_pixels(program):
        _map_pixels(program)
    else:
        _batch(program)
    return frame_apart


def _define(program: LaneProgram, name: str, arithmetic: LaneArithmetic) -> None:
    program.define(LlvmFunction("void", f"@{name}", _JOB, arithmetic.text(), exported=True))


def _frame(program: LaneProgram) -> None:
    """Write scalar code that computes the per-frame values; each may read the previous ones."""
    arithmetic = program.arithmetic()
    writer = arithmetic.writer
    groups = _groups(program)
    if len(groups) == 1:
        prologue(writer)
        _frame_values(program, arithmetic, groups[0])
    else:
        for number, group in enumerate(groups):
            part = program.arithmetic()
            prologue(part.writer)
            _frame_values(program, part, group)
            part.writer.line("ret void")
            name = f"frame_part.{number}"
            program.define(LlvmFunction("void", f"@{name}", _JOB, part.text()))
            writer.line(f"call void @{name}(ptr %job)")
    writer.line("ret void")
    _define(program, FRAME, arithmetic)


def _groups(program: LaneProgram) -> list[list[tuple[str, Expr]]]:
    """Return the per-frame values in groups of a bounded length, each for a function."""
    groups: list[list[tuple[str, Expr]]] = []
    length = FRAME_LENGTH
    for name, value in program.module.frame:
        own = program.code_of(value)
        if length + own > FRAME_LENGTH:
            groups.append([])
            length = 0
        groups[-1].append((name, value))
        length += own
    return groups


def _frame_values(
    program: LaneProgram, arithmetic: LaneArithmetic, values: list[tuple[str, Expr]]
) -> None:
    """Write code that computes per-frame values and stores them."""
    nothing = Function("frame", (), FLOAT, (), "frame")
    expressions = LaneExpressions(program, arithmetic, Uniformity(nothing, frozenset()))
    storage = Storage(arithmetic)
    for name, value in values:
        leaves = expressions.value(value)
        place = Stored(value.type, "%frame", True)
        storage.store(place, leaves, program.layout.frame[name], None, None)
        # Later values of the group use the registers instead of the memory.
        expressions.memo[PerFrame(name, value.type)] = leaves


def _field(writer: LlvmWriter, name: str, type: str = "i32") -> str:
    at = writer.value(f"getelementptr i8, ptr %job, i64 {JOB_OFFSET[name]}")
    return writer.value(f"load {type}, ptr {at}, !invariant.load !0")


class _Tiles:
    """The loop that takes tiles from the shared counter."""

    def __init__(self, writer: LlvmWriter) -> None:
        self.writer = writer
        counter, tiles = _field(writer, "counter", "ptr"), _field(writer, "tiles")
        self.next, self.done = writer.label("tile"), writer.label("done")
        going, inside = writer.label("going"), writer.label("inside")
        writer.jump(self.next)
        writer.begin(self.next)
        # Before the tile is taken: after LEAVE, other code takes it.
        stop = writer.value("load volatile i32, ptr %stop")
        writer.branch(writer.value(f"icmp eq i32 {stop}, 0"), going, self.done)
        writer.begin(going)
        self.index = writer.value(f"atomicrmw add ptr {counter}, i32 1 monotonic")
        some = writer.value(f"icmp ult i32 {self.index}, {tiles}")
        writer.branch(some, inside, self.done)
        writer.begin(inside)

    def end(self) -> None:
        """End the loop's body: continue with the next tile."""
        self.writer.jump(self.next)
        self.writer.begin(self.done)
        self.writer.line("ret void")


class _Count:
    """A loop over ``start, start + step …`` below ``stop``, with at least one iteration."""

    def __init__(self, writer: LlvmWriter, start: str, stop: str, step: int) -> None:
        self.writer, self.stop, self.step = writer, stop, step
        self.label, self.done = writer.label("row"), writer.label("past")
        self.start, self.before = start, writer.block
        writer.jump(self.label)
        writer.begin(self.label)
        self.index, self.at = writer.fresh(), writer.reserve()

    def end(self) -> None:
        """End the loop's body: continue with the next index."""
        writer = self.writer
        following = writer.value(f"add i32 {self.index}, {self.step}")
        more = writer.value(f"icmp slt i32 {following}, {self.stop}")
        edges = f"[ {self.start}, %{self.before} ], [ {following}, %{writer.block} ]"
        writer.fill(self.at, f"{self.index} = phi i32 {edges}")
        writer.branch(more, self.label, self.done)
        writer.begin(self.done)


def _least(writer: LlvmWriter, a: str, b: str) -> str:
    less = writer.value(f"icmp slt i32 {a}, {b}")
    return writer.value(f"select i1 {less}, i32 {a}, i32 {b}")


def _render(program: LaneProgram) -> None:
    """Write the kernel of a picture: top row first in memory, coordinates from the bottom."""
    arithmetic = program.arithmetic()
    writer, lanes = arithmetic.writer, program.lanes
    prologue(writer)
    output = _field(writer, "output", "ptr")
    width, height = _field(writer, "width"), _field(writer, "height")
    across = _field(writer, "tiles_across")
    block_height = lanes.count // lanes.block_width
    # A block that crosses the picture's edge is first written here: 4 floats per pixel.
    spare = writer.allocate(f"[{lanes.count * 4} x float]", 64)

    tiles = _Tiles(writer)
    row = writer.value(f"udiv i32 {tiles.index}, {across}")
    column = writer.value(f"urem i32 {tiles.index}, {across}")
    left = writer.value(f"mul i32 {column}, {TILE_WIDTH}")
    top = writer.value(f"mul i32 {row}, {TILE_HEIGHT}")
    right = _least(writer, writer.value(f"add i32 {left}, {TILE_WIDTH}"), width)
    bottom = _least(writer, writer.value(f"add i32 {top}, {TILE_HEIGHT}"), height)
    rows = _Count(writer, top, bottom, block_height)
    columns = _Count(writer, left, right, lanes.block_width)
    arithmetic.enter()
    color = _pixels(program, arithmetic, columns.index, rows.index, (width, height))
    _write(arithmetic, color, (columns.index, rows.index), (width, height), output, spare)
    arithmetic.leave()
    columns.end()
    rows.end()
    tiles.end()
    _define(program, RENDER, arithmetic)


def _pixels(
    program: LaneProgram, arithmetic: LaneArithmetic, x: str, y: str, size: tuple[str, str]
) -> Leaves:
    """Return the colors of a block; its upper left pixel is in column x, row y from the top."""
    lanes, writer = program.lanes, arithmetic.writer
    whole = lanes.vector(Kind.INT)
    number = lanes.vector(Kind.FLOAT)
    half = f"splat ({lanes.scalar(Kind.FLOAT)} {lanes.literal(0.5, Kind.FLOAT)})"
    width, height = size
    last = writer.value(f"sub i32 {height}, 1")
    # Lanes outside the picture repeat its edge, so their loops do not run longer.
    edge = arithmetic.broadcast(writer.value(f"sub i32 {width}, 1"), Kind.INT)
    edges = ("slt", edge), ("sgt", "zeroinitializer")
    coordinates: list[Leaf] = []
    for axis, first in ((0, x), (1, writer.value(f"sub i32 {last}, {y}"))):
        spread, chunks = arithmetic.broadcast(first, Kind.INT), []
        for c in range(lanes.chunks):
            steps = [
                n % lanes.block_width if axis == 0 else -(n // lanes.block_width)
                for n in range(c * lanes.width, (c + 1) * lanes.width)
            ]
            constant = ", ".join(f"i32 {n}" for n in steps)
            position = writer.value(f"add {whole} {spread}, <{constant}>")
            position = _within(writer, whole, position, edges[axis])
            as_float = writer.value(f"sitofp {whole} {position} to {number}")
            chunks.append(writer.value(f"fadd {number} {as_float}, {half}"))
        coordinates.append(Leaf(Kind.FLOAT, tuple(chunks), False))
    entry = program.module.function(program.module.entry)
    result = program.run(arithmetic, entry, [tuple(coordinates)], (True,), None)
    if len(result) == 3:
        result = (*result, arithmetic.constant(1.0, Kind.FLOAT))
    return arithmetic.spread_all(result)


def _within(writer: LlvmWriter, type: str, position: str, edge: tuple[str, str]) -> str:
    """Clamp positions to an edge, given as (comparison that holds inside, edge)."""
    order, limit = edge
    bools = type.replace("i32", "i1")
    inside = writer.value(f"icmp {order} {type} {position}, {limit}")
    return writer.value(f"select {bools} {inside}, {type} {position}, {type} {limit}")


def _write(
    arithmetic: LaneArithmetic,
    color: Leaves,
    corner: tuple[str, str],
    size: tuple[str, str],
    output: str,
    spare: str,
) -> None:
    """Write a block directly into the picture; at the picture's edges through ``spare``."""
    lanes, writer = arithmetic.lanes, arithmetic.writer
    across, down = lanes.block_width, lanes.count // lanes.block_width
    rows = interleaved(arithmetic, color)
    fits = [
        writer.value(f"icmp sle i32 {writer.value(f'add i32 {at}, {n}')}, {limit}")
        for at, n, limit in zip(corner, (across, down), size, strict=True)
    ]
    inside, edge, done = writer.label("inside"), writer.label("edge"), writer.label("written")
    writer.branch(writer.value(f"and i1 {fits[0]}, {fits[1]}"), inside, edge)
    type = f"<{across * 4} x float>"

    writer.begin(inside)
    for y, pixels in enumerate(rows):
        row = writer.value(f"add i32 {corner[1]}, {y}")
        pointer = pixel_address(writer, output, corner[0], row, size[0])
        writer.line(f"store {type} {pixels}, ptr {pointer}, align 4")
    writer.jump(done)

    writer.begin(edge)
    for y, pixels in enumerate(rows):
        pointer = writer.value(f"getelementptr i8, ptr {spare}, i64 {y * across * 16}")
        writer.line(f"store {type} {pixels}, ptr {pointer}, align 64")
    columns, lines = (
        _least(writer, str(n), writer.value(f"sub i32 {limit}, {at}"))
        for at, n, limit in zip(corner, (across, down), size, strict=True)
    )
    line = _Count(writer, "0", lines, 1)
    column = _Count(writer, "0", columns, 1)
    source = pixel_address(writer, spare, column.index, line.index, str(across))
    pixel = writer.value(f"load <4 x float>, ptr {source}, align 4")
    x = writer.value(f"add i32 {corner[0]}, {column.index}")
    y_at = writer.value(f"add i32 {corner[1]}, {line.index}")
    target = pixel_address(writer, output, x, y_at, size[0])
    writer.line(f"store <4 x float> {pixel}, ptr {target}, align 4")
    column.end()
    line.end()
    writer.jump(done)
    writer.begin(done)


def _batch(program: LaneProgram) -> None:
    """Write the kernel of points: each leaf of the arguments is a run of ``stride`` slots."""
    arithmetic = program.arithmetic()
    writer, lanes = arithmetic.writer, program.lanes
    prologue(writer)
    source, target = _field(writer, "input", "ptr"), _field(writer, "output", "ptr")
    stride, count = _field(writer, "stride", "i64"), _field(writer, "width")
    entry = program.module.function(program.module.entry)

    tiles = _Tiles(writer)
    first = writer.value(f"mul i32 {tiles.index}, {TILE_BLOCKS * lanes.count}")
    end = _least(writer, writer.value(f"add i32 {first}, {TILE_BLOCKS * lanes.count}"), count)
    blocks = _Count(writer, first, end, lanes.count)
    arithmetic.enter()
    points = writer.value(f"zext i32 {blocks.index} to i64")
    storage = Storage(arithmetic)
    leaf_number = 0
    args: list[Leaves] = []
    for param in entry.params:
        leaves: list[Leaf] = []
        for kind in leaf_kinds(param.type):
            place = Stored(
                param.type, _leaf_at(writer, lanes, source, leaf_number, stride, points), False
            )
            leaves += storage.load(place, Scalar(kind), 0, None, None)
            leaf_number += 1
        args.append(tuple(leaves))
    result = program.run(arithmetic, entry, args, (True,) * len(args), None)
    for i, leaf in enumerate(arithmetic.spread_all(result)):
        place = Stored(entry.result, _leaf_at(writer, lanes, target, i, stride, points), False)
        storage.store(place, (leaf,), 0, None, None)
    arithmetic.leave()
    blocks.end()
    tiles.end()
    _define(program, BATCH, arithmetic)


def _leaf_at(
    writer: LlvmWriter, lanes: Lanes, base: str, leaf: int, stride: str, points: str
) -> str:
    run = writer.value(f"mul i64 {stride}, {leaf}")
    slot = writer.value(f"add i64 {run}, {points}")
    byte = writer.value(f"mul i64 {slot}, {lanes.slot}")
    return writer.value(f"getelementptr i8, ptr {base}, i64 {byte}")


def _maps_pixels(program: LaneProgram) -> bool:
    """Return whether the function maps a pixel to a pixel, such as the encoding for display."""
    entry = program.module.function(program.module.entry)
    types = [param.type for param in entry.params]
    return types == [VEC4] and entry.result is VEC4 and program.lanes.precision == 32


def _map_pixels(program: LaneProgram) -> None:
    """Write the kernel from pixels to pixels of four floats, in a picture's memory layout."""
    arithmetic = program.arithmetic()
    writer, lanes = arithmetic.writer, program.lanes
    prologue(writer)
    source, target = _field(writer, "input", "ptr"), _field(writer, "output", "ptr")
    count = _field(writer, "width")
    last = writer.value(f"sub i32 {count}, {lanes.count}")

    tiles = _Tiles(writer)
    first = writer.value(f"mul i32 {tiles.index}, {TILE_BLOCKS * lanes.count}")
    end = _least(writer, writer.value(f"add i32 {first}, {TILE_BLOCKS * lanes.count}"), count)
    blocks = _Count(writer, first, end, lanes.count)
    arithmetic.enter()
    # The last block ends at the picture's end; it overlaps the block before and repeats pixels.
    first_pixel = _least(writer, blocks.index, last)
    chunks = [
        writer.value(f"add i32 {first_pixel}, {n}") for n in range(0, lanes.count, lanes.width)
    ]
    zero, one = "0", "1"
    color = channels(arithmetic, [pixel_address(writer, source, at, zero, one) for at in chunks])
    entry = program.module.function(program.module.entry)
    result = arithmetic.spread_all(program.run(arithmetic, entry, [color], (True,), None))
    for at, pixels in zip(chunks, chunk_pixels(arithmetic, result), strict=True):
        pointer = pixel_address(writer, target, at, zero, one)
        writer.line(f"store <{lanes.width * 4} x float> {pixels}, ptr {pointer}, align 4")
    arithmetic.leave()
    blocks.end()
    tiles.end()
    _define(program, PIXELS, arithmetic)
