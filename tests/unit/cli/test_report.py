"""The progress bar: only for a person, only when the work takes long."""

import io
import json
import sys

import pytest

from distal.cli import progress_lines, report
from distal.cli.report import ProgressBar, frame_progress, picture_progress, stages


class Terminal(io.StringIO):
    def isatty(self):
        return True


def run_on(monkeypatch, stream):
    # Here, not in a fixture: pytest puts its own stderr back between set-up and test.
    monkeypatch.setattr(sys, "stderr", stream)
    with ProgressBar() as progress:
        progress(0.25)
        progress(0.75)
    return stream.getvalue()


def test_quick_work_shows_nothing(monkeypatch):
    assert run_on(monkeypatch, Terminal()) == ""


def test_long_work_shows_a_bar_on_a_terminal(monkeypatch):
    monkeypatch.setenv("TERM", "xterm")  # a dumb terminal gets no bar
    monkeypatch.setattr(report, "PATIENCE_S", 0.0)
    assert "rendering" in run_on(monkeypatch, Terminal())


def test_long_work_shows_nothing_elsewhere(monkeypatch):
    monkeypatch.setattr(report, "PATIENCE_S", 0.0)
    assert run_on(monkeypatch, io.StringIO()) == ""


def test_stages_name_the_figures_that_are_seconds():
    figures = {"load_s": 0.0104, "compile_s": None, "render_s": 1.5, "lanes": 32}
    assert stages(figures) == "load 0.010 s, render 1.500 s"


def test_progress_for_programs_is_lines_of_json(monkeypatch, capsys):
    monkeypatch.setattr(progress_lines, "_PAUSE_S", 0.0)
    with picture_progress("json") as progress:
        progress.stage("loading")
        progress.describe("4 samples")
        progress(0.5)
    with frame_progress("json") as frames:
        frames(3, 12, "encoding")
    found = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert found == [
        {"stage": "loading", "done": 0.0, "text": ""},
        {"stage": "rendering", "done": 0.5, "text": "4 samples"},
        {"stage": "encoding", "done": 0.25, "text": "3 of 12 frames"},
    ]


def test_lines_of_progress_are_few_and_the_last_is_there(capsys):
    progress = picture_progress("json")
    for step in range(1001):
        progress(step / 1000)
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) < 50
    assert json.loads(lines[-1])["done"] == 1.0


def test_a_reader_that_is_gone_ends_the_command(monkeypatch):
    class Gone(io.StringIO):
        def flush(self):
            raise BrokenPipeError

    monkeypatch.setattr(sys, "stdout", Gone())
    with pytest.raises(BrokenPipeError):
        picture_progress("json")(0.5)
