"""What each name of a text stands for: two texts that differ in names only, held side by side.

In: a plain text, in which every thing has a name of its own, and a hostile text of the same
structure. Out: where the hostile text names two things alike that one scope sees. It knows of the
languages how a function and a local begin, and nothing of their types.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

_TOKEN = re.compile(r"[A-Za-z_]\w*|\d[\w.]*|\S")
_ATTRIBUTE = re.compile(r"@\w+(\([^)]*\))?")
_BEFORE_NO_NAME = frozenset({"return", "else", "in", "out", "flat", "const", "uniform", "highp"})


@dataclass
class Scope:
    """A function: names of both texts side by side, and which of the plain ones it declares."""

    title: str
    pairs: list[tuple[str, str]] = field(default_factory=list)
    declared: set[str] = field(default_factory=set)


def tokens(text: str) -> list[str]:
    """The tokens of a text without comments, directives and WGSL's attributes."""
    code = re.sub(r"/\*.*?\*/", " ", re.sub(r"//.*|^#.*", "", text, flags=re.M), flags=re.DOTALL)
    return _TOKEN.findall(_ATTRIBUTE.sub(" ", code))


def identifiers(text: str) -> set[str]:
    """The names in a text, those after a dot too."""
    return {token for token in tokens(text) if _is_name(token)}


def _is_name(token: str) -> bool:
    return token[0].isalpha() or token[0] == "_"


def conflicts(plain: str, hostile: str, given: Iterable[tuple[str, str]] = ()) -> Iterator[str]:
    """Each place where the hostile text means something else than the plain one.

    ``given``: what a host declares for the one and for the other.
    """
    ours, theirs = tokens(plain), tokens(hostile)
    if [_shape(t) for t in ours] != [_shape(t) for t in theirs]:
        yield "the texts differ in more than names"
        return
    outer, scopes = _scopes(ours, theirs)
    outer.pairs += given
    names = dict(outer.pairs)
    yield from _unclear(outer)
    for scope in scopes:
        where = scope.title
        yield from _unclear(scope)
        for ours_, theirs_ in dict.fromkeys(scope.pairs):
            if ours_ in scope.declared:
                continue
            if ours_ in names:
                if names[ours_] != theirs_:
                    yield f"{where}: {ours_} is {names[ours_]} outside and {theirs_} here"
            elif ours_ != theirs_:
                yield f"{where}: {ours_} of the language became {theirs_}"
            elif theirs_ in names.values():
                yield f"{where}: the module hides {theirs_} of the language"


def _shape(token: str) -> str:
    return "name" if _is_name(token) else token


def _unclear(scope: Scope) -> Iterator[str]:
    """Names that are two things, and things of two names, in one scope."""
    for here, there in ((0, 1), (1, 0)):
        known: dict[str, str] = {}
        for pair in dict.fromkeys(scope.pairs):
            first = known.setdefault(pair[here], pair[there])
            if first != pair[there]:
                yield f"{scope.title}: {pair[here]} stands for {first} and {pair[there]}"


def _scopes(ours: list[str], theirs: list[str]) -> tuple[Scope, list[Scope]]:
    """Module scope, and each function; members of structs belong to neither."""
    outer, scopes = Scope("module scope"), list[Scope]()
    scope, depth, brackets, is_struct = outer, 0, 0, False
    before, statement = "", list[str]()
    for i, (our, their) in enumerate(zip(ours, theirs, strict=True)):
        if our == "{":
            depth += 1
            is_struct = is_struct or (depth == 1 and "struct" in statement)
        elif our == "}":
            depth -= 1
            if depth == 0:
                scope, is_struct, statement = outer, False, []
        elif our in "()":
            brackets += 1 if our == "(" else -1
            begins = depth == 0 and our == "(" and brackets == 1 and "=" not in statement
            if begins and _opens_block(ours, i):
                scope = Scope(before)
                scopes.append(scope)
        elif our == ";" and depth == 0:
            statement = []
        elif _is_name(our) and before != "." and not (is_struct and depth):
            scope.pairs.append((our, their))
            if scope is not outer and _declares(before, our, ours[i + 1]):
                scope.declared.add(our)
        before = our
        if depth == 0:
            statement.append(our)
    return outer, scopes


def _opens_block(tokens: list[str], start: int) -> bool:
    """Whether a block comes after the bracket that opens here: it is the head of a function."""
    rest = tokens[start:]
    end = next((i for i, t in enumerate(rest) if t in "{;"), len(rest))
    return end < len(rest) and rest[end] == "{"


def _declares(before: str, name: str, after: str) -> bool:
    """Whether ``let name``, ``var name``, ``name:`` (WGSL) or ``type name`` (GLSL) stands here."""
    if after == ":" and before in ("(", ","):
        return True
    return bool(before) and _is_name(before) and before not in _BEFORE_NO_NAME and after in "=;,):["
