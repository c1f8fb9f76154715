"""Match the arguments of a call with the parameters of a function.

Input: a signature, the arguments and their source nodes. Output: an expression of the required
type for each parameter, and the type bound to each type variable.
"""

from __future__ import annotations

import ast
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

from distal.error_codes import ErrorCode
from distal.frontend.function_body import FunctionBody
from distal.frontend.problems import FollowupError, SceneError, did_you_mean, must_be, must_match
from distal.frontend.signatures.annotations import (
    AnnotationError,
    UnboundVariableError,
    admits,
    choices,
    to_type,
)
from distal.frontend.signatures.signatures import (
    MISSING,
    FunctionSignature,
    SignatureParameter,
    element_annotation,
)
from distal.frontend.types.coercion import (
    coerce,
    default_type,
    is_callable,
    vector_type,
    wrong_type,
)
from distal.frontend.types.python_objects import RefusedError, value_of
from distal.frontend.values import Closure, SequenceValue, Static, Value, Whole
from distal.ir.build import splat
from distal.ir.nodes import Construct, Expr
from distal.ir.types import FLOAT, INT, Array, FunctionType, Scalar, Type, Vector


@dataclass(frozen=True, slots=True)
class Argument:
    """An argument.

    Attributes:
        value: Its value.
        node: Its source node; a default has the node of the call.
        parts: The arguments that a parameter ``*values`` collects.
    """

    value: Value
    node: ast.expr
    parts: tuple[Argument, ...] = ()


@dataclass(frozen=True, slots=True)
class Match:
    """A matching call: the type and the expression of each parameter, and bound type variables."""

    types: tuple[Type, ...]
    args: tuple[Expr, ...]
    bindings: dict[TypeVar, Type]


def pair(
    body: FunctionBody,
    signature: FunctionSignature,
    args: Sequence[Argument],
    keywords: dict[str, Argument],
    node: ast.expr,
) -> list[Argument]:
    """Return one argument for each parameter: positional, by keyword, or the default.

    Args:
        body: The calling function.
        signature: The called function.
        args: The positional arguments.
        keywords: The keyword arguments, by name.
        node: The call.

    Raises:
        SceneError: An argument is missing, unknown, given twice, or one too many.
    """
    name = signature.name
    positional = [p for p in signature.parameters if p.positional]
    hint = signature.text()
    collecting = next((p for p in signature.parameters if p.collects), None)
    if len(args) > len(positional) and collecting is None:
        count = f"{len(positional)} argument{'' if len(positional) == 1 else 's'}"
        raise body.problem(ErrorCode.CALL, f"'{name}' takes {count}, got {len(args)}", node, hint)
    given = {p.name: a for p, a in zip(positional, args, strict=False)}
    if collecting is not None and len(args) > len(positional):
        rest = args[len(positional) :]
        values = SequenceValue(tuple(a.value for a in rest), is_list=True)
        given[collecting.name] = Argument(values, rest[0].node, tuple(rest))
    known = {p.name for p in signature.parameters if p.by_keyword}
    for keyword, argument in keywords.items():
        if keyword not in known:
            close = did_you_mean(keyword, known) or hint
            raise body.problem(
                ErrorCode.CALL, f"'{name}' has no parameter '{keyword}'", argument.node, close
            )
        if keyword in given:
            raise body.problem(
                ErrorCode.CALL, f"'{name}' gets parameter '{keyword}' twice", argument.node, hint
            )
        given[keyword] = argument
    missing = [p.name for p in signature.parameters if p.name not in given and p.default is MISSING]
    if missing:
        names = ", ".join(f"'{m}'" for m in missing)
        plural = "" if len(missing) == 1 else "s"
        raise body.problem(
            ErrorCode.CALL, f"'{name}' needs its parameter{plural} {names}", node, hint
        )
    return [given.get(p.name) or _default(body, signature, p, node) for p in signature.parameters]


def _default(
    body: FunctionBody, signature: FunctionSignature, parameter: SignatureParameter, node: ast.expr
) -> Argument:
    try:
        value = value_of(parameter.default, parameter.name, body.compilation)
    except RefusedError as refused:
        message = f"the default of '{parameter.name}' of '{signature.name}': {refused.message}"
        raise SceneError(ErrorCode.VALUE, message, parameter.span, refused.hint) from None
    return Argument(value, node)


def match(body: FunctionBody, signature: FunctionSignature, args: Sequence[Argument]) -> Match:
    """Coerce paired arguments to the types of the parameters.

    Args:
        body: The calling function.
        signature: The called function.
        args: One argument for each parameter (see ``pair``).

    Raises:
        SceneError: An argument cannot be coerced to its parameter's type.
    """
    bindings = _bind(body, signature, args)

    def coerced(pair: tuple[SignatureParameter, Argument]) -> tuple[Type, Expr]:
        type = parameter_type(body, pair[0], bindings)
        return type, _coerce_argument(body, signature, pair[0], type, pair[1])

    pairs = body.each(coerced, zip(signature.parameters, args, strict=True))
    return Match(tuple(t for t, _ in pairs), tuple(e for _, e in pairs), bindings)


