"""``distal check`` tells what is proved and refuted of the author's functions."""

from __future__ import annotations

import pytest

from distal import Box, Shape
from distal.lang import floor, func, length, sin, slider, tanh, vec3
from distal.scene.checks import measuring, proof_report
from distal.scene.checks.validation import Severity, ValidationReport, check

CUBE = (-2.0, -2.0, -2.0), (2.0, 2.0, 2.0)


@func
def waved(p: vec3, depth: float) -> float:
    return length(p) - 1.0 - depth * sin(9.0 * p.x)


@func
def ridged(p: vec3) -> float:
    return length(p) - 1.0 + 0.00015 * tanh(40000.0 * (p.x - 0.01234))


@func
def jumping(p: vec3) -> float:
    return length(p) - 1.0 - 0.001 * floor(p.x)


def notes(report: ValidationReport) -> dict[str, str]:
    found = [f.diagnostic for f in report.findings]
    return {d.code: d.message for d in found if d.code != "slope-raised"}


def test_what_was_proved_on_construction():
    shape = Shape.from_function(waved, depth=0.05, region=CUBE)
    assert notes(check(shape)) == {
        "proved": "the slope and the box of 'waved' are proved in (-2, -2, -2) to (2, 2, 2)"
    }
    (found,) = [f for f in check(shape | Box(0.2)).findings if f.diagnostic.code == "proved"]
    assert found.severity is Severity.NOTE
    assert found.diagnostic.span.text.strip().startswith("shape = Shape.from_function(waved")
    boxed = Shape.from_function(waved, depth=0.05, region=CUBE, bounds=CUBE)
    message = "the slope of 'waved' is proved in (-2, -2, -2) to (2, 2, 2)"
    assert notes(check(boxed)) == {"proved": message}


def test_a_declared_slope_is_proved_in_its_box():
    shape = Shape.from_function(waved, depth=0.05, slope=1.6, bounds=CUBE)
    message = "the slope of 'waved' is proved in its box: it is at most 1.46, and 1.6 is declared"
    assert notes(check(shape)) == {"slope-proved": message}


def test_parameters_have_their_values():
    depth = slider("Depth", 0.05, low=0.0, high=0.2)
    shape = Shape.from_function(waved, depth=depth, slope=1.6, bounds=CUBE)
    assert list(notes(check(shape))) == ["slope-proved"]
    assert list(notes(check(shape, {"depth": 0.0}))) == ["slope-proved"]


def test_a_slope_that_is_refuted_between_the_points(monkeypatch):
    """A step of width 5e-5 and slope 6, which none of a few random points meets."""
    # With thousands of points, the last bits of a processor's arithmetic decide whether one does.
    monkeypatch.setattr(measuring, "POINTS", 64)
    shape = Shape.from_function(ridged, slope=1.5, bounds=CUBE)
    report = check(shape)
    assert not report.holds
    (error,) = [f for f in report.findings if f.severity is Severity.ERROR]
    assert error.diagnostic.code == "slope-refuted"
    message = error.diagnostic.message
    assert message.startswith("'ridged' declares the slope 1.5, but its value changes by at least ")
    assert "per unit near (0.0123, " in message
    assert error.diagnostic.hint == "slope=7.01, which is proved"


def test_why_nothing_is_proved():
    shape = Shape.from_function(jumping, slope=1.5, bounds=CUBE)
    message = "the slope of 'jumping' is not proved: it may jump: it uses floor"
    assert notes(check(shape)) == {"slope-not-proved": message}


def test_long_functions_are_left_out(monkeypatch):
    monkeypatch.setattr(proof_report, "MOST_OPERATIONS", 5)
    shape = Shape.from_function(waved, depth=0.05, slope=1.6, bounds=CUBE)
    (message,) = notes(check(shape)).values()
    assert message.startswith("the slope of 'waved' is not proved: it has ")
    assert message.endswith("operations, more than 5")


@pytest.mark.parametrize("bounds", [None, CUBE])
def test_without_a_box_nothing_is_tried(bounds):
    codes = notes(check(Shape.from_function(waved, depth=0.05, slope=1.6, bounds=bounds)))
    assert ("slope-proved" in codes) == (bounds is not None)
