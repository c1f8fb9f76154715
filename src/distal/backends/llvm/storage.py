"""Access values in memory: indexed arrays, constant tables, buffers and textures.

Input: places (a pointer, leaves, an index that may differ between lanes). Output: loads, gathers,
masked stores and scatters. The bounds pass clamps indices of arrays; indices of buffers and texels
are clamped here. Inactive lanes do not access memory.
"""

from __future__ import annotations

from collections.abc import Sequence

from distal.backends.llvm.arithmetic import LaneArithmetic
from distal.backends.llvm.lanes import Leaf, Leaves, Stored, leaf_kinds
from distal.ir.nodes import BinaryOp, CompareOp
from distal.ir.types import FLOAT, Kind, Type

Mask = tuple[str, ...] | None  # one vector of i1 for each chunk; None: every lane is active

_SLOT_KIND = {Kind.FLOAT: Kind.FLOAT, Kind.INT: Kind.INT, Kind.UINT: Kind.UINT, Kind.BOOL: Kind.INT}


class Storage:
    """Writes loads and stores."""

    def __init__(self, arithmetic: LaneArithmetic) -> None:
        self.arithmetic = arithmetic
        self.lanes = arithmetic.lanes
        self.writer = arithmetic.writer

    # Arrays

    def size(self, type: Type, *, uniform: bool) -> int:
        """Return the size of a stored value in bytes."""
        count = max(1, len(leaf_kinds(type)))
        return (count if uniform else count * self.lanes.count) * self.lanes.slot

    def allocate(self, type: Type, *, uniform: bool) -> Stored:
        """Allocate memory for a value; its content is undefined."""
        size = self.size(type, uniform=uniform)
        return Stored(type, self.writer.allocate(f"[{size} x i8]", 64), uniform)

    def load(
        self, place: Stored, type: Type, offset: int, index: Leaf | None, mask: Mask
    ) -> Leaves:
        """Load a value at leaf ``offset + index``.

        Args:
            place: The memory.
            type: The type of the value.
            offset: A constant number of leaves.
            index: A computed number of leaves; None: 0.
            mask: The active lanes; None: all.
        """
        return tuple(
            self._load_leaf(place, kind, offset + i, index, mask)
            for i, kind in enumerate(leaf_kinds(type))
        )

    def store(
        self, place: Stored, value: Leaves, offset: int, index: Leaf | None, mask: Mask
    ) -> None:
        """Store leaves at leaf ``offset + index``, in the active lanes.

        Args:
            place: The memory.
            value: The leaves.
            offset: A constant number of leaves.
            index: A computed number of leaves; None: 0.
            mask: The active lanes; None: all.
        """
        for i, leaf in enumerate(value):
            self._store_leaf(place, leaf, offset + i, index, mask)

    def _load_leaf(
        self, place: Stored, kind: Kind, offset: int, index: Leaf | None, mask: Mask
    ) -> Leaf:
        slot = _SLOT_KIND[kind]
        if place.uniform and (index is None or index.uniform):
            type = self.lanes.scalar(slot)
            pointer = self._element(place, offset, index, 1)
            name = self.writer.value(f"load {type}, ptr {pointer}, align {self._align(slot)}")
            leaf = Leaf(slot, (name,), True)
        elif index is None or index.uniform:
            type = self.lanes.vector(slot)
            pointers = self._chunks(place, offset, index)
            align = self._align(slot)
            leaf = Leaf(slot, tuple(self._load_vector(type, p, align) for p in pointers), False)
        else:
            addresses = self._addresses(place, offset, index)
            leaf = self.gather(slot, addresses, mask)
        return self.arithmetic.cast(leaf, kind)

    def _store_leaf(
        self, place: Stored, leaf: Leaf, offset: int, index: Leaf | None, mask: Mask
    ) -> None:
        slot = _SLOT_KIND[leaf.kind]
        leaf = self.arithmetic.cast(leaf, slot)
        align = self._align(slot)
        if place.uniform:
            pointer = self._element(place, offset, index, 1)
            type = self.lanes.scalar(slot)
            self.writer.line(f"store {type} {leaf.names[0]}, ptr {pointer}, align {align}")
            return
        vectors, type = self.arithmetic.vectors(leaf), self.lanes.vector(slot)
        if index is not None and not index.uniform:
            self._scatter(slot, vectors, self._addresses(place, offset, index), mask)
            return
        for c, pointer in enumerate(self._chunks(place, offset, index)):
            value = vectors[c]
            if mask is not None:
                old = self._load_vector(type, pointer, align)
                value = self.writer.value(
                    f"select {self.lanes.vector(Kind.BOOL)} {mask[c]}, {type} {value}, {type} {old}"
                )
            self._store_vector(type, value, pointer, align)

    def _load_vector(self, type: str, pointer: str, align: int) -> str:
        """Load one chunk; in 64 bits each int occupies an eight-byte slot and is truncated."""
        if self.lanes.slot == 4 or "i32" not in type:
            return self.writer.value(f"load {type}, ptr {pointer}, align {align}")
        wide = type.replace("i32", "i64")
        loaded = self.writer.value(f"load {wide}, ptr {pointer}, align {align}")
        return self.writer.value(f"trunc {wide} {loaded} to {type}")

    def _store_vector(self, type: str, value: str, pointer: str, align: int) -> None:
        if self.lanes.slot == 8 and "i32" in type:
            wide = type.replace("i32", "i64")
            value, type = self.writer.value(f"zext {type} {value} to {wide}"), wide
        self.writer.line(f"store {type} {value}, ptr {pointer}, align {align}")

    def _align(self, kind: Kind) -> int:
        return self.lanes.slot if kind is Kind.FLOAT else 4

    def _element(self, place: Stored, offset: int, index: Leaf | None, per_leaf: int) -> str:
        """Return the address of a leaf, the same for all lanes; a leaf has ``per_leaf`` slots."""
        scale = per_leaf * self.lanes.slot
        pointer = place.pointer
        if index is not None:
            assert index.uniform
            wide = self.writer.value(f"sext i32 {index.names[0]} to i64")
            far = self.writer.value(f"mul i64 {wide}, {scale}")
            pointer = self.writer.value(f"getelementptr i8, ptr {pointer}, i64 {far}")
        if offset:
            pointer = self.writer.value(f"getelementptr i8, ptr {pointer}, i64 {offset * scale}")
        return pointer

    def _chunks(self, place: Stored, offset: int, index: Leaf | None) -> list[str]:
        base = self._element(place, offset, index, self.lanes.count)
        step = self.lanes.width * self.lanes.slot
        return [
            self.writer.value(f"getelementptr i8, ptr {base}, i64 {c * step}")
            for c in range(self.lanes.chunks)
        ]

    def _addresses(self, place: Stored, offset: int, index: Leaf) -> list[str]:
        """Return one vector of pointers for each chunk, for an index that varies."""
        per_leaf = 1 if place.uniform else self.lanes.count
        first = [offset * per_leaf] * self.lanes.count
        if not place.uniform:
            first = [slot + lane for lane, slot in enumerate(first)]
        return self.addresses(place.pointer, index, per_leaf, first)

    # Gather and scatter

    def addresses(
        self, pointer: str, index: Leaf, scale: int, first: Sequence[int] | None = None
    ) -> list[str]:
        """Return pointers to the slots ``index * scale + first[lane]``.

        Args:
            pointer: The first slot.
            index: The index; it may vary between lanes.
            scale: Slots per index.
            first: Slots to add in each lane; None: 0.
        """
        width, out = self.lanes.width, []
        whole = self.lanes.vector(Kind.INT)
        for c, name in enumerate(self.arithmetic.vectors(index)):
            slot = name
            if scale != 1:
                slot = self.writer.value(f"mul {whole} {slot}, splat (i32 {scale})")
            if first is not None and any(first):
                lanes = first[c * width : (c + 1) * width]
                constant = ", ".join(f"i32 {n}" for n in lanes)
                slot = self.writer.value(f"add {whole} {slot}, <{constant}>")
            element = self.lanes.scalar(Kind.FLOAT)  # only its size matters: one slot
            out.append(self.writer.value(f"getelementptr {element}, ptr {pointer}, {whole} {slot}"))
        return out

    def gather(self, kind: Kind, addresses: list[str], mask: Mask) -> Leaf:
        """Load from one pointer per lane; the result is zero in inactive lanes.

        Args:
            kind: The kind of the values.
            addresses: A vector of pointers for each chunk.
            mask: The active lanes; None: all.
        """
        width, type = self.lanes.width, self.lanes.vector(kind)
        letters = {"float": "f32", "double": "f64", "i32": "i32"}[self.lanes.scalar(kind)]
        name = f"@llvm.masked.gather.v{width}{letters}.v{width}p0"
        bools, pointers = self.lanes.vector(Kind.BOOL), f"<{width} x ptr>"
        align = self._align(kind)
        self.arithmetic.declarations.add(f"declare {type} {name}({pointers}, {bools}, {type})")
        masks = mask or ("splat (i1 true)",) * self.lanes.chunks
        loads = (
            self.writer.value(
                f"call {type} {name}({pointers} align {align} {address}, {bools} {active}, "
                f"{type} zeroinitializer)"
            )
            for address, active in zip(addresses, masks, strict=True)
        )
        return Leaf(kind, tuple(loads), False)

    def _scatter(
        self, kind: Kind, values: tuple[str, ...], addresses: list[str], mask: Mask
    ) -> None:
        width, type = self.lanes.width, self.lanes.vector(kind)
        letters = {"float": "f32", "double": "f64", "i32": "i32"}[self.lanes.scalar(kind)]
        name = f"@llvm.masked.scatter.v{width}{letters}.v{width}p0"
        bools, pointers = self.lanes.vector(Kind.BOOL), f"<{width} x ptr>"
        align = self._align(kind)
        self.arithmetic.declarations.add(f"declare void {name}({type}, {pointers}, {bools})")
        masks = mask or ("splat (i1 true)",) * self.lanes.chunks
        for value, address, active in zip(values, addresses, masks, strict=True):
            self.writer.line(
                f"call void {name}({type} {value}, {pointers} align {align} {address}, "
                f"{bools} {active})"
            )

    # Resources

    def clamp(self, index: Leaf, count: Leaf) -> Leaf:
        """Return an index, clamped to 0 .. ``count - 1``."""
        arithmetic = self.arithmetic
        zero, one = arithmetic.constant(0, Kind.INT), arithmetic.constant(1, Kind.INT)
        last = arithmetic.binary(BinaryOp.SUB, count, one)
        above = arithmetic.compare(CompareOp.LT, last, index)
        index = arithmetic.select(above, last, index)
        below = arithmetic.compare(CompareOp.LT, index, zero)
        return arithmetic.select(below, zero, index)

    def fetch(self, pointer: str, index: Leaf, kinds: Sequence[Kind], mask: Mask) -> Leaves:
        """Load element ``index`` of a buffer or texture.

        Args:
            pointer: The first slot.
            index: The index of the element; it may vary between lanes.
            kinds: The kinds of an element's leaves.
            mask: The active lanes; None: all.
        """
        stride = len(kinds)
        if index.uniform:
            place = Stored(FLOAT, pointer, True)
            stretch = self.arithmetic.binary(
                BinaryOp.MUL, index, self.arithmetic.constant(stride, Kind.INT)
            )
            return tuple(
                self._load_leaf(place, kind, i, stretch, mask) for i, kind in enumerate(kinds)
            )
        leaves = []
        for i, kind in enumerate(kinds):
            addresses = self.addresses(pointer, index, stride, [i] * self.lanes.count)
            slot = _SLOT_KIND[kind]
            leaves.append(self.arithmetic.cast(self.gather(slot, addresses, mask), kind))
        return tuple(leaves)
