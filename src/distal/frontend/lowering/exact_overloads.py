"""Choose an overload by exact argument types, for callers outside scene code."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from distal.error_codes import ErrorCode
from distal.frontend.lowering.instances import Instance
from distal.frontend.lowering.scene_calls import instantiate
from distal.frontend.problems import SceneError, must_be_call
from distal.frontend.signatures.annotations import (
    AnnotationError,
    UnboundVariableError,
    admits,
    to_type,
)
from distal.frontend.signatures.signatures import MISSING, FunctionSignature, element_annotation
from distal.ir.types import Array, Type
from distal.lang.functions import Func

if TYPE_CHECKING:
    from distal.frontend.lowering.compilation import Compilation


def exact_instance(compilation: Compilation, func: Func, types: tuple[Type, ...]) -> Instance:
    """Return the lowered overload whose parameters have exactly these types.

    Args:
        compilation: The compilation that gets the function.
        func: The function.
        types: The argument types.

    Raises:
        SceneError: No overload takes these types.
    """
    signatures = [compilation.signature(o) for o in func.overloads]
    for signature in signatures:
        signature = signature.collecting(_given(signature, types))
        bindings = exact_bindings(compilation, signature, types)
        if bindings is not None:
            return instantiate(compilation, signature, types, bindings, None)
    message = must_be_call(func.name, (s.text() for s in signatures), types)
    raise SceneError(ErrorCode.TYPE, message, signatures[0].span)


def _given(signature: FunctionSignature, types: tuple[Type, ...]) -> int:
    """Return how many positional arguments a call with these types of parameters had."""
    count = 0
    for parameter, type in zip(signature.parameters, types, strict=False):
        if parameter.collects and isinstance(type, Array):
            count += type.length
        count += parameter.positional
    return count


def exact_bindings(
    compilation: Compilation, signature: FunctionSignature, types: tuple[Type, ...]
) -> dict[TypeVar, Type] | None:
    """Return the types bound to a signature's type variables; None if the types do not match.

    Args:
        compilation: The compilation, for the names of structs.
        signature: The overload.
        types: The argument types.

    Raises:
        SceneError: An annotation is not a type of scene code.
    """
    if len(signature.parameters) != len(types):
        return None
    bindings: dict[TypeVar, Type] = {}
    for parameter, type in zip(signature.parameters, types, strict=True):
        variable = element_annotation(parameter)
        if parameter.collects and isinstance(type, Array):
            type = type.element
        if isinstance(variable, TypeVar) and (
            not admits(variable, type) or bindings.setdefault(variable, type) != type
        ):
            return None
    for parameter, type in zip(signature.parameters, types, strict=True):
        try:
            if parameter.annotation is not MISSING and (
                compilation.adopt(to_type(parameter.annotation, bindings)) is not type
            ):
                return None
        except AnnotationError as error:
            raise SceneError(
                ErrorCode.ANNOTATION, error.message, parameter.span, error.hint
            ) from None
        except UnboundVariableError:
            return None
    return bindings
