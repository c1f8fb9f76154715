"""The player's script is what its sources say, is small, checked, and asks for nothing.

Node and its packages are needed to build it, and only here: who installs distal gets the script.
"""

from __future__ import annotations

import gzip
import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
WEB = ROOT / "web"
PLAYER = ROOT / "src" / "distal" / "export" / "player.js"
PATH_PLAYER = PLAYER.with_name("path_player.js")
INSPECT_PLAYER = PLAYER.with_name("inspect_player.js")
FRAME_PLAYER = PLAYER.with_name("frame_player.js")
SCRIPTS = (PLAYER, PATH_PLAYER, FRAME_PLAYER)
PRINT_SCRIPT = PLAYER.with_name("print.js")
POSTER_SCRIPT = PLAYER.with_name("triangle_poster.js")
MESH_SCRIPT = ROOT / "src" / "distal" / "notebook" / "mesh_viewer.js"
LESSON_SCRIPT = ROOT / "src" / "distal" / "lessons" / "lesson.js"
LESSON_STYLE = LESSON_SCRIPT.with_suffix(".css")
APP = ROOT / "src" / "distal" / "editor" / "app"
_NAMES = ("studio.js", "lesson_page.js", "studio.css", "studio.html", "cell.html")
APP_FILES = [APP / name for name in _NAMES]
# Packed it has 31 kB, so that the page of the raymarcher stays below its 60 kB.
LARGEST_BYTES = 60_000
# What the other player has besides.
PATHS_BYTES = 9_000
# What a page has besides that cuts its scene open and measures it, with paths: 21 kB.
INSPECT_BYTES = 22_000
# What the player of pictures that keep frames has besides.
FRAMES_BYTES = 8_000
# What a page has besides that saves a part for printing.
PRINT_BYTES = 12_000
# What draws a poster of triangles: 3 kB packed.
POSTER_BYTES = 8_200
# What shows a mesh in a notebook, which has no player.
MESH_BYTES = 11_000
# What a lesson's page has besides: sliders, stills, experiments, goals, presentation.
LESSON_BYTES = 8_000
# The studio with its editor, packed; 2 kB of it keep frames (decision 76), 1.3 kB its access (97),
# 34 kB what one has written: drafts, versions, comparisons, conflicts, scenes (96, 98).
APP_BYTES = 268_500
INSTALL_S = 100
RUN_S = 60


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the sources with their tools installed; the script, built there, is out.js."""
    npm = shutil.which("npm")
    if npm is None or shutil.which("node") is None:
        pytest.skip("node and npm are not installed")
    folder = tmp_path_factory.mktemp("player") / "web"
    shutil.copytree(WEB, folder, ignore=shutil.ignore_patterns("node_modules", ".test"))
    try:
        installed = subprocess.run(
            [npm, "ci", "--prefer-offline", "--ignore-scripts"],
            cwd=folder,
            capture_output=True,
            text=True,
            timeout=INSTALL_S,
        )
    except subprocess.TimeoutExpired:
        pytest.skip("npm gets no packages here")
    if installed.returncode != 0:
        # A lock that does not fit package.json is a fault; a registry out of reach is not.
        assert "EUSAGE" not in installed.stderr, installed.stderr
        pytest.skip(f"npm gets no packages here: {installed.stderr.splitlines()[-1:]}")
    run(folder, "node", "build.mjs", "out")
    return folder


def run(folder: Path, *command: str) -> str:
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=RUN_S)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.mark.parametrize(
    "script",
    [
        *(*SCRIPTS, INSPECT_PLAYER, PRINT_SCRIPT, POSTER_SCRIPT, MESH_SCRIPT),
        *(LESSON_SCRIPT, LESSON_STYLE, *APP_FILES),
    ],
    ids=lambda script: script.name,
)
def test_the_committed_scripts_are_fresh(built: Path, script: Path) -> None:
    assert (built / "out" / script.name).read_bytes() == script.read_bytes(), (
        "web/ changed: run `npm ci && npm run build` in web/ and commit what it writes"
    )


def test_types_are_sound(built: Path) -> None:
    run(built, "npm", "run", "--silent", "check")


def test_its_pure_parts_pass_their_own_tests(built: Path) -> None:
    assert "# fail 0" in run(built, "npm", "run", "--silent", "test")


def test_pages_without_paths_do_not_carry_them() -> None:
    texts = [script.read_text(encoding="utf-8") for script in SCRIPTS]
    assert ["Film_offset" in text for text in texts] == [False, True, False]
    assert ["Photons_radius" in text for text in texts] == [False, True, False]
    assert ["getUserMedia" in text for text in texts] == [False, False, True]


@pytest.mark.parametrize(
    "script", [*SCRIPTS, INSPECT_PLAYER, LESSON_SCRIPT], ids=lambda script: script.name
)
def test_it_is_small_and_asks_for_nothing(script: Path) -> None:
    text = script.read_text(encoding="utf-8")
    more = {
        PATH_PLAYER: PATHS_BYTES,
        FRAME_PLAYER: FRAMES_BYTES,
        INSPECT_PLAYER: INSPECT_BYTES,
        LESSON_SCRIPT: LESSON_BYTES,
    }
    assert len(text.encode()) <= LARGEST_BYTES + more.get(script, 0)
    # The only address is the name of SVG's vocabulary, which nobody fetches.
    assert set(re.findall(r"https?://[^\"'`\s]*", text)) == {"http://www.w3.org/2000/svg"}
    for word in ("fetch(", "XMLHttpRequest", "WebSocket", "import(", "innerHTML", "sourceMapping"):
        assert word not in text, word
    assert "</script" not in text


@pytest.mark.parametrize(
    ("script", "most"),
    [(PRINT_SCRIPT, PRINT_BYTES), (POSTER_SCRIPT, POSTER_BYTES), (MESH_SCRIPT, MESH_BYTES)],
    ids=lambda given: getattr(given, "name", ""),
)
def test_other_scripts_of_cells_and_pages_are_small_too(script: Path, most: int) -> None:
    text = script.read_text(encoding="utf-8")
    assert len(text.encode()) <= most
    for word in ("http", "fetch(", "import(", "innerHTML", "</script", "EDITED", "PATHS", "FRAMES"):
        assert word not in text, word


def test_the_studio_is_small_and_complete() -> None:
    script, style = ((APP / name).read_bytes() for name in ("studio.js", "studio.css"))
    assert len(gzip.compress(script)) + len(gzip.compress(style)) <= APP_BYTES
    text = script.decode()
    assert "sourceMapping" not in text
    assert "EDITED" not in text  # a constant that the build did not know
    # The name of SVG's vocabulary, which nobody fetches.
    hosts = {address.split("/")[2] for address in re.findall(r"https?://[^\"'`\s)]*", text)}
    assert hosts == {"www.w3.org"}


def test_the_lock_names_no_registry() -> None:
    packages = json.loads((WEB / "package-lock.json").read_text())["packages"]
    assert not [name for name, entry in packages.items() if "resolved" in entry]
    assert all("integrity" in entry for name, entry in packages.items() if name)
