"""Write the types of the studio's messages for TypeScript: ``web/src/generated/messages.ts``.

Made of the classes of ``distal/editor/messages``. Run it after any change of these; a test fails
when it was forgotten.
"""

from __future__ import annotations

import inspect
import json
import sys
import types
import typing
from dataclasses import MISSING, fields, is_dataclass
from pathlib import Path
from typing import Annotated, Any, Literal, Union

from distal.editor import messages

ROOT = Path(__file__).parents[1]
FILE = ROOT / "web" / "src" / "generated" / "messages.ts"
NOTE = """\
// Made by tools/gen_messages.py from src/distal/editor/messages: change that, and run it.
// A field with a question mark has the default there where it is left out.

import type { Parameter, Payload, Program, UniformEntry } from "../payload";
"""
PLAIN = {str: "string", int: "number", float: "number", bool: "boolean", types.NoneType: "null"}


def written(wanted: Any) -> str:
    """Return a type as TypeScript writes it."""
    origin, inner = typing.get_origin(wanted), typing.get_args(wanted)
    if origin is Annotated:
        return str(inner[1])
    if origin in (Union, types.UnionType):
        return " | ".join(dict.fromkeys(map(written, inner)))
    if origin is Literal:
        return " | ".join(map(json.dumps, inner))
    if origin is tuple and inner[-1] is ...:
        element = written(inner[0])
        return f"({element})[]" if " | " in element else f"{element}[]"
    if origin is tuple:
        return f"[{', '.join(map(written, inner))}]"
    if origin is dict:
        return f"Record<string, {written(inner[1])}>"
    return wanted.__name__ if is_dataclass(wanted) else PLAIN[wanted]


def documentation(text: str, indent: str = "") -> str:
    """Return a comment."""
    lines = text.replace("``", "`").splitlines()
    if len(lines) == 1:
        return f"{indent}/** {lines[0]} */\n"
    return (
        f"{indent}/**\n"
        + "".join(f"{indent} * {x}".rstrip() + "\n" for x in lines)
        + f"{indent} */\n"
    )


def attributes(record: type) -> dict[str, str]:
    """Return what the docstrings of a record and its bases say of their fields."""
    found: dict[str, str] = {}
    for base in reversed(record.__mro__):
        _, _, listed = (inspect.cleandoc(base.__doc__ or "")).partition("Attributes:\n")
        name = ""
        for line in listed.splitlines():
            start, colon, rest = line.strip().partition(": ")
            if line.startswith("    ") and not line.startswith("     ") and colon:
                name, found[start] = start, rest
            elif name:
                found[name] += " " + line.strip()
    return found


def interface(record: type) -> str:
    """Return the interface of a record."""
    doc = inspect.cleandoc(record.__doc__ or "").partition("\n\nAttributes:")[0]
    about = attributes(record)
    lines = [documentation(doc), f"export interface {record.__name__} {{\n"]
    kind = getattr(record, "kind", None)
    if kind is not None:
        lines.append(f"  kind: {json.dumps(kind)};\n")
    hints = messages.field_types(record)
    for made in fields(record):
        has_default = made.default is not MISSING or made.default_factory is not MISSING
        optional = has_default and issubclass(record, messages.AppRequest | messages.Change)
        if made.name in about:
            lines.append(documentation(about[made.name], "  "))
        lines.append(f"  {made.name}{'?' if optional else ''}: {written(hints[made.name])};\n")
    return "".join(lines) + "}\n"


def answer() -> str:
    """Return the type of answers, one for each kind of request that has one."""
    kinds = {made.kind: made.result for made in messages.REQUESTS if made.result is not None}
    rows = "".join(f"  {kind}: {made.__name__};\n" for kind, made in kinds.items())
    doc = documentation("The result of each kind of request that is answered by `answer`.")
    return (
        f"{doc}export interface Results {{\n{rows}}}\n\n"
        + documentation("The result of a request; `request` is its kind.")
        + 'export type Answer = {\n  [K in keyof Results]: { kind: "answer"; id: number; '
        "revision: number; request: K; result: Results[K] };\n}[keyof Results];\n"
    )


def text() -> str:
    """Return the whole file."""
    parts = [NOTE]
    for name in ("Value", "LiteralValue"):
        parts.append(f"export type {name} = {written(getattr(messages, name))};\n")
    for record in messages.records():
        parts.append(answer() if record is messages.Answer else interface(record))
    for name, members in (("Request", messages.REQUESTS), ("Response", messages.RESPONSES)):
        union = " | ".join(made.__name__ for made in members)
        parts.append(f"export type {name} = {union};\n")
    return "\n".join(parts)


def main() -> None:
    """Write the file."""
    FILE.write_text(text(), encoding="utf-8")
    sys.stdout.write(f"{FILE.relative_to(ROOT)}\n")


if __name__ == "__main__":
    main()
