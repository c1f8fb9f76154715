"""Error messages for syntax that is not part of scene code, with hints."""

from __future__ import annotations

import ast
from typing import Final

from distal.error_codes import ErrorCode
from distal.frontend.function_body import FunctionBody
from distal.frontend.problems import SceneError
from distal.frontend.source import Node

# Syntax node -> (what the author wrote, hint).
_REFUSED: Final[dict[type[ast.AST], tuple[str, str | None]]] = {
    ast.JoinedStr: ("text", None),
    ast.ListComp: ("a list comprehension", "fill an array in a loop: values = [0.0] * n"),
    ast.SetComp: ("a set comprehension", None),
    ast.DictComp: ("a dict comprehension", None),
    ast.GeneratorExp: ("a generator expression", "write a for loop"),
    ast.Dict: ("a dict", "use a struct or an array"),
    ast.Set: ("a set", "use an array"),
    ast.NamedExpr: ("':='", "assign on a line of its own"),
    ast.Await: ("'await'", None),
    ast.Yield: ("'yield'", "return one value"),
    ast.YieldFrom: ("'yield from'", "return one value"),
    ast.Starred: ("'*'", None),
    ast.Slice: ("a slice", None),
    ast.Assert: ("'assert'", None),
    ast.Raise: ("'raise'", "return a value that shows the mistake"),
    ast.Try: ("'try'", "nothing fails in scene code"),
    ast.With: ("'with'", None),
    ast.AsyncWith: ("'async with'", None),
    ast.AsyncFor: ("'async for'", None),
    ast.AsyncFunctionDef: ("an async function", None),
    ast.ClassDef: ("a class inside a function", "define a @struct outside"),
    ast.Global: ("'global'", "a function's only effect is its value: return it"),
    ast.Nonlocal: ("'nonlocal'", "a function's only effect is its value: return it"),
    ast.Import: ("'import' inside a function", "import at the top of the file"),
    ast.ImportFrom: ("'import' inside a function", "import at the top of the file"),
    ast.Delete: ("'del'", None),
    ast.Match: ("'match'", "write if and elif"),
}


def refusal(body: FunctionBody, node: Node) -> SceneError:
    """Return the error for syntax that is not part of scene code."""
    if isinstance(node, ast.Constant):
        return _constant(body, node)
    what, hint = _REFUSED.get(type(node), (f"'{type(node).__name__}'", None))
    return body.problem(ErrorCode.LANGUAGE, f"{what} is not part of scene code", node, hint)


def _constant(body: FunctionBody, node: ast.Constant) -> SceneError:
    match node.value:
        case str() | bytes():
            return body.problem(ErrorCode.LANGUAGE, "text is not part of scene code", node)
        case None:
            return body.problem(
                ErrorCode.LANGUAGE,
                "None is not part of scene code",
                node,
                "every value is a number",
            )
        case complex():
            return body.problem(
                ErrorCode.LANGUAGE, "a complex number is not part of scene code", node, "use a vec2"
            )
        case _:
            return body.problem(
                ErrorCode.LANGUAGE, f"{node.value!r} is not part of scene code", node
            )
