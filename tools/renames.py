"""Rewrite calls that use former names: ``.venv/bin/python tools/renames.py examples docs``.

Input: Python files, and Markdown files with Python in fenced blocks and in inline code. Output: the
same files; a line for each that changed. ``--check`` writes nothing and fails if a file would
change. Renamed keywords come from ``scene.tree.former_names``; what moved its place is passed by
name. A value that was half of an angle is doubled. Values in tables by name are left as they are.
"""

from __future__ import annotations

import argparse
import inspect
import re
import sys
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Final

import libcst as cst
from libcst import matchers as m

import distal
from distal.scene.tree.former_names import FORMER_NAMES, FORMER_OBJECTS, FORMER_WORDS, Renamed

# The arguments of shapes in their former order, if it changed or if some are passed by name now.
FORMER_ORDERS: Final[Mapping[str, tuple[str, ...]]] = {
    "Pie": ("radius", "angle"),
    "Arc": ("radius", "angle", "thickness"),
    "Ring": ("radius", "angle", "thickness"),
    "Horseshoe": ("radius", "angle", "legs", "thickness"),
    "CircleWave": ("radius", "angle", "thickness"),
    "InfiniteCone": ("angle",),
    "Wedge": ("angle",),
    "SolidAngle": ("angle", "radius"),
    "CappedTorus": ("angle", "major", "minor"),
    "Link": ("height", "major", "minor"),
    "VesicaSolid": ("height", "width"),
    "Prism": ("count", "apothem", "height"),
}
# Other names of calls in these tables.
ALIASES: Final = {"yaw_pitch_roll": "TurnedCamera"}
# Public objects under another spelling.
FORMER_SPELLINGS: Final = {"aluminium": "aluminum", "metre": "meter"}

_FENCED: Final = re.compile(
    r"^(?P<head>```python[^\n]*\n)(?P<code>.*?)^```", re.MULTILINE | re.DOTALL
)
_INLINE: Final = re.compile(r"(?<!`)`(?P<code>[^`\n]+)`(?!`)")
_SIGN: Final = cst.AssignEqual(cst.SimpleWhitespace(""), cst.SimpleWhitespace(""))


class Renames(cst.CSTTransformer):
    """Rewrites the calls of a module, but for those of what the module itself defines."""

    def __init__(self, module: cst.Module) -> None:
        super().__init__()
        defined = m.findall(module, m.ClassDef() | m.FunctionDef())
        self._from_distal = _imported(module)
        self._own = {d.name.value for d in defined if isinstance(d, cst.ClassDef | cst.FunctionDef)}

    def leave_Call(self, original_node: cst.Call, updated_node: cst.Call) -> cst.Call:  # noqa: N802
        """Rename keywords, and pass by name what moved its place."""
        name = _callee(updated_node)
        if name == "shell":
            return updated_node.with_changes(args=[_with_word(a) for a in updated_node.args])
        if name == "apply":
            return updated_node.with_changes(args=[_with_operator(a) for a in updated_node.args])
        if name in self._own or name not in {*FORMER_NAMES, *FORMER_ORDERS}:
            return updated_node
        args = _ordered(name, updated_node.args)
        return updated_node.with_changes(args=[_renamed(name, arg) for arg in args])

    def leave_Name(self, original_node: cst.Name, updated_node: cst.Name) -> cst.Name:  # noqa: N802
        """Spell public objects as they are spelled now."""
        name = updated_node.value
        if name in FORMER_OBJECTS and name in self._from_distal:
            return updated_node.with_changes(value=FORMER_OBJECTS[name].name)
        return updated_node.with_changes(value=FORMER_SPELLINGS.get(name, name))


def _imported(module: cst.Module) -> set[str]:
    """Return the names that a module imports from ``distal`` itself."""
    found: set[str] = set()
    for node in m.findall(module, m.ImportFrom(module=m.Name("distal"))):
        if isinstance(node, cst.ImportFrom) and not isinstance(node.names, cst.ImportStar):
            found |= {str(alias.evaluated_name) for alias in node.names}
    return found


def _callee(call: cst.Call) -> str:
    match call.func:
        case cst.Name(value=name) | cst.Attribute(attr=cst.Name(value=name)):
            return ALIASES.get(name, name)
    return ""


def _with_operator(arg: cst.Arg) -> cst.Arg:
    """Return an argument of ``apply`` under its name of now: the size of blends."""
    is_former = arg.keyword is not None and arg.keyword.value == "k"
    return arg.with_changes(keyword=cst.Name("smooth")) if is_former else arg


def _with_word(arg: cst.Arg) -> cst.Arg:
    """Return an argument with a former word for a choice replaced."""
    value = arg.value
    if isinstance(value, cst.SimpleString) and value.raw_value in FORMER_WORDS:
        word = FORMER_WORDS[value.raw_value]
        return arg.with_changes(value=cst.SimpleString(f"{value.quote}{word}{value.quote}"))
    return arg


