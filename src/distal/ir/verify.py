"""Verify that a module obeys the rules of the IR, after each pass in tests and with ``--verify``.

Input: a module. Output: nothing, or an AssertionError that shows the node. A failure is a bug in
the compiler and never the author's mistake, so it is not a CompileError. This module checks names,
scopes, order and paths; ``distal.ir.verify_types`` checks the types of each node's operands.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import assert_never

from distal.ir import nodes
from distal.ir.exits import never_ends
from distal.ir.nodes import (
    Apply,
    Assign,
    Break,
    Call,
    Const,
    Continue,
    EntryKind,
    Expr,
    Field,
    For,
    Function,
    FunctionRef,
    Gradient,
    If,
    Index,
    Let,
    Module,
    PerFrame,
    Read,
    Return,
    Stmt,
    Swizzle,
    Uniform,
    Var,
    While,
)
from distal.ir.nodes import Resource as ResourceNode
from distal.ir.printer import print_expression
from distal.ir.types import (
    BOOL,
    FLOAT,
    FRAME,
    INT,
    VEC2,
    VEC4,
    FunctionType,
    Type,
    index_count,
    is_static,
    is_targets,
)
from distal.ir.verify_types import check_types
from distal.ir.walk import children, expressions, nodes_in, per_frame_reads, root_of

DEEPEST = 200

# The passes in order (``distal.passes.pipeline``), and what is absent after each of them.
_STAGES = (
    *("entry", "specialise", "gradient", "decompose", "specialise-prelude", "bounds"),
    *("fold", "frequency", "inline", "fold-inlined", "tables", "share"),
    *("split-structs", "predicate", "outline", "one-way"),
)
_NO_FRAME = frozenset(_STAGES)
_NO_FUNCTION_VALUES = frozenset(_STAGES[1:])
_NO_STATIC_PARAMETERS = frozenset(_STAGES[1:]) - {"decompose"}  # decompose adds prelude functions
_NO_GRADIENT = frozenset(_STAGES[2:])
_INDICES_IN_RANGE = frozenset(_STAGES[5:])
_PER_FRAME = frozenset(_STAGES[_STAGES.index("frequency") :])


def verify(module: Module, stage: str | None = None) -> None:
    """Raise AssertionError when the module breaks a rule.

    ``stage`` is the name of the last pass that ran: the guarantees of that pass and of the passes
    before it are checked too. None checks only the rules for every module.

    Raises:
        AssertionError: A rule is broken.
    """
    Verifier().verify(module, stage)


class Verifier:
    """Checks the outputs of one run of the pipeline; checks only once what a pass did not change.

    A function is not checked again when it is the same object and everything that its check depends
    on is equal: the rules of the stage; the types of uniforms, resources and per-frame values; the
    signatures of the functions that it mentions. Nodes are interned, so the types of a node's
    operands are checked once for all functions and passes.
    """

    def __init__(self) -> None:
        self._context: _CheckContext | None = None
        self._depths: dict[Expr, int] = {}
        self._checked: set[Expr] = set()
        # Keyed by the function's id; a record keeps the function alive, so ids stay unique.
        self._records: dict[int, _CheckedFunction] = {}

    def verify(self, module: Module, stage: str | None = None) -> None:
        """Raise AssertionError when the module breaks a rule; see the function ``verify``.

        Raises:
            AssertionError: A rule is broken.
        """
        assert stage is None or stage in _STAGES, f"no pass {stage}"
        context = _CheckContext.of(module, stage)
        if context != self._context:
            self._context, self._checked, self._records = context, set(), {}
        functions: dict[str, Function] = {}
        # Functions called by the frame part may be anywhere in the module.
        every = {f.name: f for f in module.functions}
        _Checker(context, every, self._depths, set()).frame_part(module)
        frame_reads = per_frame_reads(*(value for _, value in module.frame))
        for function in module.functions:
            assert function.name not in functions, f"function {function.name} defined twice"
            record = self._records.get(id(function))
            if record is None or not record.holds(functions):
                checker = _Checker(context, functions, self._depths, self._checked)
                checker.function(function)
                record = _CheckedFunction(function, checker.mentioned, checker.frame_reads)
                self._records[id(function)] = record
            frame_reads |= record.frame_reads
            functions[function.name] = function
        assert module.entry in functions, f"no entry function {module.entry}"
        if stage in _PER_FRAME:
            # Otherwise a backend would declare and compute a value that is never read.
            unread = {name for name, _ in module.frame} - frame_reads
            assert not unread, f"nothing reads the per-frame values {sorted(unread)}"
        _unique("uniform", [u.name for u in module.uniforms])
        _unique("resource", [r.name for r in module.resources])
        entry = functions[module.entry]
        if module.kind is EntryKind.IMAGE and stage in _NO_FRAME:
            assert [p.type for p in entry.params] == [VEC2], f"{entry.name} takes not just coord"
            assert entry.result is VEC4 or is_targets(entry.result), (
                f"{entry.name} returns {entry.result}"
            )


@dataclass(frozen=True, slots=True)
class _CheckContext:
    """Everything that the check of a function depends on, except the function and its callees."""

    no_frame: bool
    no_function_values: bool
    no_static_parameters: bool
    no_gradient: bool
    no_per_frame: bool
    indices_in_range: bool
    uniforms: dict[str, Type]
    resources: dict[str, Type]
    frame: dict[str, Type]

    @classmethod
    def of(cls, module: Module, stage: str | None) -> _CheckContext:
        """Return the rules that hold after a pass, and the declarations of the module."""
        return cls(
            stage in _NO_FRAME,
            stage in _NO_FUNCTION_VALUES,
            stage in _NO_STATIC_PARAMETERS,
            stage in _NO_GRADIENT,
            stage is not None and stage not in _PER_FRAME,
            stage in _INDICES_IN_RANGE,
            {u.name: u.type for u in module.uniforms},
            {r.name: r.type for r in module.resources},
            {name: value.type for name, value in module.frame},
        )


@dataclass(frozen=True, slots=True)
class _CheckedFunction:
    """A record of a function that was checked.

    Attributes:
        function: The function.
        mentioned: The functions that it called or referred to when it was checked.
        frame_reads: The per-frame values that it reads.
    """

    function: Function
    mentioned: dict[str, Function]
    frame_reads: set[str]

    def holds(self, functions: Mapping[str, Function]) -> bool:
        """Return whether the mentioned functions still have the same signatures."""
        return all(
            (found := functions.get(name)) is not None
            and found.result is before.result
            and [p.type for p in found.params] == [p.type for p in before.params]
            for name, before in self.mentioned.items()
        )


def _unique(what: str, names: list[str]) -> None:
    assert len(set(names)) == len(names), f"a {what} declared twice in {names}"


class _Checker:
    """Checks one function, or the per-frame part."""

    def __init__(
        self,
        context: _CheckContext,
        functions: Mapping[str, Function],
        depths: dict[Expr, int],
        checked: set[Expr],
    ) -> None:
        """Prepare the check.

        Args:
            context: The rules and declarations that the check depends on.
            functions: The functions before the one being checked.
            depths: The depths of expressions whose types were checked; extended by the check.
            checked: The expressions checked in this context, except calls; extended by the check.
        """
        self._context = context
        self._functions = functions
        self._depths = depths
        self._checked = checked
        self._frame: Mapping[str, Type] = context.frame
        self.mentioned: dict[str, Function] = {}
        self.frame_reads: set[str] = set()

    def frame_part(self, module: Module) -> None:
        """Check that each per-frame value reads only earlier ones."""
        before: dict[str, Type] = {}
        self._frame = before
        for name, value in module.frame:
            assert name not in before, f"per-frame value {name} computed twice"
            self.expression(value, {}, f"per-frame value {name}")
            before[name] = value.type

    def function(self, function: Function) -> None:
        where = function.name
        scope: dict[str, Type] = {}
        for param in function.params:
            assert param.name not in scope, f"{where}: parameter {param.name} twice"
            scope[param.name] = param.type
        for type in (*scope.values(), function.result):
            self._check_boundary_type(type, where)
        assert not is_static(function.result), f"{where} returns a {function.result}"
        walker = _Walker(self, function, set(scope))
        walker.block(function.body, scope, frozenset(), in_loop=False)
        assert never_ends(function.body), f"{where}: a path ends without return"

    def _check_boundary_type(self, type: Type, where: str) -> None:
        if self._context.no_frame:
            assert type is not FRAME, f"{where}: Frame after the entry pass"
        if self._context.no_static_parameters:
            assert not is_static(type), f"{where}: a parameter of type {type} after specialise"

    def expression(self, root: Expr, scope: Mapping[str, Type], where: str) -> None:
        """Check every node of an expression, each node once, and every read against its scope.

        Args:
            root: The expression.
            scope: The locals in scope -> their types.
            where: The name of the function, for error messages.

        Raises:
            AssertionError: A rule is broken.
        """
        for e in nodes_in(root):
            if isinstance(e, Read):
                found = scope.get(e.name)
                assert found is e.type, f"{where}: {e.name} is {found}, read as {e.type}"
            if isinstance(e, PerFrame):
                self.frame_reads.add(e.name)
            if e in self._checked:
                continue
            try:
                if e not in self._depths:
                    check_types(e)
                    depth = 1 + max((self._depths[c] for c in children(e)), default=0)
                    assert depth <= DEEPEST, f"deeper than {DEEPEST}"
                    self._depths[e] = depth
                self._references(e)
                self._stage_rules(e)
            except AssertionError as broken:
                text = print_expression(e)
                raise AssertionError(f"{where}: {broken}: {e.type}\n{text}") from broken
            if not isinstance(e, Call | FunctionRef):
                self._checked.add(e)

    def _references(self, e: Expr) -> None:
        """Check the names that refer to something outside the function."""
        match e:
            case Uniform(nodes.FRAME_TIME, type) if not self._context.no_frame:
                assert type is FLOAT, "the time is a float"
            case Uniform(name, type):
                assert self._context.uniforms.get(name) is type, "no such uniform"
            case PerFrame(name, type):
                assert self._frame.get(name) is type, "no such per-frame value"
            case ResourceNode(name, type):
                assert self._context.resources.get(name) is type, "no such resource"
            case Call(name, args, type):
                called = self._mentioned(name)
                assert called is not None, f"{name} does not stand before its caller"
                _match([p.type for p in called.params], args, name)
                assert called.result is type, f"{name} returns {called.result}"
            case FunctionRef(name, captures, type):
                called = self._mentioned(name)
                assert called is not None, f"{name} does not stand before its user"
                assert isinstance(type, FunctionType), "not of a function type"
                types = [p.type for p in called.params]
                free = len(types) - len(captures)
                assert tuple(types[:free]) == type.params, f"{name} takes {types}"
                _match(types[free:], captures, name)
                assert called.result is type.result, f"{name} returns {called.result}"
            case _:
                pass

    def _mentioned(self, name: str) -> Function | None:
        found = self._functions.get(name)
        if found is not None:
            self.mentioned[name] = found
        return found

    def _stage_rules(self, e: Expr) -> None:
        if self._context.no_frame:
            assert e.type is not FRAME, "Frame after the entry pass"
        if self._context.no_function_values:
            assert not isinstance(e, Apply), "Apply after specialise"
            for child in children(e):
                bound = isinstance(child, FunctionRef) and isinstance(e, Gradient)
                assert bound or not isinstance(child.type, FunctionType), "a function value"
        if self._context.no_gradient:
            assert not isinstance(e, Gradient | FunctionRef), "Gradient after its pass"
        if self._context.no_per_frame:
            assert not isinstance(e, PerFrame), "PerFrame before the frequency pass"
        if self._context.no_static_parameters and isinstance(e, Read):
            assert not is_static(e.type), f"a {e.type} parameter after specialise"
        if self._context.indices_in_range:
            _index_in_range(e)


def _index_in_range(e: Expr) -> None:
    if isinstance(e, Index) and isinstance(e.index, Const):
        count = index_count(e.base.type)
        assert count is None or 0 <= e.index.value < count, "index out of range"


def _match(types: Iterable[Type], args: tuple[Expr, ...], name: str) -> None:
    wanted, given = list(types), [a.type for a in args]
    assert wanted == given, f"{name} takes {list(map(str, wanted))}, gets {list(map(str, given))}"


class _Walker:
    """Checks the statements of one function."""

    def __init__(self, checker: _Checker, function: Function, bound: set[str]) -> None:
        self._checker = checker
        self._function = function
        self._bound = bound

    def block(
        self, body: tuple[Stmt, ...], scope: dict[str, Type], vars: frozenset[str], *, in_loop: bool
    ) -> None:
        scope = dict(scope)
        for stmt in body:
            for e in expressions(stmt):
                self._checker.expression(e, scope, self._function.name)
            vars = self._statement(stmt, scope, vars, in_loop)

    def _statement(
        self, stmt: Stmt, scope: dict[str, Type], vars: frozenset[str], in_loop: bool
    ) -> frozenset[str]:
        where = self._function.name
        match stmt:
            case Let(name, value):
                self._bind(name, value.type, scope)
            case Var(name, value):
                assert not is_static(value.type), f"{where}: var {name} of type {value.type}"
                self._bind(name, value.type, scope)
                return vars | {name}
            case Assign(target, value):
                self._target(target, vars)
                assert target.type is value.type, f"{where}: {target.type} = {value.type}"
            case If(condition, then, otherwise):
                assert condition.type is BOOL, f"{where}: if {condition.type}"
                self.block(then, scope, vars, in_loop=in_loop)
                self.block(otherwise, scope, vars, in_loop=in_loop)
            case While(condition, body):
                assert condition.type is BOOL, f"{where}: while {condition.type}"
                self.block(body, scope, vars, in_loop=True)
            case For(name, start, stop, step, body):
                assert start.type is stop.type is INT, f"{where}: range of {stop.type}"
                assert step != 0 and -(2**31) <= step < 2**31, f"{where}: step {step}"
                inner = dict(scope)
                self._bind(name, INT, inner)
                self.block(body, inner, vars, in_loop=True)
            case Break() | Continue():
                assert in_loop, f"{where}: {stmt} outside a loop"
            case Return(value):
                wanted = self._function.result
                assert value.type is wanted, f"{where} returns {value.type}, declared {wanted}"
            case _:
                assert_never(stmt)
        return vars

    def _bind(self, name: str, type: Type, scope: dict[str, Type]) -> None:
        assert name not in self._bound, f"{self._function.name}: {name} bound twice"
        self._bound.add(name)
        scope[name] = type

    def _target(self, target: Expr, vars: frozenset[str]) -> None:
        where = self._function.name
        part = target
        while not isinstance(part, Read):
            assert isinstance(part, Swizzle | Index | Field), f"{where}: {part} as a target"
            if isinstance(part, Swizzle):
                assert len(set(part.lanes)) == len(part.lanes), f"{where}: {part.lanes} as a target"
            part = part.base
        assert root_of(target).name in vars, f"{where}: {part.name} is no var"
