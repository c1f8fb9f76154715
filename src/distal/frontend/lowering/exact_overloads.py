"""Overloads chosen by exact types: what a caller outside scene code asks for."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from distal.frontend.lowering.scene_calls import instantiate
from distal.frontend.problems import SceneError
from distal.frontend.signatures.annotations import (
    AnnotationError,
    UnboundVariableError,
    admits,
    to_type,
)
from distal.frontend.signatures.instances import Instance
from distal.frontend.signatures.matching import signature_of
from distal.frontend.signatures.signatures import MISSING, Header
from distal.ir.types import Type
from distal.lang.functions import Func

if TYPE_CHECKING:
    from distal.frontend.lowering.compilation import Program


def exact_instance(program: Program, func: Func, types: tuple[Type, ...]) -> Instance:
    """The overload whose parameters have exactly these types, lowered."""
    headers = [program.header(o) for o in func.overloads]
    for header in headers:
        bindings = exact_bindings(program, header, types)
        if bindings is not None:
            return instantiate(program, header, types, bindings, None)
    given = ", ".join(map(str, types)) or "nothing"
    hint = " or ".join(signature_of(h) for h in headers)
    raise SceneError(f"'{func.name}' does not take {given}", headers[0].span, hint)


def exact_bindings(
    program: Program, header: Header, types: tuple[Type, ...]
) -> dict[TypeVar, Type] | None:
    """What the type variables of a header stand for, or None where the types do not fit."""
    if len(header.slots) != len(types):
        return None
    bindings: dict[TypeVar, Type] = {}
    for slot, type in zip(header.slots, types, strict=True):
        if isinstance(slot.annotation, TypeVar) and (
            not admits(slot.annotation, type) or bindings.setdefault(slot.annotation, type) != type
        ):
            return None
    for slot, type in zip(header.slots, types, strict=True):
        try:
            if slot.annotation is not MISSING and (
                program.adopt(to_type(slot.annotation, bindings)) is not type
            ):
                return None
        except AnnotationError as error:
            raise SceneError(error.message, slot.span, error.hint) from None
        except UnboundVariableError:
            return None
    return bindings
