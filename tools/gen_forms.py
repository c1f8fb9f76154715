"""Write the forms of the worker's messages as data: ``web/src/generated/forms.ts``.

Made of the classes of ``distal/editor/messages`` and of the interfaces of ``web/src/payload.ts``,
which these name. What a playground's cell sends is a stranger's: the page checks it against these
forms (``web/src/studio/forms.ts``). Run it after any change of these; a test fails when it was
forgotten.

A form is one of: "s" a text, "n" a finite number, "i" a whole number, "b" true or false, "0" null,
"*" anything, the name of a record, or a list: ["|", forms], ["=", values], ["[]", form of a list's
items], ["()", forms of a tuple], ["{}", form of an object's values]. A record is an object of forms
by field; a field with a question mark may be left out.
"""

from __future__ import annotations

import json
import re
import sys
import types
import typing
from dataclasses import is_dataclass
from pathlib import Path
from typing import Annotated, Any, Final, Literal, TypeAlias, Union

from distal.editor import messages

ROOT: Final = Path(__file__).parents[1]
FILE: Final = ROOT / "web" / "src" / "generated" / "forms.ts"
PAYLOAD: Final = ROOT / "web" / "src" / "payload.ts"
NOTE: Final = """\
// Made by tools/gen_forms.py from src/distal/editor/messages and web/src/payload.ts: change these,
// and run it.

/** A type of JSON values; `tools/gen_forms.py` says how it is written. */
export type Form = string | readonly [string, ...unknown[]];
export type FormRecord = Readonly<Record<string, Form>>;
"""
Form: TypeAlias = str | list[Any]
PLAIN: Final = {str: "s", int: "i", float: "n", bool: "b", types.NoneType: "0"}
NAMED: Final = {"string": "s", "number": "n", "boolean": "b", "null": "0", "unknown": "*"}


def union(forms: list[Form]) -> Form:
    """Return the form of values that have one of several forms."""
    flat = [x for form in forms for x in (form[1:] if form[0] == "|" else [form])]
    words = [value for form in flat if form[0] == "=" for value in form[1:]]
    rest = [form for form in flat if form[0] != "="]
    unique = list({json.dumps(form): form for form in rest}.values())
    all_forms = [*unique, *([["=", *dict.fromkeys(words)]] if words else [])]
    return all_forms[0] if len(all_forms) == 1 else ["|", *all_forms]


def form_of(wanted: Any) -> Form:
    """Return the form of a type of a message's field."""
    origin, inner = typing.get_origin(wanted), typing.get_args(wanted)
    if origin is Annotated:
        return Interfaces.one(str(inner[1]))
    if origin in (Union, types.UnionType):
        return union([form_of(member) for member in inner])
    if origin is Literal:
        return ["=", *inner]
    if origin is tuple:
        return ["[]", form_of(inner[0])] if inner[-1] is ... else ["()", *map(form_of, inner)]
    if origin is dict:
        return ["{}", form_of(inner[1])]
    return wanted.__name__ if is_dataclass(wanted) else PLAIN[wanted]


