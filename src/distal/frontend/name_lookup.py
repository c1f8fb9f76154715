"""Look up the names in a function, for its body and its annotations.

Input: a Python function. Output: a ``NameLookup``. Handles no syntax except annotations.
"""

from __future__ import annotations

import ast
import builtins
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import FunctionType
from typing import Any, Final

from distal.error_codes import ErrorCode
from distal.frontend.parsing import parse
from distal.frontend.problems import SceneError, did_you_mean

_MISSING: Final = object()


@dataclass(frozen=True, slots=True)
class NameLookup:
    """Lookup of a function's closure, global and built-in names, and of its annotations.

    Attributes:
        find: Returns (whether the name exists, its object).
        annotation: Evaluates an annotation; raises a ``SceneError`` if it cannot.
        known: Returns all names, for suggestions.
    """

    find: Callable[[str], tuple[bool, Any]]
    annotation: Callable[[ast.expr], Any]
    known: Callable[[], set[str]]


def names_of(python: FunctionType, enclosing: Mapping[str, Any]) -> NameLookup:
    """Return the lookup of a function's names: its closure, its module, Python's built-ins.

    Args:
        python: The function.
        enclosing: Types that only annotations use. Python's closures do not contain them.
    """
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
        found = getattr(builtins, name, _MISSING)
        return found is not _MISSING, found

    def find_type(name: str) -> tuple[bool, Any]:
        # Python does not put a name that is used only in annotations into a closure.
        exists, found = find(name) if name in cells or name not in enclosing else (False, None)
        return (True, enclosing[name]) if not exists and name in enclosing else (exists, found)

    def known() -> set[str]:
        return {*cells, *module, *vars(builtins)}

    return NameLookup(find, lambda node: _annotation(node, find_type, known), known)


def _annotation(node: ast.expr, find: Any, known: Any) -> Any:
    """Evaluate an annotation as Python does; ``find`` looks up its names."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        text = node.value
        try:
            node = parse(text, mode="eval").body
        except (SyntaxError, RecursionError, ValueError):
            raise SceneError(
                ErrorCode.ANNOTATION, f"'{text}' is not a type of scene code", None
            ) from None
    names = [n.id for n in ast.walk(node) if isinstance(n, ast.Name)]
    scope: dict[str, Any] = {}
    for name in names:
        exists, found = find(name)
        if not exists:
            hint = did_you_mean(name, known())
            raise SceneError(ErrorCode.NAME, f"'{name}' is not defined", None, hint)
        scope[name] = found
    if isinstance(node, ast.Name):
        return scope[node.id]
    try:
        code = compile(ast.Expression(node), "<annotation>", "eval", dont_inherit=True)
        return eval(code, {"__builtins__": {}}, scope)
    except Exception as error:
        message = f"'{ast.unparse(node)}' is not a type of scene code"
        raise SceneError(ErrorCode.ANNOTATION, message, None, str(error) or None) from None
