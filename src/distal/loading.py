"""Load a scene from a file or from the gallery of examples.

Input: ``FILE[:NAME]`` or ``example:NAME``. Output: a ``Func``, an ``Image``, a shape or a scene.
The text of a file is read once and run once, so a later edit of the file has no effect.
"""

from __future__ import annotations

import contextlib
import hashlib
import importlib
import linecache
import os
import sys
import time
import types
from collections.abc import Iterable, Iterator, Mapping, Set
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeAlias

from distal.author_errors import failure, hint_of_nothing, hint_of_syntax
from distal.diagnostics import CompileError, Diagnostic, LoadError, Span, readable
from distal.error_codes import ErrorCode
from distal.example_files import EXAMPLE_PREFIX, all_examples
from distal.ir.nodes import EntryKind
from distal.lang.composed import Composed
from distal.lang.functions import FrameBuffer, Func, Image
from distal.lang.identity_map import IdentityMap
from distal.source_text import SourceTextError, decoded, lines_of, with_plain_ends

# The objects that a scene file may define.
SceneCode: TypeAlias = Func | Composed

_DEFAULT_NAMES = ("scene", "picture", "shape")


@dataclass(frozen=True, slots=True)
class LoadedFrom:
    """Where an object was loaded from.

    Attributes:
        source: ``FILE[:NAME]`` or ``example:NAME[:NAME]`` as the caller wrote it, as Unicode text.
        files: The file, and the modules in its folder that it imported.
        neighbors: The paths of these modules relative to the folder of the file, with slashes.
        digest: The result of ``digest_of`` for them.
        began_ns: When loading began, as ``time.time_ns`` counts.
    """

    source: str
    files: tuple[Path, ...]
    neighbors: tuple[str, ...]
    digest: str
    began_ns: int = field(default=0, compare=False)


_loaded: IdentityMap[LoadedFrom] = IdentityMap()


def loaded_from(obj: object) -> LoadedFrom | None:
    """Return where ``load`` found an object; None for an object that ``load`` did not make."""
    return _loaded.get(obj)


def copy_loaded_from(origin: object, made: object) -> None:
    """Record that ``made`` was derived from ``origin``, so that it has the same source file."""
    known = loaded_from(origin)
    if known is not None:
        _loaded[made] = known


def load(path: str | Path, name: str | None = None) -> SceneCode:
    """Load a scene from a file.

    Args:
        path: A Python file, ``FILE:NAME``, or ``example:NAME`` for an example of the gallery.
        name: The name of a function, scene or shape in the file. None selects the only scene or
            ``@image`` of the file; if there are several, the one called ``scene`` or
            ``picture``. In a file without these, None selects the only shape, or else the one
            called ``shape``.

    Raises:
        LoadError: There is no such file or name, or the file fails when run.
        CompileError: The file is not valid Python.
    """
    if isinstance(path, str) and name is None:
        path, name = split_source(path)
    file, began_ns = file_of(str(path)), time.time_ns()
    return _made(file, _read(file), path, name, began_ns)[0]


@dataclass(frozen=True, slots=True)
class LoadedFile:
    """A file that was run.

    Attributes:
        picture: The object that was asked for.
        names: The names of all pictures in the file, or of all shapes if it has no pictures.
    """

    picture: SceneCode
    names: tuple[str, ...]


def load_text(
    file: Path, text: str, name: str | None = None, given: Mapping[str, Any] | None = None
) -> LoadedFile:
    """Load a scene from a text as if it were the content of a file.

    Args:
        file: The file; its folder is where modules are imported from. It need not exist.
        text: Its text.
        name: As for ``load``.
        given: Global names that the text may use without defining them.

    Raises:
        LoadError: There is no such name, or the text fails when run.
        CompileError: The text is not valid Python.
    """
    found, module = _made(file, text, file, name, time.time_ns(), given)
    return LoadedFile(found, tuple(_offered(module)[0]))


def _made(
    file: Path,
    text: str,
    path: str | Path,
    name: str | None,
    began_ns: int,
    given: Mapping[str, Any] | None = None,
) -> tuple[SceneCode, types.ModuleType]:
    """Run a file, and return the object that was asked for, and the file's module.

    Args:
        file: The file.
        text: Its text.
        path: As the caller wrote it.
        name: As for ``load``.
        began_ns: When loading began.
        given: As for ``load_text``.
    """
    module, modules = _run(file, text, given)
    found = _pick(module, file, name)
    written = readable(path).replace(os.sep, "/")  # the same on every system
    source = written if name is None else f"{written}:{name}"
    folder = file.resolve().parent
    neighbors = tuple(path.relative_to(folder).as_posix() for path in modules)
    digest = _digest(text, folder, neighbors)
    _loaded[found] = LoadedFrom(source, (file, *modules), neighbors, digest, began_ns)
    return found, module


