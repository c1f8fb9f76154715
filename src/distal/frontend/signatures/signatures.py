"""Read a function's signature: its parameters and its result.

Input: a recorded ``Overload``. Output: its syntax tree, its parameters with evaluated annotations
and defaults, and the lookup of its names.
"""

from __future__ import annotations

import ast
from dataclasses import dataclass, field, replace
from functools import lru_cache
from types import FunctionType
from typing import Any, Final
from weakref import WeakKeyDictionary

from distal.at_once import cached_property
from distal.diagnostics import CompileError, Diagnostic, Span
from distal.error_codes import ErrorCode
from distal.frontend.name_lookup import NameLookup, names_of
from distal.frontend.parsing import TREES_KEPT
from distal.frontend.problems import SceneError
from distal.frontend.scopes import ScopeAnalysis, all_parameters, analyse_scopes
from distal.frontend.source import SourceMap, parse_definition
from distal.lang.annotations import ArrayAnnotation
from distal.lang.functions import Overload, is_fixed
from distal.lang.source import capture
from distal.session import SESSION

MISSING: Final = object()


@dataclass(frozen=True, slots=True)
class SignatureParameter:
    """One parameter of a signature.

    Attributes:
        name: Its name.
        annotation: The evaluated annotation; ``MISSING`` if there is none.
        default: The default value; ``MISSING`` if there is none.
        span: Its source span.
        positional: Whether a positional argument can set it.
        by_keyword: Whether a keyword argument can set it.
        collects: Whether it is an array of the remaining positional arguments (``*values``); then
            ``annotation`` is the type of one of them.
    """

    name: str
    annotation: Any
    default: Any
    span: Span
    positional: bool = True
    by_keyword: bool = True
    collects: bool = False


def element_annotation(parameter: SignatureParameter) -> Any:
    """Return a parameter's annotation; of ``*values``, the annotation of one value."""
    annotation = parameter.annotation
    if parameter.collects and isinstance(annotation, ArrayAnnotation):
        return annotation.element
    return annotation


class Definition:
    """A parsed definition; the same for every compilation of the function.

    Attributes:
        node: Its syntax tree.
        source: Makes source spans from nodes.
    """

    def __init__(self, overload: Overload) -> None:
        name = overload.python.__code__.co_name
        self.node, self.source = parse_definition(overload.source, name)

    @cached_property
    def scopes(self) -> ScopeAnalysis:
        """The locals of the function."""
        return _scopes_of(self.node)


# Equal texts have one tree: it is analysed once, also where the file is loaded again.
@lru_cache(maxsize=TREES_KEPT)
def _scopes_of(node: ast.FunctionDef) -> ScopeAnalysis:
    return analyse_scopes(node.body, {a.arg for a in all_parameters(node.args)})


_definitions: WeakKeyDictionary[Overload, Definition] = SESSION.keep(
    "definitions", WeakKeyDictionary()
)
_fixed: dict[Overload, FunctionSignature] = SESSION.keep("signatures", {})


def definition_of(overload: Overload) -> Definition:
    """Return the parsed definition of a function, parsed at the first call.

    Raises:
        CompileError: The source text is not available or cannot be parsed.
    """
    found = _definitions.get(overload)
    if found is None:
        found = _definitions.setdefault(overload, Definition(overload))
    return found


@dataclass(eq=False, slots=True)
class FunctionSignature:
    """A function's signature, as its ``def`` line declares it.

    Attributes:
        name: The function's name.
        definition: The parsed definition.
        names: Looks up its names.
        parameters: Its parameters.
        result: The evaluated result annotation; ``MISSING`` if there is none.
        overload: The recorded Python function.
        problems: The errors of the signature.
        unusable: Whether it cannot be scene code at all, for example a method.
    """

    name: str
    definition: Definition
    names: NameLookup
    parameters: tuple[SignatureParameter, ...]
    result: Any
    overload: Overload
    problems: list[Diagnostic] = field(default_factory=list)
    unusable: bool = False

    @property
    def node(self) -> ast.FunctionDef:
        """The syntax tree."""
        return self.definition.node

    @property
    def source(self) -> SourceMap:
        """Makes source spans from nodes."""
        return self.definition.source

    @property
    def span(self) -> Span:
        """The span of the function's name."""
        return self.source.name_span(self.node)

    def collecting(self, count: int) -> FunctionSignature:
        """Return the signature for a call with ``count`` positional arguments.

        A parameter ``*values: float`` becomes one of the type ``array[float, n]`` for the n
        arguments that the parameters before it leave; it stays as it is if none are left.
        """
        left = count - sum(p.positional for p in self.parameters)
        if left < 1 or not any(p.collects for p in self.parameters):
            return self
        parameters = tuple(
            replace(p, annotation=ArrayAnnotation(p.annotation, left))
            if p.collects and p.annotation is not MISSING
            else p
            for p in self.parameters
        )
        return replace(self, parameters=parameters)

    def text(self) -> str:
        """Return ``name(p: vec3, r: float) -> float`` as the author wrote it, for hints."""
        written = {a.arg: a.annotation for a in all_parameters(self.node.args)}
        parts: list[str] = []
        collects = False
        for parameter in self.parameters:
            collects = collects or parameter.collects
            if not parameter.positional and not collects and "*" not in parts:
                parts.append("*")
            annotation = written.get(parameter.name)
            suffix = "" if annotation is None else f": {ast.unparse(annotation)}"
            parts.append(f"{'*' if parameter.collects else ''}{parameter.name}{suffix}")
        returns = self.node.returns
        result = "" if returns is None else f" -> {ast.unparse(returns)}"
        return f"{self.name}({', '.join(parts)}){result}"


