"""The gallery in a real browser, and the page that says how far every way of drawing is off.

``make parity`` draws everything everywhere; here the functions of a pixel and a few
scenes stand for the rest, among them those that once took SwiftShader minutes to compile.
"""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

import numpy as np
import pytest

import distal
from tests import webgl
from tests.browser import BrowserUnavailableError
from tests.examples import functions_of_a_pixel
from tests.parity import gallery
from tests.pictures.comparison import Difference, difference

ROOT = Path(__file__).parents[2]
EXAMPLES = sorted(distal.gallery())
ON_SWIFTSHADER = [
    *functions_of_a_pixel(),
    *("raymarcher_objects", "sdfray_glass", "sea"),
    *("sdfray_csg_on_checker", "city"),
]
ON_MESA = ["raymarcher", "bunny", "still_life"]


def assert_agreement(example, way):
    try:
        found = gallery.measure(example, gallery.WAYS[way])
    except BrowserUnavailableError as error:
        pytest.skip(str(error))
    assert found.is_agreement_of(example), found


@pytest.mark.sample(2)  # make parity draws every example
@pytest.mark.parametrize("example", ON_SWIFTSHADER)
def test_the_browser_draws_the_cpu_picture(example):
    assert_agreement(example, "webgl2-swiftshader")


@pytest.mark.parametrize("example", ON_MESA)
def test_the_browser_on_mesa_draws_the_cpu_picture(example):
    assert_agreement(example, "webgl2")


@pytest.mark.parametrize(
    ("example", "target"),
    [
        ("raymarcher", "shadertoy"),
        ("melting", "shadertoy"),
        ("raymarcher", "glsl-es100"),
        ("melting", "glsl-es100"),
    ],
)
@pytest.mark.parametrize("size", [(96, 72), (7, 33)])
def test_sites_texts_run_in_the_browser(example, target, size):
    program = gallery.program(example, target)
    values = {"time": 2.9} if gallery.is_moving(example) else {}
    try:
        picture = webgl.run_webgl(program, size, values)
    except BrowserUnavailableError as error:
        pytest.skip(str(error))
    wanted = gallery.cpu_picture(example, size, values.get("time", 0.0))
    assert difference(picture, wanted).is_agreement


def test_a_refused_text_is_an_error_with_the_drivers_words():
    program = gallery.program("course_1_rays")
    spoiled = distal.Artifact(
        "#version 300 es\nvoid main() { nothing; }", program.interface, program.vertex
    )
    try:
        with pytest.raises(webgl.WebGLError, match=r"refused: ERROR: 0:2: 'nothing'"):
            webgl.run_webgl(spoiled, (8, 8))
        again = webgl.run_webgl(program, (8, 6))  # what comes after a fault works
    except BrowserUnavailableError as error:
        pytest.skip(str(error))
    assert again.shape == (6, 8, 4) and np.isfinite(again).all()


@pytest.fixture(scope="module")
def tool():
    spec = importlib.util.spec_from_file_location("gen_parity", ROOT / "tools/gen_parity.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules["gen_parity"] = module
    spec.loader.exec_module(module)
    return module


def test_the_page_lists_every_example_for_every_way(tool):
    rows = tool.rows_on(tool.PAGE.read_text())
    assert list(rows) == [way.title for way in gallery.WAYS.values()]
    for title, lines in rows.items():
        assert sorted(lines) == EXAMPLES, title


# Mesa's software Vulkan draws 10,000 parts wrong along the diagonal where its two triangles meet.
KNOWN = {("GPU, fragment shader", "beach"), ("GPU, fragment shader", "forest")}


def test_no_row_of_the_page_is_beyond_the_tolerances(tool):
    for title, lines in tool.rows_on(tool.PAGE.read_text()).items():
        for example, line in lines.items():
            if (title, example) in KNOWN:
                continue
            *_, mean, far_off, worst = line.strip("| ").split(" | ")
            found = Difference(float(mean), float(far_off.rstrip("%")) / 100.0)
            assert found.is_agreement_of(example), line
            assert worst.isdigit(), line  # else the tool has marked it


def test_a_way_that_disagrees_fails_the_command(tool, tmp_path, monkeypatch):
    def spoiled(example, size, seconds):
        return 1.0 - gallery.cpu_picture(example, size, seconds)

    way = gallery.Way("Upside down", spoiled, lambda: "nobody")
    monkeypatch.setattr(tool, "PAGE", tmp_path / "parity.md")
    monkeypatch.setattr(tool, "WAYS", {"spoiled": way})
    (fault,) = tool.measured(["course_1_rays"], [way])
    assert fault.startswith("course_1_rays disagrees: Upside down: | course_1_rays | 160x120 | 1 |")
    assert "**beyond**" in tool.PAGE.read_text()


def test_names_update_their_rows_only(tool, tmp_path, monkeypatch):
    way = gallery.Way("The CPU again", gallery.by_device("cpu"), lambda: "itself")
    monkeypatch.setattr(tool, "PAGE", tmp_path / "parity.md")
    monkeypatch.setattr(tool, "WAYS", {"cpu": way})
    assert tool.measured(["melting", "course_1_rays"], [way]) == []
    before = tool.rows_on(tool.PAGE.read_text())["The CPU again"]
    assert list(before) == ["course_1_rays", "melting"]  # the gallery's order
    kept = before["melting"].replace("| 0 |", "| 7 |")
    tool.PAGE.write_text(tool.PAGE.read_text().replace(before["melting"], kept))
    assert tool.measured(["course_1_rays"], [way]) == []
    assert tool.rows_on(tool.PAGE.read_text())["The CPU again"]["melting"] == kept
