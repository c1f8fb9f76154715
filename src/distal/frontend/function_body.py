"""The state of lowering one function's body: its blocks, its locals, which of them have a value.

Statement and expression rules (``statements``, ``expressions`` and their neighbours) are functions
over a ``FunctionBody``, which knows names and blocks, and no rule of the language.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, TypeVar

from distal.diagnostics import Diagnostic, Span
from distal.frontend.name_lookup import NameLookup
from distal.frontend.problems import FollowupError, SceneError
from distal.frontend.scopes import ScopeAnalysis
from distal.frontend.source import Node, SourceMap
from distal.frontend.values import Closure, Static, Value
from distal.ir.build import number
from distal.ir.nodes import Assign, Compose, Construct, Expr, Let, Param, Read, Stmt, Var
from distal.ir.types import Array, Kind, Matrix, Scalar, Struct, Type, Vector, is_static
from distal.ir.walk import children

if TYPE_CHECKING:
    from distal.frontend.lowering.compilation import Compilation

# Deeper expressions are split into lets, so that no pass and no driver recurses too far.
DEEPEST = 60


@dataclass(eq=False, slots=True)
class Variable:
    """A local, a parameter or a loop variable of one function.

    Attributes:
        name: As the author writes it.
        owner: The body it belongs to.
        changes: Whether it is a Var; a Let otherwise.
        ir_name: Its name in the IR, unique in the function; empty until it is bound.
        type: Known from its first assignment on.
        static: Set instead of a type where the name stands for a function or the like.
        failed: Its definition was a mistake: uses of it are no further mistakes.
        loop: A loop variable, which is read-only.
    """

    name: str
    owner: FunctionBody
    changes: bool
    home: Block | None = None
    ir_name: str = ""
    type: Type | None = None
    static: Value | None = None
    failed: bool = False
    loop: bool = False


@dataclass(eq=False, slots=True)
class Block:
    """Statements being collected; ``start`` is where the current author's statement begins."""

    variables: dict[str, Variable]
    statements: list[Stmt] = field(default_factory=list)
    start: int = 0


@dataclass(slots=True)
class OpenLoop:
    """An open loop: what is assigned at each ``break``, or None where there was none yet."""

    at_break: set[Variable] | None = None


