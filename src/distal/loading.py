"""Finding scenes: a file's path, or the name of a gallery example, to the object to compile.

Input: ``FILE[:NAME]``. Output: a ``Func``, an ``Image``, a shape or a scene. A file
is run once from a snapshot of its text, so that a later edit never mixes in.
"""

from __future__ import annotations

import hashlib
import importlib
import linecache
import os
import sys
import types
from collections.abc import Iterable, Mapping, Set
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, TypeAlias
from weakref import WeakKeyDictionary

from distal.diagnostics import CompileError, Diagnostic, LoadError, Span
from distal.ir.nodes import EntryKind
from distal.lang.composed import Composed
from distal.lang.functions import Func, Image
from distal.packages import explained

# What a file may define for us.
SceneCode: TypeAlias = Func | Composed

EXAMPLE_PREFIX: Final = "example:"
_DEFAULT_NAMES = ("scene", "picture", "shape")


@dataclass(frozen=True, slots=True)
class LoadedFrom:
    """Where an object was loaded from.

    Attributes:
        source: ``FILE[:NAME]`` or ``example:NAME[:NAME]`` as it was given: no folder is added.
        files: The file, and the modules beside it that it imported.
        neighbours: The places of these modules beside the file, with slashes.
        digest: What ``digest_of`` gives for them.
    """

    source: str
    files: tuple[Path, ...]
    neighbours: tuple[str, ...]
    digest: str


_loaded: WeakKeyDictionary[Any, LoadedFrom] = WeakKeyDictionary()


def loaded_from(obj: object) -> LoadedFrom | None:
    """Where ``load`` found an object; None of what was made in another way."""
    return _loaded.get(obj)


def copy_loaded_from(origin: object, made: object) -> None:
    """Record that an object shows what another does, so that it comes from the same file."""
    known = loaded_from(origin)
    if known is not None:
        _loaded[made] = known


def gallery() -> dict[str, Path]:
    """The examples that come with the package, by name, in the order of their names."""
    installed = Path(__file__).parent / "gallery"
    checkout = Path(__file__).parents[2] / "examples"
    folder = installed if installed.is_dir() else checkout
    return {path.stem: path for path in sorted(folder.glob("*.py"))} if folder.is_dir() else {}


def load(path: str | Path, name: str | None = None) -> SceneCode:
    """Load a scene from a file.

    Args:
        path: A Python file, or ``example:NAME`` for one of the gallery.
        name: Which of its functions, scenes or shapes. Without it: the only scene or ``@image``
            defined in the file, else the one called ``scene`` or ``picture``; in a file without
            these the only shape, else the one called ``shape``.

    Raises:
        LoadError: There is no such file or name, or the file fails when run.
        CompileError: The file is not valid Python.
    """
    file = _find(str(path))
    text = _read(file)
    module, modules = _run(file, text)
    found = _pick(module, file, name)
    given = str(path).replace(os.sep, "/")  # the same on every system
    source = given if name is None else f"{given}:{name}"
    folder = file.resolve().parent
    neighbours = tuple(path.relative_to(folder).as_posix() for path in modules)
    digest = _digest(text, folder, neighbours)
    _loaded[found] = LoadedFrom(source, (file, *modules), neighbours, digest)
    return found


def split_source(text: str) -> tuple[str, str | None]:
    """FILE[:NAME] or example:NAME[:NAME] as the path that ``load`` takes, and the name."""
    prefix = EXAMPLE_PREFIX if text.startswith(EXAMPLE_PREFIX) else ""
    rest = text.removeprefix(prefix)
    file, colon, name = rest.rpartition(":")
    # A colon may belong to the file's own name, or to a drive (C:\scene.py).
    if not colon or not name.isidentifier() or (not prefix and Path(rest).exists()):
        file, name = rest, ""
    return prefix + file, name or None


def digest_of(path: str | Path, neighbours: Iterable[str] = ()) -> str:
    """SHA-256 of the text of a file and of modules beside it, without running them.

    A file alone has the hash of its text with the line ends of Unix; its name is no part of it.

    Args:
        path: As for ``load``.
        neighbours: The places of the modules beside it, with slashes.

    Raises:
        LoadError: There is no such file.
    """
    file = _find(str(path))
    return _digest(_read(file), file.resolve().parent, neighbours)


def _find(path: str) -> Path:
    if path.startswith(EXAMPLE_PREFIX):
        wanted = path.removeprefix(EXAMPLE_PREFIX)
        examples = gallery()
        if wanted not in examples:
            raise LoadError(f"there is no example '{wanted}'; examples: {', '.join(examples)}")
        return examples[wanted]
    file = Path(path)
    try:
        if file.is_dir():
            raise LoadError(f"{file} is a folder, not a scene file")
        if not file.exists():
            raise LoadError(f"there is no file {file}")
    except OSError as error:  # a folder on the way that cannot be entered, a name too long
        raise LoadError(f"cannot read {file}: {error.strerror}") from None
    return file