def read_signature(overload: Overload) -> FunctionSignature:
    """Parse a definition and evaluate its annotations; errors go to ``problems``.

    Raises:
        CompileError: The source text is not available or cannot be parsed.
    """
    # What an author's annotations name may change; the library's does not.
    known = _fixed.get(overload)
    if known is None:
        known = _read(overload)
        if is_fixed(overload) and not known.problems:
            known = _fixed.setdefault(overload, known)
    return known


def _read(overload: Overload) -> FunctionSignature:
    python = overload.python
    definition = definition_of(overload)
    names = names_of(python, overload.enclosing)
    signature = FunctionSignature(python.__name__, definition, names, (), MISSING, overload)
    if overload.struct is None and _is_method(python):
        message = f"'{python.__qualname__}' is a method, and its class is not a struct"
        hint = "write @struct above the class, or move it out of the class"
        signature.problems.append(Diagnostic(ErrorCode.DEFINITION, message, signature.span, hint))
        signature.unusable = True
        return signature
    if hasattr(python, "__wrapped__"):
        message = f"'{signature.name}' is changed by another decorator first"
        hint = "put @func directly above def"
        signature.problems.append(
            Diagnostic(ErrorCode.DEFINITION, message, _wrapped_span(python, signature), hint)
        )
        signature.unusable = True
        return signature
    signature.parameters = tuple(_parameters_of(signature, python))
    if definition.node.returns is not None:
        signature.result = _evaluated(signature, definition.node.returns)
    return signature


def _wrapped_span(python: FunctionType, signature: FunctionSignature) -> Span:
    """Return the span of the ``def`` that the author decorated."""
    inner = getattr(python, "__wrapped__", None)
    if not isinstance(inner, FunctionType):
        return signature.span
    try:
        node, source = parse_definition(capture(inner), inner.__code__.co_name)
    except CompileError:
        return signature.span
    return source.name_span(node)


def _is_method(python: FunctionType) -> bool:
    owner = python.__qualname__.rpartition(".")[0]
    return bool(owner) and not owner.endswith("<locals>")


def _parameters_of(signature: FunctionSignature, python: FunctionType) -> list[SignatureParameter]:
    a = signature.node.args
    if a.kwarg is not None:
        message = f"'**{a.kwarg.arg}' is not part of scene code"
        hint = "name each parameter"
        signature.problems.append(
            Diagnostic(ErrorCode.LANGUAGE, message, signature.source.span(a.kwarg), hint)
        )
    positional = [*a.posonlyargs, *a.args]
    given = python.__defaults__ or ()
    defaults: dict[str, Any] = dict(
        zip((p.arg for p in positional[len(positional) - len(given) :]), given, strict=True)
    )
    defaults.update(python.__kwdefaults__ or {})
    owner = signature.overload.struct if signature.overload.takes_self else None
    if owner is not None and not positional:
        message = f"the method '{signature.name}' has no parameter for its struct"
        hint = f"write def {signature.name}(self), or @staticmethod above @func"
        signature.problems.append(Diagnostic(ErrorCode.DEFINITION, message, signature.span, hint))
        signature.unusable = True
    starred = [] if a.vararg is None else [a.vararg]
    parameters = []
    for position, arg in enumerate((*positional, *starred, *a.kwonlyargs)):
        if position == 0 and owner is not None and arg.annotation is None:
            annotation: Any = owner
        else:
            annotation = _annotation_of(signature, arg)
        parameters.append(
            SignatureParameter(
                arg.arg,
                annotation,
                defaults.get(arg.arg, MISSING),
                signature.source.span(arg),
                arg not in (*a.kwonlyargs, *starred),
                arg not in (*a.posonlyargs, *starred),
                arg in starred,
            )
        )
    return parameters


def _annotation_of(signature: FunctionSignature, arg: ast.arg) -> Any:
    if arg.annotation is not None:
        return _evaluated(signature, arg.annotation)
    message = f"parameter '{arg.arg}' has no type"
    hint = f"write {arg.arg}: vec3, or {arg.arg}: float"
    signature.problems.append(
        Diagnostic(ErrorCode.ANNOTATION, message, signature.source.span(arg), hint)
    )
    return MISSING


def _evaluated(signature: FunctionSignature, node: ast.expr) -> Any:
    try:
        return signature.names.annotation(node)
    except SceneError as problem:
        span = signature.source.span(node)
        diagnostic = problem.diagnostic
        signature.problems.append(
            Diagnostic(diagnostic.code, diagnostic.message, span, diagnostic.hint)
        )
        return MISSING
