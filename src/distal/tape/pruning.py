"""Write the functions that shorten tapes for 64 tiles at once.

Input: a tape whose operation i writes value i, and from the interval interpreter, for each
operation, a mask of the tiles that take its first operand for certain, and of those that take its
second. Output: for each tile a tape of the operations that it still needs.

All functions go through the operations once, and treat 64 tiles as the bits of one word.
"""

from __future__ import annotations

from typing import Final

from distal.backends.llvm.lanes import Lanes
from distal.tape.layout import FIELD, LANES, OPERATION_BYTES
from distal.tape.machine_code import POINTER, WORD, FunctionCode, Value
from distal.tape.operations import NUMBER, OPERATIONS

_SELECT: Final = NUMBER["select"]
_NUMBER_BYTES: Final = 2  # of a value's or slot's number
_LEAF, _CHOICE = 4, 8  # flags beside the number of operands


def shapes_table() -> str:
    """Return the table of operand counts, with flags for inputs and choices."""
    flags = (
        row.operands + (_LEAF if row.operands == 0 else 0) + (_CHOICE if row.chooses else 0)
        for row in OPERATIONS
    )
    rows = ", ".join(f"i8 {flag}" for flag in flags)
    return f"@shapes = private unnamed_addr constant [{len(OPERATIONS)} x i8] [{rows}], align 64"


class _Pruning:
    """What the functions share: access to operations, masks and numbers."""

    def __init__(self, lanes: Lanes, declarations: set[str]) -> None:
        self.code = FunctionCode(lanes, declarations)
        self.operations = self.code.parameter("operations", POINTER)
        self.length = self.code.parameter("length")

    def operation(self, index: Value) -> Value:
        """Return the address of an operation."""
        return self.operations.at(index * OPERATION_BYTES)

    def field(self, operation: Value, name: str) -> Value:
        """Return a field of an operation."""
        return self.code.load(operation.at(FIELD[name]), "i16")

    def shape(self, number: Value) -> Value:
        """Return the table entry of an operation's number."""
        table = Value(self.code, POINTER, "@shapes")
        return self.code.load(table.at(number), "i8")

    def mask(self, array: Value, index: Value) -> Value:
        """Return the mask of an operation."""
        return self.code.load(array.at(index * 8))

    def add(self, array: Value, index: Value, bits: Value) -> None:
        """Set bits of a mask."""
        at = array.at(index * 8)
        self.code.store(self.code.load(at) | bits, at)

    def choices(self, shape: Value, index: Value) -> tuple[Value, Value]:
        """Return the tiles that take the first and the second operand; 0 without a choice."""
        code = self.code
        chooses = (shape & _CHOICE).same(_CHOICE)
        everywhere = code.select(chooses, -1, code.literal(0))
        first = self.mask(code.parameter("first", POINTER), index) & everywhere
        return first, self.mask(code.parameter("second", POINTER), index) & everywhere


def liveness_code(lanes: Lanes, declarations: set[str]) -> str:
    """Return the function that finds, for each operation, the tiles whose result needs it.

    Args:
        lanes: The shape of the machine's vectors.
        declarations: Receives the declarations of LLVM intrinsics.
    """
    self = _Pruning(lanes, declarations)
    code, live = self.code, self.code.parameter("live", POINTER)
    with code.count(self.length) as index:
        code.store(code.literal(0), live.at(index * 8))
    code.store(code.parameter("tiles"), live.at((self.length - 1) * 8))
    with code.count(self.length) as counted:
        index = (self.length - 1) - counted
        needed = self.mask(live, index)
        with code.when(~needed.same(0)):
            operation = self.operation(index)
            number = self.field(operation, "operation")
            shape = self.shape(number)
            first, second = self.choices(shape, index)
            count = shape & 3
            with code.when(count.same(3)):
                self.add(live, self.field(operation, "a"), needed & ~(first | second))
                self.add(live, self.field(operation, "b"), needed & ~second)
                self.add(live, self.field(operation, "c"), needed & ~first)
            with code.when(count.same(1) | count.same(2)):
                self.add(live, self.field(operation, "a"), needed & ~second)
            with code.when(count.same(2)):
                self.add(live, self.field(operation, "b"), needed & ~first)
    params = "ptr %operations, i64 %length, ptr %first, ptr %second, i64 %tiles, ptr noalias %live"
    return code.function("liveness", params)


