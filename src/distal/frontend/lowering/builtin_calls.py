"""Lower calls of built-ins: choose a signature for the arguments, and widen scalars to vectors."""

from __future__ import annotations

import ast
import builtins
import math
from collections.abc import Sequence
from functools import cache
from typing import Any, Final

from distal.error_codes import ErrorCode
from distal.frontend.function_body import FunctionBody
from distal.frontend.problems import SceneError, must_be, must_match, one_of
from distal.frontend.types.coercion import coerce, default_type, shown_type, with_default_type
from distal.frontend.types.powers import power
from distal.frontend.types.python_objects import coerce_constant, lang_value, number_of
from distal.frontend.values import Closure, SequenceValue, Static, Value, Whole
from distal.ir.build import splat
from distal.ir.intrinsics import INTRINSICS, Intrinsic, python_functions
from distal.ir.nodes import Builtin, Expr
from distal.ir.signatures import Follows, Signature
from distal.ir.types import FLOAT, INT, UINT, Scalar, Type, Vector
from distal.lang.values import MatrixValue, VectorValue

# Functions of Python that are translated to an intrinsic, so scene code needs no import for them.
PYTHON_FUNCTIONS: Final[dict[Any, Intrinsic]] = {
    getattr(module, function): INTRINSICS[name]
    for module, prefix in ((builtins, ""), (math, "math"))
    for function, name in python_functions(prefix).items()
    if hasattr(module, function)
}

# A whole-number literal is preferably an int, then a float; a uint only beside another uint.
_LITERAL_SCORES: Final[dict[Type, int]] = {INT: 2, FLOAT: 1, UINT: 0}


# How a signature text describes a result that depends on the type variable T.
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
    """Return every instance of a built-in: argument types to result type."""
    instances: dict[tuple[Type, ...], Type] = {}
    for signature in INTRINSICS[name].signatures:
        for params, result in signature.instances():
            instances.setdefault(params, result)
    return instances


@cache
def _instances(name: str) -> tuple[tuple[tuple[Type, ...], Type, bool], ...]:
    """Return (parameter types, result, whether scalars widen to vectors), in the table's order."""
    return tuple(
        (params, result, _splats(signature))
        for signature in INTRINSICS[name].signatures
        for params, result in signature.instances()
    )


def _splats(signature: Signature) -> bool:
    """Return whether scalars widen: the built-in is componentwise and also accepts scalars."""
    componentwise = all(p is Follows.T for p in (*signature.params, signature.result))
    return componentwise and any(isinstance(t, Scalar) for t in signature.over)


def call_builtin(
    body: FunctionBody, intrinsic: Intrinsic, args: Sequence[Value], node: ast.expr
) -> Value:
    """Lower ``intrinsic(args)``.

    Args:
        body: The calling function.
        intrinsic: The built-in.
        args: The lowered arguments.
        node: The call.

    Raises:
        SceneError: The number of arguments is wrong, or no signature accepts them.
    """
    if intrinsic.name in ("min", "max") and len(args) > 2:
        return _nary(body, intrinsic, args, node)
    if len(args) != len(intrinsic.args):
        message = (
            f"'{intrinsic.name}' takes {_counted(len(intrinsic.args), 'argument')}, got {len(args)}"
        )
        two_of_atan = intrinsic.name == "atan" and len(args) == 2
        hint = "atan2(y, x)" if two_of_atan else signature_text(intrinsic)
        raise body.problem(ErrorCode.CALL, message, node, hint)
    if intrinsic.name == "pow" and not isinstance(args[1], SequenceValue | Static | Closure):
        return power(body, args[0], args[1], node)
    types = tuple(None if isinstance(a, Whole) else default_type(a) for a in args)
    result = exact_instances(intrinsic.name).get(types)  # type: ignore[arg-type]  # None finds nothing
    if result is not None:
        typed = tuple(with_default_type(body, a, node) for a in args)
        return Builtin(intrinsic.name, typed, result, span=body.span(node))
    best = _best(intrinsic.name, args)
    if best is None:
        raise _mismatch(body, intrinsic, args, node)
    params, result = best
    coerced = tuple(_coerce(body, a, t, node) for a, t in zip(args, params, strict=True))
    return Builtin(intrinsic.name, coerced, result, span=body.span(node))


def _counted(count: int, noun: str) -> str:
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


def _nary(body: FunctionBody, intrinsic: Intrinsic, args: Sequence[Value], node: ast.expr) -> Value:
    """Lower min or max of more than two arguments, left to right: the first of equal ones wins."""
    total = args[0]
    for arg in args[1:]:
        total = call_builtin(body, intrinsic, (total, arg), node)
        assert isinstance(total, Builtin)
        total = body.shallow(total)
    return total


