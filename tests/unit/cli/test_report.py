"""The progress bar: only for a person, only when the work takes long."""

import io
import sys

import pytest

from distal.cli import report
from distal.cli.report import ProgressBar, stages


class Terminal(io.StringIO):
    def isatty(self):
        return True


@pytest.fixture
def terminal(monkeypatch):
    stream = Terminal()
    monkeypatch.setattr(sys, "stderr", stream)
    return stream


def work():
    with ProgressBar() as progress:
        progress(0.25)
        progress(3, 4)


def test_quick_work_shows_nothing(terminal):
    work()
    assert terminal.getvalue() == ""


def test_long_work_shows_a_bar_on_a_terminal(terminal, monkeypatch):
    monkeypatch.setattr(report, "PATIENCE_S", 0.0)
    work()
    assert "rendering" in terminal.getvalue()


def test_long_work_shows_nothing_elsewhere(monkeypatch):
    stream = io.StringIO()
    monkeypatch.setattr(sys, "stderr", stream)
    monkeypatch.setattr(report, "PATIENCE_S", 0.0)
    work()
    assert stream.getvalue() == ""


def test_stages_name_the_figures_that_are_seconds():
    figures = {"load_s": 0.0104, "compile_s": None, "render_s": 1.5, "lanes": 32}
    assert stages(figures) == "load 0.010 s, render 1.500 s"
