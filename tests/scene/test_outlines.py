"""Drawings and letters: what becomes of paths and fonts, and what is said of bad ones."""

from __future__ import annotations

import importlib

import numpy as np
import pytest

from distal.fields.flats.outlines import OUTLINE
from distal.fields.guarantees import EXACT
from distal.scene.objects.lettering import text_outline
from distal.scene.objects.outlines import TOLERANCE, DrawnOutline, _quadratics, svg_path
from distal.scene.tree.errors import SceneTypeError, SceneValueError
from tests.fields.checks import examined, numbers_hold
from tests.fields.rows import Sample
from tests.fields.subject import Subject, subject_of

LEAF = "M10 80 C 40 10 65 10 95 80 S 150 120 180 80 A 25 25 0 0 1 160 140 Q 90 190 20 130 t-10,-50z"
SLOT = "M 0 0 H 10 V 6 H 0 Z M 2 2 v 2 h 6 v -2 z"


def sample_of(outline: DrawnOutline, even_odd: bool = False) -> Sample:
    choices = {"lines": outline.lines, "curves": outline.curves, "even_odd": even_odd}
    return Sample(OUTLINE, {}, choices)


def distances(outline: DrawnOutline, points, even_odd: bool = False):
    return sample_of(outline, even_odd).evaluate(np.array(points, np.float64))[0]


def exact(subject: Subject) -> Subject:
    """Where no chains overlap, the inside is exact too."""
    told = {name: getattr(subject, name) for name in Subject.__dataclass_fields__}
    return Subject(**{**told, "claims": EXACT})


@pytest.mark.parametrize(
    "outline",
    [svg_path(LEAF, size=2.0), svg_path(SLOT, size=2.0), text_outline("a8&", size=1.0)],
    ids=["leaf", "slot", "text"],
)
def test_an_outline_keeps_what_it_promises(outline):
    sample = sample_of(outline)
    subject = exact(subject_of(sample))
    assert not examined(subject, 4).findings
    assert not numbers_hold(sample, subject)
    np.testing.assert_array_equal(subject.low, outline.low)
    np.testing.assert_array_equal(subject.high, outline.high)


def gone_around(outline: DrawnOutline, points):
    """How often the chains go around points, by angles along dense polylines."""
    t = np.linspace(0.0, 1.0, 200)[:, None]
    lines = np.array(outline.lines.data, np.float64).reshape(-1, 2, 2)
    curves = np.array(outline.curves.data, np.float64).reshape(-1, 3, 2)
    runs = [a + (b - a) * t for a, b in lines]
    runs += [(1 - t) ** 2 * a + 2 * t * (1 - t) * b + t * t * c for a, b, c in curves]
    total = np.zeros(len(points))
    for run in runs:
        v = run[None] - points[:, None]
        z = v[..., 0] + 1j * v[..., 1]
        total += np.angle(z[:, 1:] / z[:, :-1]).sum(axis=1)
    return np.round(total / (2 * np.pi))


STAR = "M 50 0 L 79 90 L 2 35 L 98 35 L 21 90 Z M 40 40 q 20 -10 20 10 t -20 0 z"


@pytest.mark.parametrize("path", [LEAF, SLOT, STAR], ids=["leaf", "slot", "star"])
@pytest.mark.parametrize("even_odd", [False, True])
def test_inside_is_what_is_gone_around(path, even_odd):
    outline = svg_path(path, size=2.0)
    points = np.random.default_rng(1).uniform(-1.1, 1.1, (1500, 2))
    d = distances(outline, points, even_odd)
    away = np.abs(d) > 1e-3
    wanted = gone_around(outline, points[away])
    inside = wanted % 2 != 0 if even_odd else wanted != 0
    np.testing.assert_array_equal(d[away] < 0.0, inside)


def test_levels_through_corners_and_turns_are_counted_once():
    outline = svg_path("M 0 0 L 4 4 L 8 0 L 4 -4 Z M 20 0 Q 24 8 28 0 Q 24 -8 20 0")
    corners = np.array(outline.lines.data).reshape(-1, 2)
    turns = np.array(outline.curves.data)
    levels = np.unique(np.concatenate([corners[:, 1], turns[:, 1]]))
    x = np.linspace(outline.low[0] - 5.0, outline.high[0] + 5.0, 997)
    for level in levels:
        points = np.stack([x, np.full_like(x, level)], axis=1)
        d = distances(outline, points)
        away = np.abs(d) > 1e-3
        np.testing.assert_array_equal(d[away] < 0, gone_around(outline, points[away]) != 0)


def test_arcs_make_a_circle_and_y_points_up():
    circle = svg_path("M -5 20 a 5 5 0 1 0 10 0 a 5 5 0 1 0 -10 0 z", size=2.0)
    points = np.random.default_rng(2).normal(size=(500, 2))
    wanted = np.linalg.norm(points, axis=1) - 1.0
    # fontTools' cubic arcs leave the circle by 3e-4 of its radius.
    np.testing.assert_allclose(distances(circle, points), wanted, atol=3e-4 + 2 * TOLERANCE)
    ramp = svg_path("m 0 0 h 10 v 10 z")  # in SVG's view: the right angle is above, at the right
    assert distances(ramp, [(4.0, 4.0)])[0] < 0.0 < distances(ramp, [(-4.0, -4.0)])[0]