class Interfaces:
    """Reads the types of TypeScript's declarations, one token after the other."""

    records: typing.ClassVar[dict[str, Any]] = {}
    _TOKEN: Final = re.compile(r'"[^"]*"|\w+|\[\]|\?:|[{}\[\]()<>|&;:,]')

    def __init__(self, text: str) -> None:
        self.tokens = self._TOKEN.findall(text)

    @classmethod
    def one(cls, text: str) -> Form:
        """Return the form of a type."""
        return cls(text).type()

    @classmethod
    def read(cls, text: str) -> None:
        """Read all types that a module exports."""
        text = re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL)
        for name, body in re.findall(
            r"^export interface (\w+) (\{.*?^\})", text, re.MULTILINE | re.DOTALL
        ):
            cls.records[name] = cls(body).record()
        for name, body in re.findall(
            r"^export type (\w+) =\s*(.*?);$", text, re.MULTILINE | re.DOTALL
        ):
            cls.records[name] = cls.one(body)

    def take(self, token: str) -> bool:
        """Take the next token if it is this one."""
        is_next = bool(self.tokens) and self.tokens[0] == token
        if is_next:
            self.tokens.pop(0)
        return is_next

    def type(self) -> Form:
        """Return the form of a union."""
        self.take("|")
        members = [self.intersection()]
        while self.take("|"):
            members.append(self.intersection())
        return union([member for member in members if member != "undefined"])

    def intersection(self) -> Form:
        """Return the form of one member of a union."""
        parts = [self.listed()]
        while self.take("&"):
            parts.append(self.listed())
        if len(parts) == 1:
            return parts[0]
        return ["r", {k: v for part in parts for k, v in self._fields(part).items()}]

    def listed(self) -> Form:
        """Return the form of a type with what follows it: ``[]``, or the name of a field."""
        form = self.plain()
        while self.tokens:
            if self.take("[]"):
                form = ["[]", form]
            elif len(self.tokens) > 2 and self.tokens[0] == "[" and self.tokens[2] == "]":
                _, field, _ = (self.tokens.pop(0) for _ in range(3))
                form = self._fields(form)[json.loads(field)]
            else:
                break
        return form

    def plain(self) -> Form:
        """Return the form of a type without what follows it."""
        token = self.tokens[0]
        if token == "{":
            return ["r", self.record()]
        self.tokens.pop(0)
        if token == "[":
            return self.tuple()
        if token == "(":
            form = self.type()
            self.take(")")
            return form
        if token in ("Record", "Omit"):
            self.take("<")
            first = self.type()
            self.take(",")
            second = self.type()
            self.take(">")
            if token == "Record":
                return ["{}", second]
            return ["r", {k: v for k, v in self._fields(first).items() if k not in second[1:]}]
        if token.startswith('"') or token in ("true", "false"):
            return ["=", json.loads(token)]
        return NAMED.get(token, token)

    def tuple(self) -> Form:
        """Return the form of a tuple whose bracket is taken."""
        forms: list[Form] = ["()"]
        while not self.take("]"):
            if self.tokens[1] == ":":
                del self.tokens[:2]
            forms.append(self.type())
            self.take(",")
        return forms

    def record(self) -> dict[str, Form]:
        """Return the forms of an object's fields."""
        self.take("{")
        fields: dict[str, Form] = {}
        while not self.take("}"):
            name = self.tokens.pop(0)
            name += "?" if self.take("?:") else ""
            self.take(":")
            fields[name] = self.type()
            self.take(";")
        return fields

    def _fields(self, form: Form) -> dict[str, Form]:
        found = self.records[form] if isinstance(form, str) else form[1]
        return typing.cast("dict[str, Form]", found)


def records() -> dict[str, Any]:
    """Return the form of each record, and of each result by the kind of its request."""
    Interfaces.read(PAYLOAD.read_text(encoding="utf-8"))
    found = dict(Interfaces.records)
    for record in messages.records():
        if issubclass(record, messages.AppRequest | messages.Change):
            continue
        types_of = messages.field_types(record)
        kind = getattr(record, "kind", None)
        fields = {name: form_of(wanted) for name, wanted in types_of.items()}
        if kind == "answer":
            fields["result"] = "*"  # `RESULTS` has its form
        found[kind or record.__name__] = fields
    return found


def needed(found: dict[str, Any], names: list[str]) -> dict[str, Any]:
    """Return those of the records that messages have."""
    kept: dict[str, Any] = {}

    def add(name: str) -> None:
        if name in found and name not in kept:
            kept[name] = found[name]
            for word in re.findall(r'"(\w+)"', json.dumps(found[name])):
                add(word)

    for name in names:
        add(name)
    return kept


def text() -> str:
    """Return what the file says."""
    results = {made.kind: made.result for made in messages.REQUESTS if made.result is not None}
    names = {kind: made.__name__ for kind, made in results.items()}
    of_worker = [m.kind for m in messages.RESPONSES if m.kind not in ("changed", "restarted")]
    all_records = needed(records(), [*of_worker, *names.values()])
    rows = "".join(f"  {json.dumps(k)}: {json.dumps(v)},\n" for k, v in all_records.items())
    return (
        f"{NOTE}\n/** The messages of a worker. */\n"
        f"export const OF_WORKER: readonly string[] = {json.dumps(of_worker)};\n\n"
        "/** By the kind of a request: the record of its result. */\n"
        f"export const RESULTS: Readonly<Record<string, string>> = {json.dumps(names)};\n\n"
        "export const FORMS: Readonly<Record<string, Form | FormRecord>> = {\n" + rows + "};\n"
    )


if __name__ == "__main__":
    FILE.write_text(text(), encoding="utf-8")
    sys.stdout.write(f"{FILE.relative_to(ROOT)}\n")
