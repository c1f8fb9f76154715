"""One compilation: the functions lowered so far, the uniforms and resources they read.

Functions are lowered when something calls them, once for each list of argument types. A callee is
finished before its caller, so the order of finishing is the order of the module.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Sequence
from typing import Any

from distal.diagnostics import CompileError, Diagnostic, Span
from distal.frontend.function_body import FunctionBody
from distal.frontend.lowering import lambda_lifting, scene_calls
from distal.frontend.lowering.assembly import Assembly
from distal.frontend.lowering.expressions import lower_expression
from distal.frontend.lowering.instances import Instance
from distal.frontend.problems import FollowupError, SceneError
from distal.frontend.signatures.annotations import AnnotationError, UnboundVariableError, to_type
from distal.frontend.signatures.signatures import FunctionSignature, read_signature
from distal.frontend.source import Node
from distal.frontend.values import Closure, Value
from distal.ir.nodes import (
    EntryKind,
    Expr,
    Function,
    Module,
    Origin,
    Resource,
    ResourceDeclaration,
    Uniform,
    UniformDeclaration,
)
from distal.ir.types import Array, FunctionType, Struct, Type
from distal.lang.composed import Composed
from distal.lang.expressions import Expression
from distal.lang.functions import Func, Overload
from distal.lang.parameters import Parameter
from distal.lang.resources import Buffer as LangBuffer
from distal.lang.resources import TextureValue


class Compilation:
    """The state of one compilation."""

    def __init__(self) -> None:
        self.expression: Callable[[FunctionBody, ast.expr], Value] = lower_expression
        self.functions: list[Function] = []
        self.diagnostics: list[Diagnostic] = []
        self.in_progress: list[Instance] = []
        self.instances: dict[Any, Instance] = {}
        self.is_too_deep = False  # calls went deeper than Python's stack, which was reported
        self._signatures: dict[Overload, FunctionSignature] = {}
        self._names: set[str] = set()
        self._uniforms: dict[str, tuple[Parameter, UniformDeclaration]] = {}
        self._numbers: dict[str, UniformDeclaration] = {}
        self._name_counts: dict[str, int] = {}  # how often a number was to be called that
        self.assembly = Assembly(self)
        self._resources: dict[int, ResourceDeclaration] = {}
        self._structs: dict[str, list[Struct]] = {}

    # Mistakes

    def report(self, diagnostic: Diagnostic) -> None:
        """Note a mistake, once."""
        if diagnostic not in self.diagnostics:
            self.diagnostics.append(diagnostic)

    def error(self) -> CompileError | None:
        """All mistakes in the order of the source, or None."""
        if not self.diagnostics:
            return None
        files: dict[str, int] = {}
        for d in self.diagnostics:
            if d.span is not None:
                files.setdefault(d.span.file, len(files))

        def place(d: Diagnostic) -> tuple[int, int, int]:
            span = d.span
            return (files[span.file], span.line, span.col) if span else (-1, 0, 0)

        return CompileError(sorted(self.diagnostics, key=place))

    # What the functions share

    def signature(self, overload: Overload) -> FunctionSignature:
        """A function's parsed definition; its mistakes are noted."""
        signature = self._signatures.get(overload)
        if signature is None:
            try:
                signature = read_signature(overload)
            except CompileError as error:
                for diagnostic in error.diagnostics:
                    self.report(diagnostic)
                raise FollowupError from None
            for diagnostic in signature.problems:
                self.report(diagnostic)
            self._signatures[overload] = signature
        if signature.unusable:
            raise FollowupError
        return signature

    def signature_text(self, overload: Overload) -> str:
        """``name(p: vec3) -> float`` as the author wrote it."""
        return self.signature(overload).text()

    def overloads(self) -> tuple[Overload, ...]:
        """Every Python function that was looked at so far."""
        return tuple(self._signatures)

    def unique_name(self, name: str, suffix: str = "") -> str:
        """A module-wide name: plain, else with the suffix, else numbered."""
        base = name.strip("_") or "function"
        candidates = [base, f"{base}_{suffix}"] if suffix else [base]
        for candidate in candidates:
            if candidate not in self._names:
                self._names.add(candidate)
                return candidate
        n = 2
        while f"{candidates[-1]}_{n}" in self._names:
            n += 1
        self._names.add(f"{candidates[-1]}_{n}")
        return f"{candidates[-1]}_{n}"

    def adopt(self, type: Type) -> Type:
        """The type with every struct renamed whose name another struct has already."""
        match type:
            case Struct(name, fields, is_tuple):
                inner = tuple((n, self.adopt(t)) for n, t in fields)
                renamed = type if inner == fields else Struct(name, inner, is_tuple)
                return renamed if is_tuple else self._adopt_struct(renamed)
            case Array(element, length):
                return Array(self.adopt(element), length)
            case FunctionType(params, result):
                return FunctionType(tuple(map(self.adopt, params)), self.adopt(result))
            case _:
                return type

    def _adopt_struct(self, struct: Struct) -> Struct:
        same_name = self._structs.setdefault(struct.name, [])
        if struct not in same_name:
            same_name.append(struct)
        position = same_name.index(struct)
        if position == 0:
            return struct
        return Struct(f"{struct.name}_{position + 1}", struct.fields, False)

    def annotation(self, body: FunctionBody, node: ast.expr) -> Type:
        """The type that an annotation inside a body names."""
        try:
            return self.adopt(to_type(body.names.annotation(node), body.bindings))
        except SceneError as problem:
            raise body.problem(problem.diagnostic.message, node, problem.diagnostic.hint) from None
        except AnnotationError as error:
            raise body.problem(error.message, node, error.hint) from None
        except UnboundVariableError as error:
            message = f"the type '{error.variable.__name__}' is not known here"
            raise body.problem(message, node) from None

    def uniform(self, parameter: Parameter) -> Expr:
        """The value of a parameter."""
        name = parameter.name
        known = self._uniforms.get(name)
        if known is not None and known[0] != parameter:
            message = f"two parameters are called '{name}'"
            hint = (
                f"their labels: '{known[0].label}' and '{parameter.label}', with different ranges"
            )
            raise CompileError.at(message, None, hint)
        if known is None:
            declaration = UniformDeclaration(
                name,
                parameter.type,
                Origin.PARAMETER,
                parameter.default,
                parameter.interface,
                parameter,
            )
            self._uniforms[name] = (parameter, declaration)
        return Uniform(name, parameter.type)

    def computed(self, expression: Expression) -> Expr:
        """The value of an expression of parameters and time."""
        for parameter in expression.parameters:
            self.uniform(parameter)
        return expression.node

    def number(self, preferred_name: str, type: Type, value: Any) -> Expr:
        """A number of the scene: a uniform with this value.

        Its name has a capital letter, which no parameter's name has.
        """
        first = name = f"{preferred_name[:1].upper()}{preferred_name[1:]}"
        n = self._name_counts.get(first, 1)
        while name in self._numbers:
            n += 1
            name = f"{first}_{n}"
        self._name_counts[first] = n
        self._numbers[name] = UniformDeclaration(name, type, Origin.NUMBER, value)
        return Uniform(name, type)

    def resource(self, resource: TextureValue | LangBuffer, name: str, type: Type) -> Expr:
        """A texture or buffer, under the first name it was met by."""
        known = self._resources.get(id(resource))
        if known is None:
            plain = name.rpartition(".")[2]
            plain = "".join(c if c.isalnum() or c == "_" else "_" for c in plain).strip("_")
            taken = {r.name for r in self._resources.values()}
            unique, n = plain or "resource", 2
            while unique in taken:
                unique, n = f"{plain}_{n}", n + 1
            wrap = resource.wrap if isinstance(resource, TextureValue) else "clamp"
            known = ResourceDeclaration(unique, type, resource, wrap)
            self._resources[id(resource)] = known
        return Resource(known.name, known.type)

    def finish(self, entry: Instance, kind: EntryKind) -> Module:
        """The module, or all mistakes raised."""
        error = self.error()
        if error is not None:
            raise error
        assert any(f.name == entry.name for f in self.functions), f"{entry.name} was lost"
        parameters = (declaration for _, declaration in self._uniforms.values())
        uniforms = (*parameters, *self._numbers.values())
        resources = tuple(self._resources.values())
        return Module(tuple(self.functions), entry.name, kind, uniforms, resources)

    # Functions (the rules are in ``scene_calls`` and ``lambda_lifting``)

    def call(
        self, body: FunctionBody, function: Func, args: Sequence[Value], node: ast.Call
    ) -> Expr:
        """A call of another scene function."""
        return scene_calls.call(body, function, args, node)

    def call_closure(
        self, body: FunctionBody, closure: Closure, args: Sequence[Value], node: ast.Call
    ) -> Expr:
        """A call of a lambda or nested function."""
        return lambda_lifting.call_closure(body, closure, args, node)

    def function_value(
        self, body: FunctionBody, value: Value, type: FunctionType, node: Node
    ) -> Expr | None:
        """A function as a value of a FunctionType."""
        return lambda_lifting.function_value(body, value, type, node)

    def composed(self, obj: Composed) -> Instance:
        """The function that an object makes itself, made now if it was not yet."""
        known = self.instances.get(obj)
        if known is None:
            types = tuple(type for _, type in obj.signature)
            known = self.instances[obj] = Instance("", obj.name, types)
            known.name = obj.compose(self.assembly)
            known.result = next(f.result for f in self.functions if f.name == known.name)
        elif not known.name:
            raise CompileError.at(f"'{obj.name}' is part of itself", None, "write a loop")
        return known

    def check_recursion(self, instance: Instance, span: Span) -> None:
        """Refuse a call of a function that is being lowered right now."""
        if instance in self.in_progress:
            start = self.in_progress.index(instance)
            chain = [i.source_name for i in self.in_progress[start:]] + [instance.source_name]
            message = f"recursion is not part of scene code: {' calls '.join(chain)}"
            raise SceneError(message, span, "write a loop")