class FunctionBody:
    """One function body on its way to IR."""

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
        self.result: Type | None = None
        self.returned: list[tuple[Value, ast.Return]] = []
        self.failed = False
        self.whole_starts: dict[str, int] = {}  # locals that are ints because a literal began them
        self.place: Span | None = None  # of the statement that is being lowered
        self._taken: set[str] = set()
        self._depths: dict[Expr, int] = {}
        self._expression: Callable[[FunctionBody, ast.expr], Value] = compilation.expression

    # Places and mistakes

    def span(self, node: Node | ast.arg | ast.keyword) -> Span:
        """The author's place of a node."""
        return self.source.span(node)

    def problem(
        self,
        message: str,
        node: Node | ast.arg | ast.keyword,
        hint: str | None = None,
    ) -> SceneError:
        """A mistake at a node, to be raised."""
        return SceneError(message, self.span(node), hint)

    def report(self, diagnostic: Diagnostic) -> None:
        """Note a mistake of this function."""
        self.failed = True
        self.compilation.report(diagnostic)

    # Blocks and statements

    def expression(self, node: ast.expr) -> Value:
        """Lower an expression; one that grows too deep is cut by a Let."""
        value = self._expression(self, node)
        if isinstance(value, Static | Closure) or not hasattr(value, "type"):
            return value
        return self.shallow(value)  # type: ignore[arg-type]

    def shallow(self, value: Expr) -> Expr:
        """The expression, or a read of a new Let that holds it."""
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
        """Add a statement; what can never run is checked but not kept."""
        if self.reachable:
            self.blocks[-1].statements.append(stmt)

    def bind(self, name: str, value: Expr) -> Expr:
        """Hold a value in a new Let before the current statement."""
        if not children(value):
            return value
        fresh = self.fresh(name)
        self.emit(Let(fresh, value, span=self.place))
        return Read(fresh, value.type)

    def hold(self, name: str, value: Expr) -> Expr:
        """As ``bind``, and also for a Var that is about to change."""
        if isinstance(value, Read):
            fresh = self.fresh(name)
            self.emit(Let(fresh, value, span=self.place))
            return Read(fresh, value.type)
        return self.bind(name, value)

    @contextmanager
    def block(self, statements: list[ast.stmt]) -> Iterator[Block]:
        """Collect the statements of an inner block."""
        block = Block({})
        for local in self.scopes.blocks.get(id(statements), ()):
            block.variables[local.name] = Variable(local.name, self, local.changes, block)
        self.blocks.append(block)
        yield block
        self.blocks.pop()

    def begin_statement(self, stmt: ast.stmt) -> None:
        """Remember where hoisted locals go, before this statement, and where they come from."""
        self.place = self.span(stmt)
        self.blocks[-1].start = len(self.blocks[-1].statements)

    # Names

    def fresh(self, name: str) -> str:
        """A name of the IR that is new in this function, as close to ``name`` as can be."""
        base = name.strip("_") or "value"
        candidate, n = base, 2
        while candidate in self._taken:
            candidate, n = f"{base}_{n}", n + 1
        self._taken.add(candidate)
        return candidate

    def add_parameter(self, name: str, type: Type | None) -> Variable:
        """Declare a parameter; ``type`` is None where its annotation was a mistake."""
        variable = Variable(name, self, False, None, self.fresh(name), type, failed=type is None)
        self.parameters[name] = variable
        self.assigned.add(variable)
        return variable

    def lookup(self, name: str) -> Variable | None:
        """The local or parameter of this body that a name stands for here."""
        for block in reversed(self.blocks):
            if name in block.variables:
                return block.variables[name]
        return self.parameters.get(name)

    def find(self, name: str, node: ast.expr) -> Variable | tuple[bool, Any]:
        """A variable of this or an enclosing body, or (found, object) from outside."""
        body: FunctionBody | None = self
        while body is not None:
            variable = body.lookup(name)
            if variable is not None:
                return variable
            if name in body.scopes.loops:
                message = f"the loop variable '{name}' has no value outside its loop"
                raise self.problem(message, node, "assign it to a local inside the loop")
            if name in body.scopes.names:
                raise self.problem(f"'{name}' has no value here", node)
            body = body.parent
        return self.names.find(name)

    def read(self, variable: Variable, node: ast.expr) -> Value:
        """The value of a variable here; of an enclosing function's variable, a capture."""
        if variable.failed:
            raise FollowupError
        owner = variable.owner
        unknown = variable.type is None and variable.static is None
        if variable not in owner.assigned and (owner.reachable or unknown):
            message = f"'{variable.name}' may be read before it has a value"
            raise self.problem(message, node, "give it a value before the if or the loop")
        if variable.static is not None:
            return variable.static
        assert variable.type is not None
        if owner is self:
            return Read(variable.ir_name, variable.type, span=self.span(node))
        return self.capture(variable)

    def capture(self, variable: Variable) -> Expr:
        """An enclosing function's variable, as a parameter that this lifted function gets."""
        assert variable.type is not None
        if variable.owner is self:
            return Read(variable.ir_name, variable.type)
        if variable not in self.captures:
            self.captures[variable] = Read(self.fresh(variable.name), variable.type)
        return self.captures[variable]

    def capture_params(self) -> tuple[Param, ...]:
        """The parameters that captures became, in order."""
        return tuple(Param(read.name, read.type) for read in self.captures.values())

    # Assignment

    def store(self, variable: Variable, value: Expr, node: ast.stmt | ast.expr) -> None:
        """Give a local a value of the type it has, or of its first type."""
        span = self.span(node)
        if variable.ir_name and variable.changes:
            assert variable.type is not None
            self.emit(Assign(Read(variable.ir_name, variable.type), value, span=span))
        else:
            self._declare(variable, value, span)
        self.assigned.add(variable)

    def _declare(self, variable: Variable, value: Expr, span: Span) -> None:
        variable.type = value.type
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
    """A value for a local that is surely assigned before it is read."""
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