def _best(name: str, args: Sequence[Value]) -> tuple[tuple[Type, ...], Type] | None:
    """Return the instance with the least conversion; the first one if several are equal."""
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
        elif isinstance(arg, SequenceValue):
            score = 3 if _sequence_matches(arg, type) else None
            exact = exact or score is not None
        else:
            given = default_type(arg)
            score = 3 if given is type else None
            exact = exact or score is not None
            if score is None and splats and isinstance(type, Vector):
                score = 1 if given is Scalar(type.kind) else None
        if score is None:
            return None
        total += score
    # If all arguments are literals, only float and int match: vectors and unsigned numbers need at
    # least one argument of the type.
    plain = all(p is FLOAT or p is INT for p in params)
    return total if exact or plain else None


def _sequence_matches(sequence: SequenceValue, type: Type) -> bool:
    if not isinstance(type, Vector) or len(sequence.items) != type.size:
        return default_type(sequence) is type
    if sequence.is_list and not sequence.captured:
        return False
    scalar = Scalar(type.kind)
    return all(isinstance(i, Whole) or default_type(i) is scalar for i in sequence.items)


def _coerce(body: FunctionBody, value: Value, type: Type, node: ast.expr) -> Expr:
    if isinstance(type, Vector) and isinstance(default_type(value), Scalar):
        return splat(_coerce(body, value, Scalar(type.kind), node), type)
    coerced = coerce(body, value, type, node)
    assert coerced is not None
    return coerced


def call_with_constants(intrinsic: Intrinsic, args: Sequence[Any]) -> Expr | None:
    """Return a call of a built-in with Python numbers, vectors or matrices; None if none matches.

    Raises:
        RefusedError: An argument is not a constant of scene code.
    """
    values = [_plain_value(a, f"an argument of {intrinsic.name}") for a in args]
    known = [v for v in values if v is not None]
    if len(known) < len(values) or len(values) != len(intrinsic.args):
        return None
    best = _best(intrinsic.name, known)
    if best is None:
        return None
    params, result = best
    coerced = [_coerce_constant(v, t) for v, t in zip(known, params, strict=True)]
    exprs = tuple(f for f in coerced if f is not None)
    return Builtin(intrinsic.name, exprs, result) if len(exprs) == len(coerced) else None


def _plain_value(arg: Any, text: str) -> Value | None:
    if isinstance(arg, VectorValue | MatrixValue):
        return lang_value(arg, text)
    return number_of(arg, text)


def _coerce_constant(value: Value, type: Type) -> Expr | None:
    if isinstance(type, Vector) and isinstance(default_type(value), Scalar):
        scalar = coerce_constant(value, Scalar(type.kind))
        return None if scalar is None else splat(scalar, type)
    return coerce_constant(value, type)


def _mismatch(
    body: FunctionBody, intrinsic: Intrinsic, args: Sequence[Value], node: ast.expr
) -> SceneError:
    for arg in args:
        if isinstance(arg, Static | Closure):
            with_default_type(body, arg, node)
    hint = signature_text(intrinsic)
    for i, (arg, name) in enumerate(zip(args, intrinsic.args, strict=True)):
        of_arg = {params[i]: splats for params, _, splats in _instances(intrinsic.name)}
        if all(_score([arg], [t], splats=splats) is None for t, splats in of_arg.items()):
            what = "the argument" if len(args) == 1 else f"argument '{name}'"
            message = must_be(
                f"{what} of '{intrinsic.name}'", one_of(map(str, of_arg)), shown_type(arg)
            )
            return body.problem(ErrorCode.TYPE, message, node, hint)
    types = map(shown_type, args)
    return body.problem(
        ErrorCode.TYPE, must_match(f"the arguments of '{intrinsic.name}'", types), node, hint
    )


def signature_text(intrinsic: Intrinsic) -> str:
    """Return a built-in's signature for hints: ``length(v) -> float, v: vec2 | vec3 | vec4``."""
    signature = intrinsic.signatures[0]
    over = " | ".join(dict.fromkeys(str(t) for s in intrinsic.signatures for t in s.over))
    result = _RESULTS.get(signature.result, str(signature.result))
    if len(intrinsic.args) == 1 and result != "T":
        (only,) = intrinsic.args
        return f"{intrinsic.name}({only}) -> {result}, {only}: {over}"
    patterns = zip(intrinsic.args, signature.params, strict=True)
    params = ", ".join(f"{n}: {'T' if p is Follows.T else p}" for n, p in patterns)
    return f"{intrinsic.name}({params}) -> {result}, T: {over}"
