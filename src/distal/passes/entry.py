"""Give the module a plain entry point: the values from the host become coord and uniforms.

Input: a lowered module whose image function takes a ``Frame``. Output: a module without ``Frame``.
A parameter of type ``Frame`` becomes the vec2 ``coord``; each other field of it becomes a uniform
of origin FRAME, declared only when it is read. An image is wrapped into
``main(coord: vec2) -> vec4``. The time in expressions created from Python becomes the frame's time,
also in functions without a ``Frame``. The pass does not depend on how a target provides coord or
uniforms.

The names of the frame's values are reserved. A parameter uniform with such a name (a slider called
"Time") gets ``_value`` appended, and its interface then ends in ``("parameter", "time")``, the name
by which users set it.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Final

from distal.diagnostics import CompileError, Span
from distal.error_codes import ErrorCode
from distal.ir import nodes
from distal.ir.build import number, subtract
from distal.ir.kept import kept
from distal.ir.limits import FRAME_SECONDS
from distal.ir.nodes import (
    Apply,
    Call,
    Compose,
    Construct,
    EntryKind,
    Expr,
    Field,
    Function,
    FunctionRef,
    Let,
    Module,
    Origin,
    Param,
    Read,
    Return,
    Stmt,
    Uniform,
    UniformDeclaration,
    Var,
    span_in,
)
from distal.ir.types import FRAME, VEC2, VEC3, VEC4, FunctionType, Struct, Type, is_targets
from distal.ir.walk import children, map_statement, rebuild
from distal.passes.context import Context
from distal.passes.naming import FreshNames, local_names

_DEFAULTS: Final = {
    "resolution": (640.0, 480.0),
    "time": 0.0,
    "mouse": (0.0, 0.0, 0.0, 0.0),
    "index": 0,
    "seed": 0,
    "delta": FRAME_SECONDS,
    "date": (0.0, 0.0, 0.0, 0.0),
    "buttons": 0,
}
_FRAME_UNIFORMS: Final = {
    name: UniformDeclaration(name, type, Origin.FRAME, _DEFAULTS[name])
    for name, type in FRAME.fields
    if name != "coord"
}
# A host that shows more than the author's frame declares this number: the frame's lower left corner
# in pixels. The uniform ``resolution`` is then the size of the frame.
FRAME_OFFSET: Final = UniformDeclaration("Frame_offset", VEC2, Origin.NUMBER, (0.0, 0.0))


def run(module: Module, context: Context) -> Module:
    """Replace ``Frame`` by coord and uniforms, and wrap an image into the entry function."""
    renamed = renamed_parameters(module.uniforms)
    used: set[str] = set()
    functions = []
    for function in module.functions:
        replaced, read = _without_frames(function, tuple(renamed.items()))
        functions.append(replaced)
        used |= read
    entry = module.entry
    if module.kind is EntryKind.IMAGE:
        wrapper = _wrapper(functions, entry, module.uniforms, context.target.targets)
        functions.append(wrapper)
        entry = wrapper.name
    frame = [u for name, u in _FRAME_UNIFORMS.items() if name in used]
    parameters = [_rename(u, renamed) for u in module.uniforms]
    return replace(module, functions=tuple(functions), entry=entry, uniforms=(*frame, *parameters))


def renamed_parameters(uniforms: Iterable[UniformDeclaration]) -> dict[str, str]:
    """Return the new names of the parameters that have the name of a frame value."""
    declared = [u.name for u in uniforms]
    alike = [name for name in declared if name in _FRAME_UNIFORMS]
    if not alike:
        return {}
    names = FreshNames([*_FRAME_UNIFORMS, *declared])
    return {name: names.fresh(f"{name}_value") for name in alike}


def _rename(uniform: UniformDeclaration, renamed: dict[str, str]) -> UniformDeclaration:
    name = renamed.get(uniform.name)
    if name is None:
        return uniform
    interface = (*uniform.interface, ("parameter", uniform.name))
    return replace(uniform, name=name, interface=interface)


def _wrapper(
    functions: list[Function], entry: str, uniforms: Iterable[UniformDeclaration], targets: int
) -> Function:
    image = next(f for f in functions if f.name == entry)
    coord: Expr = Read("coord", VEC2)
    if FRAME_OFFSET in uniforms:
        coord = subtract(coord, Uniform(FRAME_OFFSET.name, VEC2))
    args = tuple(coord for p in image.params if p.type is VEC2)
    if len(args) != len(image.params):
        raise CompileError.at(
            ErrorCode.DEFINITION,
            f"the image '{image.source_name}' takes more than a frame",
            image.span,
            f"def {image.source_name}(frame: Frame) -> vec3",
        )
    color: Expr = Call(entry, args, image.result)
    if image.result is VEC3:
        color = Compose((color, number(1.0)), VEC4)
    elif image.result is not VEC4 and not _is_drawn(image.result, targets):
        raise CompileError.at(
            ErrorCode.DEFINITION,
            f"the image '{image.source_name}' returns {image.result}",
            image.span,
            "an image returns vec3 or vec4",
        )
    name = FreshNames(f.name for f in functions).fresh("main")
    body = (Return(color),)
    return Function(name, (Param("coord", VEC2),), color.type, body, "main", span=image.span)


def _is_drawn(type: Type, targets: int) -> bool:
    """Return whether the target draws so many pictures at once."""
    return isinstance(type, Struct) and is_targets(type) and len(type.fields) <= targets


def _without_frame(type: Type) -> Type:
    """Return the type with vec2 in place of Frame, also in the parameters of a function type."""
    if type is FRAME:
        return VEC2
    if isinstance(type, FunctionType):
        params = tuple(_without_frame(p) for p in type.params)
        return FunctionType(params, _without_frame(type.result))
    return type


@kept
def _without_frames(
    function: Function, renamed: tuple[tuple[str, str], ...]
) -> tuple[Function, frozenset[str]]:
    """Return a function without frames, and the names of the frame's uniforms that it reads."""
    replacer = _FrameReplacer(function, dict(renamed))
    return replacer.function(), frozenset(replacer.used)


