"""The state of one compilation: the lowered functions, and the uniforms and resources they read.

A function is lowered at its first call, once for each list of argument types. A callee is finished
before its caller, and the module lists functions in this order.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any, TypeVar

from distal.diagnostics import CompileError, Diagnostic, Label, Span
from distal.error_codes import ErrorCode
from distal.frontend.function_body import FunctionBody
from distal.frontend.lowering import lambda_lifting, scene_calls
from distal.frontend.lowering.assembly import TABLE_FROM, Assembly
from distal.frontend.lowering.expressions import lower_expression
from distal.frontend.lowering.instances import Instance
from distal.frontend.lowering.recipes import Recording, What
from distal.frontend.problems import FollowupError, SceneError
from distal.frontend.signatures.annotations import AnnotationError, UnboundVariableError, to_type
from distal.frontend.signatures.signatures import FunctionSignature, read_signature
from distal.frontend.source import Node
from distal.frontend.values import Closure, Value
from distal.ir.intrinsics import Intrinsic
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
    """The state of one compilation.

    Attributes:
        expression: Lowers an expression of a function body.
        functions: The finished IR functions, callees first.
        diagnostics: The errors found so far.
        in_progress: The functions that are being lowered, outermost first.
        instances: The lowered functions, by source and argument types.
        is_too_deep: Whether calls exceeded Python's recursion limit, which was reported.
        recordings: What the functions in progress have asked for.
        assembly: The interface for objects that add functions.
        table_from: With so many parts or more, an object may put the numbers of its parts into
            buffers; None if the target has none.
    """

    def __init__(self, *, table_from: int | None = TABLE_FROM) -> None:
        self.table_from = table_from
        self.expression: Callable[[FunctionBody, ast.expr], Value] = lower_expression
        self.functions: list[Function] = []
        self.diagnostics: list[Diagnostic] = []
        self.in_progress: list[Instance] = []
        self.instances: dict[Any, Instance] = {}
        # By identity: objects that are equal have places of their own. The objects are kept, so
        # that no other one gets their identity.
        self._composed: dict[int, tuple[Composed, Instance]] = {}
        self.is_too_deep = False
        self.recordings: list[Recording] = []
        self._signatures: dict[Overload, FunctionSignature] = {}
        self._names: set[str] = set()
        self._uniforms: dict[str, tuple[Parameter, UniformDeclaration]] = {}
        self._numbers: dict[str, UniformDeclaration] = {}
        self._name_counts: dict[str, int] = {}  # how often each name was requested for a number
        self.assembly = Assembly(self)
        self._resources: dict[int, ResourceDeclaration] = {}
        self._structs: dict[str, list[Struct]] = {}

    # Errors

    def report(self, diagnostic: Diagnostic) -> None:
        """Record an error, once."""
        self._not_lasting()
        # A generic function may fail in the same way for several types.
        key = (diagnostic.message, diagnostic.span)
        if all((d.message, d.span) != key for d in self.diagnostics):
            self.diagnostics.append(diagnostic)

    def error(self) -> CompileError | None:
        """Return all errors in the order of the source, or None."""
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

    # State shared by all functions

    def signature(self, overload: Overload) -> FunctionSignature:
        """Return a function's parsed signature, and record its errors.

        Raises:
            FollowupError: The definition cannot be used; its errors are recorded.
        """
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
        self.record("signature", (), overload)
        return signature

    def signature_text(self, overload: Overload) -> str:
        """Return the signature as the author wrote it: ``name(p: vec3) -> float``."""
        return self.signature(overload).text()

    def overloads(self) -> tuple[Overload, ...]:
        """Return every Python function whose signature was read so far."""
        return tuple(self._signatures)

    def unique_name(self, name: str, suffix: str = "") -> str:
        """Return a name unique in the module: plain, else with the suffix, else numbered."""
        base = name.strip("_") or "function"
        candidates = [base, f"{base}_{suffix}"] if suffix else [base]
        unique = next((c for c in candidates if c not in self._names), None)
        if unique is None:
            n = 2
            while f"{candidates[-1]}_{n}" in self._names:
                n += 1
            unique = f"{candidates[-1]}_{n}"
        self._names.add(unique)
        self.record("name", (name, suffix), unique)
        return unique

    def add(self, function: Function) -> None:
        """Add a finished function."""
        self.functions.append(function)
        self.record("function", (), function)

    def withdraw(self, names: Sequence[str], functions: Sequence[Function]) -> None:
        """Take back names and functions."""
        self._names.difference_update(names)
        for function in functions:
            del self.functions[next(i for i, f in enumerate(self.functions) if f is function)]

    def record(self, what: What, asked: tuple[Any, ...], answer: Any) -> None:
        """Note a request of the function in progress, and its answer."""
        if self.recordings:
            self.recordings[-1].add(what, asked, answer)

    @contextmanager
    def recording(self) -> Iterator[Recording]:
        """Record what is asked for in the block, apart from what its caller asks for."""
        recording = Recording()
        self.recordings.append(recording)
        try:
            yield recording
        finally:
            self.recordings.pop()

    def _not_lasting(self) -> None:
        """What is asked for is the author's: the function in progress is lowered every time."""
        if self.recordings:
            self.recordings[-1].is_lasting = False

    def instance_of(
        self, overload: Overload, types: tuple[Type, ...], bindings: dict[TypeVar, Type]
    ) -> Instance:
        """Return the instance of a function that scene code calls."""
        signature = self.signature(overload)
        return scene_calls.instantiate(self, signature, types, bindings, None)

    def builtin_function(self, intrinsic: Intrinsic, types: tuple[Type, ...]) -> Instance:
        """Return a function that only calls a built-in."""
        return lambda_lifting.builtin_function(self, intrinsic, types)

    def adopt(self, type: Type) -> Type:
        """Return the type; a struct is renamed if another struct of the program has its name."""
        match type:
            case Struct(name, fields, is_tuple, owner):
                inner = tuple((n, self.adopt(t)) for n, t in fields)
                renamed = type if inner == fields else Struct(name, inner, is_tuple, owner)
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
        adopted = struct
        if position > 0:
            name = f"{struct.name}_{position + 1}"
            adopted = Struct(name, struct.fields, False, struct.owner)
        self.record("struct", (struct,), adopted)
        return adopted

    def annotation(self, body: FunctionBody, node: ast.expr) -> Type:
        """Return the type that an annotation inside a body names.

        Raises:
            SceneError: The annotation is not a type of scene code.
        """
        try:
            return self.adopt(to_type(body.names.annotation(node), body.bindings))
        except SceneError as problem:
            raise body.problem(
                problem.diagnostic.code, problem.diagnostic.message, node, problem.diagnostic.hint
            ) from None
        except AnnotationError as error:
            raise body.problem(ErrorCode.ANNOTATION, error.message, node, error.hint) from None
        except UnboundVariableError as error:
            message = f"the type '{error.variable.__name__}' is not known here"
            raise body.problem(ErrorCode.ANNOTATION, message, node) from None

    def uniform(self, parameter: Parameter) -> Expr:
        """Return a read of a parameter's uniform, and declare the uniform.

        Raises:
            CompileError: Two different parameters have the same name.
        """
        self._not_lasting()
        name = parameter.name
        known = self._uniforms.get(name)
        if known is not None and known[0] != parameter:
            message = f"two parameters are called '{name}'"
            hint = f'they differ, so one needs another name: name="{name}_2"'
            labels = [Label(p, "the first is here") for p in (known[0].span,) if p is not None]
            raise CompileError.at(ErrorCode.PARAMETER, message, parameter.span, hint, tuple(labels))
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
        """Return the IR of an expression of parameters and time."""
        self._not_lasting()
        for parameter in expression.parameters:
            self.uniform(parameter)
        return expression.node

    def number(self, preferred_name: str, type: Type, value: Any) -> Expr:
        """Return a number of the scene: a new uniform with this value.

        Its name starts with a capital letter; names of parameters never do.

        Args:
            preferred_name: The name, which gets a number if another uniform has it.
            type: The type of the uniform.
            value: The value.
        """
        self._not_lasting()
        first = name = f"{preferred_name[:1].upper()}{preferred_name[1:]}"
        n = self._name_counts.get(first, 1)
        while name in self._numbers:
            n += 1
            name = f"{first}_{n}"
        self._name_counts[first] = n
        self._numbers[name] = UniformDeclaration(name, type, Origin.NUMBER, value)
        return Uniform(name, type)

    def resource(self, resource: TextureValue | LangBuffer, name: str, type: Type) -> Expr:
        """Return a texture or buffer, under the first name that referred to it.

        Args:
            resource: The texture or buffer.
            name: The preferred name.
            type: Its type in the IR.
        """
        self._not_lasting()
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
        """Return the module.

        Raises:
            CompileError: The scene code has errors; it contains all of them.
        """
        error = self.error()
        if error is not None:
            raise error
        assert any(f.name == entry.name for f in self.functions), f"{entry.name} was lost"
        parameters = (declaration for _, declaration in self._uniforms.values())
        uniforms = (*parameters, *self._numbers.values())
        resources = tuple(self._resources.values())
        return Module(tuple(self.functions), entry.name, kind, uniforms, resources)

    # Functions (``scene_calls`` and ``lambda_lifting`` implement the rules)

    def call(
        self, body: FunctionBody, function: Func, args: Sequence[Value], node: ast.Call
    ) -> Expr:
        """Lower a call of another scene function; arguments as for ``scene_calls.call``."""
        return scene_calls.call(body, function, args, node)

    def call_closure(
        self, body: FunctionBody, closure: Closure, args: Sequence[Value], node: ast.Call
    ) -> Expr:
        """Lower a call of a closure; arguments as for ``lambda_lifting.call_closure``."""
        return lambda_lifting.call_closure(body, closure, args, node)

    def function_value(
        self, body: FunctionBody, value: Value, type: FunctionType, node: Node
    ) -> Expr | None:
        """Return a function value; arguments as for ``lambda_lifting.function_value``."""
        return lambda_lifting.function_value(body, value, type, node)

    def composed(self, obj: Composed) -> Instance:
        """Return the function of an object; the object adds it at the first request.

        Raises:
            CompileError: The object contains itself.
        """
        self._not_lasting()
        _, instance = self._composed.get(id(obj), (obj, None))
        if instance is None:
            types = tuple(type for _, type in obj.signature)
            instance = Instance("", obj.name, types)
            self._composed[id(obj)] = (obj, instance)
            instance.name = obj.compose(self.assembly)
            instance.result = next(f.result for f in self.functions if f.name == instance.name)
        elif not instance.name:
            raise CompileError.at(
                ErrorCode.RECURSION, f"'{obj.name}' is part of itself", None, "write a loop"
            )
        return instance

    def check_recursion(self, instance: Instance, span: Span) -> None:
        """Check that a called function is not being lowered now.

        Raises:
            SceneError: The call is recursive.
        """
        if instance in self.in_progress:
            start = self.in_progress.index(instance)
            chain = [i.source_name for i in self.in_progress[start:]] + [instance.source_name]
            message = f"recursion is not part of scene code: {' calls '.join(chain)}"
            raise SceneError(ErrorCode.RECURSION, message, span, "write a loop")
