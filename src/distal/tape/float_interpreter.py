"""Write the interpreter of tapes for floats: 64 points at once.

Input: the shape of the machine's vectors. Output: the text of one LLVM function. A slot holds 64
floats.
"""

from __future__ import annotations

from distal.backends.llvm.lanes import Lanes
from distal.tape.interpreter_loop import ROUNDINGS, Reader, TapeLoop
from distal.tape.layout import FLOAT_SLOT
from distal.tape.machine_code import Value
from distal.tape.operations import ELEMENTARY, FIRST_ELEMENTARY, NUMBER, OPERATIONS


def float_code(lanes: Lanes, declarations: set[str]) -> str:
    """Return the function that evaluates a tape at 64 points.

    Args:
        lanes: The shape of the machine's vectors.
        declarations: Receives the declarations of LLVM intrinsics.
    """
    self = TapeLoop(lanes, declarations, FLOAT_SLOT)
    code = self.code

    def value(name: str, a: Value, b: Value) -> Value:
        match name:
            case "add":
                return a + b
            case "sub":
                return a - b
            case "mul":
                return a * b
            case "div":
                return a / b
            case "min":
                return self.least(a, b)
            case "max":
                return self.most(a, b)
            case "neg":
                return -a
            case "abs":
                return self.call("fabs", a)
            case "square":
                return a * a
            case "sqrt":
                return self.call("sqrt", self.positive(a))
            case "less" | "less_equal" | "equal":
                holds = {"less": a < b, "less_equal": a <= b, "equal": a.same(b)}[name]
                return code.select(holds, 1.0, code.literal(0.0, self.vector))
            case _:
                return self.call(ROUNDINGS[name], a)

    def case(name: str, reader: Reader, _: Value) -> None:
        row = OPERATIONS[NUMBER[name]]
        target = self.slot(reader, "result")
        if name == "const":
            constant = self.constant(reader)
            for offset in self.offsets:
                self.store(constant, target, offset)
        elif name in ("x", "y", "z"):
            source = self.inputs.at("xyz".index(name) * FLOAT_SLOT)
            for offset in self.offsets:
                self.store(self.load(source, offset), target, offset)
        elif name in ELEMENTARY:
            operands = [self.slot(reader, f) for f in "ab"[: row.operands]]
            number = code.literal(NUMBER[name] - FIRST_ELEMENTARY)
            code.call("elementary", target, operands[0], operands[-1], number)
        elif name == "select":
            a, b, c = (self.slot(reader, f) for f in "abc")
            for offset in self.offsets:
                chosen = self.load(a, offset) > 0.5
                both = self.load(b, offset), self.load(c, offset)
                self.store(code.select(chosen, *both), target, offset)
        else:
            addresses = [self.slot(reader, f) for f in "ab"[: row.operands]]
            for offset in self.offsets:
                chunks = [self.load(address, offset) for address in addresses]
                self.store(value(name, chunks[0], chunks[-1]), target, offset)

    self.loop(case)
    params = "ptr %operations, i64 %length, ptr %constants, ptr noalias %slots, ptr %inputs"
    return code.function("floats", params)
