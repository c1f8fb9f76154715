"""Write functions and statements in the common syntax of GLSL and WGSL.

Input: IR functions. Output: lines of text, each with the author's place. Expressions are written by
``distal.backends.clike.expressions``; a language implements ``Dialect`` and the abstract methods
here.
"""

from __future__ import annotations

from abc import abstractmethod
from pathlib import PurePath
from typing import assert_never

from distal.backends.clike.code import Code, Line, Precedence, infix, prefix
from distal.backends.clike.expressions import ExpressionWriter
from distal.backends.clike.literals import INT_MIN
from distal.backends.clike.module_text import comment_text
from distal.backends.clike.names import Namer
from distal.diagnostics import Span
from distal.ir.nodes import (
    Assign,
    Binary,
    BinaryOp,
    Break,
    Const,
    Construct,
    Continue,
    Expr,
    Field,
    For,
    Function,
    If,
    Index,
    Let,
    PerFrame,
    Read,
    Return,
    Splat,
    Stmt,
    Swizzle,
    Uniform,
    Var,
    While,
)
from distal.ir.types import INT, UINT, Scalar, Type, Vector
from distal.ir.walk import statements_in
from distal.lang.source_places import is_library

INT_MAX = 2**31 - 1

_IN_PLACE = (BinaryOp.ADD, BinaryOp.SUB, BinaryOp.MUL, BinaryOp.DIV)


def falls_through(body: tuple[Stmt, ...]) -> bool:
    """Return whether the end of a block seems reachable, without evaluating conditions."""
    if not body:
        return True
    match body[-1]:
        case Return() | Break() | Continue():
            return False
        case If(_, then, otherwise):
            return falls_through(then) or falls_through(otherwise)
        case _:
            return True


def place(span: Span) -> str:
    """Return the file's name and the line for a comment, without the folder.

    Of a file of distal the name alone: its lines change with each version, the program does not.
    """
    name = comment_text(PurePath(span.file.replace(chr(92), "/")).name)
    return name if is_library(span.file) else f"{name}:{span.line}"


