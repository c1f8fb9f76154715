"""The state of lowering one function body: its blocks, its locals, and which locals have a value.

The rules of statements and expressions (``lowering/statements.py``, ``lowering/expressions.py`` and
others) are functions that take a ``FunctionBody``. This class handles names and blocks and contains
no rules of the language.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, TypeVar

from distal.diagnostics import Diagnostic, Label, Span
from distal.error_codes import ErrorCode
from distal.frontend.name_lookup import NameLookup
from distal.frontend.problems import LOWERING_ERRORS, FollowupError, SceneError
from distal.frontend.scopes import ScopeAnalysis
from distal.frontend.source import Node, SourceMap
from distal.frontend.values import Closure, Static, Value
from distal.ir.build import number
from distal.ir.nodes import Assign, Compose, Construct, Expr, Let, Param, Read, Stmt, Var
from distal.ir.types import Array, Kind, Matrix, Scalar, Struct, Type, Vector, is_static
from distal.ir.walk import children

if TYPE_CHECKING:
    from distal.frontend.lowering.compilation import Compilation

# Deeper expressions are split into lets, because passes and drivers recurse over expressions.
DEEPEST = 60


Item = TypeVar("Item")
Result = TypeVar("Result")


@dataclass(eq=False, slots=True)
class Variable:
    """A local, a parameter or a loop variable of one function.

    Attributes:
        name: The name in the author's source.
        owner: The function body that declares it.
        changes: Whether it is a Var; otherwise it is a Let.
        home: The block that declares it; None for a parameter.
        ir_name: Its name in the IR, unique in the function; empty until it is bound.
        type: Its type; None before the first assignment.
        typed_at: Where it gets its type.
        static: Set instead of a type if the name refers to a function, a type or a resource.
        failed: Its definition has an error; uses of it are not reported as further errors.
        loop: Whether it is a loop variable, which is read-only.
    """

    name: str
    owner: FunctionBody
    changes: bool
    home: Block | None = None
    ir_name: str = ""
    type: Type | None = None
    typed_at: Span | None = None
    static: Value | None = None
    failed: bool = False
    loop: bool = False


@dataclass(eq=False, slots=True)
class Block:
    """A block whose statements are being collected.

    Attributes:
        variables: The locals that the block declares, by name.
        statements: The IR statements so far.
        start: The index in ``statements`` where the author's current statement begins.
    """

    variables: dict[str, Variable]
    statements: list[Stmt] = field(default_factory=list)
    start: int = 0


@dataclass(slots=True)
class OpenLoop:
    """A loop being lowered.

    Attributes:
        at_break: The variables that are assigned at every ``break``; None before the first one.
    """

    at_break: set[Variable] | None = None


class FunctionBody:
    """The lowering state of one function body."""

    def __init__(
        self,
        compilation: Compilation,
        name: str,
        source: SourceMap,
        names: NameLookup,
        scopes: ScopeAnalysis,
        parent: FunctionBody | None = None,
    ) -> None:
        self.compilation = compilation
        self.name = name
        self.source = source
        self.names = names
        self.scopes = scopes
        self.parent = parent
        self.parameters: dict[str, Variable] = {}
        self.blocks: list[Block] = []
        self.assigned: set[Variable] = set()
        self.reachable = True
        self.loops: list[OpenLoop] = []
        self.captures: dict[Variable, Read] = {}
        self.bindings: dict[TypeVar, Type] = {}
        self.labels: tuple[Label, ...] = ()  # the calls that chose its types, innermost first
        self.result: Type | None = None
        self.returned: list[tuple[Value, ast.Return]] = []
        self.failed = False
        self.self_name = ""  # the parameter of a method that holds its struct
        self.whole_starts: dict[
            str, int
        ] = {}  # locals that are ints because they start as a literal
        self.place: Span | None = None  # span of the statement that is being lowered
        self._taken: set[str] = set()
        self._depths: dict[Expr, int] = {}
        self._expression: Callable[[FunctionBody, ast.expr], Value] = compilation.expression

    # Source places and errors

    def span(self, node: Node | ast.arg | ast.keyword) -> Span:
        """Return the source span of a node."""
        return self.source.span(node)

    def problem(
        self,
        code: ErrorCode,
        message: str,
        node: Node | ast.arg | ast.keyword,
        hint: str | None = None,
        labels: tuple[Label, ...] = (),
    ) -> SceneError:
        """Return an error at a node, for the caller to raise.

        Args:
            code: The family of messages that it belongs to.
            message: What is wrong.
            node: The node that the error points at.
            hint: What to write instead.
            labels: Other places that explain it.
        """
        return SceneError(code, message, self.span(node), hint, labels)

    def report(self, diagnostic: Diagnostic) -> None:
        """Record an error of this function."""
        self.failed = True
        labels = (*diagnostic.labels, *self.labels)
        self.compilation.report(replace(diagnostic, labels=labels))

    def record(self, error: SceneError | FollowupError) -> None:
        """Record an error that was raised; the consequence of another one is not reported."""
        self.failed = True
        if isinstance(error, SceneError):
            self.report(error.diagnostic)

    def followup(
        self,
        error: SceneError | FollowupError,
        rest: Iterable[Item],
        check: Callable[[Item], object],
    ) -> FollowupError:
        """Record an error, and the errors of what is left of a statement; return what to raise.

        Args:
            error: The error.
            rest: What is left.
            check: Raises the error of one of them.
        """
        self.record(error)
        for item in rest:
            try:
                check(item)
            except LOWERING_ERRORS as another:
                self.record(another)
        return FollowupError()

    def each(self, function: Callable[[Item], Result], items: Iterable[Item]) -> list[Result]:
        """Return the function's value for each item, and record the errors of all items.

        Raises:
            FollowupError: There was an error.
        """
        rest = iter(items)
        try:
            return [function(item) for item in rest]
        except LOWERING_ERRORS as error:
            raise self.followup(error, rest, function) from None

    def labels_of_call(self, node: Node, types: Mapping[str, Type]) -> tuple[Label, ...]:
        """Return the labels of errors in a called function.

        Args:
            node: The call.
            types: The types that the call chooses, by the name of the type variable or parameter.
        """
        if not types:
            return ()
        chosen = ", ".join(f"{name} = {type}" for name, type in types.items())
        return (Label(self.span(node), f"called here with {chosen}"), *self.labels)

    # Blocks and statements

    def expression(self, node: ast.expr) -> Value:
        """Lower an expression, and bind it to a Let if it is too deep."""
        value = self._expression(self, node)
        if isinstance(value, Static | Closure) or not hasattr(value, "type"):
            return value
        return self.shallow(value)  # type: ignore[arg-type]

    def shallow(self, value: Expr) -> Expr:
        """Return the expression, or a read of a new Let if it is deeper than ``DEEPEST``."""
        if self._depth(value) <= DEEPEST or is_static(value.type):
            return value
        return self.bind("part", value)

    def _depth(self, value: Expr) -> int:
        known = self._depths.get(value)
        if known is None:
            known = 1 + max((self._depth(c) for c in children(value)), default=0)
            self._depths[value] = known
        return known

    def emit(self, stmt: Stmt) -> None:
        """Add a statement. Unreachable statements are checked but not added."""
        if self.reachable:
            self.blocks[-1].statements.append(stmt)

    def bind(self, name: str, value: Expr) -> Expr:
        """Bind a value to a new Let before the current statement, unless it has no operands."""
        if not children(value):
            return value
        fresh = self.fresh(name)
        self.emit(Let(fresh, value, span=self.place))
        return Read(fresh, value.type)

    def hold(self, name: str, value: Expr) -> Expr:
        """Bind a value like ``bind``, and also copy a plain read of a Var that may change next."""
        if isinstance(value, Read):
            fresh = self.fresh(name)
            self.emit(Let(fresh, value, span=self.place))
            return Read(fresh, value.type)
        return self.bind(name, value)

    @contextmanager
    def block(self, statements: list[ast.stmt]) -> Iterator[Block]:
        """Open an inner block that collects statements."""
        block = Block({})
        for local in self.scopes.blocks.get(id(statements), ()):
            block.variables[local.name] = Variable(local.name, self, local.changes, block)
        self.blocks.append(block)
        yield block
        self.blocks.pop()

    def begin_statement(self, stmt: ast.stmt) -> None:
        """Record the statement's span, and its position: declarations are inserted before it."""
        self.place = self.span(stmt)
        self.blocks[-1].start = len(self.blocks[-1].statements)

    # Names

    def fresh(self, name: str) -> str:
        """Return an unused IR name of this function: ``name``, numbered if it is taken."""
        base = name.strip("_") or "value"
        candidate, n = base, 2
        while candidate in self._taken:
            candidate, n = f"{base}_{n}", n + 1
        self._taken.add(candidate)
        return candidate

    def add_parameter(self, name: str, type: Type | None, span: Span | None) -> Variable:
        """Declare a parameter; ``type`` is None if its annotation has an error."""
        ir_name, failed = self.fresh(name), type is None
        variable = Variable(name, self, False, None, ir_name, type, span, failed=failed)
        self.parameters[name] = variable
        self.assigned.add(variable)
        return variable

    def lookup(self, name: str) -> Variable | None:
        """Return the local or parameter of this body with this name, or None."""
        for block in reversed(self.blocks):
            if name in block.variables:
                return block.variables[name]
        return self.parameters.get(name)

    def find(self, name: str, node: ast.expr) -> Variable | tuple[bool, Any]:
        """Return a variable of this or an enclosing body, or (found, object) from outside.

        Raises:
            SceneError: The name is a local that has no value at this place.
        """
        body: FunctionBody | None = self
        while body is not None:
            variable = body.lookup(name)
            if variable is not None:
                return variable
            if name in body.scopes.loops:
                message = f"the loop variable '{name}' has no value outside its loop"
                raise self.problem(
                    ErrorCode.UNSET, message, node, "assign it to a local inside the loop"
                )
            if name in body.scopes.names:
                raise self.problem(ErrorCode.UNSET, f"'{name}' has no value here", node)
            body = body.parent
        return self.names.find(name)

    def read(self, variable: Variable, node: ast.expr) -> Value:
        """Return the value of a variable; a variable of an enclosing function becomes a capture.

        Raises:
            FollowupError: The variable's definition has an error.
            SceneError: The variable may have no value here.
        """
        if variable.failed:
            raise FollowupError
        owner = variable.owner
        unknown = variable.type is None and variable.static is None
        if variable not in owner.assigned and (owner.reachable or unknown):
            message = f"'{variable.name}' may be read before it has a value"
            raise self.problem(
                ErrorCode.UNSET, message, node, "give it a value before the if or the loop"
            )
        if variable.static is not None:
            return variable.static
        assert variable.type is not None
        if owner is self:
            return Read(variable.ir_name, variable.type, span=self.span(node))
        return self.capture(variable)

    def capture(self, variable: Variable) -> Expr:
        """Return an enclosing function's variable as an extra parameter of this lifted function."""
        assert variable.type is not None
        if variable.owner is self:
            return Read(variable.ir_name, variable.type)
        if variable not in self.captures:
            self.captures[variable] = Read(self.fresh(variable.name), variable.type)
        return self.captures[variable]

    def capture_params(self) -> tuple[Param, ...]:
        """Return the extra parameters for the captured variables, in order."""
        return tuple(Param(read.name, read.type) for read in self.captures.values())

    # Assignment

    def store(self, variable: Variable, value: Expr, node: ast.stmt | ast.expr) -> None:
        """Assign a value to a local. The first assignment declares the local with the value's type.

        Args:
            variable: The local.
            value: The value; its type is the local's type if the local has one.
            node: The node whose span the statement gets.
        """
        span = self.span(node)
        if variable.ir_name and variable.changes:
            assert variable.type is not None
            self.emit(Assign(Read(variable.ir_name, variable.type), value, span=span))
        else:
            self._declare(variable, value, span)
        self.assigned.add(variable)

    def _declare(self, variable: Variable, value: Expr, span: Span) -> None:
        variable.type, variable.typed_at = value.type, variable.typed_at or span
        variable.ir_name = self.fresh(variable.name)
        home = variable.home
        if not variable.changes:
            self.emit(Let(variable.ir_name, value, span=span))
        elif home is self.blocks[-1] and home is not None:
            self.emit(Var(variable.ir_name, value, span=span))
        else:
            assert home is not None
            declaration = Var(variable.ir_name, zero(value.type), span=span)
            home.statements.insert(home.start, declaration)
            home.start += 1
            self.emit(Assign(Read(variable.ir_name, value.type), value, span=span))


def zero(type: Type) -> Expr:
    """Return an initial value for a local that is always assigned before it is read."""
    match type:
        case Scalar() | Vector():
            return number(0, type)
        case Matrix(size):
            return Compose((number(0, Vector(Kind.FLOAT, size)),) * size, type)
        case Struct(_, fields):
            return Construct(tuple(zero(t) for _, t in fields), type)
        case Array(element, length):
            return Construct((zero(element),) * length, type)
        case _:
            raise AssertionError(f"{type} is no type of a local")
