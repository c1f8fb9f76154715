"""Letters, numbers, legends of views and labels of slices, as they are drawn here."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import distal
from distal import Plane, Scene, Sphere
from distal.lang import func, vec2, vec4
from distal.lang.runtime_access import executor
from distal.render import legend, lettering, views
from distal.render.ranges import Range


def asked(function: Any, *args: Any) -> Any:
    """A scene function's values by the reference."""
    return executor().call(function, args, {}, device="reference")


def squares(left: float, right: float, height: int = 7) -> Any:
    """Places in squares, the uppermost row first."""
    x, y = np.meshgrid(np.arange(left, right) + 0.5, np.arange(height - 1, -1, -1) + 0.5)
    return np.stack([x.ravel(), y.ravel()], axis=1)


def drawn(covers: Any, width: int) -> list[str]:
    return ["".join("#" if c else "." for c in row) for row in np.reshape(covers, (-1, width))]


def art(text: str) -> list[str]:
    """The rows of a text, from the table."""
    glyphs = [lettering.GLYPHS[c].replace("0", ".").replace("1", "#").split() for c in text]
    return [".".join(glyph[row] for glyph in glyphs) + "." for row in range(7)]


def test_glyphs_look_as_they_are_drawn_here():
    assert lettering.GLYPHS["7"].split()[0] == "11111"
    two = [".###.", "#...#", "....#", "...#.", "..#..", ".#...", "#####"]
    found = asked(lettering.glyph_covers, 3, squares(0, 5) - 0.5)
    assert drawn(found, 5) == two


def test_a_word_is_drawn_letter_by_letter():
    packed = lettering.word("hit.distance")
    found = asked(lettering.word_covers, np.array([packed] * 7 * 96), squares(0, 96))
    assert drawn(found, 96) == art("HIT.DISTANCE    ")


def test_words_are_cut_and_unknown_letters_are_blank():
    assert lettering.word("abcdefghijklmnopqrst") == lettering.word("abcdefghijklmnop")
    assert lettering.word("a\u00e9b") == lettering.word("a b")


@pytest.mark.parametrize(
    ("value", "decimals", "text"),
    [
        (0.0, 0, "0"),
        (7.0, 2, "7.00"),
        (-0.5, 1, "-0.5"),
        (0.0496, 3, "0.050"),
        (-128.0, 0, "-128"),
        (65.84, 1, "65.8"),
        (123456.0, 0, "123456"),
        (-0.001, 1, "0.0"),
    ],
)
def test_numbers_end_at_their_lower_right(value, decimals, text):
    width = 6 * len(text)
    found = asked(lettering.number_covers, value, decimals, squares(-width, 0))
    # A number has no blank after it; the art has, so it moves by one.
    expected = ["." + row[:-1] for row in art(text)]
    assert drawn(found, width) == expected
    assert asked(lettering.number_width, value, decimals) == width - 1


@pytest.mark.parametrize(
    ("value", "digits", "decimals"),
    [(9.7, 3, 2), (0.05, 1, 2), (65.8, 3, 1), (134.0, 3, 0), (1.0, 3, 2), (0.2, 1, 1), (5e6, 3, 0)],
)
def test_decimals_show_so_many_digits(value, digits, decimals):
    assert asked(lettering.decimals_for, value, digits) == decimals


@func
def depth_legend(coord: vec2, width: float, height: float) -> vec4:
    resolution = vec2(width, height)
    shown = Range(4.0, 6.0, 8.0)
    return legend.with_depth(vec4(0.2, 0.4, 0.6, 0.5), coord, resolution, TITLE, shown)


TITLE = legend.ivec4(*lettering.word("depth"))


@pytest.mark.parametrize(
    ("width", "height", "size"), [(320, 240, 1), (1920, 1080, 3), (640, 480, 2)]
)
def test_a_legend_has_a_title_a_bar_and_numbers(width, height, size):
    """At the lower left, in squares of whole pixels: what a person reads off is the range."""
    high = int(size * (legend.MARGIN + legend.PANEL[1] + 1))
    wide = int(size * (legend.MARGIN + legend.PANEL[0] + 1))
    rows, columns = np.mgrid[0:high:size, 0:wide:size] + 0.5 * size
    places = np.stack([columns.ravel(), rows.ravel()], axis=1)
    colors = asked(depth_legend, places, float(width), float(height)).reshape(*rows.shape, 4)
    ink = (colors[..., :3] > 0.93).all(-1)
    text = ["".join("#" if c else "." for c in row) for row in ink[::-1]]
    joined = "\n".join(text)
    for row in art("DEPTH"):
        assert row.strip(".") in joined
    for number in ("4.00", "6.00", "8.00"):
        assert sum(art(number)[3].strip(".") in line for line in text) >= 1, number
    at = int(legend.MARGIN + legend.BAR_Y + 2)
    left = int(legend.MARGIN + legend.BAR_X)
    bar = colors[at, left : left + int(legend.BAR), :3]
    shares = (np.arange(len(bar)) + 0.5) / legend.BAR
    assert bar == pytest.approx(asked(views.depth_color, shares), abs=0.03)
    beside = asked(
        depth_legend, np.array([(0.5, 0.5), (wide + 4.0, 9.0)]), float(width), float(height)
    )
    assert beside == pytest.approx(np.tile([0.2, 0.4, 0.6, 0.5], (2, 1)))


def test_a_small_picture_has_no_legend():
    places = squares(0, 60, 40)
    found = asked(depth_legend, places, 64.0, 48.0)
    assert found == pytest.approx(np.tile([0.2, 0.4, 0.6, 0.5], (len(places), 1)))


def test_slices_have_the_distance_at_bold_lines():
    """A plane seen from the side: its bold lines are level; three columns have their labels."""
    scene = Scene(Plane(y=0.0), camera=distal.OrthographicCamera(position=(0, 0, 5), height=4.8))
    picture = scene.render((480, 480), view="slice").array[..., :3]
    paper = (picture > 0.86).all(-1)
    # 20 pixels are 0.2: bold lines lie 1 apart, and a unit is 100 pixels.
    for level in (1, 2):
        row = 240 - 100 * level
        for column in (80, 240, 400):
            area = paper[row - 9 : row + 9, column - 8 : column + 8]
            assert area.mean() > 0.4, (level, column)
            assert not paper[row + 30 : row + 60, column - 8 : column + 8].any()


def test_the_lines_of_a_slice_lie_at_their_distances():
    scene = Scene(Sphere(1.0), camera=distal.OrthographicCamera(position=(0, 0, 5), height=4.8))
    picture = scene.render((320, 320), view="slice").array[..., :3]
    # To the right of the middle, away from labels: 66.7 pixels a unit, a line each 0.2 or 0.5.
    row = picture[160, 160:].mean(-1)
    zero = 160 + np.argmin(row)
    assert abs((zero + 0.5 - 160) / (320 / 4.8) - 1.0) < 0.02
