"""Write LLVM functions with structured control flow: values with operators, loops, conditions.

Input: operations on ``Value``. Output: the text of LLVM functions. Integers are ``i64`` (loads
extend to it), floats are scalars or vectors of 32-bit floats. No floating-point flag is set: LLVM
neither fuses nor reorders operations. Does not depend on tapes.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Final

from distal.backends.llvm.lanes import Lanes
from distal.backends.llvm.writer import LlvmWriter
from distal.ir.types import Kind

WORD: Final = "i64"
POINTER: Final = "ptr"
BOOL: Final = "i1"
_SIZES: Final = {"i8": 1, "i16": 2, "i32": 4, "i64": 8, "float": 4, "ptr": 8}


@dataclass(frozen=True, slots=True, eq=False)
class Value:
    """A value of the function that is being written.

    Attributes:
        code: The function.
        type: LLVM's type.
        name: LLVM's operand.
    """

    code: FunctionCode
    type: str
    name: str

    def _apply(self, whole: str, other: Value | int | float, number: str = "") -> Value:
        rhs = self.code.operand(other, self.type)
        name = number if number and "float" in self.type else whole
        return self.code.value(self.type, f"{name} {self.type} {self.name}, {rhs}")

    def __add__(self, other: Value | int | float) -> Value:
        return self._apply("add", other, "fadd")

    def __sub__(self, other: Value | int | float) -> Value:
        return self._apply("sub", other, "fsub")

    def __mul__(self, other: Value | int | float) -> Value:
        return self._apply("mul", other, "fmul")

    def __truediv__(self, other: Value | int | float) -> Value:
        return self._apply("fdiv", other, "fdiv")

    def __floordiv__(self, other: Value | int) -> Value:
        return self._apply("udiv", other)

    def __mod__(self, other: Value | int) -> Value:
        return self._apply("urem", other)

    def __and__(self, other: Value | int) -> Value:
        return self._apply("and", other)

    def __or__(self, other: Value | int) -> Value:
        return self._apply("or", other)

    def __lshift__(self, other: Value | int) -> Value:
        return self._apply("shl", other)

    def __rshift__(self, other: Value | int) -> Value:
        return self._apply("lshr", other)

    def __invert__(self) -> Value:
        ones = "true" if self.type == BOOL else "-1"
        return self.code.value(self.type, f"xor {self.type} {self.name}, {ones}")

    def __neg__(self) -> Value:
        return self.code.value(self.type, f"fneg {self.type} {self.name}")

    def _compare(self, whole: str, number: str, other: Value | int | float) -> Value:
        rhs = self.code.operand(other, self.type)
        order = f"fcmp {number}" if "float" in self.type else f"icmp {whole}"
        result = self.type.replace("float", BOOL) if "float" in self.type else BOOL
        return self.code.value(result, f"{order} {self.type} {self.name}, {rhs}")

    def __lt__(self, other: Value | int | float) -> Value:
        return self._compare("slt", "olt", other)

    def __le__(self, other: Value | int | float) -> Value:
        return self._compare("sle", "ole", other)

    def __gt__(self, other: Value | int | float) -> Value:
        return self._compare("sgt", "ogt", other)

    def __ge__(self, other: Value | int | float) -> Value:
        return self._compare("sge", "oge", other)

    def same(self, other: Value | int | float) -> Value:
        """Return whether two values are equal."""
        return self._compare("eq", "oeq", other)

    def at(self, offset: Value | int) -> Value:
        """Return a pointer ``offset`` bytes further."""
        rhs = self.code.operand(offset, WORD)
        return self.code.value(POINTER, f"getelementptr i8, ptr {self.name}, i64 {rhs}")


class StackVariable:
    """A value that changes: memory of the stack, which LLVM turns into registers."""

    def __init__(self, code: FunctionCode, first: Value) -> None:
        self._code, self._type = code, first.type
        self._place = code.writer.allocate(first.type, 64 if "<" in first.type else 8)
        self.set(first)

    def get(self) -> Value:
        """Return the current value."""
        return self._code.value(self._type, f"load {self._type}, ptr {self._place}")

    def set(self, value: Value) -> None:
        """Change the value."""
        self._code.writer.line(f"store {self._type} {value.name}, ptr {self._place}")


class FunctionCode:
    """The text of one LLVM function.

    Attributes:
        writer: Writes the lines.
        declarations: Declarations of LLVM intrinsics that the function calls.
    """

    def __init__(self, lanes: Lanes, declarations: set[str]) -> None:
        self.writer = LlvmWriter()
        self.declarations = declarations
        self._lanes = lanes

    # Values

    def value(self, type: str, instruction: str) -> Value:
        """Write an instruction with a result."""
        return Value(self, type, self.writer.value(instruction))

    def operand(self, value: Value | int | float, type: str) -> str:
        """Return an operand of a type; a Python number is a literal, the same in all lanes."""
        if isinstance(value, Value):
            assert value.type == type, (value.type, type)
            return value.name
        if "float" not in type:
            return str(int(value))
        literal = self._lanes.literal(float(value), Kind.FLOAT)
        return f"splat (float {literal})" if "<" in type else literal

    def literal(self, number: int | float, type: str = WORD) -> Value:
        """Return a literal as a value."""
        return Value(self, type, self.operand(number, type))

    def parameter(self, name: str, type: str = WORD) -> Value:
        """Return a parameter of the function."""
        return Value(self, type, f"%{name}")

    def variable(self, first: Value | int) -> StackVariable:
        """Return a variable; a Python number makes one of ``i64``."""
        return StackVariable(self, first if isinstance(first, Value) else self.literal(first))

    def load(self, pointer: Value, type: str = WORD, *, align: int = 0) -> Value:
        """Load a value; small integers are extended to ``i64``."""
        size = align or _SIZES.get(type, 4)
        found = self.value(type, f"load {type}, ptr {pointer.name}, align {size}")
        if type in ("i8", "i16", "i32"):
            return self.value(WORD, f"zext {type} {found.name} to i64")
        return found

    def store(
        self,
        value: Value,
        pointer: Value,
        type: str = "",
        *,
        align: int = 0,
        streamed: bool = False,
    ) -> None:
        """Store a value.

        Args:
            value: The value; an ``i64`` is truncated to a smaller ``type``.
            pointer: The address.
            type: The type in memory; the value's own by default.
            align: The alignment in bytes; that of an element by default.
            streamed: Whether the value will not be read soon, so that caches need not keep it.
        """
        type = type or value.type
        if type != value.type:
            value = self.value(type, f"trunc {value.type} {value.name} to {type}")
        size = align or _SIZES.get(type, 4)
        hint = ", !nontemporal !1" if streamed else ""
        line = f"store {type} {value.name}, ptr {pointer.name}, align {size}{hint}"
        self.writer.line(line)

    def spread(self, scalar: Value, vector: str) -> Value:
        """Return a vector with a scalar in all lanes."""
        first = f"insertelement {vector} poison, {scalar.type} {scalar.name}, i64 0"
        one = self.value(vector, first).name
        zeros = f"<{vector[1:].split(' ', maxsplit=1)[0]} x i32> zeroinitializer"
        return self.value(vector, f"shufflevector {vector} {one}, {vector} poison, {zeros}")

    def select(self, condition: Value, yes: Value | int | float, no: Value) -> Value:
        """Return ``yes`` where the condition holds, else ``no``."""
        chosen = self.operand(yes, no.type)
        kinds = f"{condition.type} {condition.name}, {no.type} {chosen}, {no.type} {no.name}"
        return self.value(no.type, f"select {kinds}")

    def intrinsic(self, name: str, result: str, *operands: Value, rest: str = "") -> Value:
        """Call an LLVM intrinsic, whose name here has no ``llvm.``."""
        types = ", ".join(o.type for o in operands) + (", i1" if rest else "")
        self.declarations.add(f"declare {result} @llvm.{name}({types})")
        args = ", ".join(f"{o.type} {o.name}" for o in operands) + rest
        return self.value(result, f"call {result} @llvm.{name}({args})")

    def call(self, name: str, *operands: Value, result: str = "void") -> Value:
        """Call a function of the runtime."""
        args = ", ".join(f"{o.type} {o.name}" for o in operands)
        text = f"call {result} @{name}({args})"
        if result != "void":
            return self.value(result, text)
        self.writer.line(text)
        return Value(self, result, "")

    def stack(self, size: int) -> Value:
        """Return stack memory of ``size`` bytes, aligned to 64."""
        return Value(self, POINTER, self.writer.allocate(f"[{size} x i8]", 64))

    # Control flow

    @contextmanager
    def when(self, condition: Value) -> Iterator[None]:
        """Run the block if a condition holds."""
        yes, after = self.writer.label("then"), self.writer.label("after")
        self.writer.branch(condition.name, yes, after)
        self.writer.begin(yes)
        yield
        self.writer.jump(after)
        self.writer.begin(after)

    @contextmanager
    def count(self, stop: Value | int, start: Value | int = 0, step: int = 1) -> Iterator[Value]:
        """Run the block for ``start``, ``start + step`` … below ``stop``."""
        begin = start if isinstance(start, Value) else self.literal(start)
        end = stop if isinstance(stop, Value) else self.literal(stop)
        index = self.variable(begin)
        head, body, done = (self.writer.label(w) for w in ("loop", "body", "done"))
        self.writer.jump(head)
        self.writer.begin(head)
        now = index.get()
        self.writer.branch((now < end).name, body, done)
        self.writer.begin(body)
        yield now
        index.set(now + step)
        self.writer.jump(head)
        self.writer.begin(done)

    @contextmanager
    def bits(self, mask: Value) -> Iterator[Value]:
        """Run the block for the number of each bit that is set in an ``i64``, lowest first."""
        left = self.variable(mask)
        head, body, done = (self.writer.label(w) for w in ("bits", "bit", "none"))
        self.writer.jump(head)
        self.writer.begin(head)
        now = left.get()
        self.writer.branch(now.same(0).name, done, body)
        self.writer.begin(body)
        yield self.intrinsic("cttz.i64", WORD, now, rest=", i1 true")
        left.set(now & (now - 1))
        self.writer.jump(head)
        self.writer.begin(done)

    @contextmanager
    def forever(self) -> Iterator[str]:
        """Repeat the block until it calls ``leave`` with the loop's label."""
        head, done = self.writer.label("again"), self.writer.label("left")
        self.writer.jump(head)
        self.writer.begin(head)
        yield done
        self.writer.jump(head)
        self.writer.begin(done)

    def leave(self, condition: Value, loop: str) -> None:
        """Leave a ``forever`` loop if a condition holds."""
        stay = self.writer.label("stay")
        self.writer.branch(condition.name, loop, stay)
        self.writer.begin(stay)

    @contextmanager
    def switch(self, value: Value, cases: dict[int, str]) -> Iterator[str]:
        """Jump to the label of a value's case; each case ends with a jump to the given label."""
        after = self.writer.label("switched")
        rows = " ".join(f"i64 {number}, label %{label}" for number, label in cases.items())
        none = self.writer.label("none")
        self.writer.line(f"switch i64 {value.name}, label %{none} [ {rows} ]")
        self.writer.begin(none)
        self.writer.line("unreachable")
        yield after
        self.writer.begin(after)

    # The text

    def function(self, name: str, params: str, result: str = "void") -> str:
        """Return the definition; ``result`` is also the text of a final ``ret``."""
        end = "  ret void\n" if result == "void" else ""
        linkage = "" if params == "ptr noalias %job" else "internal "
        attributes = "#0"
        return (
            f"define {linkage}{result} @{name}({params}) {attributes} {{\n"
            f"{self.writer.text()}\n{end}}}"
        )
