"""The playground: the studio's app as a folder of files, with Python in a sealed cell.

Input: the app as ``web/build.mjs`` makes it, the files of Pyodide, the examples. Output: a folder
that any server of files can serve, and that works without a network after the first visit.
"""

from __future__ import annotations

import base64
import hashlib
import json
import shutil
import subprocess
import tempfile
import zipfile
from collections.abc import Sequence
from pathlib import Path

from distal.cli.studio import STARTER
from distal.editor.local.files import SceneFiles
from distal.editor.local.server import APP, examples
from distal.editor.messages import LookRequest, SceneFound
from distal.editor.worker import StudioWorker
from distal.example_files import all_examples, posters
from distal.version import __version__

ROOT = Path(__file__).parents[2]
PYODIDE = ROOT / "web" / "node_modules" / "pyodide"
OFFLINE = ROOT / "web" / "src" / "offline.js"
PYTHON = (
    *("pyodide.mjs", "pyodide.asm.mjs", "pyodide.asm.wasm"),
    *("python_stdlib.zip", "pyodide-lock.json"),
)
START = "planet"
# Of distal, what the compile path needs: not what only devices, windows and videos use.
_LEFT_OUT = (
    *("cli", "editor/local", "gallery", "lessons", "mesh", "notebook"),
    *("polygons", "video", "window"),
)
# The cell is a part of the page's own text, so the page's policy holds in it, beside its own: the
# cell's script, known by its digest, starts Python from what the page hands it.
_POLICY = (
    "default-src 'none'; script-src 'self' {cell} 'wasm-unsafe-eval' blob:; "
    "style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; connect-src 'self'; "
    "frame-src 'self'; worker-src 'self' blob:; base-uri 'none'; form-action 'none'"
)


def build(folder: Path, names: Sequence[str]) -> None:
    """Write the playground, with the examples of these names.

    Raises:
        FileNotFoundError: Pyodide is not installed: ``npm ci`` in ``web/`` does it.
    """
    (folder / "python").mkdir(parents=True)
    (folder / "gallery").mkdir()
    for name in ("studio.js", "studio.css"):
        shutil.copyfile(APP / name, folder / name)
    shutil.copyfile(APP / "cell.html", folder / "python" / "cell.html")
    for name in PYTHON:
        shutil.copyfile(PYODIDE / name, folder / "python" / name)
    write_package(folder / "python" / "distal.zip")
    _compile_sources(folder / "python")
    for name, opened in opened_examples([START, *names]).items():
        (folder / "gallery" / f"{name}.json").write_text(json.dumps(opened), encoding="utf-8")
        shutil.copyfile(posters()[name], folder / "gallery" / f"{name}.webp")
    (folder / "index.html").write_text(_page(folder), encoding="utf-8")
    _write_offline(folder)


def write_package(path: Path) -> None:
    """Write the part of distal that the compiler and the editor's worker need, as an archive."""
    source = ROOT / "src" / "distal"
    with zipfile.ZipFile(path, "w") as archive:
        for file in sorted(source.rglob("*.py")):
            inner = file.relative_to(source).as_posix()
            if not any(inner.startswith(f"{left}/") for left in _LEFT_OUT):
                _add(archive, f"distal/{inner}", file.read_bytes())
        for name in ("player.js", "path_player.js", "frame_player.js"):
            _add(archive, f"distal/export/{name}", (source / "export" / name).read_bytes())


def _compile_sources(folder: Path) -> None:
    """Replace sources by bytecode in the archives of Python and distal, by Pyodide itself."""
    here = Path(__file__).parent
    script, program = here / "bytecode.mjs", here / "bytecode_program.py"
    command = ["node", str(script), str(folder.resolve()), str(program)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"no bytecode of the playground could be made: {done.stderr[-2000:]}")


def _add(archive: zipfile.ZipFile, name: str, data: bytes) -> None:
    info = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))  # the same archive on all days
    archive.writestr(info, data, zipfile.ZIP_DEFLATED, 9)


def opened_examples(names: Sequence[str]) -> dict[str, dict[str, object]]:
    """Return the examples with the payload of their first picture, which needs no Python then."""
    sources = {name: SceneFiles(all_examples()[name]) for name in dict.fromkeys(names)}
    with tempfile.TemporaryDirectory() as folder:
        worker = StudioWorker(Path(folder))
        return {
            name: _opened(worker, source.main, source.all().files)
            for name, source in sources.items()
        }


def _opened(worker: StudioWorker, main: str, files: dict[str, str]) -> dict[str, object]:
    request = LookRequest(id=1, revision=1, files=files, main=main, guided=False)
    answer = worker.answers(request)[-1]
    opened: dict[str, object] = {"main": main, "files": files}
    if isinstance(answer, SceneFound) and not answer.payload["resources"]:
        opened["payload"] = answer.payload
    return opened


def _starter() -> dict[str, object]:
    """Return what a new scene begins with, as ``distal studio`` has it."""
    with tempfile.TemporaryDirectory() as folder:
        return _opened(StudioWorker(Path(folder)), "scene.py", {"scene.py": STARTER})


def _page(folder: Path) -> str:
    known = {path.stem for path in (folder / "gallery").iterdir()}
    settings = {
        "main": f"{START}.py",
        "folder": "playground",
        "isNew": False,
        "gallery": [row for row in examples() if row["name"] in known],
        "version": __version__,
        "python": "python/",
        "start": json.loads((folder / "gallery" / f"{START}.json").read_text(encoding="utf-8")),
        "starter": _starter(),
    }
    text = (APP / "studio.html").read_text(encoding="utf-8")
    filled = json.dumps(settings).replace("<", "\\u003c")  # inside of a script, "<" could end it
    content = _POLICY.replace("{cell}", _digest_of_script(APP / "cell.html"))
    policy = f'<meta http-equiv="Content-Security-Policy" content="{content}">'
    script = f'<script type="application/json" id="settings">{filled}</script>\n'
    made = text.replace(' nonce="{nonce}"', "").replace("<script", f"{script}<script", 1)
    made = made.replace('<meta name="viewport"', f'{policy}\n<meta name="viewport"')
    return made.replace("<title>distal</title>", "<title>Playground · distal</title>")


def _digest_of_script(page: Path) -> str:
    """Return the digest of a page's only script, as a policy names it."""
    text = page.read_text(encoding="utf-8")
    script = text.partition("<script>")[2].rpartition("</script>")[0]
    digest = hashlib.sha256(script.encode()).digest()
    return f"'sha256-{base64.b64encode(digest).decode()}'"


def _write_offline(folder: Path) -> None:
    """Write the service worker that keeps all files; its name for them changes when one does."""
    names = sorted(p.relative_to(folder).as_posix() for p in folder.rglob("*") if p.is_file())
    digest = hashlib.sha256()
    for name in names:
        digest.update(name.encode() + (folder / name).read_bytes())
    script = OFFLINE.read_text(encoding="utf-8")
    listed = json.dumps(["./", *names])
    script = script.replace("FILES = []", f"FILES = {listed}")
    script = script.replace('NAME = ""', f'NAME = "distal-{digest.hexdigest()[:16]}"')
    (folder / "offline.js").write_text(script, encoding="utf-8")
