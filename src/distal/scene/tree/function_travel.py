"""Authors' functions in pickles: as their source and the values that they read.

Input: a ``Func``. Output: what ``pickle`` stores of it. A function that an import finds is stored
by its name. Another one (of ``__main__``, of a notebook's cell, of a function, of a file that
``distal.load`` ran) is stored as the lines of its file and the values of the names in it, so that
its errors keep file and line in the other process.
"""

from __future__ import annotations

import ast
import copy
import dataclasses
import importlib
import linecache
import sys
from collections.abc import Mapping
from types import CodeType, FunctionType, ModuleType
from typing import Any, Final
from weakref import WeakValueDictionary

from distal.frontend.function_contents import attributes_read, values_read
from distal.frontend.parsing import parse
from distal.frontend.source import parse_definition
from distal.lang.functions import Func, Overload
from distal.lang.source import Source
from distal.lang.structs import METHODS, Method, StructNames, is_struct, struct
from distal.library_stamp import check_stamp, library_stamp
from distal.scene.tree.digests import digest_of

# What has come from other processes, by digest: a function that comes twice is one object.
_functions: WeakValueDictionary[bytes, Func] = WeakValueDictionary()
_structs: WeakValueDictionary[bytes, type] = WeakValueDictionary()
# The attribute of a struct with its wrapper: pickles share an object that they meet again.
_WRAPPER: Final = "__distal_wrapper__"


def reduced(function: Func) -> Any:
    """Return what ``Func.__reduce__`` gives.

    Raises:
        CompileError: The source text is not available.
    """
    if function.remade is not None:
        make, data = function.remade
        return make, (data,)
    if _is_importable(function):
        return function.__qualname__
    key = (type(function), digest_of(function), library_stamp())
    return _function_of_digest, key, _state_of(function), None, None, _complete


def _is_importable(value: Any) -> bool:
    """Return whether an import in another process finds a function, a class or a module."""
    is_module = isinstance(value, ModuleType)
    module: Any = sys.modules.get(value.__name__ if is_module else value.__module__)
    if module is None or module.__name__ == "__main__" or getattr(module, "__spec__", None) is None:
        return False
    named = module
    for part in () if is_module else value.__qualname__.split("."):
        named = getattr(named, part, None)
    return named is value


def _function_of_digest(kind: type[Func], digest: bytes, stamp: str) -> Func:
    check_stamp(stamp)
    function = _functions.get(digest)
    if function is None:
        function = _functions.setdefault(digest, kind.__new__(kind))
    return function


# Writing


def _state_of(function: Func) -> dict[str, Any]:
    names = ("__name__", "__qualname__", "__module__", "__doc__")
    state = {name: getattr(function, name) for name in names}
    if "number" in function.__dict__:
        state["number"] = function.__dict__["number"]
    return {**state, "overloads": [_overload_state(o) for o in function.overloads]}


def _overload_state(overload: Overload) -> dict[str, Any]:
    python, source = overload.python, overload.source
    values = {
        name: _packed_module(overload, name, value)
        if isinstance(value, ModuleType)
        else _packed(value)
        for name, value in values_read(overload).items()
    }
    return {
        "source": (source.file, source.lines, source.first_line),
        "name": python.__code__.co_name,
        "defaults": (_packed(python.__defaults__), _packed(python.__kwdefaults__)),
        "values": values,
        "apart": overload.apart,
        "struct": None if overload.struct is None else _packed(overload.struct),
        "takes_self": overload.takes_self,
    }


def _packed_module(overload: Overload, name: str, module: ModuleType) -> ModuleByName:
    """Return a module that a function reads by a name, as pickle can store it."""
    importable = _is_importable(module)
    parts = {} if importable else attributes_read(overload, name, module)
    return ModuleByName(module.__name__, _packed(parts), importable)


def _packed(value: Any) -> Any:
    """Return a value that pickle can store, which becomes the value when it is read."""
    if is_struct(value) and not _is_importable(value):
        if _WRAPPER not in vars(value):
            setattr(value, _WRAPPER, StructByFields(value))
        return vars(value)[_WRAPPER]
    if is_struct(type(value)) and not _is_importable(type(value)):
        return StructValue(_packed(type(value)), [_packed(v) for v in vars(value).values()])
    if type(value) in (tuple, list):
        return type(value)(map(_packed, value))
    if type(value) is dict:
        return {name: _packed(each) for name, each in value.items()}
    return value


class ModuleByName:
    """A module in a pickle: its name, or if no import finds it, the attributes that are read."""

    def __init__(self, name: str, parts: Mapping[str, Any], importable: bool) -> None:
        self._made = (name, dict(parts), importable)

    def __reduce__(self) -> Any:
        return _module_of, self._made