def writer_code(lanes: Lanes, declarations: set[str]) -> str:
    """Return the function that writes the tape of each tile.

    The tape of tile t begins ``t * stride`` bytes after ``tapes``; ``lengths`` receives the number
    of its operations. ``names`` holds, for each operation and tile, the number of the value that
    stands for its result in the tile's tape.

    Args:
        lanes: The shape of the machine's vectors.
        declarations: Receives the declarations of LLVM intrinsics.
    """
    self = _Pruning(lanes, declarations)
    code = self.code
    live, names, tapes, stride, lengths = (
        code.parameter("live", POINTER),
        code.parameter("names", POINTER),
        code.parameter("tapes", POINTER),
        code.parameter("stride"),
        code.parameter("lengths", POINTER),
    )

    def names_of(value: Value) -> Value:
        return names.at(value * (LANES * _NUMBER_BYTES))

    def name(row: Value, tile: Value) -> Value:
        return code.load(row.at(tile * _NUMBER_BYTES), "i16")

    with code.count(LANES) as tile:
        code.store(code.literal(0), lengths.at(tile * 8))
    with code.count(self.length) as index:
        needed = self.mask(live, index)
        with code.when(~needed.same(0)):
            operation = self.operation(index)
            number = self.field(operation, "operation")
            shape = self.shape(number)
            first, second = self.choices(shape, index)
            a, b, c = (self.field(operation, f) for f in "abc")
            is_leaf, count = (shape & _LEAF).same(_LEAF), shape & 3
            own = names_of(index)
            # Fields beyond the operands are no values: for them row 0 is read, and 0 is written.
            zero = code.literal(0)
            rows = [
                names_of(code.select(count > position, field, zero))
                for position, field in enumerate((a, b, c))
            ]
            selects = number.same(_SELECT)
            taken = (
                code.select(selects, rows[1], rows[0]),
                code.select(selects, rows[2], rows[1]),
            )
            for tiles, row in zip((first, second), taken, strict=True):
                with code.bits(needed & tiles) as tile:
                    code.store(name(row, tile), own.at(tile * _NUMBER_BYTES), "i16")
            with code.bits(needed & ~(first | second)) as tile:
                place = lengths.at(tile * 8)
                length = code.load(place)
                target = tapes.at(tile * stride).at(length * OPERATION_BYTES)
                code.store(number, target.at(FIELD["operation"]), "i16")
                code.store(length, target.at(FIELD["result"]), "i16")
                operand = code.select(is_leaf, a, name(rows[0], tile))
                code.store(operand, target.at(FIELD["a"]), "i16")
                for position, field in ((1, "b"), (2, "c")):
                    operand = code.select(count > position, name(rows[position], tile), zero)
                    code.store(operand, target.at(FIELD[field]), "i16")
                code.store(length, own.at(tile * _NUMBER_BYTES), "i16")
                code.store(length + 1, place)
    params = (
        "ptr %operations, i64 %length, ptr %first, ptr %second, ptr %live, ptr noalias %names, "
        "ptr noalias %tapes, i64 %stride, ptr noalias %lengths"
    )
    return code.function("write_tapes", params)


def allocation_code(lanes: Lanes, declarations: set[str]) -> str:
    """Return the function that gives the values of a tape slots, and reuses them.

    A value's slot is free again after its last use; the result of an operation may take the slot of
    one of its operands, because interpreters read a chunk of all operands before they write it.

    Args:
        lanes: The shape of the machine's vectors.
        declarations: Receives the declarations of LLVM intrinsics.
    """
    self = _Pruning(lanes, declarations)
    code = self.code
    target = code.parameter("target", POINTER)
    last, slot_of, free = (code.parameter(n, POINTER) for n in ("last", "slot_of", "free"))

    def number(array: Value, index: Value) -> Value:
        return code.load(array.at(index * _NUMBER_BYTES), "i16")

    def put(array: Value, index: Value, value: Value) -> None:
        code.store(value, array.at(index * _NUMBER_BYTES), "i16")

    with code.count(self.length) as index:
        operation = self.operation(index)
        count = self.shape(self.field(operation, "operation")) & 3
        put(last, index, index)
        for position, field in enumerate("abc"):
            with code.when(count > position):
                put(last, self.field(operation, field), index)
    freed, used = code.variable(0), code.variable(0)
    with code.count(self.length) as index:
        operation, result = self.operation(index), target.at(index * OPERATION_BYTES)
        kind = self.field(operation, "operation")
        count = self.shape(kind) & 3
        code.store(kind, result.at(FIELD["operation"]), "i16")
        code.store(self.field(operation, "a"), result.at(FIELD["a"]), "i16")
        for position, field in enumerate("abc"):
            with code.when(count > position):
                value = self.field(operation, field)
                slot = number(slot_of, value)
                code.store(slot, result.at(FIELD[field]), "i16")
                # A value is released once, also if it is several operands of its last use.
                with code.when(number(last, value).same(index)):
                    put(free, freed.get(), slot)
                    freed.set(freed.get() + 1)
                    put(last, value, code.literal(0))
        any_free = freed.get() > 0
        with code.when(any_free):
            freed.set(freed.get() - 1)
        fresh = used.get()
        reused = number(free, freed.get())
        with code.when(~any_free):
            used.set(fresh + 1)
        slot = code.select(any_free, reused, fresh)
        put(slot_of, index, slot)
        code.store(slot, result.at(FIELD["result"]), "i16")
    code.writer.line(f"ret i64 {used.get().name}")
    params = (
        "ptr %operations, i64 %length, ptr noalias %target, ptr noalias %last, "
        "ptr noalias %slot_of, ptr noalias %free"
    )
    return code.function("allocate", params, WORD)
