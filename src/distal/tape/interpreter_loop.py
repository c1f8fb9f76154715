"""What the interpreters of tapes share: the loop over the operations, and access to registers.

Input: the shape of the machine's vectors. Output: helpers that write LLVM text. An interpreter does
not depend on any tape: it reads its operations (``layout``) and jumps to the code of each.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from distal.backends.llvm.lanes import Lanes
from distal.ir.types import Kind
from distal.tape.layout import FIELD, FLOAT_SLOT, OPERATION_BYTES
from distal.tape.machine_code import POINTER, FunctionCode, Value
from distal.tape.operations import OPERATIONS

ROUNDINGS: Final = {"floor": "floor", "ceil": "ceil", "round": "rint", "trunc": "trunc"}


def vector_type(lanes: Lanes) -> str:
    """Return LLVM's type of one register of floats."""
    return lanes.vector(Kind.FLOAT)


class Reader:
    """The operation that an interpreter's loop has reached."""

    def __init__(self, code: FunctionCode, operation: Value) -> None:
        self.code = code
        self._operation = operation

    def field(self, name: str) -> Value:
        """Return a field of the operation: its number, a slot, or a constant's number."""
        return self.code.load(self._operation.at(FIELD[name]), "i16")


class TapeLoop:
    """What all interpreters share: the loop over the operations, and access to chunks."""

    def __init__(self, lanes: Lanes, declarations: set[str], slot: int) -> None:
        self.code = FunctionCode(lanes, declarations)
        self.lanes = lanes
        self.vector = vector_type(lanes)
        self._slot = slot
        self.operations = self.code.parameter("operations", POINTER)
        self.length = self.code.parameter("length")
        self.constants = self.code.parameter("constants", POINTER)
        self.slots = self.code.parameter("slots", POINTER)
        self.inputs = self.code.parameter("inputs", POINTER)

    @property
    def offsets(self) -> range:
        """The byte offset of each chunk in 64 floats."""
        return range(0, FLOAT_SLOT, 4 * self.lanes.width)

    def slot(self, reader: Reader, field: str) -> Value:
        """Return the address of an operand's slot, or of the result's."""
        return self.slots.at(reader.field(field) * self._slot)

    def load(self, address: Value, offset: int) -> Value:
        """Load a chunk."""
        return self.code.load(address.at(offset), self.vector, align=64)

    def store(self, value: Value, address: Value, offset: int) -> None:
        """Store a chunk."""
        self.code.store(value, address.at(offset), align=64)

    def constant(self, reader: Reader) -> Value:
        """Return a constant, broadcast to a chunk."""
        number = self.code.load(self.constants.at(reader.field("a") * 4), "float")
        return self.code.spread(number, self.vector)

    def least(self, a: Value, b: Value) -> Value:
        """Return ``b if b < a else a``."""
        return self.code.select(b < a, b, a)

    def most(self, a: Value, b: Value) -> Value:
        """Return ``b if a < b else a``."""
        return self.code.select(a < b, b, a)

    def call(self, name: str, *operands: Value) -> Value:
        """Call an LLVM intrinsic for a chunk."""
        suffix = f"v{self.lanes.width}f32"
        return self.code.intrinsic(f"{name}.{suffix}", self.vector, *operands)

    def positive(self, a: Value) -> Value:
        """Return ``max(a, 0)``, 0 for NaN."""
        return self.code.select(a > 0.0, a, self.code.literal(0.0, self.vector))

    def loop(self, case: Callable[[str, Reader, Value], None]) -> None:
        """Write the loop; ``case`` writes the code of one operation at a place of the tape."""
        code = self.code
        with code.count(self.length) as index:
            reader = Reader(code, self.operations.at(index * OPERATION_BYTES))
            labels = {i: f"op_{row.name}" for i, row in enumerate(OPERATIONS)}
            with code.switch(reader.field("operation"), labels) as after:
                for number, row in enumerate(OPERATIONS):
                    code.writer.begin(labels[number])
                    case(row.name, reader, index)
                    code.writer.jump(after)
