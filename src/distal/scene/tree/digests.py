"""Digests of objects that an author makes: equal objects have equal ones.

Input: nodes, and whatever objects and functions hold. Output: 16 bytes. Rules, numbers, materials
and names count; places in the author's files and classes do not. Textures and arrays count by their
content, a file by its path, a live texture by what it shows. What is opaque counts by identity, so
that such digests are equal in one process only.
"""

from __future__ import annotations

import itertools
import os
from collections.abc import Callable, Iterator, Mapping
from dataclasses import MISSING, fields, is_dataclass
from enum import Enum
from hashlib import blake2b
from types import BuiltinFunctionType, FunctionType, GenericAlias, ModuleType
from typing import Any, Final

from distal.fields.guarantees import Operator, Primitive
from distal.frontend.function_contents import attributes_read, contents_of, values_read
from distal.ir.interning import Interned
from distal.ir.nodes import Expr
from distal.ir.walk import nodes_in
from distal.lang.expressions import Expression
from distal.lang.functions import Func, is_fixed
from distal.lang.identity_map import IdentityMap
from distal.lang.names import LangForm, LangFunction
from distal.lang.parameters import Parameter
from distal.lang.resources import Buffer, TextureValue
from distal.lang.structs import METHODS, is_struct
from distal.lang.values import MatrixValue, VectorValue
from distal.scene.tree.calls import FunctionCall
from distal.scene.tree.conversion import Number
from distal.scene.tree.node import Node
from distal.scene.tree.rules import name_of
from distal.scene.tree.value import AuthorObject
from distal.scene.tree.varying import VaryingNumber

_SIZE: Final = 16
_PLAIN: Final = frozenset((bool, int, float, str, bytes, type(None)))
# Opaque objects by number; the process is part of it, because digests of functions travel.
_PROCESS: Final = os.urandom(8).hex()
_numbers: IdentityMap[int] = IdentityMap()
_kept: dict[int, tuple[Any, int]] = {}
_next_number = itertools.count()


def digest_of_node(root: Node) -> bytes:
    """Return the digest of a tree; it is kept with each node."""
    digest, waiting = Digest(), [root]
    while waiting:
        node = waiting[-1]
        missing = [child for child in node.children if child.known("digest") is None]
        if node.known("digest") is None and missing:
            waiting.extend(missing)
            continue
        waiting.pop()
        node.derived("digest", lambda node=node: digest.of("node", *_parts_of(node)))  # type: ignore[misc]
    whole: bytes = root.known("digest")
    return whole


def digest_of(*values: Any) -> bytes:
    """Return the digest of values together."""
    return Digest().of(*values)


def _parts_of(node: Node) -> Iterator[Any]:
    yield from (node.rule, node.flat, node.label, node.numbers, node.constants)
    yield from (node.material, node.cut_material)
    yield [child.known("digest") for child in node.children]


