"""Expressions of parameters and time as Python code that evaluates to an equal expression.

Input: an expression. Output: code such as ``0.5 * slider('Size', 1.0, 0.0, 2.0) + sin(time)``, in
terms of the names of ``distal.lang``; None if it is too long, or holds what no such code makes.
"""

from __future__ import annotations

from typing import Any, Final

from distal.ir import nodes as n
from distal.ir.walk import nodes_in

_MOST_LETTERS: Final = 300
_PREFIX: Final = {n.UnaryOp.NEGATE: "-", n.UnaryOp.NOT: "~"}
_COMPARISONS: Final = ("<", "<=", ">", ">=")


def expression_text(root: n.Expr, parameters: Any) -> str | None:
    """Return the code of an expression.

    Args:
        root: Its node.
        parameters: The parameters that it reads.
    """
    uniforms = {parameter.name: repr(parameter) for parameter in parameters}
    texts: dict[n.Expr, str] = {}
    for node in nodes_in(root):  # operands before users
        text = _text(node, texts, {**uniforms, n.FRAME_TIME: "time"})
        if text is None or len(text) > _MOST_LETTERS:
            return None
        texts[node] = text
    if isinstance(root, n.Cast):
        return None
    has_brackets = isinstance(root, n.Binary | n.Compare | n.Unary)
    return texts[root][1:-1] if has_brackets else _whole(root, texts)


def _whole(node: n.Expr, texts: dict[n.Expr, str]) -> str:
    """Return the code of a node where no operator makes a vector of a number."""
    return f"{node.type}({texts[node]})" if isinstance(node, n.Splat) else texts[node]


def _text(node: n.Expr, texts: dict[n.Expr, str], uniforms: dict[str, str]) -> str | None:
    """Return the code of a node whose operands have theirs; None if there is none."""
    match node:
        case n.Const():
            return repr(node.value)
        case n.Uniform():
            return uniforms.get(node.name)
        case n.Unary() if node.op in _PREFIX:
            return f"({_PREFIX[node.op]}{texts[node.operand]})"
        case n.Binary(op=n.BinaryOp.DIV, lhs=n.Cast(), rhs=n.Cast()):
            return f"({texts[node.lhs]} / {texts[node.rhs]})"
        case n.Binary() if not isinstance(node.lhs, n.Cast) and not isinstance(node.rhs, n.Cast):
            return f"({texts[node.lhs]} {node.op.value} {texts[node.rhs]})"
        case n.Compare() if node.op.value in _COMPARISONS:
            return f"({texts[node.lhs]} {node.op.value} {texts[node.rhs]})"
        case n.Select():
            yes, no = _whole(node.yes, texts), _whole(node.no, texts)
            return f"select({texts[node.condition]}, {yes}, {no})"
        case n.Builtin():
            return f"{node.name}({', '.join(texts[arg] for arg in node.args)})"
        case n.Compose():
            return f"{node.type}({', '.join(texts[part] for part in node.parts)})"
        case n.Swizzle():
            return f"{_whole(node.base, texts)}.{node.lanes}"
        case n.Splat() | n.Cast():  # made by the operator that reads them
            return texts[node.value]
        case _:
            return None
