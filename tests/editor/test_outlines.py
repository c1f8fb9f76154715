"""The outline of what a line makes: against what the CPU finds along the rays."""

import pytest

from distal.editor.shape_map import shape_map
from distal.loading import load, load_text
from distal.scene.checks.probe import probe
from distal.scene.steering import Steering
from distal.scene.viewing.viewable import viewable
from tests.editor.studio_page import SCENE, SETTLED, studio

pytest.importorskip("websockets")

MAP = """async ([line, width, height]) => {
  const map = await studio.picture.outline.map();
  const bytes = await studio.picture.player.drawn(map.program, {}, [width, height]);
  const found = [];
  for (let i = 0; i < bytes.length; i += 4) {
    const lines = bytes[i + 3] ? map.parts[bytes[i] + 256 * bytes[i + 1]] : [];
    found.push(lines.some(([file, from]) => from === line));
  }
  return found;
}"""
OUTLINE = """() => {
  const canvas = document.querySelector('canvas.outline');
  if (canvas.hidden) return null;
  const { width, height } = canvas;
  const { data } = canvas.getContext('2d').getImageData(0, 0, width, height);
  const at = [];
  for (let i = 0; i < data.length; i += 4) if (data[i] === 255) at.push((i / 4) % width);
  return { width, height, left: Math.min(...at), right: Math.max(...at), count: at.length };
}"""
SEEN = "() => !document.querySelector('canvas.outline').hidden"
GONE = "() => document.querySelector('canvas.outline').hidden"
LINES = {"ball": 7, "box": 8, "scene": 10}

USED_TWICE = """from distal import *
ball = Sphere(0.3)
left = ball.translate(-1.0, 0.0, 0.0)
right = ball.translate(1.0, 0.0, 0.0)
both = left | right
cut = both - Box(0.2).translate(-1.0, 0.3, 0.0)
"""
MANY = """from distal import *
row = [Sphere(0.3).translate(1.0 * i, 0.0, 0.0) for i in range(60)]
other = [Box(0.2).translate(1.0 * i, 1.0, 0.0).rotate(y=0.5) for i in range(60)]
floor = Plane()
scene = Scene(union(*row, *other) | floor)
"""


def parts_of(text, folder):
    """The lines of each part."""
    file = folder / "scene.py"
    found = shape_map(viewable(load_text(file, text).picture), ("scene.py",))
    return [{line for _, line in part} for part in found.parts]


def test_parts_know_the_lines_that_hold_them(tmp_path):
    parts = parts_of(USED_TWICE + "scene = Scene(cut)\n", tmp_path)
    assert {2, 3, 5, 6, 7} >= parts[0] >= {2, 3, 5, 6}
    assert {2, 4, 5, 6, 7} >= parts[1] >= {2, 4, 5, 6}
    # The cutter made its face, not those that were cut.
    assert {6, 7} >= parts[2] >= {6}


def test_parts_of_a_table_know_their_lines(tmp_path):
    parts = parts_of(MANY, tmp_path)
    assert sum(2 in part for part in parts) == 60
    assert sum(3 in part for part in parts) == 60
    assert sum(4 in part for part in parts) == 1
    assert all(5 in part for part in parts)
    assert not any({2, 3} <= part for part in parts)


def test_the_map_is_what_rays_hit(tmp_path):
    with studio(tmp_path) as app:
        app.page.evaluate("() => studio.picture.player.setSteering({ yaw: 0.4, pitch: -0.2 })")
        app.page.evaluate(SETTLED)
        scene = viewable(load(app.file)).scene
        assert scene is not None
        width, height = 32, 24
        found = {n: app.page.evaluate(MAP, [at, width, height]) for n, at in LINES.items()}
        for name, hits in found.items():
            assert any(hits) and not all(hits), name
        assert [a or b for a, b in zip(found["ball"], found["box"], strict=True)] == found["scene"]
        assert not any(a and b for a, b in zip(found["ball"], found["box"], strict=True))
        wrong = 0
        moved = Steering(yaw=0.4, pitch=-0.2)
        for y in range(height):
            for x in range(width):
                hit = probe(scene, (x, height - 1 - y), (width, height), steering=moved)
                name = hit.path[-1].place.line if hit.hit else 0
                for each in ("ball", "box"):
                    wrong += found[each][y * width + x] != (name == LINES[each])
        assert wrong == 0


def test_a_line_under_the_mouse_is_outlined(tmp_path):
    with studio(tmp_path) as app:
        app.page.evaluate(SETTLED)
        lines = app.page.locator(".cm-line")
        assert app.page.evaluate(OUTLINE) is None
        lines.nth(LINES["ball"] - 1).hover()
        app.wait(SEEN)
        ball = app.page.evaluate(OUTLINE)
        lines.nth(LINES["box"] - 1).hover()
        app.wait(f"() => ({OUTLINE})()?.left > {ball['left']}")
        box = app.page.evaluate(OUTLINE)
        assert box["right"] > ball["right"]
        # A line that makes nothing has no outline.
        lines.nth(1).hover()
        app.wait(GONE)
        # It follows the camera.
        lines.nth(LINES["ball"] - 1).hover()
        app.wait(SEEN)
        app.page.evaluate("() => studio.picture.player.setSteering({ pan: [0.3, 0.0] })")
        app.wait(f"() => {{ const x = ({OUTLINE})(); return x && x.left !== {ball['left']}; }}")
        app.page.locator(".picture").hover()
        app.wait(GONE)


def test_a_click_on_the_picture_outlines_the_shape_for_a_moment(tmp_path):
    with studio(tmp_path) as app:
        app.page.evaluate(SETTLED)
        # On a busy machine the moment may be over before the click is reported.
        app.page.evaluate(
            f"() => {{ const look = () => {{ window.seen ||= !!({SEEN})();"
            " requestAnimationFrame(look); }; look(); }"
        )
        app.page.locator(".host canvas").click()
        app.wait("() => window.seen")
        app.wait(GONE)


def test_typing_takes_the_outline_away(tmp_path):
    with studio(tmp_path, SCENE) as app:
        app.page.evaluate(SETTLED)
        app.page.locator(".cm-line").nth(LINES["ball"] - 1).hover()
        app.wait(SEEN)
        app.page.get_by_role("textbox", name="Code", exact=True).press("End")
        app.page.keyboard.type("  #")
        app.page.wait_for_timeout(20)
        assert app.page.evaluate(GONE)
        app.idle()
        # It is asked for again for the new text.
        app.page.locator(".cm-line").nth(1).hover()
        app.page.locator(".cm-line").nth(LINES["ball"] - 1).hover()
        app.wait(SEEN)
