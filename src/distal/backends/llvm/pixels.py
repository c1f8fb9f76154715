"""Convert pixels of four floats between memory and the lanes of vectors.

Input: addresses, or the channels of a block. Output: channels, or vectors of whole pixels in the
order of a picture in memory. Does not depend on the surrounding loops.
"""

from __future__ import annotations

from distal.backends.llvm.arithmetic import LaneArithmetic
from distal.backends.llvm.lanes import Leaf, Leaves
from distal.backends.llvm.writer import LlvmWriter
from distal.ir.types import Kind


def pixel_address(writer: LlvmWriter, base: str, x: str, y: str, width: str) -> str:
    """Return the address of a pixel of four floats.

    Args:
        writer: The text of the function.
        base: The address of the picture.
        x: The column.
        y: The row, from the top.
        width: Pixels in a row.
    """
    wide = [writer.value(f"zext i32 {n} to i64") for n in (x, y, width)]
    row = writer.value(f"mul i64 {wide[1]}, {wide[2]}")
    index = writer.value(f"add i64 {row}, {wide[0]}")
    return writer.value(f"getelementptr <4 x float>, ptr {base}, i64 {index}")


def interleaved(arithmetic: LaneArithmetic, color: Leaves) -> list[str]:
    """Return the rows of a block as RGBA pixels, always 32-bit floats."""
    lanes, writer = arithmetic.lanes, arithmetic.writer
    parts, across = chunk_pixels(arithmetic, color), lanes.block_width * 4
    return [
        _run(writer, parts, 4 * lanes.width, first, across)
        for first in range(0, lanes.count * 4, across)
    ]


def chunk_pixels(arithmetic: LaneArithmetic, color: Leaves) -> list[str]:
    """Return each chunk of lanes as RGBA pixels, always 32-bit floats."""
    lanes, writer = arithmetic.lanes, arithmetic.writer
    width, narrow = lanes.width, f"<{lanes.width} x float>"
    parts: list[str] = []
    for c in range(lanes.chunks):
        channels = [leaf.names[c] for leaf in color]
        if lanes.precision == 64:
            wide = lanes.vector(Kind.FLOAT)
            channels = [writer.value(f"fptrunc {wide} {n} to {narrow}") for n in channels]
        everything = ", ".join(f"i32 {i}" for i in range(2 * width))
        pairs = [
            writer.value(
                f"shufflevector {narrow} {a}, {narrow} {b}, <{2 * width} x i32> <{everything}>"
            )
            for a, b in (channels[:2], channels[2:])
        ]
        order = ", ".join(f"i32 {k * width + lane}" for lane in range(width) for k in range(4))
        pair = f"<{2 * width} x float>"
        parts.append(
            writer.value(
                f"shufflevector {pair} {pairs[0]}, {pair} {pairs[1]}, <{4 * width} x i32> <{order}>"
            )
        )
    return parts


def _run(writer: LlvmWriter, parts: list[str], size: int, first: int, count: int) -> str:
    """Return ``count`` consecutive numbers from the concatenation of vectors of ``size``."""
    if count <= size:
        part, start = parts[first // size], first % size
        if count == size:
            return part
        order = ", ".join(f"i32 {start + i}" for i in range(count))
        type = f"<{size} x float>"
        return writer.value(
            f"shufflevector {type} {part}, {type} poison, <{count} x i32> <{order}>"
        )
    half = count // 2
    low = _run(writer, parts, size, first, half)
    high = _run(writer, parts, size, first + half, half)
    order = ", ".join(f"i32 {i}" for i in range(count))
    type = f"<{half} x float>"
    return writer.value(f"shufflevector {type} {low}, {type} {high}, <{count} x i32> <{order}>")


def channels(arithmetic: LaneArithmetic, pointers: list[str]) -> Leaves:
    """Return red, green, blue and alpha of the pixels at the address of each chunk."""
    lanes, writer = arithmetic.lanes, arithmetic.writer
    type = f"<{lanes.width * 4} x float>"
    loaded = [writer.value(f"load {type}, ptr {p}, align 4") for p in pointers]
    leaves = []
    for channel in range(4):
        order = ", ".join(f"i32 {4 * lane + channel}" for lane in range(lanes.width))
        mask = f"<{lanes.width} x i32> <{order}>"
        picked = (writer.value(f"shufflevector {type} {p}, {type} poison, {mask}") for p in loaded)
        leaves.append(Leaf(Kind.FLOAT, tuple(picked), False))
    return tuple(leaves)
