"""Matching a call's arguments with a function's parameters.

Input: a header, the arguments and where they stand. Output: an expression of the
right type for each parameter, and what each type variable stands for.
"""

from __future__ import annotations

import ast
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

from distal.frontend.lowering.body import Body
from distal.frontend.objects import RefusedError, value_of
from distal.frontend.problems import FollowupError, SceneError, did_you_mean
from distal.frontend.signatures.annotations import (
    AnnotationError,
    UnboundVariableError,
    admits,
    choices,
    to_type,
)
from distal.frontend.signatures.signatures import MISSING, Header, Slot
from distal.frontend.types.coercion import (
    callable_hint,
    conversion_hint,
    fit,
    is_callable,
    natural_type,
    not_a_value,
    shown_type,
    vector_type,
)
from distal.frontend.values import Closure, Static, Value, Whole
from distal.ir.build import splat
from distal.ir.nodes import Expr
from distal.ir.types import FLOAT, INT, FunctionType, Scalar, Type, Vector


@dataclass(frozen=True, slots=True)
class Argument:
    """A value and the place it was written at; a default stands at the call."""

    value: Value
    node: ast.expr


@dataclass(frozen=True, slots=True)
class Match:
    """A call that fits: types and expressions by parameter, type variables bound."""

    types: tuple[Type, ...]
    args: tuple[Expr, ...]
    bindings: dict[TypeVar, Type]


def signature_of(header: Header) -> str:
    """``name(p: vec3, r: float)`` for hints."""
    parts = []
    for slot in header.slots:
        annotation = ast_annotation(header, slot.name)
        parts.append(f"{slot.name}: {annotation}" if annotation else slot.name)
    returns = header.node.returns
    result = f" -> {ast.unparse(returns)}" if returns is not None else ""
    return f"{header.name}({', '.join(parts)}){result}"


def ast_annotation(header: Header, name: str) -> str:
    """A parameter's annotation as it is written."""
    a = header.node.args
    for arg in (*a.posonlyargs, *a.args, *a.kwonlyargs):
        if arg.arg == name and arg.annotation is not None:
            return ast.unparse(arg.annotation)
    return ""


def pair(
    body: Body,
    header: Header,
    args: Sequence[Argument],
    keywords: dict[str, Argument],
    node: ast.expr,
) -> list[Argument]:
    """One argument for each parameter: by place, by keyword, by default."""
    name = header.name
    positional = [s for s in header.slots if s.positional]
    hint = signature_of(header)
    if len(args) > len(positional):
        count = f"{len(positional)} argument{'' if len(positional) == 1 else 's'}"
        raise body.problem(f"'{name}' takes {count}, got {len(args)}", node, hint)
    given = {s.name: a for s, a in zip(positional, args, strict=False)}
    known = {s.name for s in header.slots if s.by_keyword}
    for keyword, argument in keywords.items():
        if keyword not in known:
            close = did_you_mean(keyword, known) or hint
            raise body.problem(f"'{name}' has no parameter '{keyword}'", argument.node, close)
        if keyword in given:
            raise body.problem(f"'{name}' gets parameter '{keyword}' twice", argument.node, hint)
        given[keyword] = argument
    missing = [s.name for s in header.slots if s.name not in given and s.default is MISSING]
    if missing:
        names = ", ".join(f"'{m}'" for m in missing)
        plural = "" if len(missing) == 1 else "s"
        raise body.problem(f"'{name}' needs its parameter{plural} {names}", node, hint)
    return [given.get(s.name) or _default(body, header, s, node) for s in header.slots]


def _default(body: Body, header: Header, slot: Slot, node: ast.expr) -> Argument:
    try:
        value = value_of(slot.default, slot.name, body.program)
    except RefusedError as refused:
        message = f"the default of '{slot.name}' of '{header.name}': {refused.message}"
        raise SceneError(message, slot.span, refused.hint) from None
    return Argument(value, node)


def match(body: Body, header: Header, args: Sequence[Argument]) -> Match:
    """Bring paired arguments to the parameters' types.

    Raises:
        SceneError: An argument has another type.
    """
    bindings = _bind(body, header, args)
    types, fitted = [], []
    for slot, argument in zip(header.slots, args, strict=True):
        type = slot_type(body, header, slot, bindings)
        types.append(type)
        fitted.append(_fit_argument(body, header, slot, type, argument))
    return Match(tuple(types), tuple(fitted), bindings)