class _FrameReplacer:
    """Replaces the frames of one function by their coords and by uniforms.

    Attributes:
        used: The names of the frame's uniforms that are read so far.
    """

    def __init__(self, function: Function, renamed: dict[str, str]) -> None:
        self.used: set[str] = set()
        self._function = function
        self._renamed = renamed
        self._coords: dict[str, Expr] = {}  # a local of type Frame -> its coord
        self._memo: dict[Expr, Expr] = {}
        self._span: Span | None = function.span

    def function(self) -> Function:
        fn = self._function
        if fn.result is FRAME:
            raise CompileError.at(
                ErrorCode.DEFINITION,
                f"'{fn.source_name}' returns a Frame",
                fn.span,
                "return the values it needs instead",
            )
        names = FreshNames(local_names(fn))
        params = []
        for param in fn.params:
            name = param.name
            if param.type is FRAME:
                name = names.fresh("coord")
                self._coords[param.name] = Read(name, VEC2)
            params.append(Param(name, _without_frame(param.type)))
        return replace(fn, params=tuple(params), body=self._block(fn.body))

    def _block(self, body: tuple[Stmt, ...]) -> tuple[Stmt, ...]:
        written = []
        for stmt in body:
            self._span = stmt.span
            if isinstance(stmt, Let) and stmt.value.type is FRAME:
                self._coords[stmt.name] = self._coord(stmt.value)
            elif isinstance(stmt, Var) and stmt.value.type is FRAME:
                raise self._misuse(stmt.value)
            else:
                written.append(map_statement(stmt, self._expression, self._block))
        return tuple(written)

    def _expression(self, e: Expr) -> Expr:
        done = self._memo.get(e)
        if done is None:
            done = self._memo[e] = self._rewritten(e)
        return done

    def _rewritten(self, e: Expr) -> Expr:
        match e:
            case Field(base, name, type) if base.type is FRAME:
                coord = self._coord(base)
                if name == "coord":
                    return coord
                self.used.add(name)
                return Uniform(name, type, span=e.span)
            case Uniform(nodes.FRAME_TIME, type):
                self.used.add("time")
                return Uniform("time", type, span=e.span)
            case Uniform(name, type):
                return Uniform(self._renamed.get(name, name), type, span=e.span)
            case _ if e.type is FRAME:
                return self._coord(e)
        passed_on = isinstance(e, Call | Apply | FunctionRef)
        if not passed_on and any(c.type is FRAME for c in children(e)):
            raise self._misuse(e)
        operands = tuple(self._expression(c) for c in children(e))
        return _retyped(rebuild(e, operands))

    def _coord(self, frame: Expr) -> Expr:
        """Return the coord that replaces a value of type Frame."""
        if isinstance(frame, Read) and frame.name in self._coords:
            return self._coords[frame.name]
        if isinstance(frame, Construct):  # another coord (``runtime.sampling``)
            return self._expression(frame.parts[0])
        raise self._misuse(frame)

    def _misuse(self, e: Expr) -> CompileError:
        return CompileError.at(
            ErrorCode.DEFINITION,
            "a Frame can only be read and passed on",
            span_in(self._span, e),
            "there is one frame; read its values where they are needed",
        )


def _retyped(e: Expr) -> Expr:
    """Return a function value with each Frame parameter in its type replaced by the coord."""
    type = _without_frame(e.type)
    if type is e.type:
        return e
    if isinstance(e, Read):
        return Read(e.name, type, span=e.span)
    assert isinstance(e, FunctionRef), f"{e} makes a function value"
    return FunctionRef(e.name, e.captures, type, span=e.span)
