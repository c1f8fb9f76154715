"""Replace sources by bytecode in the archives of the playground; runs in Pyodide itself.

Input: the archive of the standard library and that of distal, as bytes. Output: the same with what
Python would make of the sources at each start. Functions of scene code are compiled from their
source, so modules that have them keep it. ``tools/site/bytecode.mjs`` runs it, because bytecode is
of one version of Python.
"""

from __future__ import annotations

import ast
import contextlib
import gc
import importlib.util
import io
import marshal
import pathlib
import sys
import tempfile
import zipfile
from collections.abc import Iterable, Sequence
from types import CodeType

DISTAL = "/lib/distal/"
STDLIB = f"/lib/python{sys.version_info.major}{sys.version_info.minor}.zip/"
# What a terminal, a network, a debugger or a test uses, and rare encodings.
_UNUSED = """
_pydatetime _pyio _pyrepl/ antigravity bdb cProfile cmd. code. ctypes/ curses/ dbm/ doctest
ensurepip/ ftplib getpass idlelib/ imaplib ipaddress mailbox modulefinder multiprocessing/ netrc
optparse pdb pickletools poplib profile pstats pty pyclbr pydoc rlcompleter smtplib socketserver
sqlite3/
tabnanny tarfile trace. tty turtle unittest/ venv/ webbrowser wsgiref/ xml/ xmlrpc/ zipapp
encodings/big5 encodings/cp encodings/euc encodings/gb encodings/hz encodings/iso
encodings/johab encodings/koi8 encodings/mac encodings/shift
"""
LEFT_OUT = tuple(_UNUSED.split())
# The most instructions of an entry in a table of lines.
_ENTRY = 8


# So that what the first answer needs is bytecode, too.
_SCENE = """
from distal import Box, Scene, Sphere, time
from distal.lang import slider

ball = Sphere(slider("Radius", 0.5, low=0.1, high=1.0)).paint("#d97757")
scene = Scene(ball.union(Box(0.5).translate(time, 0.0, 0.0), smooth=0.1))
"""


def answer() -> None:
    """Let the worker answer as it will first in the playground.

    Raises:
        RuntimeError: It has no picture.
    """
    from distal.editor.messages import LookRequest  # noqa: PLC0415 (in the archive)
    from distal.editor.worker import StudioWorker  # noqa: PLC0415

    with tempfile.TemporaryDirectory() as folder:
        files = {"scene.py": _SCENE}
        request = LookRequest(id=1, revision=1, files=files, main="scene.py", guided=False)
        found = StudioWorker(pathlib.Path(folder)).answers(request)[-1]
    if found.kind != "scene":
        raise RuntimeError(str(found.mistakes[0].message))


def imported(place: str) -> set[str]:
    """Return the names in an archive of the modules that are imported so far."""
    files = (getattr(module, "__file__", None) or "" for module in list(sys.modules.values()))
    return {file.removeprefix(place) for file in files if file.startswith(place)}


def with_scene_code(names: Iterable[str]) -> set[str]:
    """Import modules of distal; return those with scene code."""
    from distal.lang.functions import Overload  # noqa: PLC0415 (in the archive)

    for name in names:
        # What needs NumPy does not import.
        with contextlib.suppress(ImportError):
            importlib.import_module(name.removesuffix(".py").replace("/", "."))
    recorded = {o.source.file for o in gc.get_objects() if isinstance(o, Overload)}
    return {file.removeprefix(DISTAL) for file in recorded if file.startswith(DISTAL)}


def compiled(archives: Sequence[bytes]) -> tuple[bytes, bytes]:
    """Return the standard library and distal with bytecode of what the first answer imports."""
    answer()
    stdlib, distal = map(_read, archives)
    used, own = imported(STDLIB), imported(DISTAL)
    read = with_scene_code(name for name, _ in distal if name.endswith(".py"))
    made = []
    for name, data in stdlib:
        if name in used and name.endswith(".py"):
            made.append((f"{name}c", _bytecode(data, STDLIB + name)))
        elif name in used or not name.startswith(LEFT_OUT):
            made.append((name, data))
    kept = []
    for name, data in distal:
        if name in read or name not in own:
            kept.append((name, data))
        if name in own:
            place = importlib.util.cache_from_source(name) if name in read else f"{name}c"
            kept.append((place, _bytecode(data, DISTAL + name, keeps_docs=name in read)))
    return _written(made), _written(kept)


def _read(archive: bytes) -> list[tuple[str, bytes]]:
    with zipfile.ZipFile(io.BytesIO(archive)) as found:
        return [(info.filename, found.read(info)) for info in found.infolist()]


def _written(files: list[tuple[str, bytes]]) -> bytes:
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w") as archive:
        for name, data in files:
            info = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))  # the same archive on all days
            archive.writestr(info, data, zipfile.ZIP_DEFLATED, 9)
    return made.getvalue()


def _bytecode(source: bytes, file: str, *, keeps_docs: bool = False) -> bytes:
    """Return a module's bytecode, which Python takes without looking at the source.

    All instructions are at the first line of their function, which has a docstring only if it is
    documented.
    """
    tree = ast.parse(source)
    if not keeps_docs:
        for node in ast.walk(tree):
            if isinstance(node, ast.FunctionDef) and ast.get_docstring(node, clean=False):
                node.body[0] = ast.copy_location(ast.Pass(), node.body[0])
    code = _at_first_lines(compile(tree, file, "exec", dont_inherit=True))
    flags = (1).to_bytes(4, "little")  # the digest of a source, which is not checked
    return importlib.util.MAGIC_NUMBER + flags + bytes(8) + marshal.dumps(code)


def _at_first_lines(code: CodeType) -> CodeType:
    """Return code whose instructions are all at the line where it begins, as a short table.

    Without a table, frames have no lines, and ``traceback`` fails.
    """
    parts = tuple(_at_first_lines(c) if isinstance(c, CodeType) else c for c in code.co_consts)
    count = len(code.co_code) // 2
    lengths = [_ENTRY] * (count // _ENTRY) + [count % _ENTRY] * (count % _ENTRY > 0)
    # An entry without columns for so many instructions, and no step to another line.
    table = b"".join(bytes((0x80 | 13 << 3 | length - 1, 0)) for length in lengths)
    return code.replace(co_linetable=table, co_consts=parts)
