"""Targets and a library for tests of passes on IR built by hand."""

from distal.ir.nodes import EntryKind, Function, Module, Param, UniformDeclaration
from distal.ir.target import FramePlace, Target
from distal.ir.types import Type
from distal.passes.context import Context


class EmptyLibrary:
    def find(self, name, args):
        return None

    def link(self, module, name, args):
        raise AssertionError(f"no {name} for {args}")


CPU = Target("llvm", "llvm", FramePlace.HOST, integer_floor=True, saturating_cast=True)
CONTEXT = Context(CPU, EmptyLibrary())


def function(name: str, params: dict[str, Type], result: Type, *body) -> Function:
    return Function(name, tuple(Param(n, t) for n, t in params.items()), result, tuple(body), name)


def program(
    *functions: Function,
    kind: EntryKind = EntryKind.FUNCTION,
    uniforms: tuple[UniformDeclaration, ...] = (),
    **rest,
) -> Module:
    return Module(functions, functions[-1].name, kind, uniforms, **rest)
