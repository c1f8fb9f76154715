"""Reports on errors that Python raises in the author's code.

Input: a file and the exception that stopped it. Output: a ``LoadError`` with the author's line, a
caret and, where a name is misspelled or a common mistake is known, what to write instead.
"""

from __future__ import annotations

import builtins
import inspect
import linecache
import pkgutil
import re
import sys
import types
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any, Final

from distal.diagnostics import Diagnostic, LoadError, Span
from distal.error_codes import ErrorCode
from distal.frontend.other_languages import COUNTERPARTS
from distal.frontend.problems import did_you_mean
from distal.lang.expressions import UnknownValue
from distal.packages import PACKAGES, explained

_USUAL_IMPORTS: Final = {"np": "import numpy as np", "numpy": "import numpy as np"}
_UNKNOWN_KEYWORD: Final = re.compile(r"^([\w.]+)\(\) got an unexpected keyword argument '(\w+)'")
_MISSING: Final = re.compile(
    r"^([\w.]+)\(\) missing \d+ required (?:positional|keyword-only) arguments?: (.+)$"
)
# What Python and NumPy say where a module stands for a number.
_NOT_MODULE: Final = re.compile(r"real number, not module|operand type.*'module'|type module ")
# Lines of GLSL and C; signs that text programs write.
_DECLARED: Final = re.compile(
    r"\s*(?:const\s+)?(?:float|int|uint|bool|[iub]?vec[234]|mat[234]|var|let|auto)\s+(\w+)\s*="
)
_STEPPED: Final = re.compile(r"(\w+)(\+\+|--)")
_WRITTEN: Final = {
    **{"&&": "and", "||": "or"},
    **dict.fromkeys("\u201c\u201d\u201e", '"'),
    **dict.fromkeys("\u2018\u2019", "'"),
    **dict.fromkeys("\u2013\u2212", "-"),
    "\u00d7": "*",
}
_USUAL_NAMES: Final = ("scene", "picture", "shape")
_MADE: Final = {"Picture": "render", "Mesh": "mesh", "Outline": "outline"}
_NOT_CALLED: Final = re.compile(r"operand type.*'(ABCMeta|type)'")
_OWN: Final = ("distal", "distal.lang")
_UNKNOWN_IMPORT: Final = re.compile(r"^cannot import name '(\w+)' from '([\w.]+)'")


def failure(file: Path, error: BaseException) -> LoadError:
    """Return the report for an error, with the line of the author's files where it was raised.

    Args:
        file: The scene's file, as the author named it.
        error: What stopped it.
    """
    span, frame = _innermost(file, error)
    reason, hint = explanation(error, frame, file.resolve().parent)
    if span is None:
        return LoadError(f"{reason}\n  --> {file}", None, reason, hint)
    shown = span.file
    if shown != str(file):  # a module in the same folder: show its path in the form of the scene's
        shown = str(file.parent / Path(shown).name)
    span = _at_keyword(span, error)
    at = Span(shown, span.line, span.col, span.end_col, span.text, span.end_line)
    text = Diagnostic(ErrorCode.FILE, reason, at, hint).text("").removeprefix(": ")
    return LoadError(text, span, reason, hint)


def _at_keyword(span: Span, error: BaseException) -> Span:
    """Return the place of the keyword that an error is about, if it is about one."""
    found = _UNKNOWN_KEYWORD.match(str(error)) if isinstance(error, TypeError) else None
    if found is None:
        return span
    given = re.search(rf"\b{found[2]}\s*=", span.text[span.col : span.end_col])
    if given is None:
        return span
    start = span.col + given.start()
    return Span(span.file, span.line, start, start + len(found[2]), span.text, span.line)


def _innermost(file: Path, error: BaseException) -> tuple[Span | None, types.FrameType | None]:
    """Return the innermost place in the author's files, and its frame."""
    span, frame = None, None
    folder = file.resolve().parent
    trace = error.__traceback__
    while trace is not None:
        code_file = trace.tb_frame.f_code.co_filename
        if code_file == str(file) or Path(code_file).parent == folder:
            span, frame = place_of(trace), trace.tb_frame
        trace = trace.tb_next
    return span, frame