class Digest:
    """Digests of values; a function, a struct and a rule are read once."""

    def __init__(self) -> None:
        self._digests: dict[int, bytes] = {}
        self._alive: list[Any] = []  # what the digests are of, so that no identity recurs
        self._in_progress: list[Any] = []
        self._outermost = 0  # the first of those in progress that what was just read refers to

    def of(self, *values: Any) -> bytes:
        """Return the digest of values together."""
        return digest_of_bytes("\0".join(self._texts(values)).encode("utf-8", "surrogatepass"))

    def _texts(self, values: Any) -> Iterator[str]:
        yield f"({len(values)}"
        for value in values:
            kind = type(value)
            if kind in _PLAIN:
                yield f"{kind.__name__} {value + 0.0 if kind is float else value!r}"
            elif kind is Number and type(value.value) is float:
                yield f"{value.type} {value.value + 0.0!r}"  # -0.0 draws what 0.0 draws
            elif kind is Number and type(value.value) is tuple:
                yield f"{value.type} {[component + 0.0 for component in value.value]!r}"
            else:
                yield from self._text(value)

    def _text(self, value: Any) -> Iterator[str]:
        match value:
            case AuthorObject():
                yield value._digest().hex()
            case FunctionCall():
                yield "call"
                yield from self._texts((value.func, value.values))
            case Number():
                yield from self._texts([str(value.type), *_fields_of(value)[1:]])
            case tuple() | list():
                yield from self._texts(value)
            case Mapping():
                yield "mapping"
                yield from self._texts([*value, *value.values()])
            case Enum():
                yield f"{type(value).__qualname__}.{value.name}"
            case bool() | int() | float() | str():
                yield f"{type(value).__name__} {_plain(value)!r}"
            case Primitive() | Operator():
                yield name_of(value) or self._once(value, self._of_fields).hex()
            case Func() if all(map(is_fixed, value.overloads)):
                yield f"function {value.__module__}.{value.__qualname__}"
            case Func():
                yield self._once(value, self._of_function).hex()
            case Expression():
                yield self._of_expression(value.node).hex()
                yield from self._texts(value.parameters)
            case Parameter():
                yield f"parameter {value.name} {value.default!r} {value.interface}"
            case VaryingNumber():
                yield from self._texts(("varying", value.name, value.number))
            case TextureValue() | Buffer():
                yield type(value).__name__
                yield from self._texts([*vars(value), *vars(value).values()])
            case _:
                yield from self._text_of_read(value)

    def _text_of_read(self, value: Any) -> Iterator[str]:
        """Yield the text of what only functions read, and of arrays."""
        match value:
            case VectorValue() | MatrixValue() | GenericAlias():
                yield repr(value)
            case set() | frozenset():
                yield f"set {sorted(map(repr, value))}"
            case LangFunction() | LangForm():
                yield f"distal.lang {value.__name__}"
            case Interned():
                yield self._once(value, self._of_ir).hex()
            case os.PathLike():
                yield f"path {os.fspath(value)!r}"
            case ModuleType():
                yield f"module {value.__name__}"
            case type() if is_struct(value):
                yield self._once(value, self._of_struct).hex()
            case type() | FunctionType() | BuiltinFunctionType():
                name = f"{value.__module__}.{value.__qualname__}"
                yield name if "<locals>" not in name else _opaque(value)
            case _ if is_dataclass(value):
                yield type(value).__qualname__
                yield from self._texts(_fields_of(value))
            case _ if hasattr(value, "tobytes") and hasattr(value, "dtype"):
                yield f"array {value.dtype} {value.shape}"
                if value.dtype.hasobject:
                    yield from self._texts(value.ravel().tolist())
                else:
                    yield digest_of_bytes(value.tobytes()).hex()
            case _:
                yield _opaque(value)

    def _once(self, value: Any, digest: Callable[[Any], bytes]) -> bytes:
        """Return the digest of what may refer to itself, computed once.

        What is in progress already is there by its distance in the chain. A digest with such a
        distance in it that leads out of its object is right in this chain only, and not kept.
        """
        if id(value) in self._digests:
            return self._digests[id(value)]
        own = len(self._in_progress)
        for index, other in enumerate(self._in_progress):
            if other is value:
                self._outermost = min(self._outermost, index)
                return f"{own - index} above".encode()
        before, self._outermost = self._outermost, own
        self._in_progress.append(value)
        try:
            computed = digest(value)
        finally:
            self._in_progress.pop()
        if self._outermost >= own:
            self._alive.append(value)
            self._digests[id(value)] = computed
        self._outermost = min(before, self._outermost)
        return computed

    def _of_fields(self, value: Any) -> bytes:
        return self.of(*_fields_of(value))

    def _of_expression(self, root: Expr) -> bytes:
        # Operands come before users, so that nothing here is deep.
        for node in nodes_in(root):
            self._once(node, self._of_ir)
        return self._once(root, self._of_ir)

    def _of_ir(self, node: Any) -> bytes:
        names = (field.name for field in fields(node) if field.name != "span")
        return self.of(type(node).__name__, *(getattr(node, name) for name in names))

    def _of_struct(self, cls: Any) -> bytes:
        defaults = [None if f.default is MISSING else f.default for f in fields(cls)]
        annotations = [a if isinstance(a, str) else repr(a) for a in cls.__annotations__.values()]
        names, methods = list(cls.__annotations__), getattr(cls, METHODS, {})
        return self.of(cls.__qualname__, names, annotations, defaults, methods)

    def _of_function(self, function: Func) -> bytes:
        """Return the digest of a function's text and of the values that it reads."""
        if function.remade is not None:
            return self.of(*function.remade)
        parts: list[Any] = []
        for overload in function.overloads:
            python = overload.python
            parts += [contents_of(overload).text, overload.apart, overload.takes_self]
            parts += [python.__defaults__, python.__kwdefaults__]
            for name, value in values_read(overload).items():
                is_module = isinstance(value, ModuleType)
                read = attributes_read(overload, name, value) if is_module else None
                parts += [name, value, read]
        return self.of(type(function).__name__, *parts)


def _fields_of(value: Any) -> list[Any]:
    return [getattr(value, field.name) for field in fields(value) if field.compare]


def _plain(value: Any) -> Any:
    """Return a number of a subclass, such as one of NumPy, as one of Python."""
    return next(kind(value) for kind in (bool, int, float, str) if isinstance(value, kind))


def digest_of_bytes(data: bytes) -> bytes:
    """Return the digest of bytes."""
    return blake2b(data, digest_size=_SIZE).digest()


def _opaque(value: Any) -> str:
    """Return a text for an object by its identity; numbers are never used again."""
    number = _numbers.get(value)
    if number is None and id(value) in _kept:
        number = _kept[id(value)][1]
    if number is None:
        number = next(_next_number)
        try:
            _numbers[value] = number
        except TypeError:  # no weak reference: it is kept alive
            _kept[id(value)] = (value, number)
    return f"object {_PROCESS} {os.getpid()} {number}"