class FunctionWriter(ExpressionWriter):
    """Writes whole functions.

    Attributes:
        variables: The IR names of the locals that are Vars.
    """

    @abstractmethod
    def header(self, fn: Function) -> str:
        """Return the first line of a function, without its brace."""

    @abstractmethod
    def loop_start(self, name: str, start: Code, type: Type) -> str:
        """Return the first part of a ``for``.

        Args:
            name: The loop variable.
            start: Its first value.
            type: Its type.
        """

    @abstractmethod
    def unsigned(self, value: Code) -> Code:
        """Return an int's bits as a uint."""

    @abstractmethod
    def signed(self, value: Code) -> Code:
        """Return a uint's bits as an int."""

    @abstractmethod
    def zero(self, type: Type) -> str:
        """Return any value of a type, for a statement that is never reached."""

    @abstractmethod
    def assign_swizzle(self, base: str, lanes: str, value: Code, type: Type) -> None:
        """Append ``base.lanes = value`` for several lanes.

        Args:
            base: The text of the vector.
            lanes: The letters of the swizzle.
            value: The value.
            type: The type of the value.
        """

    @abstractmethod
    def target_index(self, base: str, target: Index) -> str:
        """Return an element as the target of an assignment."""

    def open_function(self, fn: Function) -> None:
        """Begin a function: append its comment, and name its parameters and locals."""
        self.span = fn.span
        if fn.span is not None:
            self.line(f"// {place(fn.span)}")
        self.name_locals(fn)

    def function(self, fn: Function) -> None:
        """Append the whole function."""
        self.open_function(fn)
        self.line(f"{self.header(fn)} {{")
        self.body(fn)
        self.line("}")

    def body(self, fn: Function) -> None:
        """Append the statements of a function, indented by one step."""
        self.depth += 1
        self.copy_parameters(fn)
        self.block(fn.body, tail=True)
        if falls_through(fn.body):
            # Only after an endless loop that returns from inside; compilers require a return here.
            self.line(f"return {self.zero(fn.result)};")
        self.depth -= 1

    def copy_parameters(self, fn: Function) -> None:
        """Copy the parameters that cannot be used directly; the default copies none."""

    def mentioned(self, fn: Function) -> frozenset[str]:
        """Return the module-scope names that the function's text may contain."""
        return self.names.mentioned(fn)

    def name_locals(self, fn: Function, namer: Namer | None = None) -> None:
        """Assign a name in the text to every parameter and local."""
        self.local_namer = namer or self.names.namer.inner(self.mentioned(fn))
        self.locals = {p.name: self.local_namer.name(p.name) for p in fn.params}
        self.variables = set()
        for stmt in statements_in(fn.body):
            match stmt:
                case Let(name) | Var(name):
                    self.locals[name] = self.local_namer.name(name)
                    if isinstance(stmt, Var):
                        self.variables.add(name)
                case For(name):
                    # ``for _ in range(n)``: use the name i.
                    self.locals[name] = self.local_namer.name(name if name.strip("_") else "i")
                case _:
                    pass

    variables: set[str]

    def block(self, body: tuple[Stmt, ...], *, tail: bool = False) -> None:
        """Append statements; ``tail`` means that the function ends after them."""
        for i, stmt in enumerate(body):
            self.statement(stmt, tail=tail and i == len(body) - 1)
            if isinstance(stmt, Return | Break | Continue):
                return

    def inner(self, body: tuple[Stmt, ...], *, tail: bool = False) -> None:
        """Append a block, indented by one step."""
        self.depth += 1
        self.block(body, tail=tail)
        self.depth -= 1

    def statement(self, stmt: Stmt, *, tail: bool) -> None:
        """Append one statement."""
        here = stmt.span
        if here is not None and (self.span is None or here.file == self.span.file):
            self.span = here
        match stmt:
            case Let(name, value):
                self.bind(name, value, mutable=False)
            case Var(name, value):
                self.bind(name, value, mutable=True)
            case Assign(target, value):
                self._assign_statement(target, value)
            case If():
                self._if(stmt, self.expression(stmt.condition), tail)
            case For():
                self._for(stmt)
            case While():
                self._while(stmt)
            case Break():
                self.line("break;")
            case Continue():
                self.line("continue;")
            case Return(value):
                self.write_return(self.expression(value), tail=tail)
            case _:
                assert_never(stmt)

    def bind(self, name: str, value: Expr, *, mutable: bool) -> None:
        """Append the declaration of a local.

        Args:
            name: The IR name of the local.
            value: Its value.
            mutable: Whether it is assigned again.
        """
        code = self.expression(value)
        if not mutable and isinstance(value, Construct) and value in self.tables:
            self.locals[name] = code.text  # use the table itself
            return
        self.line(self.declaration(self.locals[name], code, value.type, mutable=mutable))

    def write_return(self, value: Code, *, tail: bool) -> None:
        """Append a return of a value; ``tail`` means that it is the last statement."""
        self.line(f"return {value.text};")

    def _assign_statement(self, target: Expr, value: Expr) -> None:
        match value:
            case Binary(op, lhs, rhs, Scalar() | Vector()) if lhs is target and op in _IN_PLACE:
                if isinstance(target, Read):
                    amount = self.expression(rhs.value if isinstance(rhs, Splat) else rhs)
                    self.line(f"{self.target(target)} {op.value}= {amount.text};")
                    return
            case _:
                pass
        self._assign(target, self.expression(value))

    def _assign(self, target: Expr, value: Code) -> None:
        match target:
            case Swizzle(Swizzle(base, outer), lanes, type):
                # a.zyx.xz is a.zx
                picked = "".join(outer["xyzw".index(lane)] for lane in lanes)
                self._assign(Swizzle(base, picked, type), value)
            case Swizzle(base, lanes, type) if len(lanes) > 1:
                self.assign_swizzle(self.target(base), lanes, value, type)
            case Index(Swizzle() as part):
                # An element of a swizzle: change a copy of the swizzle, and write it back.
                copy = self.temporary("lanes", self.expression(part), part.type, mutable=True)
                self.line(f"{self.target_index(copy.text, target)} = {value.text};")
                self._assign(part, copy)
            case _:
                self.line(f"{self.target(target)} = {value.text};")

    def target(self, target: Expr) -> str:
        """Return the text of an assignment's target."""
        match target:
            case Read(name):
                return self.locals[name]
            case Swizzle(base, lanes):
                return f"{self.target(base)}.{lanes}"
            case Field(base, name):
                return f"{self.target(base)}.{self.names.fields[base.type, name]}"  # type: ignore[index]
            case Index(base):
                return self.target_index(self.target(base), target)
            case _:
                raise AssertionError(f"{target.__class__.__name__} is no target of an assignment")

    def _if(self, stmt: If, condition: Code, tail: bool) -> None:
        self.line(f"if ({condition.text}) {{")
        self.inner(stmt.then, tail=tail)
        rest = stmt.otherwise
        while len(rest) == 1 and isinstance(rest[0], If):
            following = rest[0]
            mark = len(self.lines)
            self.span = following.span or self.span
            self.depth += 1
            test = self.expression(following.condition)
            self.depth -= 1
            if len(self.lines) > mark:
                # The condition needs statements, so it needs a block.
                needed = self.lines[mark:]
                del self.lines[mark:]
                self.line("} else {")
                self.lines += needed
                self.depth += 1
                self._if(following, test, tail)
                self.depth -= 1
                self.line("}")
                return
            self.line(f"}} else if ({test.text}) {{")
            self.inner(following.then, tail=tail)
            rest = following.otherwise
        if rest:
            self.line("} else {")
            self.inner(rest, tail=tail)
        self.line("}")

    def _while(self, stmt: While) -> None:
        mark = len(self.lines)
        self.depth += 1
        condition = self.expression(stmt.condition)
        self.depth -= 1
        needed: list[Line] = self.lines[mark:]
        del self.lines[mark:]
        if needed:
            # The condition needs statements, which run again in every iteration.
            self.line("while (true) {")
            self.lines += needed
            self.depth += 1
            self.line(f"if ({prefix('!', condition).text}) {{")
            self.depth += 1
            self.line("break;")
            self.depth -= 1
            self.line("}")
            self.depth -= 1
        else:
            self.line(f"while ({condition.text}) {{")
        self.inner(stmt.body)
        self.line("}")

    def _for(self, stmt: For) -> None:
        if not _cannot_overflow(stmt):
            self._counted_for(stmt)
            return
        name, step = self.locals[stmt.name], stmt.step
        start = self.expression(stmt.start)
        stop = self.expression(stmt.stop)
        if not self._is_fixed(stmt.stop):
            stop = self.temporary(f"{name}_stop", stop, INT)
        test = infix("<" if step > 0 else ">", Precedence.RELATION, Code(name), stop)
        sign = "+" if step > 0 else "-"
        advance = f"{name}{sign}{sign}" if abs(step) == 1 else f"{name} {sign}= {abs(step)}"
        self.line(f"for ({self.loop_start(name, start, INT)}; {test.text}; {advance}) {{")
        self.inner(stmt.body)
        self.line("}")

    def _is_fixed(self, e: Expr) -> bool:
        """Return whether an expression is cheap to read in each iteration and never changes."""
        if isinstance(e, Read):
            return e.name not in self.variables
        return isinstance(e, Const | Uniform | PerFrame)

    def _counted_for(self, stmt: For) -> None:
        """Append a loop that counts its iterations, because its variable could overflow."""
        name, step = self.locals[stmt.name], stmt.step
        start = self.temporary(f"{name}_start", self.expression(stmt.start), INT)
        stop = self.temporary(f"{name}_stop", self.expression(stmt.stop), INT)
        low, high = (start, stop) if step > 0 else (stop, start)
        span = infix("-", Precedence.SUM, self.unsigned(high), self.unsigned(low))
        # ceil(span / step) without overflow; an empty loop is not entered.
        rounds = f"({span.text} - 1u) / {abs(step)}u + 1u"
        last = self.temporary(f"{name}_rounds", Code(rounds, Precedence.SUM), UINT)
        entered = infix("<", Precedence.RELATION, low, high)
        self.line(f"if ({entered.text}) {{")
        self.depth += 1
        index = self.local_namer.name(f"{name}_round")
        header = self.loop_start(index, Code("0u"), UINT)
        self.line(f"for ({header}; {index} < {last.text}; {index}++) {{")
        self.depth += 1
        away = self.signed(infix("*", Precedence.PRODUCT, Code(index), Code(f"{abs(step)}u")))
        here = infix("+" if step > 0 else "-", Precedence.SUM, start, away)
        self.line(self.declaration(name, here, INT, mutable=False))
        self.block(stmt.body)
        self.depth -= 1
        self.line("}")
        self.depth -= 1
        self.line("}")


def _cannot_overflow(stmt: For) -> bool:
    """Return whether the variable cannot overflow after the last iteration."""
    step, start, stop = stmt.step, stmt.start, stmt.stop
    if abs(step) == 1:
        return True
    if isinstance(stop, Const):
        bound = int(stop.value)
        if step > 0 and bound <= INT_MAX - step + 1:
            return True
        if step < 0 and bound >= INT_MIN - step - 1:
            return True
    if isinstance(stop, Const) and isinstance(start, Const):
        values = range(int(start.value), int(stop.value), step)
        return not values or INT_MIN <= values[-1] + step <= INT_MAX
    return False
