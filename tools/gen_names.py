"""Write the names that the studio completes: ``web/src/generated/names.ts``.

The public names of ``distal`` and ``distal.lang`` and the methods of shapes, each with its
arguments and the first line of its docstring. Run it after any change of these, then build the
studio; a test fails when it was forgotten.
"""

from __future__ import annotations

import ast
import enum
import inspect
import json
from pathlib import Path
from typing import Any

import distal
from distal import Shape, lang

ROOT = Path(__file__).parents[1]
FILE = ROOT / "web" / "src" / "generated" / "names.ts"
STUB = ROOT / "src" / "distal" / "lang" / "__init__.pyi"

NOTE = "// Made by tools/gen_names.py from the public names: change these, and run it.\n"
_LONGEST = 110


def text() -> str:
    """Return what the file says."""
    tables = {"DISTAL": _named(distal), "LANGUAGE": _named(lang), "METHODS": _members(Shape)}
    made = [
        NOTE,
        "/** By name: the arguments, and what it is. */\n",
        "export type Names = Record<string, [string, string]>;\n",
    ]
    for name, rows in tables.items():
        lines = "".join(f"  {json.dumps(n)}: {json.dumps(row)},\n" for n, row in rows.items())
        made.append(f"\nexport const {name}: Names = {{\n{lines}}};\n")
    return "".join(made)


def _named(module: Any) -> dict[str, list[str]]:
    overloads = _overloads() if module is lang else {}
    found: dict[str, list[str]] = {}
    for name in sorted(module.__all__):
        value = getattr(module, name)
        if not inspect.ismodule(value):
            own = _arguments(value)
            known = overloads.get(name) if own.startswith(("(*args", "(*parts")) else None
            found[name] = [known or own, _about(value)]
    return found


def _members(cls: type) -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}
    for name in sorted(n for n in dir(cls) if not n.startswith("_")):
        value = inspect.getattr_static(cls, name)
        value = value.__func__ if isinstance(value, classmethod | staticmethod) else value
        found[name] = [_arguments(value), _about(value)]
    return found


def _about(value: Any) -> str:
    plain = not (inspect.isclass(value) or callable(value) or isinstance(value, property))
    if plain:
        return ""
    lines = (inspect.getdoc(value) or "").splitlines()
    return lines[0].replace("``", "") if lines else ""


def _arguments(value: Any) -> str:
    """Return the arguments in parentheses, without types; "" for what is not called."""
    if not callable(value):
        return ""
    if isinstance(value, enum.EnumType):
        return "(value)"  # what Python says of it depends on its version
    try:
        parameters = inspect.signature(value).parameters.values()
    except (TypeError, ValueError):
        return ""
    parts = [_parameter(p) for p in parameters if p.name not in ("self", "cls", "blend_numbers")]
    whole = ", ".join(parts)
    if len(whole) > _LONGEST:
        whole = f"{whole[:_LONGEST].rpartition(', ')[0]}, …"
    return f"({whole})"


def _parameter(parameter: inspect.Parameter) -> str:
    stars = {parameter.VAR_POSITIONAL: "*", parameter.VAR_KEYWORD: "**"}.get(parameter.kind, "")
    if parameter.default is parameter.empty:
        return f"{stars}{parameter.name}"
    default = repr(parameter.default).replace("vec3(", "(").replace("vec2(", "(")
    return f"{parameter.name}={default if len(default) < 30 else '…'}"


def _overloads() -> dict[str, str]:
    """Return the arguments of the language's functions, from the first overload in the stub."""
    found: dict[str, str] = {}
    for node in ast.parse(STUB.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.FunctionDef) and node.name not in found:
            names = [
                a.arg for a in (*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs)
            ]
            found[node.name] = f"({', '.join(name.removeprefix('__') for name in names)})"
    return found


if __name__ == "__main__":
    FILE.write_text(text(), encoding="utf-8")
    print(FILE.relative_to(ROOT))
