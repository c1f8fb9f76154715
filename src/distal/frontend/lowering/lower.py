"""The front end's door: a function in, a module of IR out, or every mistake at once."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias, TypeVar

from distal.diagnostics import CompileError, Diagnostic
from distal.frontend.freshness import Captured
from distal.frontend.lowering.builtin_calls import exact_instances
from distal.frontend.lowering.compilation import Program
from distal.frontend.lowering.lambda_lifting import lower_row
from distal.frontend.lowering.scene_calls import instantiate
from distal.frontend.problems import FollowupError, SceneError
from distal.frontend.signatures.annotations import AnnotationError, UnboundVariableError, to_type
from distal.frontend.signatures.exact import exact_bindings, exact_instance
from distal.frontend.signatures.signatures import MISSING
from distal.ir.nodes import EntryKind, Function, Module
from distal.ir.types import FRAME, VEC3, VEC4, FunctionType, Type, is_static
from distal.lang.composed import Composed
from distal.lang.functions import Func, Image
from distal.lang.names import LangFunction

R = TypeVar("R")

# What can be lowered.
SceneCode: TypeAlias = Func | Composed | LangFunction


def lower(obj: SceneCode, arg_types: tuple[Type, ...] | None = None) -> Module:
    """Lower an image, or a function for the types of its arguments.

    Args:
        obj: What ``@image`` or ``@func`` made, a shape, a scene, or a built-in.
        arg_types: Picks the overload and binds type variables; may be left out where the
            function's annotations say it all.

    Raises:
        CompileError: All mistakes in the function and in what it calls.
    """
    return _lower(Program(), obj, arg_types)


def lower_captured(
    obj: SceneCode, arg_types: tuple[Type, ...] | None = None
) -> tuple[Module, Captured]:
    """As ``lower``; also tells whether the module still stands for the function later on."""
    program = Program()
    module = _lower(program, obj, arg_types)
    return module, Captured(program.overloads())


def _lower(program: Program, obj: SceneCode, arg_types: tuple[Type, ...] | None) -> Module:
    if isinstance(obj, LangFunction):
        return _lower_builtin(program, obj, arg_types)
    if isinstance(obj, Composed):
        return _guarded(program, obj.name, lambda: program.finish(program.composed(obj), obj.kind))
    if isinstance(obj, Image):
        return _guarded(program, obj.name, lambda: _lower_image(program, obj))
    return _guarded(program, obj.name, lambda: _lower_func(program, obj, arg_types))


def lower_overload(func: Func | LangFunction, arg_types: tuple[Type, ...]) -> tuple[Function, ...]:
    """A function for exactly these argument types, and what it calls, callees first.

    Unlike for ``lower``, parameters may be functions, textures and buffers.
    """
    program = Program()

    def work() -> tuple[Function, ...]:
        if isinstance(func, LangFunction):
            lower_row(program, func.row, arg_types)
        else:
            exact_instance(program, func, arg_types)
        error = program.error()
        if error is not None:
            raise error
        return tuple(program.functions)

    name = func.row.name if isinstance(func, LangFunction) else func.name
    return _guarded(program, name, work)


def has_overload(func: Func, arg_types: tuple[Type, ...]) -> bool:
    """Whether a function has an overload for exactly these argument types."""
    program = Program()
    headers = [program.header(o) for o in func.overloads]
    return any(exact_bindings(program, h, arg_types) is not None for h in headers)


def _guarded(program: Program, name: str, work: Callable[[], R]) -> R:
    """Run, and turn whatever stops the work into one error with all mistakes."""
    try:
        return work()
    except SceneError as problem:
        program.report(problem.diagnostic)
    except FollowupError:
        pass
    except CompileError as error:
        for diagnostic in error.diagnostics:
            program.report(diagnostic)
    except (RecursionError, MemoryError):
        hint = "split long expressions, and functions that call each other many levels deep"
        program.report(Diagnostic(f"'{name}' is too deeply nested", None, hint))
    error_found = program.error()
    assert error_found is not None, f"lowering {name} stopped without a mistake"
    raise error_found


def _lower_builtin(
    program: Program, function: LangFunction, types: tuple[Type, ...] | None
) -> Module:
    row = function.row
    if types is None or types not in exact_instances(row.name):
        given = "nothing" if not types else ", ".join(map(str, types))
        raise CompileError.at(f"'{row.name}' does not take {given}", None)
    return program.finish(lower_row(program, row, types), EntryKind.FUNCTION)


def _lower_image(program: Program, image: Image) -> Module:
    header = program.header(image.overloads[0])
    if len(image.overloads) > 1:
        raise SceneError(f"the image '{image.name}' has overloads", header.span)
    hint = f"write def {image.name}(frame: Frame) -> vec3"
    if not header.problems:
        types = [_plain_type(program, s.annotation) for s in header.slots]
        if types != [FRAME]:
            message = f"the image '{image.name}' takes one parameter, a Frame"
            raise SceneError(message, header.span, hint)
    instance = instantiate(program, header, (FRAME,) * len(header.slots), {}, None)
    if instance.result is not None and instance.result not in (VEC3, VEC4):
        message = f"the image '{image.name}' returns vec3 or vec4, not {instance.result}"
        program.report(Diagnostic(message, header.span, hint))
    return program.finish(instance, EntryKind.IMAGE)


def _plain_type(program: Program, annotation: object) -> Type | None:
    try:
        return program.adopt(to_type(annotation))
    except (AnnotationError, UnboundVariableError):
        return None


def _lower_func(program: Program, func: Func, types: tuple[Type, ...] | None) -> Module:
    if types is None:
        types = _own_types(program, func)
    header = program.header(func.overloads[0])
    for type in types:
        if is_static(type) or type is FRAME:
            what = "a function" if isinstance(type, FunctionType) else f"a {type}"
            message = f"'{func.name}' takes {what}: only scene code can call it"
            raise SceneError(message, header.span)
    return program.finish(exact_instance(program, func, types), EntryKind.FUNCTION)


def _own_types(program: Program, func: Func) -> tuple[Type, ...]:
    """The annotated types, where there is nothing to choose."""
    headers = [program.header(o) for o in func.overloads]
    if len(headers) > 1:
        message = f"'{func.name}' has {len(headers)} overloads: say which argument types are meant"
        raise SceneError(message, headers[0].span)
    (header,) = headers
    types: list[Type] = []
    for slot in header.slots:
        if slot.annotation is MISSING:
            # The mistake is reported; the body's own mistakes are wanted beside it.
            types.append(VEC3)
            continue
        try:
            types.append(program.adopt(to_type(slot.annotation)))
        except UnboundVariableError:
            message = f"'{func.name}' is generic: say which argument types are meant"
            raise SceneError(message, slot.span) from None
        except AnnotationError as error:
            program.report(Diagnostic(error.message, slot.span, error.hint))
            raise FollowupError from None
    return tuple(types)