def explanation(
    error: BaseException, frame: types.FrameType | None, folder: Path
) -> tuple[str, str | None]:
    """Return what an error says, and a hint.

    Args:
        error: The error.
        frame: The author's frame that it was raised in, if there is one.
        folder: The folder of the author's file.
    """
    kind = "TypeError" if isinstance(error, UnknownValue) else type(error).__name__
    try:
        found = explained(error) if isinstance(error, Exception) else None
        if found is not None:
            return str(found), None
        for base, explain in _EXPLAINED:
            if isinstance(error, base):
                message, hint = explain(error, frame, folder)
                return f"{kind}: {message}", hint
        return f"{kind}: {error}", None
    except Exception:  # the author's own class
        return f"{kind}: its text cannot be made", None


def _of_name(
    error: NameError, frame: types.FrameType | None, folder: Path
) -> tuple[str, str | None]:
    name = error.name
    if not name or isinstance(error, UnboundLocalError):
        return str(error), None
    hint = _import_of(name) or COUNTERPARTS.get(name) or _similar(name, _names_in(error))
    return str(error), hint


def _names_in(error: BaseException) -> list[str]:
    """Return the names that are known where an error was raised."""
    trace = error.__traceback__
    if trace is None:
        return dir(builtins)
    while trace.tb_next is not None:
        trace = trace.tb_next
    frame = trace.tb_frame
    return [*frame.f_locals, *frame.f_globals, *frame.f_builtins]


def _import_of(name: str) -> str | None:
    """Return the import that defines a name: of distal, its language, or a usual module."""
    if name in _USUAL_IMPORTS:
        return _USUAL_IMPORTS[name]
    for module in ("distal", "distal.lang"):
        found = sys.modules.get(module)
        if found is not None and not name.startswith("_") and name in _public(found):
            return f"from {module} import {name}"
    return f"import {name}" if name in sys.stdlib_module_names else None


def _public(module: types.ModuleType) -> list[str]:
    return [*getattr(module, "__all__", ()), *dir(module)]


def _similar(name: str, known: Iterable[str]) -> str | None:
    return did_you_mean(name, [other for other in known if not other.startswith("_")])


def _of_attribute(
    error: AttributeError, frame: types.FrameType | None, folder: Path
) -> tuple[str, str | None]:
    message, name = str(error), error.name
    said, _, instead = message.partition("; ")
    if not name or instead:  # the object's class says what to use
        return said, instead or None
    near = did_you_mean(name, [other for other in dir(error.obj) if not other.startswith("_")])
    if isinstance(error.obj, types.ModuleType):
        is_language = error.obj is sys.modules.get("distal.lang")
        known = COUNTERPARTS.get(name) if is_language else None
        return f"'{error.obj.__name__}' has no '{name}'", known or near
    return message, near


def _of_import(
    error: ImportError, frame: types.FrameType | None, folder: Path
) -> tuple[str, str | None]:
    found = _UNKNOWN_IMPORT.match(str(error))
    if found is not None:
        name, module = found.groups()
        known = sys.modules.get(module)
        others = [] if known is None else _public(known)
        of_others = COUNTERPARTS.get(name) if module in _OWN else None
        hint = _import_of(name) or of_others or _similar(name, others)
        return f"'{module}' has no '{name}'", hint
    if isinstance(error, ModuleNotFoundError) and error.name:
        top, _, rest = error.name.partition(".")
        if rest and top in sys.modules:
            return f"there is no module '{error.name}'", did_you_mean(error.name, _inside(top))
        own = ["distal", *(p.imported_as for p in PACKAGES), *(f.stem for f in folder.glob("*.py"))]
        return f"there is no module '{error.name}'", _similar(top, own)
    return str(error), None


def _inside(package: str) -> list[str]:
    """Return the names of the modules in a package."""
    paths = getattr(sys.modules[package], "__path__", [])
    return [f"{package}.{module.name}" for module in pkgutil.iter_modules(paths)]


def _of_type(
    error: TypeError, frame: types.FrameType | None, folder: Path
) -> tuple[str, str | None]:
    if isinstance(error, UnknownValue):
        return error.args[0], error.hint
    message = str(error)
    found = _UNKNOWN_KEYWORD.match(message)
    if found is not None:
        called, name = found.groups()
        message = f"{_shown(called)} has no '{name}'"
        function = _named(called, frame)
        if function is None:
            return message, None
        names = [key for key in inspect.signature(function).parameters if key != "self"]
        return message, did_you_mean(name, names) or f"it takes {', '.join(names)}"
    lacking = _MISSING.match(message)
    if lacking is not None:
        return f"{_shown(lacking[1])} needs {lacking[2]}", None
    if _NOT_MODULE.search(message) and frame is not None:
        time = frame.f_globals.get("time")
        if isinstance(time, types.ModuleType):
            return "'time' is Python's module here", "from distal import time, and np.sin(time)"
    if _NOT_CALLED.search(message):
        return message, "a class is no shape; call it: Box(…)"
    return message, None