def test_size_is_the_longer_side_and_the_middle_is_the_origin():
    """Whatever the path's own place and units: 4 by 2 far from the origin, at size 3."""
    for path, half in (
        ("M 10 20 h 4 v 2 h -4 z", (1.5, 0.75)),
        ("M -9 -7 h 2 v 4 h -2 z", (0.75, 1.5)),
    ):
        outline = svg_path(path, size=3.0)
        assert outline.high == pytest.approx(half)
        assert outline.low == pytest.approx((-half[0], -half[1]))
    kept = svg_path("M 10 20 h 4 v 2 h -4 z")
    assert (kept.low, kept.high) == ((-2.0, -1.0), (2.0, 1.0))


def test_parabolas_stay_near_their_cubic():
    rng = np.random.default_rng(3)
    for _ in range(20):
        a, b, c, d = rng.normal(size=4) + 1j * rng.normal(size=4)
        parts = list(_quadratics((a, b, c, d), 1e-3))
        assert parts[0][0] == a and parts[-1][-1] == d
        s = np.linspace(0.0, 1.0, 50)
        worst = 0.0
        for i, (e, f, g) in enumerate(parts):
            part = (1 - s) ** 2 * e + 2 * s * (1 - s) * f + s**2 * g
            t = (i + s) / len(parts)
            u = 1 - t
            cubic = u**3 * a + 3 * t * u**2 * b + 3 * t**2 * u * c + t**3 * d
            worst = max(worst, np.abs(part - cubic).max())
        assert worst <= 1e-3
        fewer = np.sqrt(3.0) / 36.0 * abs(d - 3 * c + 3 * b - a) / max(len(parts) - 1, 1) ** 3
        assert len(parts) == 1 or fewer > 1e-3


def test_text_is_laid_out():
    both, first, second = (text_outline(t, justify="left") for t in ("AV", "A", "V"))
    assert both.high[0] < first.high[0] + second.high[0]  # the pair is kerned
    centred, right = text_outline("AV"), text_outline("AV", justify="right")
    width = both.high[0] - both.low[0]
    assert centred.high[0] - centred.low[0] == pytest.approx(width)
    assert right.high[0] < 0.1 and both.low[0] > -0.1
    capitals = text_outline("H", size=2.0)
    assert capitals.low[1] == pytest.approx(-capitals.high[1], abs=0.02)
    rows = text_outline("H\nH", line_spacing=1.5)
    assert rows.high[1] - rows.low[1] == pytest.approx(
        1.5 + (capitals.high[1] - capitals.low[1]) / 2
    )
    assert distances(text_outline("O"), [(0.0, 0.0), (0.0, 0.35)])[0] > 0.0


PATHS = [
    ("", "this SVG path encloses nothing"),
    ("L 1 2", "this SVG path cannot be read: it does not start with M at character 1, 'L 1 2'"),
    ("M 0 0 W 1", "this SVG path cannot be read: it has no command at character 7, 'W 1'"),
    ("M 0 0 L 1e999 0 L 1 1 Z", "this SVG path holds a number that is not finite"),
    ("M 0 0 L 5 5", "this SVG path encloses nothing"),
    ("M 0 0 L 5 0 L 3 0", "this SVG path encloses nothing"),
    ("M 0 0", "this SVG path encloses nothing"),
]


@pytest.mark.parametrize(("path", "message"), PATHS)
def test_bad_paths(path, message):
    with pytest.raises(SceneValueError) as error:
        svg_path(path)
    assert error.value.diagnostics[0].message == message


@pytest.mark.parametrize("path", ["M 0 0 L 1", "M 0 0 Q 1 1 2", "M", "M 0 0 A 1 2 3", "M 0 0 C 1"])
def test_paths_that_lack_numbers(path):
    with pytest.raises(SceneValueError) as error:
        svg_path(path)
    assert "path" in error.value.diagnostics[0].message


TEXTS = [
    (("",), {}, "a text needs a letter"),
    ((" \n",), {}, "a text needs a letter"),
    (("a",), {"size": 0.0}, "size must be above 0, not 0.0"),
    (("a",), {"justify": "middle"}, "justify is 'left', 'center' or 'right', not 'middle'"),
    (("a",), {"font": "no such font"}, "there is no font 'no such font' on this machine"),
    (("a",), {"font": "missing.ttf"}, "there is no font file 'missing.ttf'"),
    (("\U000f0000",), {}, "no font that is known has '\\U000f0000'"),
]


@pytest.mark.parametrize(("args", "kwargs", "message"), TEXTS)
def test_bad_texts(args, kwargs, message):
    with pytest.raises(SceneValueError) as error:
        text_outline(*args, **kwargs)
    assert error.value.diagnostics[0].message == message


def test_other_kinds():
    with pytest.raises(SceneTypeError):
        svg_path(7)
    with pytest.raises(SceneTypeError):
        text_outline(None)
    with pytest.raises(SceneTypeError):
        text_outline("a", font=3)


def test_a_file_that_is_no_font(tmp_path):
    file = tmp_path / "broken.ttf"
    file.write_bytes(b"no font at all")
    with pytest.raises(SceneValueError) as error:
        text_outline("a", font=file)
    assert error.value.diagnostics[0].message.startswith("the font 'broken.ttf' cannot be read")


def test_without_font_tools(monkeypatch):
    real = importlib.import_module

    def refused(name, *rest):
        if name.startswith("fontTools"):
            raise ImportError(name)
        return real(name, *rest)

    monkeypatch.setattr(importlib, "import_module", refused)
    with pytest.raises(SceneValueError) as error:
        svg_path("M 0 0 L 1 0 L 1 1 Z")
    assert error.value.diagnostics[0].hint == "pip install 'distal[text]'"
