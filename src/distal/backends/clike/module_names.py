"""Name everything of a module in a text, and find what a part of a module uses."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from distal.backends.clike.constants import is_literal_operation, is_table
from distal.backends.clike.names import Namer, Reserved, safe_name
from distal.ir.nodes import Call, Expr, Function, Module, PerFrame, Resource, Uniform
from distal.ir.types import Array, Buffer, Struct, Type
from distal.ir.walk import expressions_in, nodes_in


@dataclass(frozen=True, slots=True)
class Vocabulary:
    """The names that a target reserves.

    Attributes:
        fields: Reserved for fields of structs: keywords and macros.
        names: Reserved for all other names: the same, and the names that the language, the host
            or the writer declares at module scope.
    """

    fields: Reserved
    names: Reserved


@dataclass(slots=True)
class ModuleNames:
    """The names of module scope; each dictionary maps an IR name to the name in the text."""

    namer: Namer
    uniforms: dict[str, str] = field(default_factory=dict)
    resources: dict[str, str] = field(default_factory=dict)
    accessors: dict[str, str] = field(default_factory=dict)  # read one texel or element
    counts: dict[str, str] = field(default_factory=dict)  # the number of elements of a buffer
    samplers: dict[str, str] = field(default_factory=dict)
    frame: dict[str, str] = field(default_factory=dict)
    functions: dict[str, str] = field(default_factory=dict)
    tables: list[str] = field(default_factory=list)  # reserved for tables of literals
    constants: list[str] = field(default_factory=list)  # for literals that are stored in variables
    structs: dict[Type, str] = field(default_factory=dict)
    fields: dict[tuple[Struct, str], str] = field(default_factory=dict)

    def local_namer(self) -> Namer:
        """Return a namer for a function that the writer adds; it shadows no module-scope name."""
        return self.namer.inner()

    def mentioned(self, function: Function) -> frozenset[str]:
        """Return the module-scope names that a function's text may contain, except the writer's."""
        found = {self.structs[t] for t in types_of(function) if t in self.structs}
        found |= {*self.tables, *self.constants}
        for e in expressions_in(function.body):
            match e:
                case Call(callee):
                    found.add(self.functions[callee])
                case Uniform(name):
                    found.add(self.uniforms[name])
                case PerFrame(name):
                    found.add(self.frame[name])
                case Resource(name):
                    found |= {self.resources[name], self.accessors[name], self.counts[name]}
                    found.add(self.samplers[name])
                case _:
                    pass
        return frozenset(found)


def name_module(
    module: Module,
    vocabulary: Vocabulary,
    fixed_uniforms: dict[str, str] | None = None,
    fixed_resources: dict[str, str] | None = None,
    *,
    has_members: bool = False,
) -> ModuleNames:
    """Assign a name to everything in a module.

    Args:
        module: The module.
        vocabulary: The reserved names.
        fixed_uniforms: The text of the uniforms that the host provides.
        fixed_resources: The names of the textures that the host provides.
        has_members: Whether the text declares uniforms and per-frame values as members of structs.
    """
    namer = Namer(vocabulary.names)
    names = ModuleNames(namer)
    fixed = fixed_uniforms or {}
    of_uniforms, of_frame = (Namer(vocabulary.fields) if has_members else namer for _ in range(2))
    for uniform in module.uniforms:
        names.uniforms[uniform.name] = fixed.get(uniform.name) or of_uniforms.name(uniform.name)
    for resource in module.resources:
        fixed_name = (fixed_resources or {}).get(resource.name)
        names.resources[resource.name] = fixed_name or namer.name(resource.name)
        names.accessors[resource.name] = namer.name(f"{resource.name}_at")
        names.counts[resource.name] = namer.name(f"{resource.name}_count")
        names.samplers[resource.name] = namer.name(f"{resource.name}_sampler")
    for name, _ in module.frame:
        names.frame[name] = of_frame.name(name)
    for type in types_in(module, module.functions):
        if isinstance(type, Struct):
            names.structs[type] = namer.name(type.name)
            local = Namer(vocabulary.fields)
            names.fields |= {(type, name): local.name(name) for name, _ in type.fields}
        elif isinstance(type, Array):
            names.structs[type] = namer.name(_array_name(type))
    for function in module.functions:
        names.functions[function.name] = namer.name(function.name)
    nodes = list(all_expressions(module))
    names.tables = [namer.name("table") for e in nodes if is_table(e)]
    names.constants = [namer.name("constant") for e in nodes if is_literal_operation(e)]
    return names


def all_expressions(module: Module) -> Iterator[Expr]:
    """Yield every expression of all functions and of the per-frame part."""
    yield from nodes_in(*(value for _, value in module.frame))
    for function in module.functions:
        yield from expressions_in(function.body)


def _array_name(type: Type) -> str:
    match type:
        case Array(element, length):
            return f"Array_{_array_name(element).removeprefix('Array_')}_{length}"
        case _:
            return safe_name(str(type), Reserved(frozenset()))


def reachable(module: Module, roots: Iterable[Expr]) -> tuple[Function, ...]:
    """Return the functions that expressions call, directly or indirectly, callees first."""
    wanted = {e.function for e in nodes_in(*roots) if isinstance(e, Call)}
    found = []
    for function in reversed(module.functions):
        if function.name in wanted:
            found.append(function)
            wanted |= called_by(function)
    return tuple(reversed(found))


def called_by(function: Function) -> set[str]:
    """Return the names of the functions that a function calls directly."""
    return {e.function for e in expressions_in(function.body) if isinstance(e, Call)}


def types_in(module: Module, functions: Iterable[Function]) -> Iterator[Type]:
    """Yield the structs and arrays that functions and the per-frame part use, inner types first."""
    seen: set[Type] = set()
    frame = [value for _, value in module.frame]
    for e in nodes_in(*frame):
        yield from _parts(e.type, seen)
    for function in functions:
        yield from types_of(function, seen)


def types_of(function: Function, seen: set[Type] | None = None) -> Iterator[Type]:
    """Yield the structs and arrays that a function uses, except those in ``seen``."""
    seen = set() if seen is None else seen
    for param in function.params:
        yield from _parts(param.type, seen)
    yield from _parts(function.result, seen)
    for e in expressions_in(function.body):
        yield from _parts(e.type, seen)


def _parts(type: Type, seen: set[Type]) -> Iterator[Type]:
    if type in seen:
        return
    seen.add(type)
    match type:
        case Struct(_, fields):
            for _, inner in fields:
                yield from _parts(inner, seen)
            yield type
        case Array(element):
            yield from _parts(element, seen)
            yield type
        case Buffer(element):
            yield from _parts(element, seen)
        case _:
            return