def hint_of_syntax(line: str) -> str | None:
    """Return what to write instead of a line of GLSL or C; None if it is not one.

    Args:
        line: The line where Python stopped reading.
    """
    declared = _DECLARED.match(line)
    if declared is not None:
        return f"types are not written: {declared[1]} = …"
    stepped = _STEPPED.search(line)
    if stepped is not None:
        return f"write {stepped[1]} {stepped[2][0]}= 1"
    known = next((word for word in _WRITTEN if word in line), None)
    return None if known is None else f"write {_WRITTEN[known]} instead of {known}"


def hint_of_nothing(names: Mapping[str, Any], shown: type) -> str:
    """Return what a file that shows nothing may lack.

    Args:
        names: What the file defines.
        shown: The base class of shapes and scenes.
    """
    own = {k: v for k, v in names.items() if not k.startswith("_")}
    for name, value in own.items():
        parts = [*value] if isinstance(value, list | tuple) else []
        if parts and all(isinstance(part, shown) for part in parts):
            return f"'{name}' is a {type(value).__name__} of shapes: scene = Scene({name})"
        if isinstance(value, type) and issubclass(value, shown) and name in _USUAL_NAMES:
            return f"'{name}' is a class; call it: {value.__name__}(…)"
        if type(value).__module__.startswith("distal.") and type(value).__name__ in _MADE:
            made = type(value).__name__
            return f"'{name}' is a {made} already: leave out .{_MADE[made]}()"
    for name, value in own.items():
        if isinstance(value, types.FunctionType) and value.__module__ == names.get("__name__"):
            return f"{name}() is a function; give its result a name: scene = {name}()"
    return "scene = Scene(…)"


def _of_recursion(
    error: RecursionError, frame: types.FrameType | None, folder: Path
) -> tuple[str, str | None]:
    name = "a function" if frame is None else f"{frame.f_code.co_name}()"
    return f"{name} calls itself again and again", "return something else when n == 0"


def _shown(called: str) -> str:
    """Return a qualified name without the classes that an author does not know."""
    first, *rest = called.removesuffix(".__init__").split(".")
    known = first in _public(sys.modules["distal"]) if "distal" in sys.modules else False
    return ".".join([first, *rest] if known or not rest else rest)


def _named(name: str, frame: types.FrameType | None) -> Callable[..., Any] | None:
    """Return the function with a qualified name that the author's code can see."""
    first, *rest = name.split(".")
    scope = {} if frame is None else {**frame.f_globals, **frame.f_locals}
    found = scope.get(first)
    if found is None and first in dir(sys.modules.get("distal")):
        found = getattr(sys.modules["distal"], first)
    if found is None:  # a base class of distal's, which has no public name
        modules = [m for key, m in sys.modules.items() if key.startswith("distal.")]
        found = next((vars(m)[first] for m in modules if first in vars(m)), None)
    for part in rest:
        found = getattr(found, part, None)
    return found if callable(found) else None


_EXPLAINED: Final[tuple[tuple[type[Exception], Callable[..., tuple[str, str | None]]], ...]] = (
    (NameError, _of_name),
    (AttributeError, _of_attribute),
    (ImportError, _of_import),
    (TypeError, _of_type),
    (RecursionError, _of_recursion),
)


def place_of(trace: types.TracebackType) -> Span:
    """Return the expression that was evaluated when an error was raised."""
    code = trace.tb_frame.f_code
    linecache.checkcache(code.co_filename)
    line, col, end_col = trace.tb_lineno, 0, 0
    text = linecache.getline(code.co_filename, line).rstrip("\n")
    for number, (first, last, start, end) in enumerate(code.co_positions()):
        if number == trace.tb_lasti // 2 and start is not None and end is not None:
            if first == line:  # positions count bytes of UTF-8
                col = len(text.encode()[:start].decode("utf-8", "replace"))
                end_col = len(text.encode()[:end].decode("utf-8", "replace"))
            if last != line:
                end_col = len(text)
    return Span(code.co_filename, line, col, max(end_col, col) or len(text), text, line)