def slot_type(body: Any, header: Header, slot: Slot, bindings: dict[TypeVar, Type]) -> Type:
    """The type of a parameter."""
    if slot.annotation is MISSING:
        raise FollowupError
    try:
        adopted: Type = body.program.adopt(to_type(slot.annotation, bindings))
        return adopted
    except AnnotationError as error:
        raise SceneError(error.message, slot.span, error.hint) from None
    except UnboundVariableError as error:
        message = f"nothing tells what '{error.variable.__name__}' is in this call"
        raise SceneError(message, slot.span) from None


def _fit_argument(body: Body, header: Header, slot: Slot, type: Type, argument: Argument) -> Expr:
    value, node = argument.value, argument.node
    if isinstance(slot.annotation, TypeVar) and isinstance(type, Vector):
        scalar = Scalar(type.kind)
        if isinstance(value, Whole) or natural_type(value) is scalar:
            narrow = fit(body, value, scalar, node)
            if narrow is not None:
                return splat(narrow, type)
    fitted = fit(body, value, type, node)
    if fitted is not None:
        return fitted
    if isinstance(value, Static) and not (isinstance(type, FunctionType) and is_callable(value)):
        raise not_a_value(body, value.object, value.text, node)
    what = f"argument '{slot.name}' of '{header.name}'"
    hint = conversion_hint(value, type) or callable_hint(body, value)
    raise body.problem(f"{what} is {type}, not {shown_type(value)}", node, hint)


def _bind(body: Body, header: Header, args: Sequence[Argument]) -> dict[TypeVar, Type]:
    """What each type variable stands for: the widest type among the arguments that have it."""
    bindings: dict[TypeVar, Type] = {}
    groups: dict[TypeVar, list[Argument]] = {}
    for slot, argument in zip(header.slots, args, strict=True):
        if isinstance(slot.annotation, TypeVar):
            groups.setdefault(slot.annotation, []).append(argument)
    for variable, group in groups.items():
        bindings[variable] = _bound(body, header, variable, group)
    return bindings


def _bound(body: Body, header: Header, variable: TypeVar, group: list[Argument]) -> Type:
    firm: dict[Type, Argument] = {}
    for argument in group:
        if isinstance(argument.value, Static | Closure):
            continue
        if not isinstance(argument.value, Whole):
            natural = vector_type(argument.value) or natural_type(argument.value)
            if natural is not None:
                firm.setdefault(natural, argument)
    wide = [t for t in firm if not isinstance(t, Scalar)]
    if not firm:
        chosen: Type = INT if admits(variable, INT) else FLOAT
    elif len(wide) > 1 or (not wide and len(firm) > 1):
        names = " and ".join(map(str, firm))
        node = list(firm.values())[-1].node
        message = f"'{header.name}' takes one type for '{variable.__name__}', not {names}"
        raise body.problem(message, node)
    else:
        chosen = wide[0] if wide else next(iter(firm))
    if not admits(variable, chosen):
        node = group[0].node
        hint = f"{variable.__name__}: {choices(variable)}"
        raise body.problem(f"'{header.name}' does not take {chosen}", node, hint)
    return chosen


def closeness(header: Header, args: Sequence[Argument], body: Body) -> int | None:
    """How well arguments fit an overload; None when they do not."""
    total = 0
    try:
        bindings = _bind(body, header, args)
        for slot, argument in zip(header.slots, args, strict=True):
            score = _slot_closeness(body, header, slot, argument, bindings)
            if score is None:
                return None
            total += score
    except SceneError:
        return None
    return total


def _slot_closeness(
    body: Body, header: Header, slot: Slot, argument: Argument, bindings: dict[TypeVar, Type]
) -> int | None:
    type = slot_type(body, header, slot, bindings)
    value = argument.value
    if isinstance(type, FunctionType):
        return 2 if is_callable(value) else None
    if isinstance(value, Whole):
        return {INT.kind: 2, FLOAT.kind: 1}.get(type.kind, 0) if isinstance(type, Scalar) else None
    if natural_type(value) is type:
        return 3
    if isinstance(slot.annotation, TypeVar) and isinstance(type, Vector):
        return 1 if natural_type(value) is Scalar(type.kind) else None
    if isinstance(value, Static | Closure):
        return None
    return 1 if fit(body, value, type, argument.node) is not None else None
