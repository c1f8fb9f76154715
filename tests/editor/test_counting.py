"""How often lines run: the counts of the GPU against those of plain Python."""

import pytest

from tests.editor.studio_page import SCENE, SETTLED, studio

pytest.importorskip("websockets")

COUNTED = """from distal.lang import Frame, func, image, vec3

@func
def climb(start: float, limit: int) -> float:
    total = start
    for i in range(limit):
        if i % 3 == 0:
            total += 1.0
        elif i % 3 == 1:
            continue
        elif total > 40.0:
            return total
        else:
            total += 2.0
        total += 0.5
    return total

@image
def picture(frame: Frame) -> vec3:
    x = frame.coord.x
    y = frame.coord.y
    height = climb(x, int(y))
    left = x
    while left > 1.0:
        left = left / 2.0
        if left < 1.5:
            break
    if x > y:
        height = climb(y, 4)
    return vec3(height, left, x) / 60.0
"""
WIDTH, HEIGHT = 64, 48  # as the frame's 640 by 480
COUNT = """async ([width, height]) => {
  const text = studio.editor.view.state.doc.toString();
  const answer = await studio.client.ask({
    kind: "count", revision: 1, files: { "scene.py": text }, main: "scene.py" });
  const { program, places, which } = answer.result;
  const player = studio.picture.player;
  const found = [];
  for (let n = 0; n < places.length; n++) {
    const bytes = await player.drawn(program, { [which]: n }, [width, height]);
    const runs = [];
    for (let i = 0; i < bytes.length; i += 4)
      runs.push(bytes[i] + 256 * bytes[i + 1] + 65536 * bytes[i + 2]);
    found.push([places[n][1], runs]);
  }
  return found;
}"""


def plain_counts(width: int, height: int) -> dict[int, list[int]]:
    """The runs of each line, pixel by pixel from the lower left: the same program in Python."""
    runs: dict[int, list[int]] = {}
    now: dict[int, int] = {}

    def ran(line: int) -> None:
        now[line] = now.get(line, 0) + 1

    def climb(start: float, limit: int) -> float:
        ran(5)
        total = start
        ran(6)
        for i in range(limit):
            ran(7)
            if i % 3 == 0:
                ran(8)
                total += 1.0
            else:
                ran(9)
                if i % 3 == 1:
                    ran(10)
                    continue
                ran(11)
                if total > 40.0:
                    ran(12)
                    return total
                ran(14)
                total += 2.0
            ran(15)
            total += 0.5
        ran(16)
        return total

    for pixel in range(width * height):
        now.clear()
        x, y = pixel % width + 0.5, pixel // width + 0.5
        for line in (20, 21, 22):
            ran(line)
        climb(x, int(y))
        ran(23)
        left = x
        ran(24)
        while left > 1.0:
            ran(25)
            left = left / 2.0
            ran(26)
            if left < 1.5:
                ran(27)
                break
        ran(28)
        if x > y:
            ran(29)
            climb(y, 4)
        ran(30)
        for line in range(1, 31):
            runs.setdefault(line, []).append(now.get(line, 0))
    return {line: counts for line, counts in runs.items() if any(counts)}


def test_counts_are_those_of_plain_python(tmp_path):
    with studio(tmp_path, COUNTED) as app:
        app.page.evaluate(SETTLED)
        found = dict(app.page.evaluate(COUNT, [WIDTH, HEIGHT]))
    expected = plain_counts(WIDTH, HEIGHT)
    for line, counts in expected.items():
        assert found[line] == counts, line
    assert set(found) >= set(expected)
    assert {n for n, counts in found.items() if any(counts)} == set(expected)


def test_a_shape_counts_where_it_was_written_though_equal_ones_share_a_function(tmp_path):
    text = """from distal import *

one = Sphere(0.2).translate(x=-0.5)
two = Sphere(0.3).translate(x=0.5)
three = Sphere(0.4).translate(y=0.5)
scene = Scene((one | two | three).named("balls"), floor=None)
"""
    with studio(tmp_path, text) as app:
        app.page.evaluate(SETTLED)
        found = dict(app.page.evaluate(COUNT, [16, 12]))
    assert found[3] == found[4] == found[5]
    assert 0 < min(found[3]) <= max(found[3]) < 1000


def test_the_column_of_costs_is_shown_and_goes_away(tmp_path):
    with studio(tmp_path, SCENE) as app:
        app.page.get_by_role("button", name="Cost").click()
        marks = app.page.locator(".runs")
        marks.first.wait_for(timeout=60_000)
        assert marks.first.get_attribute("title").startswith("Runs ")
        assert app.page.locator(".costs").is_visible()
        app.page.evaluate("() => studio.editor.goTo(1)")
        app.page.keyboard.type("# a line more\n")
        app.idle()
        app.page.get_by_role("button", name="Cost").click()
        assert not app.page.locator(".costs").is_visible()


def test_the_layers_are_small_pictures_of_all_views(tmp_path):
    pictures = """() => new Set([...document.querySelectorAll('.layer canvas')]
      .map((still) => still.toDataURL())).size"""
    with studio(tmp_path, SCENE) as app:
        app.page.get_by_role("button", name="Layers").click()
        layers = app.page.locator(".layer")
        labels = [text.strip() for text in layers.all_inner_texts()]
        assert labels[0] == "Color" and {"Coordinate", "Signal", "Normal"} <= set(labels)
        # Few are equal: none is empty, but some views of so small a scene are black.
        app.wait(f"() => ({pictures})() >= {len(labels) - 3}")
        normal = layers.nth(labels.index("Normal"))
        normal.click()
        app.wait("() => document.querySelector('.picture .host').distal.view === 'normal'")
        assert normal.get_attribute("aria-pressed") == "true"
        app.idle()