def split_source(text: str) -> tuple[str, str | None]:
    """Split FILE[:NAME] or example:NAME[:NAME] into the path for ``load`` and the name."""
    prefix = EXAMPLE_PREFIX if text.startswith(EXAMPLE_PREFIX) else ""
    rest = text.removeprefix(prefix)
    file, colon, name = rest.rpartition(":")
    # The colon may be part of the file's name or of a drive (C:\scene.py).
    if not colon or not name.isidentifier() or (not prefix and Path(rest).exists()):
        file, name = rest, ""
    return prefix + file, name or None


def digest_of(path: str | Path, neighbors: Iterable[str] = ()) -> str:
    """Return the SHA-256 of the text of a file and of modules in its folder, without running them.

    The digest of a single file is the hash of its text with Unix line ends; the name of the file is
    not included.

    Args:
        path: As for ``load``.
        neighbors: The paths of the modules relative to the folder of the file, with slashes.

    Raises:
        LoadError: There is no such file.
    """
    file = file_of(str(path))
    return _digest(_read(file), file.resolve().parent, neighbors)


def file_of(path: str) -> Path:
    """Return the file of a scene.

    Args:
        path: A Python file, or ``example:NAME``.

    Raises:
        LoadError: There is no such file.
    """
    if path.startswith(EXAMPLE_PREFIX):
        wanted = path.removeprefix(EXAMPLE_PREFIX)
        examples = all_examples()
        if wanted not in examples:
            raise LoadError(f"there is no example '{wanted}'; examples: {', '.join(examples)}")
        return examples[wanted]
    file = Path(path)
    try:
        if file.is_dir():
            raise LoadError(f"{file} is a folder, not a scene file")
        if not file.exists():
            raise LoadError(f"there is no file {file}")
    except OSError as error:  # a parent folder without permission, or a name that is too long
        raise LoadError(f"cannot read {file}: {error.strerror}") from None
    return file


def _run(
    file: Path, text: str, given: Mapping[str, Any] | None = None
) -> tuple[types.ModuleType, list[Path]]:
    """Run a file; return its module and the files of the modules in its folder that it imported."""
    name = "distal_scene_" + "".join(c if c.isalnum() else "_" for c in file.stem)
    module = types.ModuleType(name)
    module.__file__ = os.path.abspath(file)
    module.__dict__.update(given or {})
    filename = str(file)
    linecache.cache[filename] = (len(text), None, lines_of(text), module.__file__)
    try:
        code = compile(text, filename, "exec", dont_inherit=True)
    except SyntaxError as error:
        raise _syntax_error(error, filename) from None
    except (RecursionError, MemoryError):
        raise LoadError(f"{file} is too deeply nested for Python itself") from None
    except ValueError as error:  # a NUL byte
        raise LoadError(f"{file} is not Python source: {error}") from None
    # Decorators look up their module. Modules in the file's folder can be imported, as in a script.
    sys.modules[name] = module
    folder = str(file.resolve().parent)
    known = set(sys.modules)
    sys.path.insert(0, folder)
    importlib.invalidate_caches()  # a module may be newer than Python's cached list of the folder
    try:
        with _same_folder_after():
            exec(code, module.__dict__)
    except CompileError:
        raise
    except SystemExit as error:
        raise LoadError(f"{file} left with sys.exit({error.code!r}) while it was loaded") from None
    except Exception as error:
        raise failure(file, error) from error
    except BaseException as error:
        if type(error).__module__ != name:  # ctrl-C and the like are not the author's
            raise
        raise failure(file, error) from error
    finally:
        if folder in sys.path:  # the author's code may have changed it
            sys.path.remove(folder)
        neighbors = _forget_neighbors(Path(folder), known)
    return module, neighbors


@contextlib.contextmanager
def _same_folder_after() -> Iterator[None]:
    """Return to the working folder that a file may leave by ``os.chdir``.

    Names of outputs are relative to the folder in which the author gave them.
    """
    before = None
    with contextlib.suppress(OSError):  # it was deleted
        before = os.getcwd()
    try:
        yield
    finally:
        if before is not None:
            with contextlib.suppress(OSError):
                os.chdir(before)


def _digest(text: str, folder: Path, neighbors: Iterable[str]) -> str:
    whole = hashlib.sha256(text.encode("utf-8", "surrogatepass"))
    for place in neighbors:
        whole.update(f"\0{place}\0".encode("utf-8", "surrogatepass"))
        whole.update(_neighbor(folder, place))
    return whole.hexdigest()


def _neighbor(folder: Path, place: str) -> bytes:
    """Return the text of a module; if it cannot be read, a byte that differs from every text."""
    try:
        file = (folder / place).resolve()
        if not file.is_relative_to(folder) or not file.is_file():  # not a device, not elsewhere
            return b"\0"
        return file.read_bytes().replace(b"\r\n", b"\n")
    except (OSError, ValueError):
        return b"\0"


