"""Read ``.vm`` files: functions of a point as a list of operations, as Fidget writes them.

Input: a text with one operation in each line: a name for its result, the operation, and a number or
the names of earlier results. The last result is the value of the function. Lines that begin with
``#`` are comments. Output: the operations, as a tape and as the text of a scene function. Does not
depend on shapes.

Source of the format: M. Keeter, Fidget, ``Context::from_text`` (github.com/mkeeter/fidget).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any, Final, NoReturn

from distal.at_once import cached_property
from distal.diagnostics import CompileError, Diagnostic, Span, printable
from distal.error_codes import ErrorCode
from distal.frontend.problems import did_you_mean
from distal.ir.nodes import BinaryOp, CompareOp, UnaryOp
from distal.ir.types import Kind
from distal.tape.operations import OPERATIONS
from distal.tape.scalars import Scalar, Scalars, Varying
from distal.tape.tape import Tape

# The names of operands in ``VM_OPERATIONS``.
_OPERANDS: Final = ("a", "b")
# The number of operands, and what is computed of them, as an expression of scene code. Where scene
# code and Fidget differ: ``round`` is half to even, ``%`` has the sign of the divisor; built-ins of
# numbers for which they are not defined (the root of -1) give the nearest defined value.
VM_OPERATIONS: Final[Mapping[str, tuple[int, str]]] = {
    "add": (2, "{a} + {b}"),
    "sub": (2, "{a} - {b}"),
    "mul": (2, "{a} * {b}"),
    "div": (2, "{a} / {b}"),
    "min": (2, "min({a}, {b})"),
    "max": (2, "max({a}, {b})"),
    "mod": (2, "{a} % {b}"),
    "atan2": (2, "atan2({a}, {b})"),
    "compare": (2, "sign({a} - {b})"),
    "and": (2, "select({a} == 0.0, {a}, {b})"),
    "or": (2, "select({a} == 0.0, {b}, {a})"),
    "not": (1, "select({a} == 0.0, 1.0, 0.0)"),
    "neg": (1, "-{a}"),
    "abs": (1, "abs({a})"),
    "square": (1, "{a} * {a}"),
    "sqrt": (1, "sqrt({a})"),
    "recip": (1, "1.0 / {a}"),
    "floor": (1, "floor({a})"),
    "ceil": (1, "ceil({a})"),
    "round": (1, "round({a})"),
    "sin": (1, "sin({a})"),
    "cos": (1, "cos({a})"),
    "tan": (1, "tan({a})"),
    "asin": (1, "asin({a})"),
    "acos": (1, "acos({a})"),
    "atan": (1, "atan({a})"),
    "exp": (1, "exp({a})"),
    "ln": (1, "log({a})"),
}
_BUILTINS: Final = (
    "abs",
    "acos",
    "asin",
    "atan",
    "atan2",
    "ceil",
    "cos",
    "exp",
    "floor",
    "log",
    "max",
    "min",
    "round",
    "sign",
    "sin",
    "sqrt",
    "tan",
)
_AXES: Final = {"var-x": "x", "var-y": "y", "var-z": "z"}
_CONST: Final = "const"
# Ordinary targets compile the whole function: 7,600 operations take 7 s on the CPU. Drivers of GPUs
# take longer, so this many are the most that a file may have.
MOST_OPERATIONS: Final = 20_000


class VmFileError(CompileError, ValueError):
    """A ``.vm`` file that cannot be read; the message shows its line."""


@dataclass(frozen=True, slots=True)
class VmRow:
    """One operation.

    Attributes:
        operation: Its name in the file.
        operands: The numbers of the rows that it uses.
        number: The number of a constant.
    """

    operation: str
    operands: tuple[int, ...]
    number: float = 0.0


@dataclass(frozen=True)
class VmProgram:
    """The operations of a file.

    Attributes:
        rows: The operations; the last one is the result.
        name: The name of the file, without its suffix.
    """

    rows: tuple[VmRow, ...]
    name: str

    @cached_property
    def flat(self) -> bool:
        """Whether only x and y occur."""
        return not any(row.operation == "var-z" for row in self.rows)

    def tape(self) -> Tape:
        """Return the function as a tape."""
        scalars = Scalars()
        builder = scalars.builder
        values: list[int] = []
        direct = _direct()
        for row in self.rows:
            operands = [values[i] for i in row.operands]
            if row.operation == _CONST:
                value = builder.constant(row.number)
            elif axis := _AXES.get(row.operation):
                value = builder.operation(axis)
            elif name := direct.get(row.operation):
                value = builder.operation(name, *operands)
            else:
                value = _trace(row.operation, scalars, tuple(operands))
            values.append(value)
        return builder.tape(values[-1])

    def scene_code(self, function: str) -> str:
        """Return the text of a scene function.

        Args:
            function: Its name.
        """
        lines = [f"def {function}(p: {'vec2' if self.flat else 'vec3'}) -> float:"]
        for i, row in enumerate(self.rows):
            if row.operation == _CONST:
                text = repr(row.number)
            elif axis := _AXES.get(row.operation):
                text = f"p.{axis}"
            else:
                operands = (f"v{operand}" for operand in row.operands)
                names = dict(zip(_OPERANDS, operands, strict=False))
                text = VM_OPERATIONS[row.operation][1].format(**names)
            lines.append(f"    v{i} = {text}")
        lines.append(f"    return v{len(self.rows) - 1}")
        return "\n".join(lines) + "\n"


def read_vm(text: str, file: str) -> VmProgram:
    """Return the operations of a text.

    Args:
        text: The text.
        file: The name of the file, for messages.

    Raises:
        VmFileError: The text is invalid; the message shows the line.
    """
    rows: list[VmRow] = []
    names: dict[str, int] = {}
    for number, line in enumerate(text.splitlines(), 1):
        words = line.split()
        if not words or line.startswith("#"):
            continue
        if len(rows) == MOST_OPERATIONS:
            hint = "compiling more for other targets than the tape would take minutes"
            _refuse(f"a file has at most {MOST_OPERATIONS} operations", file, number, line, 0, hint)
        rows.append(_row(words, names, file, number, line))
        names[words[0]] = len(rows) - 1
    if not rows:
        raise VmFileError(
            [Diagnostic(ErrorCode.FILE, f"'{file}' has no operations", None, _FORMAT)]
        )
    name = file.replace("\\", "/").rpartition("/")[2].removesuffix(".vm")
    return VmProgram(tuple(rows), name)


_FORMAT: Final = "write one operation in each line: _2 add _0 _1"


def _row(words: list[str], names: Mapping[str, int], file: str, number: int, line: str) -> VmRow:
    """Return the operation of a line.

    Args:
        words: The words of the line.
        names: The earlier results.
        file: The name of the file.
        number: The number of the line.
        line: The line.
    """
    if len(words) < 2:
        _refuse("this line has no operation", file, number, line, 0, _FORMAT)
    operation, operands = words[1], words[2:]
    if operation in _AXES:
        count = 0
    elif operation == _CONST:
        count = 1
    elif operation in VM_OPERATIONS:
        count = VM_OPERATIONS[operation][0]
    else:
        hint = did_you_mean(operation, (*VM_OPERATIONS, *_AXES, _CONST))
        hint = hint or f"operations are const, {', '.join((*_AXES, *VM_OPERATIONS))}"
        _refuse(f"there is no operation '{printable(operation, 40)}'", file, number, line, 1, hint)
    if len(operands) != count:
        takes = {0: "nothing", 1: "one operand", 2: "two operands"}[count]
        message = f"'{operation}' takes {takes}, not {len(operands)}"
        _refuse(message, file, number, line, 1, _FORMAT)
    if operation == _CONST:
        return VmRow(operation, (), _number(operands[0], file, number, line))
    found = []
    for position, name in enumerate(operands, 2):
        if name not in names:
            message = f"'{printable(name, 40)}' is not the result of an earlier line"
            _refuse(message, file, number, line, position, None)
        found.append(names[name])
    return VmRow(operation, tuple(found))


def _number(word: str, file: str, number: int, line: str) -> float:
    try:
        value = float(word)
    except ValueError:
        value = math.nan
    if not abs(value) <= 3e38:
        message = f"'{printable(word, 40)}' is not a finite number of 32 bits"
        _refuse(message, file, number, line, 2, None)
    return value


def _refuse(
    message: str, file: str, number: int, line: str, word: int, hint: str | None
) -> NoReturn:
    """Raise an error at a word of a line.

    Args:
        message: What is wrong.
        file: The name of the file.
        number: The number of the line.
        line: The line.
        word: The position of the word in the line.
        hint: What to write instead.

    Raises:
        VmFileError: Always.
    """
    start = 0
    words = line.split()
    for each in words[: word + 1]:
        start = line.index(each, start) + (0 if each is words[word] else len(each))
    span = Span(file, number, start, start + len(words[word]), line)
    raise VmFileError([Diagnostic(ErrorCode.FILE, message, span, hint)])


# Operations as functions: the expressions of the table, on values that record what is computed.


@dataclass(frozen=True, slots=True, eq=False)
class _Traced:
    """A value of scene code, whose operations go to a tape."""

    scalars: Scalars
    scalar: Scalar

    def _other(self, other: Any) -> Scalar:
        return other.scalar if isinstance(other, _Traced) else float(other)

    def _binary(self, op: BinaryOp, a: Scalar, b: Scalar) -> _Traced:
        return _Traced(self.scalars, self.scalars.binary(op, a, b, Kind.FLOAT))

    def __add__(self, other: Any) -> _Traced:
        return self._binary(BinaryOp.ADD, self.scalar, self._other(other))

    def __sub__(self, other: Any) -> _Traced:
        return self._binary(BinaryOp.SUB, self.scalar, self._other(other))

    def __mul__(self, other: Any) -> _Traced:
        return self._binary(BinaryOp.MUL, self.scalar, self._other(other))

    def __truediv__(self, other: Any) -> _Traced:
        return self._binary(BinaryOp.DIV, self.scalar, self._other(other))

    def __rtruediv__(self, other: Any) -> _Traced:
        return self._binary(BinaryOp.DIV, self._other(other), self.scalar)

    def __mod__(self, other: Any) -> _Traced:
        return self._binary(BinaryOp.MOD, self.scalar, self._other(other))

    def __neg__(self) -> _Traced:
        return _Traced(self.scalars, self.scalars.unary(UnaryOp.NEGATE, self.scalar, Kind.FLOAT))

    def __eq__(self, other: Any) -> Any:
        return _Traced(
            self.scalars, self.scalars.compare(CompareOp.EQ, self.scalar, self._other(other))
        )


def _traced_builtin(name: str) -> Callable[..., _Traced]:
    def call(*args: _Traced) -> _Traced:
        scalars = args[0].scalars
        return _Traced(scalars, scalars.builtin(name, [a.scalar for a in args], Kind.FLOAT))

    return call


def _traced_select(condition: _Traced, yes: Any, no: Any) -> _Traced:
    scalars = condition.scalars
    both = (condition._other(yes), condition._other(no))
    return _Traced(scalars, scalars.select(condition.scalar, *both))


_NAMES: Final = {name: _traced_builtin(name) for name in _BUILTINS} | {"select": _traced_select}
_RULES: Final[Mapping[str, Callable[..., _Traced]]] = {
    name: eval(f"lambda {', '.join(_OPERANDS[:count])}: {text.format(a='a', b='b')}", dict(_NAMES))
    for name, (count, text) in VM_OPERATIONS.items()
}


def _trace(name: str, scalars: Scalars, operands: tuple[int, ...]) -> int:
    """Add an operation of a file to a tape, and return its value there."""
    values = (_Traced(scalars, Varying(operand)) for operand in operands)
    return scalars.value(_RULES[name](*values).scalar)


@cache
def _direct() -> dict[str, str]:
    """Return the operations that are one operation of a tape, with its name there.

    They are added without tracing, which takes four times as long.
    """
    found = {}
    for name, (count, _) in VM_OPERATIONS.items():
        scalars = Scalars()
        operands = tuple(scalars.operation(axis).value for axis in "xy"[:count])
        tape = scalars.builder.tape(_trace(name, scalars, operands))
        row = tape.operations[-1].tolist()
        if len(tape) == count + 1 and tuple(row[2 : 2 + count]) == operands:
            found[name] = OPERATIONS[row[0]].name
    return found
