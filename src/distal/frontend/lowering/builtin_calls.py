"""Calls of table rows: which signature fits the arguments, and what is splatted for it."""

from __future__ import annotations

import ast
import builtins
import math
from collections.abc import Sequence
from functools import cache
from typing import Any, Final

from distal.frontend.lowering.body import Body
from distal.frontend.objects import fit_constant, lang_value, number_of
from distal.frontend.problems import SceneError
from distal.frontend.types.coercion import fit, natural_type, settle, shown_type
from distal.frontend.types.powers import power
from distal.frontend.values import Closure, Display, Static, Value, Whole
from distal.ir.build import splat
from distal.ir.intrinsics import INTRINSICS, Intrinsic, python_functions
from distal.ir.nodes import Builtin, Expr
from distal.ir.signatures import Follows, Signature
from distal.ir.types import FLOAT, INT, UINT, Scalar, Type, Vector
from distal.lang.values import MatrixValue, VectorValue

# Python's own functions that mean an intrinsic, so that scene code needs no import for them.
PYTHON_FUNCTIONS: Final[dict[Any, Intrinsic]] = {
    getattr(module, function): INTRINSICS[name]
    for module, prefix in ((builtins, ""), (math, "math"))
    for function, name in python_functions(prefix).items()
    if hasattr(module, function)
}

# A whole-number literal is an int by itself, becomes a float readily, a uint only beside one.
_LITERAL_SCORES: Final[dict[Type, int]] = {INT: 2, FLOAT: 1, UINT: 0}


# What a result is called that depends on the type variable T.
_RESULTS: Final[dict[object, str]] = {
    Follows.T: "T",
    Follows.AS_BOOL: "a bool for each component",
    Follows.AS_INT: "an int for each component",
    Follows.AS_UINT: "a uint for each component",
    Follows.AS_FLOAT: "a float for each component",
    Follows.SQUARE: "the matrix with columns T",
}


@cache
def exact_instances(name: str) -> dict[tuple[Type, ...], Type]:
    """Every instance of a row: argument types to result."""
    instances: dict[tuple[Type, ...], Type] = {}
    for signature in INTRINSICS[name].signatures:
        for params, result in signature.instances():
            instances.setdefault(params, result)
    return instances


@cache
def _instances(name: str) -> tuple[tuple[tuple[Type, ...], Type, bool], ...]:
    """(parameter types, result, whether a scalar may stand for a vector), in the table's order."""
    return tuple(
        (params, result, _splats(signature))
        for signature in INTRINSICS[name].signatures
        for params, result in signature.instances()
    )


def _splats(signature: Signature) -> bool:
    """Scalars widen where the built-in works on each component, so takes scalars too."""
    componentwise = all(p is Follows.T for p in (*signature.params, signature.result))
    return componentwise and any(isinstance(t, Scalar) for t in signature.over)


def call_row(body: Body, row: Intrinsic, args: Sequence[Value], node: ast.expr) -> Value:
    """``row(args)``."""
    if row.name in ("min", "max") and len(args) > 2:
        return _nary(body, row, args, node)
    if len(args) != len(row.args):
        message = f"'{row.name}' takes {_counted(len(row.args), 'argument')}, got {len(args)}"
        raise body.problem(message, node, signature_text(row))
    if row.name == "pow" and not isinstance(args[1], Display | Static | Closure):
        return power(body, args[0], args[1], node)
    types = tuple(None if isinstance(a, Whole) else natural_type(a) for a in args)
    result = exact_instances(row.name).get(types)  # type: ignore[arg-type]  # None finds nothing
    if result is not None:
        settled = tuple(settle(body, a, node) for a in args)
        return Builtin(row.name, settled, result, span=body.span(node))
    best = _best(row.name, args)
    if best is None:
        raise _mismatch(body, row, args, node)
    params, result = best
    fitted = tuple(_fit(body, a, t, node) for a, t in zip(args, params, strict=True))
    return Builtin(row.name, fitted, result, span=body.span(node))


def _counted(count: int, noun: str) -> str:
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


def _nary(body: Body, row: Intrinsic, args: Sequence[Value], node: ast.expr) -> Value:
    """Min and max of many, left to right: the first of equals wins, as with two."""
    total = args[0]
    for arg in args[1:]:
        total = call_row(body, row, (total, arg), node)
        assert isinstance(total, Builtin)
        total = body.shallow(total)
    return total