def _forget_neighbors(folder: Path, known: Set[str]) -> list[Path]:
    """Remove the modules of a folder from ``sys.modules``; return their files, sorted.

    Python caches modules by name only, so ``shapes`` of one folder would also be imported by scenes
    of another folder. Removing them also makes the next load read edited modules again. The modules
    stay alive in the globals of the scene that imported them. A module that another thread is
    importing stays: Python looks for it once more when it has run, and that load forgets it.
    """
    tops = {name.partition(".")[0] for name in set(sys.modules) - known}
    near = {top for top in tops if _is_directly_in(sys.modules.get(top), folder)}
    files: set[Path] = set()
    for name in set(sys.modules) - known:
        if name.partition(".")[0] in near and not _is_being_imported(sys.modules.get(name)):
            file = getattr(sys.modules.pop(name), "__file__", None)
            if file is not None and Path(file).is_relative_to(folder):
                files.add(Path(file))
    return sorted(files)


def _is_being_imported(module: types.ModuleType | None) -> bool:
    """Return whether a module has not run to its end yet."""
    return getattr(getattr(module, "__spec__", None), "_initializing", False)


def _is_directly_in(module: types.ModuleType | None, folder: Path) -> bool:
    """Return whether the file of a module, or the folder of a package, is directly in a folder."""
    places = list(getattr(module, "__path__", ())) or [getattr(module, "__file__", None)]
    return any(place is not None and Path(place).parent == folder for place in places)


def _read(file: Path) -> str:
    try:
        return with_plain_ends(decoded(file.read_bytes()))
    except SourceTextError as error:
        raise LoadError(f"{file} {error}") from None
    except OSError as error:
        raise LoadError(f"cannot read {file}: {error.strerror}") from None


def _syntax_error(error: SyntaxError, filename: str) -> CompileError:
    line = error.lineno or 1
    text = (error.text or "").rstrip("\n")
    start = max((error.offset or 1) - 1, 0)
    same_line = error.end_lineno == error.lineno and error.end_offset
    end = error.end_offset - 1 if same_line and error.end_offset else len(text)
    span = Span(filename, line, start, max(end, start + 1), text, line)
    return CompileError(
        [
            Diagnostic(
                ErrorCode.SYNTAX, f"this is not Python: {error.msg}", span, hint_of_syntax(text)
            )
        ]
    )


def _pick(module: types.ModuleType, file: Path, name: str | None) -> SceneCode:
    found = _scene_code(module)
    if name is not None:
        if name not in found:
            raise LoadError(f"{file} has no scene, @image or @func '{name}'; {_listed(found)}")
        return _shown(found[name])
    offered, what = _offered(module)
    if len(set(map(id, offered.values()))) == 1:
        return _shown(next(iter(offered.values())))
    for wanted in _DEFAULT_NAMES:
        if wanted in offered:
            return _shown(offered[wanted])
    if not offered:
        raise _nothing_shown(module, file, found)
    raise LoadError(f"{file} defines several {what}; say which: {file}:NAME; {_listed(offered)}")


def _scene_code(module: types.ModuleType) -> dict[str, Any]:
    """Return what a file makes, by name; a group of shapes and lights is among it."""
    named = vars(module).items()
    return {k: v for k, v in named if isinstance(v, Func | Composed) or _is_group(v)}


def _is_group(value: Any) -> bool:
    return hasattr(type(value), "as_scene")


def _shown(value: Any) -> SceneCode:
    """Return scene code; of a group, a scene of what it has."""
    shown: SceneCode = value.as_scene() if _is_group(value) else value
    return shown


def _nothing_shown(
    module: types.ModuleType, file: Path, found: Mapping[str, SceneCode]
) -> LoadError:
    reason = f"{file} defines no scene and no @image; {_listed(found)}"
    hint = hint_of_nothing(vars(module), Composed)
    text = Diagnostic(ErrorCode.FILE, reason, None, hint).text("").removeprefix(": ")
    return LoadError(text, None, reason, hint)


def _offered(module: types.ModuleType) -> tuple[dict[str, Any], str]:
    """Return the objects that need no name to be shown, and what they are."""
    found = _scene_code(module)
    pictures = {key: value for key, value in found.items() if _is_own_picture(value, module)}
    # Buffers are drawn for a picture; one is shown by its name.
    shown = {k: v for k, v in pictures.items() if not isinstance(v, FrameBuffer)}
    pictures = shown or pictures
    shapes = {k: v for k, v in found.items() if isinstance(v, Composed) or _is_group(v)}
    return (pictures, "pictures") if pictures else (shapes, "shapes")


def _is_own_picture(value: SceneCode, module: types.ModuleType) -> bool:
    if isinstance(value, Image):
        return value.__module__ == module.__name__
    return isinstance(value, Composed) and value.kind is EntryKind.IMAGE


def _listed(found: Mapping[str, SceneCode]) -> str:
    if not found:
        return "it has no scene code at all"
    return f"it has: {', '.join(found)}"
