"""``distal export lesson.md``."""

from __future__ import annotations

from pathlib import Path

import pytest

from distal.cli import main

LESSON = Path(__file__).parents[2] / "lessons" / "01_rays_are_colors" / "lesson.md"


def run(*arguments: str) -> int:
    with pytest.raises(SystemExit) as ended:
        main(list(arguments))
    return int(ended.value.code or 0)


def test_it_writes_one_page(tmp_path, capsys):
    page = tmp_path / "lesson.html"
    assert run("export", str(LESSON), "-o", str(page)) == 0
    assert "lesson.html" in "".join(capsys.readouterr())
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
def test_options_of_scenes_are_refused(arguments, message, capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    assert run("export", str(LESSON), *arguments) != 0
    assert message in " ".join("".join(capsys.readouterr()).split())
