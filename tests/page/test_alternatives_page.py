"""A page whose controls select shapes and count copies: the CPU's pictures, no new program."""

from __future__ import annotations

from itertools import pairwise

import pytest

import distal
from distal.scene.viewing.viewable import viewable
from tests.browser import BrowserUnavailableError
from tests.browser import browser as running_browser
from tests.page.looking import looked_at

TEXT = '''
"""Blocks by choice."""

from distal import Box, Camera, RoundBox, Scene, Torus, choose
from distal.lang import choice, integer, toggle

form = choice("Form", ["block", "tower", "none"])
count = integer("Count", 3, 2, 6)
lid = toggle("Lid", True)
block = RoundBox((0.9, 0.5, 0.7), 0.1).paint("tomato")
tower = RoundBox((0.4, 1.1, 0.4), 0.05).twist(1.0).paint("gold")
ring = Torus(0.2, 0.06).translate(1.0, -0.3, 0).repeat_polar(count).paint("navy")
top = Box((0.8, 0.1, 0.8)).translate(y=0.7).shown(lid)
shape = choose(form, {"block": block, "tower": tower, "none": None}) | ring | top
scene = Scene(shape, camera=Camera((2.0, 1.4, 2.4)), far=8.0, floor=False)
'''


@pytest.fixture(scope="module", autouse=True)
def browser():
    try:
        return running_browser()
    except BrowserUnavailableError as error:
        pytest.skip(f"no browser: {error}")


def test_controls_change_the_structure(tmp_path):
    source, path = tmp_path / "blocks.py", tmp_path / "blocks.html"
    source.write_text(TEXT, encoding="utf-8")
    scene = distal.load(source)
    scene.export(path)
    seen = viewable(scene)
    with looked_at(path) as looked:
        page = looked.page
        page.evaluate(
            """() => {
              window.linked = 0;
              const link = WebGL2RenderingContext.prototype.linkProgram;
              WebGL2RenderingContext.prototype.linkProgram = function (program) {
                window.linked += 1;
                return link.call(this, program);
              };
            }"""
        )
        assert looked.beside(seen).is_agreement
        pictures = [looked.picture()]
        page.evaluate("() => { window.linked = 0; }")
        page.get_by_label("Form", exact=True).select_option("tower")
        slider = page.get_by_role("slider", name="Count")
        slider.focus()
        slider.press("ArrowRight")
        slider.press("ArrowRight")
        page.get_by_label("Lid", exact=True).click()
        wanted = {"form": 1, "count": 5, "lid": False}
        assert looked.state()["parameters"] == wanted
        assert looked.beside(seen).is_agreement
        pictures.append(looked.picture())
        page.get_by_label("Form", exact=True).select_option("none")
        assert looked.beside(seen).is_agreement
        pictures.append(looked.picture())
        assert page.evaluate("() => window.linked") == 0
    apart = [(a != b).any(-1).mean() for a, b in pairwise(pictures)]
    assert min(apart) > 0.02
