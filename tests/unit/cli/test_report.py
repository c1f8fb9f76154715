"""The progress bar: only for a person, only when the work takes long."""

import io
import sys

from distal.cli import report
from distal.cli.report import ProgressBar, stages


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
