"""Print the IR as text: readable, deterministic and complete.

Input: a module. Output: the text that ``--target ir`` shows, that golden tests compare, and that
the object cache hashes (without the values of a scene's numbers). It contains everything that
affects the compiled code; spans and the data of resources are not part of it. ``@name`` is a
uniform, ``$name`` a value of the per-frame part, ``&name`` a texture or buffer; ``name(...)`` calls
a function of the module and ``(name ...)`` a built-in.

Expressions share subexpressions. A shared subexpression that a statement uses more than once is
written once, as ``%3 = ...`` before the statement, so the text grows with the size of the graph.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from typing import assert_never

from distal.ir.kept import kept
from distal.ir.nodes import (
    Apply,
    Assign,
    Binary,
    Break,
    Builtin,
    Call,
    Cast,
    Compare,
    Compose,
    Const,
    Construct,
    Continue,
    Expr,
    Field,
    For,
    Function,
    FunctionRef,
    Gradient,
    If,
    Index,
    Let,
    Logical,
    MatMul,
    Module,
    Origin,
    PerFrame,
    Read,
    Resource,
    Return,
    Sample,
    Select,
    Size,
    Splat,
    Stmt,
    Swizzle,
    Texel,
    Unary,
    Uniform,
    UniformDeclaration,
    Var,
    While,
)
from distal.ir.types import UINT, FunctionType, Struct, Type, contained_structs
from distal.ir.walk import children, expressions_in, nodes_in

# A shared part of at most this many characters is repeated: naming it would not shorten the text.
_SHORT = 24


def print_module(module: Module) -> str:
    """Return a whole module as text."""
    lines = [f"entry {module.entry} {module.kind.value}"]
    for struct in _structs(module):
        fields = ", ".join(f"{name}: {type}" for name, type in struct.fields)
        lines.append(f"struct {struct.name}({fields})" + (" tuple" if struct.is_tuple else ""))
    lines.extend(_uniform_line(u) for u in module.uniforms)
    lines.extend(f"resource &{r.name}: {r.type} {r.wrap}" for r in module.resources)
    if module.frame:
        lines.append("frame")
        writer = _ModulePrinter()
        for name, value in module.frame:
            writer.line(1, [value], f"${name}: {value.type} =")
        lines.extend(writer.lines)
    for function in module.functions:
        lines.append("")
        lines.extend(_function_lines(function))
    return "\n".join(lines) + "\n"


def print_identity(module: Module) -> str:
    """Return the text that a module's code depends on: all but the values of a scene's numbers."""
    uniforms = tuple(
        replace(u, default=None) if u.origin is Origin.NUMBER else u for u in module.uniforms
    )
    return print_module(replace(module, uniforms=uniforms))


def print_expression(e: Expr) -> str:
    """Return one expression as text; each shared part is on a line before it."""
    writer = _ModulePrinter()
    writer.line(0, [e], "")
    return "\n".join(line.strip() for line in writer.lines)


def _uniform_line(uniform: UniformDeclaration) -> str:
    about = ", ".join(f"{key}={value!r}" for key, value in uniform.interface)
    text = f"uniform @{uniform.name}: {uniform.type} = {uniform.default!r} {uniform.origin.value}"
    return f"{text} ({about})" if about else text


def _structs(module: Module) -> Iterator[Struct]:
    """Yield every struct of the module once: inner structs before outer ones, by first use."""
    seen: set[Struct] = set()
    for type in _types(module):
        for struct in contained_structs(type):
            if struct not in seen:
                seen.add(struct)
                yield struct


def _types(module: Module) -> Iterator[Type]:
    listed: list[Type] = [u.type for u in module.uniforms]
    listed.extend(r.type for r in module.resources)
    for _, value in module.frame:
        listed.extend(e.type for e in nodes_in(value))
    for function in module.functions:
        listed.extend(_types_of(function))
    for type in dict.fromkeys(listed):
        if isinstance(type, FunctionType):
            yield from (*type.params, type.result)
        else:
            yield type


@kept
def _types_of(function: Function) -> tuple[Type, ...]:
    inside = (e.type for e in expressions_in(function.body))
    return tuple(dict.fromkeys([*(p.type for p in function.params), function.result, *inside]))


@kept
def _function_lines(function: Function) -> tuple[str, ...]:
    params = ", ".join(f"{p.name}: {p.type}" for p in function.params)
    writer = _ModulePrinter()
    writer.block(1, function.body)
    name = function.name
    said = "" if function.source_name == name else f" of {function.source_name}"
    said += " apart" if function.apart else ""
    return (f"fn {name}({params}) -> {function.result}{said}", *writer.lines)


class _ModulePrinter:
    """Writes the lines of one function and numbers its shared parts."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self._named = 0

    def block(self, depth: int, body: tuple[Stmt, ...]) -> None:
        for stmt in body:
            self.statement(depth, stmt)

    def statement(self, depth: int, stmt: Stmt) -> None:
        match stmt:
            case Let(name, value):
                self.line(depth, [value], f"let {name}: {value.type} =")
            case Var(name, value):
                self.line(depth, [value], f"var {name}: {value.type} =")
            case Assign(target, value):
                self.line(depth, [target, value], "set", "=")
            case Return(value):
                self.line(depth, [value], "return")
            case If(condition, then, otherwise):
                self.line(depth, [condition], "if")
                self.block(depth + 1, then)
                if otherwise:
                    self.lines.append("  " * depth + "else")
                    self.block(depth + 1, otherwise)
            case While(condition, body):
                self.line(depth, [condition], "while")
                self.block(depth + 1, body)
            case For(name, start, stop, step, body):
                self.line(depth, [start, stop], f"for {name} step {step} from", "to")
                self.block(depth + 1, body)
            case Break():
                self.lines.append("  " * depth + "break")
            case Continue():
                self.lines.append("  " * depth + "continue")
            case _:
                assert_never(stmt)

    def line(self, depth: int, values: list[Expr], *words: str) -> None:
        """Write words and values alternately, after the shared parts of the values."""
        indent = "  " * depth
        uses = Counter(values)
        for e in nodes_in(*values):
            uses.update(children(e))
        texts: dict[Expr, str] = {}
        for e in nodes_in(*values):
            text = _text(e, [texts[c] for c in children(e)])
            if uses[e] > 1 and len(text) > _SHORT:
                self._named += 1
                self.lines.append(f"{indent}%{self._named} = {text}")
                text = f"%{self._named}"
            texts[e] = text
        pairs = zip(words, values, strict=True)
        self.lines.append(indent + " ".join(f"{word} {texts[e]}".lstrip() for word, e in pairs))