class StructByFields:
    """A struct of an author's file in a pickle: its fields, and its methods after it."""

    def __init__(self, cls: type) -> None:
        self._cls = cls

    def __reduce__(self) -> Any:
        cls: Any = self._cls
        annotations = {name: _packed(a) for name, a in cls.__annotations__.items()}
        defaults = {
            f.name: _packed(f.default)
            for f in dataclasses.fields(cls)
            if f.default is not dataclasses.MISSING
        }
        names = _names_of_annotations(cls)
        made = (cls.__name__, cls.__qualname__, cls.__module__, annotations, defaults)
        key = (digest_of(cls), library_stamp())
        return _struct_of, (*key, *made), (names, _methods_of(cls)), None, None, _adopt


class StructValue:
    """A value of a struct of an author's file in a pickle."""

    def __init__(self, cls: Any, values: list[Any]) -> None:
        self._cls, self._values = cls, values

    def __reduce__(self) -> Any:
        return _struct_value, (self._cls, self._values)


def _names_of_annotations(cls: Any) -> dict[str, Any]:
    """Return the values of the names in the annotations of a struct that are text."""
    spaces: StructNames = cls.__distal_struct__
    texts = [a for a in cls.__annotations__.values() if isinstance(a, str)]
    nodes = (node for text in texts for node in ast.walk(parse(text, mode="eval")))
    names = {node.id for node in nodes if isinstance(node, ast.Name)}
    values = {**spaces.module, **spaces.enclosing}
    return {name: _packed(values[name]) for name in sorted(names) if name in values}


def _methods_of(cls: type) -> list[tuple[str, Func, bool]]:
    """Return the scene functions of a struct: their names, and whether they are static."""
    bound = [(name, m.func, False) for name, m in vars(cls).items() if isinstance(m, Method)]
    static = [(name, m) for name, m in vars(cls).items() if isinstance(m, staticmethod)]
    return [*bound, *((n, m.__func__, True) for n, m in static if isinstance(m.__func__, Func))]


# Reading


def _complete(function: Func, state: Mapping[str, Any]) -> None:
    """Give a function what it consists of; it may be a part of that."""
    if "overloads" in function.__dict__:
        return
    names = {name: value for name, value in state.items() if name != "overloads"}
    overloads = [_overload_of(row, state) for row in state["overloads"]]
    function.__dict__.update(names, __wrapped__=overloads[0].python, overloads=overloads)


def _overload_of(row: Mapping[str, Any], state: Mapping[str, Any]) -> Overload:
    file, lines, first_line = row["source"]
    if not linecache.getlines(file):
        # Without a time of change, so that it is kept.
        linecache.cache[file] = (sum(map(len, lines)), None, list(lines), file)
    source = Source(file, lines, first_line)
    names = {"__name__": state["__module__"], "__file__": file, **row["values"]}
    positional, by_name = row["defaults"]
    python = FunctionType(_code_of(source, row["name"]), names, row["name"], positional)
    python.__kwdefaults__ = by_name
    python.__qualname__, python.__module__ = state["__qualname__"], state["__module__"]
    python.__doc__ = state["__doc__"]
    return Overload(python, source, {}, row["apart"], row["struct"], row["takes_self"])


def _code_of(source: Source, name: str) -> CodeType:
    """Return the code of a function, compiled again: what it reads of its closure is global."""
    node, places = parse_definition(source, name)
    node = copy.deepcopy(node)
    ast.increment_lineno(node, places.span(node.body[0]).line - node.body[0].lineno)
    code = compile(ast.Module([node], []), source.file, "exec", dont_inherit=True)
    codes = (c for c in code.co_consts if isinstance(c, CodeType))
    return next(c for c in codes if c.co_name == name)


def _module_of(name: str, parts: Mapping[str, Any], importable: bool) -> ModuleType:
    if importable:
        return importlib.import_module(name)
    module = ModuleType(name)
    module.__dict__.update(parts)
    return module


def _struct_of(
    digest: bytes,
    stamp: str,
    name: str,
    qualname: str,
    module: str,
    annotations: Mapping[str, Any],
    defaults: Mapping[str, Any],
) -> type:
    check_stamp(stamp)
    cls = _structs.get(digest)
    if cls is None:
        body = {"__annotations__": dict(annotations), "__module__": module, **defaults}
        new = struct(type(name, (), {**body, "__qualname__": qualname}))
        cls = _structs.setdefault(digest, new)
    return cls


def _adopt(cls: Any, state: tuple[Mapping[str, Any], list[tuple[str, Func, bool]]]) -> None:
    """Give a struct its methods, and the values of names in its annotations."""
    names, methods = state
    cls.__distal_struct__ = StructNames(names, {})
    for name, function, is_static in methods:
        setattr(cls, name, staticmethod(function) if is_static else Method(function))
    if methods:
        setattr(cls, METHODS, {name: f for name, f, is_static in methods if not is_static})


def _struct_value(cls: Any, values: list[Any]) -> Any:
    return cls(*values)