def _best(name: str, args: Sequence[Value]) -> tuple[tuple[Type, ...], Type] | None:
    """The instance that needs the least conversion; the first of equals."""
    best, best_score = None, -1
    for params, result, splats in _instances(name):
        score = _score(args, params, splats=splats)
        if score is not None and score > best_score:
            best, best_score = (params, result), score
    return best


def _score(args: Sequence[Value], params: Sequence[Type], *, splats: bool) -> int | None:
    total, exact = 0, False
    for arg, type in zip(args, params, strict=True):
        if isinstance(arg, Whole):
            score = _LITERAL_SCORES.get(type)
            if score is None and splats and isinstance(type, Vector):
                score = 0
        elif isinstance(arg, Display):
            score = 3 if _display_fits(arg, type) else None
            exact = exact or score is not None
        else:
            given = natural_type(arg)
            score = 3 if given is type else None
            exact = exact or score is not None
            if score is None and splats and isinstance(type, Vector):
                score = 1 if given is Scalar(type.kind) else None
        if score is None:
            return None
        total += score
    # Something must say that vectors or unsigned numbers are meant.
    plain = all(p is FLOAT or p is INT for p in params)
    return total if exact or plain else None


def _display_fits(display: Display, type: Type) -> bool:
    if not isinstance(type, Vector) or len(display.items) != type.size:
        return natural_type(display) is type
    if display.is_list and not display.captured:
        return False
    scalar = Scalar(type.kind)
    return all(isinstance(i, Whole) or natural_type(i) is scalar for i in display.items)


def _fit(body: Body, value: Value, type: Type, node: ast.expr) -> Expr:
    if isinstance(type, Vector) and isinstance(natural_type(value), Scalar):
        return splat(_fit(body, value, Scalar(type.kind), node), type)
    fitted = fit(body, value, type, node)
    assert fitted is not None
    return fitted


def call_with_constants(row: Intrinsic, args: Sequence[Any]) -> Expr | None:
    """The call of a row with Python numbers, vectors or matrices; None where it takes no such.

    Raises:
        RefusedError: An argument is no constant of scene code.
    """
    values = [_plain_value(a, f"an argument of {row.name}") for a in args]
    known = [v for v in values if v is not None]
    if len(known) < len(values) or len(values) != len(row.args):
        return None
    best = _best(row.name, known)
    if best is None:
        return None
    params, result = best
    fitted = [_fit_constant(v, t) for v, t in zip(known, params, strict=True)]
    exprs = tuple(f for f in fitted if f is not None)
    return Builtin(row.name, exprs, result) if len(exprs) == len(fitted) else None


def _plain_value(arg: Any, text: str) -> Value | None:
    if isinstance(arg, VectorValue | MatrixValue):
        return lang_value(arg, text)
    return number_of(arg, text)


def _fit_constant(value: Value, type: Type) -> Expr | None:
    if isinstance(type, Vector) and isinstance(natural_type(value), Scalar):
        scalar = fit_constant(value, Scalar(type.kind))
        return None if scalar is None else splat(scalar, type)
    return fit_constant(value, type)


def _mismatch(body: Body, row: Intrinsic, args: Sequence[Value], node: ast.expr) -> SceneError:
    for arg in args:
        if isinstance(arg, Static | Closure):
            settle(body, arg, node)
    types = [shown_type(a) for a in args]
    distinct = list(dict.fromkeys(types))
    shown = distinct[0] if len(distinct) == 1 else ", ".join(types)
    return body.problem(f"'{row.name}' does not take {shown}", node, signature_text(row))


def signature_text(row: Intrinsic) -> str:
    """A row in an author's words: ``length(v) -> float, v: vec2 | vec3 | vec4``."""
    signature = row.signatures[0]
    over = " | ".join(dict.fromkeys(str(t) for s in row.signatures for t in s.over))
    result = _RESULTS.get(signature.result, str(signature.result))
    if len(row.args) == 1 and result != "T":
        (only,) = row.args
        return f"{row.name}({only}) -> {result}, {only}: {over}"
    patterns = zip(row.args, signature.params, strict=True)
    params = ", ".join(f"{n}: {'T' if p is Follows.T else p}" for n, p in patterns)
    return f"{row.name}({params}) -> {result}, T: {over}"