def _text(e: Expr, parts: list[str]) -> str:
    """Return the text of one node; ``parts`` are the texts of its operands."""
    joined = " ".join(parts)
    match e:
        case Const(value, type):
            if isinstance(value, bool):
                return "true" if value else "false"
            return f"{value}u" if type is UINT else repr(value)
        case Read(name):
            return name
        case Uniform(name):
            return f"@{name}"
        case PerFrame(name):
            return f"${name}"
        case Resource(name):
            return f"&{name}"
        case FunctionRef(name, captures):
            return f"(function {name} {joined})" if captures else f"(function {name})"
        case Unary(op):
            return f"({op.name.lower()} {joined})"
        case Binary(op) | Compare(op):
            return f"({op.name.lower()} {joined})"
        case Logical(op):
            return f"({op.name.lower()}_then {joined})"
        case MatMul():
            return f"(matmul {joined})"
        case Select():
            return f"(select {joined})"
        case Splat(_, type):
            return f"(splat {type} {joined})"
        case Compose(_, type):
            return f"({type} {joined})"
        case Swizzle(_, lanes):
            return f"{joined}.{lanes}"
        case Field(_, name):
            return f"{joined}.{name}"
        case Index():
            return f"{parts[0]}[{parts[1]}]"
        case Construct(_, type):
            return f"(construct {type} {joined})"
        case Cast(_, type):
            return f"(cast {type} {joined})"
        case Builtin(name):
            return f"({name} {joined})"
        case Call(name):
            return f"{name}({', '.join(parts)})"
        case Apply():
            return f"(apply {joined})"
        case Gradient(_, _, with_value):
            return f"({'value_and_gradient' if with_value else 'gradient'} {joined})"
        case Sample():
            return f"(sample {joined})"
        case Texel():
            return f"(texel {joined})"
        case Size():
            return f"(size {joined})"
        case _:
            assert_never(e)
