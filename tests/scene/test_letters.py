"""Letters and drawings as flat shapes."""

from __future__ import annotations

import numpy as np
import pytest

from distal import CompileError, SvgPath, Text


def test_a_square_path_is_a_square():
    square = SvgPath("M 0 0 L 10 0 L 10 10 L 0 10 Z", size=2.0)
    places = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.5, 0.0]])
    np.testing.assert_allclose(square(places), [-1.0, 1.0, np.sqrt(2.0), -0.5], atol=1e-6)
    assert square.bounds() == ((-1.0, -1.0), (1.0, 1.0))


def test_holes_of_paths_by_either_rule():
    nested = "M 0 0 H 9 V 9 H 0 Z M 3 3 H 6 V 6 H 3 Z"
    middle = np.array([[0.0, 0.0]])
    assert SvgPath(nested, size=9.0)(middle)[0] < 0.0
    assert SvgPath(nested, size=9.0, even_odd=True)(middle)[0] > 0.0


def test_an_o_has_a_hole_and_becomes_a_solid():
    letter = Text("O")
    low, high = letter.bounds()
    middle = np.array([[0.5 * (low[0] + high[0]), 0.0]])
    assert letter(middle)[0] > 0.0
    solid = letter.extrude(0.5)
    assert solid(np.array([[low[0] + 0.04, 0.0, 0.0]]))[0] < 0.0
    assert solid.bounds()[1][2] == pytest.approx(0.25)


@pytest.mark.parametrize(
    "make", [lambda: SvgPath("not a path"), lambda: Text(""), lambda: Text("a", font="/none.ttf")]
)
def test_mistakes_are_told_at_the_authors_line(make):
    with pytest.raises(CompileError, match=r"test_letters\.py"):
        make()
