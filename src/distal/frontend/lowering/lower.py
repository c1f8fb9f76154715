"""Lower a function, an object or a built-in to a module of IR.

Input: a function decorated with ``@func`` or ``@image``, an object or a built-in, and argument
types. Output: a module, or one ``CompileError`` with all errors. Does not depend on targets.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias, TypeVar

from distal.diagnostics import CompileError, Diagnostic
from distal.error_codes import ErrorCode
from distal.frontend.freshness import Captured
from distal.frontend.lowering.assembly import TABLE_FROM
from distal.frontend.lowering.builtin_calls import exact_instances, signature_text
from distal.frontend.lowering.compilation import Compilation
from distal.frontend.lowering.exact_overloads import exact_bindings, exact_instance
from distal.frontend.lowering.lambda_lifting import builtin_function
from distal.frontend.lowering.scene_calls import instantiate
from distal.frontend.problems import FollowupError, SceneError, must_be, must_be_call
from distal.frontend.signatures.annotations import AnnotationError, UnboundVariableError, to_type
from distal.frontend.signatures.signatures import MISSING
from distal.ir.collection import paused_collection
from distal.ir.nodes import EntryKind, Function, Module
from distal.ir.types import FRAME, VEC3, VEC4, FunctionType, Type, is_static
from distal.lang.composed import Composed
from distal.lang.functions import Func, Image
from distal.lang.names import LangFunction

R = TypeVar("R")

# The objects that can be lowered.
SceneCode: TypeAlias = Func | Composed | LangFunction


def lower(
    obj: SceneCode,
    arg_types: tuple[Type, ...] | None = None,
    *,
    table_from: int | None = TABLE_FROM,
) -> Module:
    """Lower an image, or a function for the types of its arguments.

    Args:
        obj: A function decorated with ``@image`` or ``@func``, a shape, a scene, or a built-in.
        arg_types: The argument types; they select the overload and bind type variables. None if
            the annotations alone determine the types.
        table_from: With so many parts or more, an object may put the numbers of its parts into
            buffers; None if the target has none.

    Raises:
        CompileError: The function, or a function that it calls, has errors; contains all of them.
    """
    return _lower(Compilation(table_from=table_from), obj, arg_types)


def lower_captured(
    obj: SceneCode, arg_types: tuple[Type, ...] | None = None
) -> tuple[Module, Captured]:
    """Lower like ``lower``; also return an object that can check if the module is still current."""
    compilation = Compilation()
    module = _lower(compilation, obj, arg_types)
    return module, Captured(compilation.overloads())


def _lower(compilation: Compilation, obj: SceneCode, arg_types: tuple[Type, ...] | None) -> Module:
    if isinstance(obj, LangFunction):
        return _lower_builtin(compilation, obj, arg_types)
    if isinstance(obj, Composed):
        return _guarded(
            compilation, obj.name, lambda: compilation.finish(compilation.composed(obj), obj.kind)
        )
    if isinstance(obj, Image):
        return _guarded(compilation, obj.name, lambda: _lower_image(compilation, obj))
    return _guarded(compilation, obj.name, lambda: _lower_func(compilation, obj, arg_types))


def lower_overload(func: Func | LangFunction, arg_types: tuple[Type, ...]) -> tuple[Function, ...]:
    """Return a function for exactly these argument types and the functions it calls, callees first.

    Unlike in ``lower``, parameters may be functions, textures and buffers.

    Raises:
        CompileError: No overload takes these types, or the function has errors.
    """
    compilation = Compilation()

    def work() -> tuple[Function, ...]:
        if isinstance(func, LangFunction):
            builtin_function(compilation, func.row, arg_types)
        else:
            exact_instance(compilation, func, arg_types)
        error = compilation.error()
        if error is not None:
            raise error
        return tuple(compilation.functions)

    name = func.row.name if isinstance(func, LangFunction) else func.name
    return _guarded(compilation, name, work)


def has_overload(func: Func, arg_types: tuple[Type, ...]) -> bool:
    """Return whether a function has an overload for exactly these argument types."""
    compilation = Compilation()
    signatures = [compilation.signature(o) for o in func.overloads]
    return any(exact_bindings(compilation, h, arg_types) is not None for h in signatures)


def _guarded(compilation: Compilation, name: str, work: Callable[[], R]) -> R:
    """Run ``work``, and convert any exception of lowering to one ``CompileError``."""
    try:
        with paused_collection():
            return work()
    except SceneError as problem:
        compilation.report(problem.diagnostic)
    except FollowupError:
        pass
    except CompileError as error:
        for diagnostic in error.diagnostics:
            compilation.report(diagnostic)
    except (RecursionError, MemoryError):
        hint = "split long expressions, and functions that call each other many levels deep"
        compilation.report(
            Diagnostic(ErrorCode.RECURSION, f"'{name}' is too deeply nested", None, hint)
        )
    error_found = compilation.error()
    assert error_found is not None, f"lowering {name} stopped without a mistake"
    raise error_found


def _lower_builtin(
    compilation: Compilation, function: LangFunction, types: tuple[Type, ...] | None
) -> Module:
    intrinsic = function.row
    if types is None or types not in exact_instances(intrinsic.name):
        message = must_be_call(intrinsic.name, (signature_text(intrinsic),), types or ())
        raise CompileError.at(ErrorCode.TYPE, message, None)
    return compilation.finish(builtin_function(compilation, intrinsic, types), EntryKind.FUNCTION)


def _lower_image(compilation: Compilation, image: Image) -> Module:
    signature = compilation.signature(image.overloads[0])
    if len(image.overloads) > 1:
        raise SceneError(
            ErrorCode.DEFINITION, f"the image '{image.name}' has overloads", signature.span
        )
    hint = f"write def {image.name}(frame: Frame) -> vec3"
    if not signature.problems:
        types = [_plain_type(compilation, p.annotation) for p in signature.parameters]
        if types != [FRAME]:
            message = f"the image '{image.name}' takes one parameter, a Frame"
            raise SceneError(ErrorCode.DEFINITION, message, signature.span, hint)
    instance = instantiate(compilation, signature, (FRAME,) * len(signature.parameters), {}, None)
    if instance.result is not None and instance.result not in (VEC3, VEC4):
        what = f"the value of the image '{image.name}'"
        message = must_be(what, "vec3 or vec4", instance.result)
        compilation.report(Diagnostic(ErrorCode.TYPE, message, signature.span, hint))
    return compilation.finish(instance, EntryKind.IMAGE)


def _plain_type(compilation: Compilation, annotation: object) -> Type | None:
    try:
        return compilation.adopt(to_type(annotation))
    except (AnnotationError, UnboundVariableError):
        return None


def _lower_func(compilation: Compilation, func: Func, types: tuple[Type, ...] | None) -> Module:
    if types is None:
        types = _own_types(compilation, func)
    signature = compilation.signature(func.overloads[0])
    for type in types:
        if is_static(type) or type is FRAME:
            what = "a function" if isinstance(type, FunctionType) else f"a {type}"
            message = f"'{func.name}' takes {what}: only scene code can call it"
            raise SceneError(ErrorCode.CALL, message, signature.span)
    return compilation.finish(exact_instance(compilation, func, types), EntryKind.FUNCTION)


def _own_types(compilation: Compilation, func: Func) -> tuple[Type, ...]:
    """Return the annotated types of a function that has one overload and no type variables."""
    signatures = [compilation.signature(o) for o in func.overloads]
    if len(signatures) > 1:
        message = (
            f"'{func.name}' has {len(signatures)} overloads: say which argument types are meant"
        )
        raise SceneError(ErrorCode.CALL, message, signatures[0].span)
    (signature,) = signatures
    types: list[Type] = []
    for parameter in signature.parameters:
        if parameter.annotation is MISSING:
            # The missing annotation is reported; go on, to report the errors of the body too.
            types.append(VEC3)
            continue
        try:
            types.append(compilation.adopt(to_type(parameter.annotation)))
        except UnboundVariableError:
            message = f"'{func.name}' is generic: say which argument types are meant"
            raise SceneError(ErrorCode.CALL, message, parameter.span) from None
        except AnnotationError as error:
            compilation.report(
                Diagnostic(ErrorCode.ANNOTATION, error.message, parameter.span, error.hint)
            )
            raise FollowupError from None
    return tuple(types)