def parameter_type(
    body: FunctionBody, parameter: SignatureParameter, bindings: dict[TypeVar, Type]
) -> Type:
    """Return the type of a parameter.

    Args:
        body: The calling function.
        parameter: The parameter.
        bindings: The types bound to the type variables.

    Raises:
        FollowupError: The parameter has no annotation.
        SceneError: The annotation is not a type of scene code.
    """
    if parameter.annotation is MISSING:
        raise FollowupError
    try:
        return body.compilation.adopt(to_type(parameter.annotation, bindings))
    except AnnotationError as error:
        raise SceneError(ErrorCode.ANNOTATION, error.message, parameter.span, error.hint) from None
    except UnboundVariableError as error:
        message = f"the type '{error.variable.__name__}' is not known in this call"
        raise SceneError(ErrorCode.ANNOTATION, message, parameter.span) from None


def _coerce_argument(
    body: FunctionBody,
    signature: FunctionSignature,
    parameter: SignatureParameter,
    type: Type,
    argument: Argument,
) -> Expr:
    if argument.parts and isinstance(type, Array):
        one = replace(parameter, annotation=element_annotation(parameter), collects=False)
        element = type.element
        parts = body.each(
            lambda a: _coerce_argument(body, signature, one, element, a), argument.parts
        )
        return Construct(tuple(parts), type)
    value, node = argument.value, argument.node
    if isinstance(parameter.annotation, TypeVar) and isinstance(type, Vector):
        scalar = Scalar(type.kind)
        if isinstance(value, Whole) or default_type(value) is scalar:
            narrow = coerce(body, value, scalar, node)
            if narrow is not None:
                return splat(narrow, type)
    coerced = coerce(body, value, type, node)
    if coerced is not None:
        return coerced
    what = f"argument '{parameter.name}' of '{signature.name}'"
    raise wrong_type(body, value, type, node, what)


def _bind(
    body: FunctionBody, signature: FunctionSignature, args: Sequence[Argument]
) -> dict[TypeVar, Type]:
    """Bind each type variable to the widest type among the arguments annotated with it."""
    bindings: dict[TypeVar, Type] = {}
    groups: dict[TypeVar, list[Argument]] = {}
    for parameter, argument in zip(signature.parameters, args, strict=True):
        annotation = element_annotation(parameter)
        if isinstance(annotation, TypeVar):
            groups.setdefault(annotation, []).extend(argument.parts or (argument,))
    for variable, group in groups.items():
        bindings[variable] = _bound(body, signature, variable, group)
    return bindings


def _bound(
    body: FunctionBody, signature: FunctionSignature, variable: TypeVar, group: list[Argument]
) -> Type:
    concrete: dict[Type, Argument] = {}
    for argument in group:
        if isinstance(argument.value, Static | Closure):
            continue
        if not isinstance(argument.value, Whole):
            default = vector_type(argument.value) or default_type(argument.value)
            if default is not None:
                concrete.setdefault(default, argument)
    wide = [t for t in concrete if not isinstance(t, Scalar)]
    if not concrete:
        chosen: Type = INT if admits(variable, INT) else FLOAT
    elif len(wide) > 1 or (not wide and len(concrete) > 1):
        node = list(concrete.values())[-1].node
        what = f"the arguments of '{signature.name}' that are '{variable.__name__}'"
        raise body.problem(ErrorCode.TYPE, must_match(what, concrete), node)
    else:
        chosen = wide[0] if wide else next(iter(concrete))
    if not admits(variable, chosen):
        what = f"an argument of '{signature.name}' that is '{variable.__name__}'"
        raise body.problem(ErrorCode.TYPE, must_be(what, choices(variable), chosen), group[0].node)
    return chosen


def closeness(
    signature: FunctionSignature, args: Sequence[Argument], body: FunctionBody
) -> int | None:
    """Return a score of how closely arguments match an overload; None if they do not match.

    Args:
        signature: The overload.
        args: One argument for each parameter (see ``pair``).
        body: The calling function.
    """
    total = 0
    try:
        bindings = _bind(body, signature, args)
        for parameter, argument in zip(signature.parameters, args, strict=True):
            score = _parameter_closeness(body, parameter, argument, bindings)
            if score is None:
                return None
            total += score
    except SceneError:
        return None
    return total


def _parameter_closeness(
    body: FunctionBody,
    parameter: SignatureParameter,
    argument: Argument,
    bindings: dict[TypeVar, Type],
) -> int | None:
    type = parameter_type(body, parameter, bindings)
    if argument.parts and isinstance(type, Array):
        one = replace(parameter, annotation=element_annotation(parameter), collects=False)
        scores = [_parameter_closeness(body, one, a, bindings) for a in argument.parts]
        known = [s for s in scores if s is not None]
        return min(known) if len(known) == len(scores) else None
    value = argument.value
    if isinstance(type, FunctionType):
        return 2 if is_callable(value) else None
    if isinstance(value, Whole):
        return {INT.kind: 2, FLOAT.kind: 1}.get(type.kind, 0) if isinstance(type, Scalar) else None
    if default_type(value) is type:
        return 3
    if isinstance(parameter.annotation, TypeVar) and isinstance(type, Vector):
        return 1 if default_type(value) is Scalar(type.kind) else None
    if isinstance(value, Static | Closure):
        return None
    return 1 if coerce(body, value, type, argument.node) is not None else None
