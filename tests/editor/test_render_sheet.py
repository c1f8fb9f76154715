"""The export sheet's pictures and films in a browser: options, progress, cancel, the result."""

from __future__ import annotations

import io
import re
import shlex

import numpy as np
import pytest
from PIL import Image
from typer.testing import CliRunner

from distal.cli.application import application
from distal.editor.local.render_choices import choices
from tests.accessibility import violations
from tests.editor.studio_page import SCENE, SLOW_MS, studio

pytest.importorskip("websockets")

_MOVE = """() => {
  const { player } = studio.picture;
  player.setSteering({ yaw: 0.4, zoom: 0.8 });
  player.setParameter("size", 0.8);
}"""


def opened(app):
    app.page.get_by_role("button", name="Export").click()
    app.page.locator(".render .command code").wait_for(timeout=SLOW_MS)
    return app.page.locator(".render")


def test_a_picture_is_rendered_as_it_is_seen_and_as_its_command_does(tmp_path, monkeypatch):
    with studio(tmp_path) as app:
        app.page.evaluate(_MOVE)
        # Unsaved: the ball has another color.
        app.page.evaluate(
            "(text) => studio.editor.replace('scene.py', text)", SCENE.replace("#d97757", "#33aa55")
        )
        app.idle()
        sheet = opened(app)
        sheet.get_by_label("Width").fill("96")
        sheet.get_by_label("Height").fill("64")
        app.wait("() => document.querySelector('.render code').textContent.includes('96x64')")
        assert "save first" in sheet.locator(".result").inner_text()
        command = sheet.locator(".command code").first.inner_text()
        assert "--set size=0.8" in command
        assert "--steering yaw=0.4,pitch=0,zoom=0.8,pan_x=0,pan_y=0" in command
        with app.page.expect_download(timeout=SLOW_MS) as found:
            sheet.get_by_role("button", name="Render PNG").click()
            app.page.locator(".jobs progress").wait_for()
        assert found.value.suggested_filename == "scene.png"
        made = found.value.path().read_bytes()
        assert sheet.locator(".jobs .command code").inner_text() == command
        app.saved()
    words = shlex.split(command)
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(application, words[1:])
    assert done.exit_code == 0, done.output
    assert made == (tmp_path / "scene.png").read_bytes()
    pixels = np.asarray(Image.open(io.BytesIO(made)).convert("RGB")).astype(int)
    assert pixels.shape == (64, 96, 3)
    assert (pixels[..., 1] > pixels[..., 0] + 20).any(), "the unsaved green ball is not there"


def test_a_render_is_cancelled_while_one_goes_on_typing(tmp_path):
    with studio(tmp_path) as app:
        sheet = opened(app)
        sheet.get_by_label("Width").fill("1600")
        sheet.get_by_label("Height").fill("1200")
        sheet.get_by_label("Samples").fill("4096")
        sheet.get_by_role("button", name="Render PNG").click()
        app.page.locator(".jobs li", has_text=re.compile("compiling|rendering")).wait_for(
            timeout=SLOW_MS
        )
        app.page.keyboard.press("Escape")
        app.page.evaluate("() => studio.editor.goTo(1)")
        app.page.keyboard.press("Home")
        app.page.keyboard.type("# typed\n")
        app.idle()
        chip = app.page.locator(".chip")
        assert re.match("scene.png: (compiling|rendering)", chip.inner_text())
        chip.click()
        app.page.get_by_role("button", name="Cancel scene.png").click()
        app.page.locator(".jobs .cancelled").wait_for(timeout=SLOW_MS)
        assert "Cancelled; no file is left." in app.page.locator(".jobs .cancelled").inner_text()
    assert [file.name for file in tmp_path.iterdir()] == ["scene.py"]


def test_a_film_is_written_beside_the_scene(tmp_path):
    (tmp_path / "scene.gif").write_bytes(b"mine")
    moving = "@image\ndef picture(frame: Frame) -> vec3:\n    return vec3(frame.time, 0.5, 0.0)\n"
    with studio(tmp_path, f"from distal.lang import Frame, image, vec3\n\n\n{moving}") as app:
        sheet = opened(app)
        sheet.get_by_label("Format").select_option("gif")
        for label, value in {"Width": "32", "Height": "24", "Length, s": "0.2"}.items():
            sheet.get_by_label(label).fill(value)
        assert sheet.get_by_label("Repeats").is_checked()
        assert not sheet.get_by_label("Light").is_visible()
        sheet.get_by_role("button", name="Render GIF").click()
        app.page.locator(".jobs .done").wait_for(timeout=SLOW_MS)
        text = app.page.locator(".jobs .done").inner_text()
        assert "scene-2.gif" in text and "beside the scene" in text
    assert (tmp_path / "scene.gif").read_bytes() == b"mine"
    assert (tmp_path / "scene-2.gif").read_bytes()[:4] == b"GIF8"


def test_what_a_format_needs_and_what_a_field_lacks_is_said_before(tmp_path, monkeypatch):
    monkeypatch.setattr("distal.packages.is_installed", lambda module: module != "OpenEXR")
    choices.cache_clear()
    try:
        with studio(tmp_path) as app:
            sheet = opened(app)
            sheet.get_by_label("Width").fill("0")
            app.wait("() => document.querySelector('.render .result').textContent")
            assert sheet.locator(".result").inner_text().startswith("Size: ")
            sheet.get_by_label("Width").fill("40")
            sheet.get_by_label("Format").select_option("exr")
            assert "pip install 'distal[exr]'" in sheet.locator(".result").inner_text()
            assert sheet.get_by_role("button", name="Render EXR").is_disabled()
            sheet.get_by_label("Format").select_option("mp4")
            sheet.get_by_label("Light").select_option("path")
            assert sheet.get_by_label("Quality").input_value() == "high"
            assert violations(app.page) == []
    finally:
        choices.cache_clear()