def _run(file: Path, text: str) -> tuple[types.ModuleType, list[Path]]:
    """Run a file: its module, and the modules beside it that it imported."""
    name = "distal_scene_" + "".join(c if c.isalnum() else "_" for c in file.stem)
    module = types.ModuleType(name)
    module.__file__ = str(file)
    filename = str(file)
    linecache.cache[filename] = (len(text), None, text.splitlines(keepends=True), filename)
    try:
        code = compile(text, filename, "exec", dont_inherit=True)
    except SyntaxError as error:
        raise _syntax_error(error, filename) from None
    except (RecursionError, MemoryError):
        raise LoadError(f"{file} is too deeply nested for Python itself") from None
    except ValueError as error:  # a NUL byte
        raise LoadError(f"{file} is not Python source: {error}") from None
    # Decorators look their module up; neighbours of the file can be imported, as in a script.
    sys.modules[name] = module
    folder = str(file.resolve().parent)
    known = set(sys.modules)
    sys.path.insert(0, folder)
    importlib.invalidate_caches()  # a neighbour may be younger than what Python saw of the folder
    try:
        exec(code, module.__dict__)
    except CompileError:
        raise
    except SystemExit as error:
        raise LoadError(f"{file} left with sys.exit({error.code!r}) while it was loaded") from None
    except Exception as error:
        raise LoadError(_failure(file, error)) from error
    finally:
        sys.path.remove(folder)
        neighbours = _forget_neighbours(Path(folder), known)
    return module, neighbours


def _digest(text: str, folder: Path, neighbours: Iterable[str]) -> str:
    whole = hashlib.sha256(text.encode("utf-8", "surrogatepass"))
    for place in neighbours:
        whole.update(f"\0{place}\0".encode("utf-8", "surrogatepass"))
        whole.update(_neighbour(folder, place))
    return whole.hexdigest()


def _neighbour(folder: Path, place: str) -> bytes:
    """The text of a module beside a file; of none, what no text is equal to."""
    try:
        file = (folder / place).resolve()
        if not file.is_relative_to(folder) or not file.is_file():  # no device, nothing elsewhere
            return b"\0"
        return file.read_bytes().replace(b"\r\n", b"\n")
    except (OSError, ValueError):
        return b"\0"


def _forget_neighbours(folder: Path, known: Set[str]) -> list[Path]:
    """Let the next scene import its own neighbours, and edited ones again; their files, sorted.

    Python keeps imported modules by name alone: the ``shapes`` of one folder would serve the scenes
    of another. What the scene imported stays alive in its globals.
    """
    tops = {name.partition(".")[0] for name in set(sys.modules) - known}
    near = {top for top in tops if _is_directly_in(sys.modules.get(top), folder)}
    files: set[Path] = set()
    for name in set(sys.modules) - known:
        if name.partition(".")[0] in near:
            file = getattr(sys.modules.pop(name), "__file__", None)
            if file is not None and Path(file).is_relative_to(folder):
                files.add(Path(file))
    return sorted(files)


def _is_directly_in(module: types.ModuleType | None, folder: Path) -> bool:
    """Whether a module's file, or a package's folder, is directly in a folder."""
    places = list(getattr(module, "__path__", ())) or [getattr(module, "__file__", None)]
    return any(place is not None and Path(place).parent == folder for place in places)


def _read(file: Path) -> str:
    try:
        return file.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        raise LoadError(f"{file} is not text in UTF-8") from None
    except OSError as error:
        raise LoadError(f"cannot read {file}: {error.strerror}") from None


def _syntax_error(error: SyntaxError, filename: str) -> CompileError:
    line = error.lineno or 1
    text = (error.text or "").rstrip("\n")
    start = max((error.offset or 1) - 1, 0)
    same_line = error.end_lineno == error.lineno and error.end_offset
    end = error.end_offset - 1 if same_line and error.end_offset else len(text)
    span = Span(filename, line, start, max(end, start + 1), text, line)
    return CompileError([Diagnostic(f"this is not Python: {error.msg}", span)])


def _failure(file: Path, error: Exception) -> str:
    """Say where in the author's files an exception came from, in a line or two."""
    name, line = str(file), None
    folder = file.resolve().parent
    trace = error.__traceback__
    while trace is not None:
        code_file = trace.tb_frame.f_code.co_filename
        if code_file == str(file) or Path(code_file).parent == folder:
            name, line = code_file, trace.tb_lineno
        trace = trace.tb_next
    if name != str(file):  # a neighbour: named as the author names the scene beside it
        linecache.checkcache(name)
        shown = str(file.parent / Path(name).name)
    else:
        shown = name
    lines = [
        str(explained(error) or f"{type(error).__name__}: {error}"),
        f"  --> {shown if line is None else f'{shown}:{line}'}",
    ]
    if line is not None:
        lines.append(f"  {linecache.getline(name, line).strip()}")
    return "\n".join(lines)


def _pick(module: types.ModuleType, file: Path, name: str | None) -> SceneCode:
    found = {k: v for k, v in vars(module).items() if isinstance(v, Func | Composed)}
    if name is not None:
        if name not in found:
            raise LoadError(f"{file} has no scene, @image or @func '{name}'; {_listed(found)}")
        return found[name]
    pictures = {key: value for key, value in found.items() if _is_own_picture(value, module)}
    shapes = {key: value for key, value in found.items() if isinstance(value, Composed)}
    offered, what = (pictures, "pictures") if pictures else (shapes, "shapes")
    if len(set(map(id, offered.values()))) == 1:
        return next(iter(offered.values()))
    for wanted in _DEFAULT_NAMES:
        if wanted in offered:
            return offered[wanted]
    if not offered:
        raise LoadError(f"{file} defines no scene and no @image; {_listed(found)}")
    raise LoadError(f"{file} defines several {what}; say which: {file}:NAME; {_listed(offered)}")


def _is_own_picture(value: SceneCode, module: types.ModuleType) -> bool:
    if isinstance(value, Image):
        return value.__module__ == module.__name__
    return isinstance(value, Composed) and value.kind is EntryKind.IMAGE


def _listed(found: Mapping[str, SceneCode]) -> str:
    if not found:
        return "it has no scene code at all"
    return f"it has: {', '.join(found)}"
