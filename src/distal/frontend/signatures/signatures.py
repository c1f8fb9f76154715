"""A function's parameters and result: what ``def`` says before the body.

Input: an ``Overload`` as it was recorded. Output: its syntax, its parameters with
evaluated annotations and defaults, and where its names are looked up.
"""

from __future__ import annotations

import ast
import builtins
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import FunctionType
from typing import Any, Final

from distal.diagnostics import CompileError, Diagnostic, Span
from distal.frontend.lowering.body import Names
from distal.frontend.parsing import parse
from distal.frontend.problems import SceneError, did_you_mean
from distal.frontend.source import SourceMap, parse_definition
from distal.lang.functions import Overload
from distal.lang.source import capture

MISSING: Final = object()


@dataclass(frozen=True, slots=True)
class Slot:
    """One parameter: ``annotation`` is the evaluated object, ``MISSING`` where there is none."""

    name: str
    annotation: Any
    default: Any
    span: Span
    positional: bool = True
    by_keyword: bool = True


@dataclass(eq=False, slots=True)
class Header:
    """A function as far as its ``def`` line tells."""

    name: str
    node: ast.FunctionDef
    source: SourceMap
    names: Names
    slots: tuple[Slot, ...]
    result: Any
    overload: Overload
    problems: list[Diagnostic] = field(default_factory=list)
    hopeless: bool = False  # not a function that could be scene code at all

    @property
    def span(self) -> Span:
        """The place of the function's name."""
        return self.source.header(self.node)


def read_header(overload: Overload) -> Header:
    """Parse the definition and evaluate what its first line says.

    Raises:
        CompileError: There is no source to parse.
    """
    python = overload.python
    node, source = parse_definition(overload.source, python.__code__.co_name)
    names = _names(python, overload.enclosing)
    header = Header(python.__name__, node, source, names, (), MISSING, overload)
    if _is_method(python):
        message = f"'{python.__qualname__}' is a method; scene code is plain functions"
        header.problems.append(Diagnostic(message, header.span, "move it out of the class"))
        header.hopeless = True
        return header
    if hasattr(python, "__wrapped__"):
        message = f"'{header.name}' is changed by another decorator first"
        hint = "put @func directly above def"
        header.problems.append(Diagnostic(message, _wrapped_span(python, header), hint))
        header.hopeless = True
        return header
    header.slots = tuple(_slots(header, python))
    if node.returns is not None:
        header.result = _evaluated(header, node.returns)
    return header


def _wrapped_span(python: FunctionType, header: Header) -> Span:
    """The place of the ``def`` that the author decorated."""
    inner = getattr(python, "__wrapped__", None)
    if not isinstance(inner, FunctionType):
        return header.span
    try:
        node, source = parse_definition(capture(inner), inner.__code__.co_name)
    except CompileError:
        return header.span
    return source.header(node)


def _is_method(python: FunctionType) -> bool:
    owner = python.__qualname__.rpartition(".")[0]
    return bool(owner) and not owner.endswith("<locals>")


def _slots(header: Header, python: FunctionType) -> list[Slot]:
    a = header.node.args
    for star, starred in (("*", a.vararg), ("**", a.kwarg)):
        if starred is not None:
            message = f"'{star}{starred.arg}' is not part of scene code"
            hint = "name each parameter"
            header.problems.append(Diagnostic(message, header.source.span(starred), hint))
    positional = [*a.posonlyargs, *a.args]
    given = python.__defaults__ or ()
    defaults: dict[str, Any] = dict(
        zip((p.arg for p in positional[len(positional) - len(given) :]), given, strict=True)
    )
    defaults.update(python.__kwdefaults__ or {})
    slots = []
    for arg in (*positional, *a.kwonlyargs):
        annotation: Any = MISSING
        if arg.annotation is not None:
            annotation = _evaluated(header, arg.annotation)
        else:
            message = f"parameter '{arg.arg}' has no type"
            hint = f"write {arg.arg}: vec3, or {arg.arg}: float"
            header.problems.append(Diagnostic(message, header.source.span(arg), hint))
        slots.append(
            Slot(
                arg.arg,
                annotation,
                defaults.get(arg.arg, MISSING),
                header.source.span(arg),
                arg not in a.kwonlyargs,
                arg not in a.posonlyargs,
            )
        )
    return slots


def _evaluated(header: Header, node: ast.expr) -> Any:
    try:
        return header.names.annotation(node)
    except SceneError as problem:
        span = header.source.span(node)
        diagnostic = problem.diagnostic
        header.problems.append(Diagnostic(diagnostic.message, span, diagnostic.hint))
        return MISSING


def _names(python: FunctionType, enclosing: Mapping[str, Any]) -> Names:
    module: Mapping[str, Any] = python.__globals__
    cells = dict(zip(python.__code__.co_freevars, python.__closure__ or (), strict=True))

    def find(name: str) -> tuple[bool, Any]:
        if name in cells:
            try:
                return True, cells[name].cell_contents
            except ValueError:  # the cell is still empty
                return False, None
        if name in module:
            return True, module[name]
        found = getattr(builtins, name, MISSING)
        return found is not MISSING, found

    def find_type(name: str) -> tuple[bool, Any]:
        # A type that only an annotation names is in no closure.
        exists, found = find(name) if name in cells or name not in enclosing else (False, None)
        return (True, enclosing[name]) if not exists and name in enclosing else (exists, found)

    def known() -> set[str]:
        return {*cells, *module, *vars(builtins)}

    return Names(find, lambda node: _annotation(node, find_type, known), known)


def _annotation(node: ast.expr, find: Any, known: Any) -> Any:
    """Evaluate an annotation as Python would, its names looked up by ``find``."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        text = node.value
        try:
            node = parse(text, mode="eval").body
        except (SyntaxError, RecursionError, ValueError):
            raise SceneError(f"'{text}' is not a type of scene code", None) from None
    names = [n.id for n in ast.walk(node) if isinstance(n, ast.Name)]
    scope: dict[str, Any] = {}
    for name in names:
        exists, found = find(name)
        if not exists:
            hint = did_you_mean(name, known())
            raise SceneError(f"'{name}' is not defined", None, hint)
        scope[name] = found
    if isinstance(node, ast.Name):
        return scope[node.id]
    try:
        code = compile(ast.Expression(node), "<annotation>", "eval", dont_inherit=True)
        return eval(code, {"__builtins__": {}}, scope)
    except Exception as error:
        message = f"'{ast.unparse(node)}' is not a type of scene code"
        raise SceneError(message, None, str(error) or None) from None
