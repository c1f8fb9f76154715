"""``distal export lesson.md``."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner

from distal.cli.application import application

LESSON = Path(__file__).parents[2] / "lessons" / "01_rays_are_colors" / "lesson.md"


def run(*arguments: str) -> tuple[int, str]:
    result = CliRunner().invoke(application, arguments)
    return result.exit_code, " ".join(result.output.split())


def test_it_writes_one_page(tmp_path):
    page = tmp_path / "lesson.html"
    code, said = run("export", str(LESSON), "-o", str(page))
    assert code == 0
    assert "lesson.html" in said
    text = page.read_text(encoding="utf-8")
    assert text.startswith("<!doctype html>")
    assert "<h1>Rays are colors</h1>" in text


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["-o", "lesson.glsl"], "a lesson is written as a page: -o lesson.html"),
        (
            ["-o", "lesson.html", "--no-panel"],
            "--no-panel is for scenes; a lesson's file has its own settings",
        ),
        (
            ["-o", "lesson.html", "--set", "focal_length=2"],
            "--set is for scenes; a lesson's file has its own settings",
        ),
    ],
)
def test_options_of_scenes_are_refused(arguments, message, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    code, said = run("export", str(LESSON), *arguments)
    assert code != 0
    assert message in said