def _renamed(name: str, arg: cst.Arg) -> cst.Arg:
    """Return an argument with the keyword of now, and its value doubled if it was a half."""
    if arg.keyword is None:
        return arg
    now = FORMER_NAMES.get(name, {}).get(arg.keyword.value)
    if now is None:
        return _with_word(arg)
    value = _with_word(arg).value
    value = value if now.factor == 1 else doubled(value)
    return arg.with_changes(keyword=cst.Name(now.name), value=value)


def _ordered(name: str, args: Iterable[cst.Arg]) -> list[cst.Arg]:
    """Return arguments by position in the order of now, with former names for those by name."""
    listed = list(args)
    former = FORMER_ORDERS.get(name)
    if former is None or any(a.star for a in listed):
        return listed
    changed = FORMER_NAMES.get(name, {})
    now = inspect.signature(getattr(distal, name)).parameters
    by_name = {p.name for p in now.values() if p.kind is p.KEYWORD_ONLY}
    used = {a.keyword.value for a in listed if a.keyword is not None}
    if used & (by_name - set(former)) or used & {former[0]} & by_name:
        return listed  # it is written in the order of now
    given = {_name_now(former[i], changed): a for i, a in enumerate(listed) if a.keyword is None}
    former_of = {_name_now(n, changed): n for n in former}
    names = {_name_now(n, changed): n for n in used}
    given |= {n: a for n in names for a in listed if a.keyword and a.keyword.value == names[n]}
    order = sorted(given, key=list(now).index)
    made: list[cst.Arg] = []
    by_position = True
    for place, key in enumerate(order):
        arg, like = given[key], listed[place]
        by_position = by_position and arg.keyword is None
        by_position = by_position and list(now)[place] == key and key not in by_name
        keyword = None if by_position else cst.Name(former_of.get(key, key))
        made.append(
            like.with_changes(
                value=arg.value,
                keyword=keyword,
                equal=cst.MaybeSentinel.DEFAULT if keyword is None else _SIGN,
            )
        )
    return made


def _name_now(former: str, changed: Mapping[str, Renamed]) -> str:
    return changed[former].name if former in changed else former


# Values


def doubled(value: cst.BaseExpression) -> cst.BaseExpression:
    """Return twice a value: a number is computed, a half loses its half."""
    number = _number(value)
    if number is not None:
        return _literal(2 * number)
    if isinstance(value, cst.BinaryOperation):
        if isinstance(value.operator, cst.Divide) and _number(value.right) == 2:
            return value.left
        factor = _number(value.left)
        if factor is not None and isinstance(value.operator, cst.Multiply | cst.Divide):
            if factor == 0.5 and isinstance(value.operator, cst.Multiply):
                return value.right
            return value.with_changes(left=_literal(2 * factor))
    sums = (cst.BinaryOperation, cst.IfExp, cst.Lambda, cst.BooleanOperation, cst.Comparison)
    product = isinstance(value, cst.BinaryOperation) and isinstance(
        value.operator, cst.Multiply | cst.Divide
    )
    if isinstance(value, sums) and not product and not value.lpar:
        value = value.with_changes(lpar=[cst.LeftParen()], rpar=[cst.RightParen()])
    if product and isinstance(value, cst.BinaryOperation):
        return value.with_changes(left=doubled(value.left))
    return cst.BinaryOperation(cst.Integer("2"), cst.Multiply(), value)


def _number(value: cst.BaseExpression) -> float | int | None:
    if isinstance(value, cst.Integer):
        return int(value.value)
    return float(value.value) if isinstance(value, cst.Float) else None


def _literal(number: float | int) -> cst.BaseExpression:
    return cst.Integer(str(number)) if isinstance(number, int) else cst.Float(repr(number))


# Files


def rewritten(code: str) -> str:
    """Return Python code with the names of now."""
    module = cst.parse_module(code)
    return module.visit(Renames(module)).code


def rewritten_document(text: str) -> str:
    """Return Markdown with the names of now in its Python."""

    def replaced(found: re.Match[str]) -> str:
        code = found["code"]
        try:
            return found[0].replace(code, rewritten(code))
        except cst.ParserSyntaxError:
            return found[0]

    return _INLINE.sub(replaced, _FENCED.sub(replaced, text))


def _files(paths: Iterable[str]) -> Iterator[Path]:
    for path in map(Path, paths):
        found = sorted(path.rglob("*")) if path.is_dir() else [path]
        yield from (f for f in found if f.suffix in (".py", ".md"))


def main() -> int:
    """Rewrite the files of the command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("paths", nargs="+", help="files and folders")
    parser.add_argument("--check", action="store_true", help="write nothing; fail if stale")
    options = parser.parse_args()
    stale = False
    for file in _files(options.paths):
        text = file.read_text(encoding="utf-8")
        try:
            new = rewritten_document(text) if file.suffix == ".md" else rewritten(text)
        except cst.ParserSyntaxError as error:
            print(f"{file}: not read: {error.message}", file=sys.stderr)
            continue
        if new != text:
            stale = True
            print(file)
            if not options.check:
                file.write_text(new, encoding="utf-8")
    return int(stale and options.check)


if __name__ == "__main__":
    sys.exit(main())
