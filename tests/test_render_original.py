"""The oracle pictures are all listed, and the tool that made them draws, records and refuses."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tests.egl import EglUnavailableError, context

ROOT = Path(__file__).parent.parent
ORIGINALS = ROOT / "tests" / "originals"
TEXT = (
    "precision highp float;\nuniform vec2 u_resolution;\n"
    "uniform float u_time;\nuniform vec3 tint;\n"
    "void main() {\n  float top = step(0.5, gl_FragCoord.y / u_resolution.y);\n"
    "  gl_FragColor = vec4(tint.x, top, u_time, 1.0);\n}\n"
)


def run_tool(*arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, str(ROOT / "tools" / "render_original.py"), *arguments]
    return subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)


def test_index_and_folder_agree() -> None:
    entries = json.loads((ORIGINALS / "index.json").read_text("utf-8"))
    assert [entry["file"] for entry in entries] == sorted(p.name for p in ORIGINALS.glob("*.png"))
    for entry in entries:
        with Image.open(ORIGINALS / entry["file"]) as picture:
            assert (list(picture.size), picture.mode) == (entry["size"], "RGB")
        assert entry["file"].startswith(entry["example"])
        assert entry["file"].endswith(f"_{entry['time']}.png")


def test_tool_draws_and_records(tmp_path: Path) -> None:
    try:
        context()
    except EglUnavailableError as error:
        pytest.skip(str(error))
    (tmp_path / "a.frag").write_text(TEXT)
    out = tmp_path / "a_0.2.png"
    options = ["--size", "6x4", "--time", "0.2", "--set", "tint=1,0,0", "--record", "a"]
    for _ in range(2):
        done = run_tool(str(tmp_path / "a.frag"), str(out), *options)
        assert (done.returncode, done.stderr) == (0, "")
    pixels = np.asarray(Image.open(out))
    assert (pixels[:2] == (255, 255, 51)).all()
    assert (pixels[2:] == (255, 0, 51)).all()
    parameters = {"tint": [1.0, 0.0, 0.0]}
    entry = {"file": out.name, "example": "a", "size": [6, 4], "time": 0.2}
    assert json.loads((tmp_path / "index.json").read_text()) == [entry | {"parameters": parameters}]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (TEXT, "render_original: no value for uniform tint"),
        ("void main() { nothing = 1.0; }", "render_original: GLSL Compiler failed"),
    ],
)
def test_mistakes_end_in_one_message(tmp_path: Path, text: str, message: str) -> None:
    try:
        context()
    except EglUnavailableError as error:
        pytest.skip(str(error))
    (tmp_path / "a.frag").write_text(text)
    done = run_tool(str(tmp_path / "a.frag"), str(tmp_path / "a.png"))
    assert done.returncode == 1
    assert done.stderr.startswith(message)
    assert "Traceback" not in done.stderr
