"""``distal video``: what it says, and its exit codes."""

import re
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from distal.cli.application import application
from tests.video.moving import decode, scene_file


@pytest.fixture
def run(tmp_path, monkeypatch):
    scene_file(tmp_path)
    monkeypatch.chdir(tmp_path)
    return lambda *words: CliRunner().invoke(application, ["video", "moving.py", *words])


def test_a_video_and_one_line_about_it(run):
    pytest.importorskip("av")
    words = ["-o", "out.mp4", "--duration", "1", "--fps", "29.97", "--size", "64x48"]
    result = run(*words, "--set", "glow=0.25", "--start", "0.5")
    assert result.exit_code == 0, result.output
    assert result.stdout == ""
    line = r"out\.mp4: 30 frames, 64x48, 1\.001 s, \d+\.\d kB; \d+\.\d s\n"
    assert re.fullmatch(line, result.stderr)
    assert '"glow": 0.25' in decode(Path("out.mp4")).metadata["comment"]


def test_numbered_pictures_go_on(run):
    words = ["-o", "frames/%02d.png", "--fps", "10", "--size", "16x12"]
    assert run(*words, "--duration", "0.2").exit_code == 0
    result = run(*words, "--duration", "0.4")
    assert result.stderr.startswith("continues: 2 of 4 frames are there\nframes/%02d.png: 4 frames")


def test_the_time_of_a_still_is_the_start_of_a_sequence(run):
    words = ["-o", "%d.png", "--duration", "0.1", "--fps", "10", "--size", "16x12"]
    assert run(*words, "--start", "0.5").exit_code == 0
    result = run(*words, "--time", "0.5")
    assert result.stderr.startswith("continues: 1 of 1 frames are there")
    assert run(*words, "--time", "0.6").stderr.startswith("%d.png: 1 frame")


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        (["-o", "o.mp4", "--duration", "0"], 2, "a duration is more than 0 seconds, not 0"),
        (["-o", "o.mp4", "--duration", "1", "--fps", "0"], 2, "a frame rate is more than 0 a sec"),
        (["-o", "o.mp4", "--duration", "1", "--size", "33x32"], 2, "the nearest is 34x32"),
        (["-o", "o.mp4", "--duration", "1", "--set", "glow=7"], 2, "--set glow:"),
        (["-o", "o.apng", "--duration", "1", "--quality", "low"], 2, "--quality is for mp4, webm"),
        (["-o", "o.mp4", "--duration", "1", "--view", "depth"], 2, "view 'depth'"),
        (["-o", "o.mov", "--duration", "1"], 1, "cannot write o.mov: it has the suffix '.mov'"),
        (["-o", "o.png", "--duration", "1"], 1, "cannot write o.png: every frame needs its number"),
        (["-o", "no/o.mp4", "--duration", "1"], 1, "cannot write no/o.mp4: there is no folder"),
    ],
)
def test_mistakes_are_one_clear_line(run, tmp_path, words, code, message):
    pytest.importorskip("av")
    result = run(*words)
    assert result.exit_code == code, result.output
    assert result.stderr.startswith("error: ")
    assert message in result.stderr
    assert result.exception is None or isinstance(result.exception, SystemExit)
    assert [path.name for path in tmp_path.iterdir()] == ["moving.py"]


def test_without_pyav_it_says_what_to_install(run, monkeypatch):
    monkeypatch.setitem(sys.modules, "av", None)
    result = run("-o", "out.mp4", "--duration", "1")
    assert (result.exit_code, result.stderr) == (
        1,
        "error: videos need PyAV: av is missing: pip install 'distal[video]'\n",
    )
    result = run("-o", "frames/%02d.png", "--duration", "0.1", "--fps", "10", "--size", "16x12")
    assert result.exit_code == 0, result.output


def test_python_knows_it_by_one_name(moving, tmp_path):
    made = moving.video(tmp_path / "%d.png", duration=0.2, fps=10, size=(16, 12))
    assert str(made).startswith(f"{tmp_path / '%d.png'}: 2 frames, 16x12, 0.2 s, ")
    again = moving.video(tmp_path / "%d.png", duration=0.2, fps=10, size=(16, 12))
    assert (again.frames, again.rendered) == (2, 0)
