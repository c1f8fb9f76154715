"""The studio in a browser: typing, mistakes, dials, Keep, clicks, loops, drafts, phones, keys."""

from __future__ import annotations

import re

import pytest

from distal.cli.studio import STARTER
from tests.accessibility import needs_axe, violations
from tests.editor.studio_page import (
    DESK,
    IDLE,
    PLAYER,
    SCENE,
    SETTLED,
    SLOW_MS,
    studio,
)

pytest.importorskip("websockets")

PHONE = {"viewport": {"width": 390, "height": 844}, "has_touch": True, "is_mobile": True}

FUNC = """from distal.lang import Frame, image, vec3

@image
def picture(frame: Frame) -> vec3:
    level = 0.25
    for _ in range(3):
        level = level * 0.9
    return vec3(level, 0.5, 0.0)
"""

_VALUES = "() => document.querySelector('.picture .host').distal.parameters()"

COLORS = """async () => {
  const blob = await studio.picture.player.screenshot(1);
  const image = await createImageBitmap(blob);
  const canvas = new OffscreenCanvas(image.width, image.height);
  const context = canvas.getContext("2d");
  context.drawImage(image, 0, 0);
  const { data } = context.getImageData(0, 0, image.width, image.height);
  return new Set(new Uint32Array(data.buffer)).size;
}"""


def test_a_mistake_is_shown_at_its_line_and_the_picture_stays(tmp_path):
    with studio(tmp_path) as app:
        app.page.evaluate("() => studio.editor.goTo(8)")
        app.page.keyboard.press("End")
        app.page.keyboard.type(".foo(1)")
        app.wait("() => document.querySelector('.mistakes').childElementCount")
        assert app.mistakes.startswith("line 8: AttributeError: 'Shape' has no 'foo'")
        assert app.page.locator(".cm-lintRange-error").inner_text().startswith("Box(")
        assert "old" in app.page.locator(".picture").get_attribute("class")
        assert app.page.locator(".announcer").inner_text().startswith("Line 8: ")
        app.page.keyboard.press("F8")
        caret = app.page.evaluate("() => studio.editor.view.state.selection.main.from")
        assert caret == SCENE.index("Box(0.50)")
        app.page.keyboard.press("End")
        for _ in ".foo(1)":
            app.page.keyboard.press("Backspace")
        app.wait("() => !document.querySelector('.mistakes').childElementCount")
        app.idle()
        assert "old" not in app.page.locator(".picture").get_attribute("class")
        assert app.text == SCENE


# Those that keep frames, and a parameter of each.
KEEP_FRAMES = [
    *(("coral", "feed"), ("ink", "swirl"), ("lamps", "glow")),
    *(("pilot", "fading"), ("spectrum", "trails")),
]


@pytest.mark.sample(3)
@pytest.mark.parametrize(("name", "parameter"), KEEP_FRAMES)
def test_an_example_that_keeps_frames_is_drawn(name, parameter, tmp_path):
    with studio(tmp_path) as app:
        app.page.evaluate("(name) => studio.opening.open(name)", name)
        app.wait(f"() => studio.picture.player.payload.parameters[0]?.name === '{parameter}'")
        app.idle()
        player = "studio.picture.player"
        app.page.evaluate(f"async () => {{ {player}.pause(); {player}.setTime(0); }}")
        app.page.evaluate(f"async () => {{ {player}.setTime(0.1); await {player}.settled(); }}")
        colors = app.page.evaluate(COLORS)
        assert app.mistakes == ""
        assert colors > 20


def test_a_dragged_number_changes_its_bytes_and_the_picture_and_is_one_undo(tmp_path):
    with studio(tmp_path) as app:
        app.dial("0.50")
        app.turn(0.82)
        app.wait("() => studio.editor.view.state.doc.toString().includes('0.82')")
        app.idle()
        assert app.text == SCENE.replace("Box(0.50)", "Box(0.82)")
        assert app.page.locator(".dial input[type=number]").input_value() == "0.82"
        assert app.equals_the_cpu()
        assert app.file.read_text() == SCENE.replace("Box(0.50)", "Box(0.82)")
        app.page.keyboard.press("Escape")
        app.page.evaluate("() => studio.editor.view.focus()")
        app.page.keyboard.press("Control+z")
        app.idle()
        assert app.text == SCENE


def test_a_number_is_dragged_in_the_text_itself(tmp_path):
    def press(literal: str, right: int) -> None:
        box = app.page.locator(".literal", has_text=literal).first.bounding_box()
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        app.page.mouse.move(x, y)
        app.page.mouse.down()
        for step in range(1, 5):
            app.page.mouse.move(x + right * step / 4, y)
        app.page.mouse.up()

    with studio(tmp_path) as app:
        press("0.50", 80)  # 20 steps of 0.01
        app.wait("() => studio.editor.view.state.doc.toString().includes('Box(0.70)')")
        app.idle()
        assert app.text == SCENE.replace("Box(0.50)", "Box(0.70)")
        assert app.page.locator(".dial input[type=number]").input_value() == "0.7"
        app.page.keyboard.press("Control+z")
        app.idle()
        assert app.text == SCENE

        press("(1, 2, 3)", 0)  # a press that rests is a click
        fields = app.page.locator(".dial input[type=number]")
        assert [field.input_value() for field in fields.all()] == ["1", "2", "3"]
        caret = app.page.evaluate("() => studio.editor.view.state.selection.main.head")
        assert abs(caret - SCENE.index("(1, 2, 3)") - 4.5) < 1
        press("(1, 2, 3)", 8)  # the number in the middle
        app.wait("() => studio.editor.view.state.doc.toString().includes('(1, 4, 3)')")


def test_a_number_of_a_function_is_turned_without_compiling(tmp_path):
    with studio(tmp_path, FUNC) as app:
        app.page.evaluate(
            "() => { studio.sent = []; const post = studio.client.channel.post.bind("
            "studio.client.channel); studio.client.channel.post = (m) => {"
            " studio.sent.push(m.kind); post(m); } }"
        )
        app.dial("0.25")
        app.turn(0.75, steps=30)
        app.wait("() => studio.editor.view.state.doc.toString().includes('level = 0.75')")
        app.idle()
        kinds = app.page.evaluate("() => studio.sent")
        assert kinds[0] == "hold"
        assert len(kinds) < 8, kinds
        assert app.text == FUNC.replace("0.25", "0.75")
        assert app.equals_the_cpu()


def test_the_bound_of_a_loop_is_turned_too(tmp_path):
    with studio(tmp_path, FUNC) as app:
        app.dial("3")
        app.turn(7)
        app.wait("() => studio.editor.view.state.doc.toString().includes('range(7)')")
        app.idle()
        assert app.equals_the_cpu()


def test_a_color_is_picked(tmp_path):
    with studio(tmp_path) as app:
        app.page.locator(".swatch").first.click()
        app.page.locator(".dial input[type=color]").evaluate(
            """(picker) => {
              picker.value = "#33aa55";
              picker.dispatchEvent(new Event("input", { bubbles: true }));
              picker.dispatchEvent(new Event("change", { bubbles: true }));
            }"""
        )
        app.wait("() => studio.editor.view.state.doc.toString().includes('#33aa55')")
        app.idle()
        assert app.text == SCENE.replace("#d97757", "#33aa55")
        assert app.equals_the_cpu()


def test_a_word_is_chosen(tmp_path):
    with studio(tmp_path, SCENE.replace('"#123456",', '"#123456", tone_map="aces",')) as app:
        app.dial('"aces"')
        words = app.page.locator(".dial select")
        assert "agx" in words.locator("option").all_inner_texts()
        words.select_option("none")
        app.wait("() => studio.editor.view.state.doc.toString().includes('\"none\"')")
        app.idle()
        assert app.equals_the_cpu()


def test_keep_writes_a_slider_and_the_camera(tmp_path):
    with studio(tmp_path) as app:
        keep = app.page.get_by_role("button", name="Keep", exact=True)
        assert not keep.is_visible()
        app.page.locator(".knobs input[type=range]").evaluate(
            "(s) => { s.value = s.max; s.dispatchEvent(new Event('input', { bubbles: true })); }"
        )
        keep.click()
        app.wait("() => studio.editor.view.state.doc.toString().includes('\"Size\", 1.0, 0.1')")
        app.idle()
        assert not keep.is_visible()
        assert app.page.evaluate(_VALUES) == {"size": 1}
        app.page.evaluate("() => studio.picture.player.hands.drag(0.2, 0.1, false)")
        app.page.get_by_role("button", name="Keep camera").click()
        app.wait("() => !studio.editor.view.state.doc.toString().includes('(1.0, 1.5, 4.0)')")
        app.idle()
        app.wait("() => studio.picture.player.steering().yaw === 0")
        assert "fov_deg=40" in app.text
        assert app.equals_the_cpu()


def test_the_camera_is_kept_before_its_guide_is_there(tmp_path):
    """The program that knows where the camera is comes in a pause; a click needs none.

    Nor is it lost where the player cannot ask that program yet.
    """
    with studio(tmp_path) as app:
        app.page.evaluate(
            """() => {
              const { camera } = studio.picture.player;
              const real = camera.here.bind(camera);
              let count = 0;
              camera.here = () => (++count < 4 ? Promise.resolve(null) : real());
            }"""
        )
        app.page.evaluate("() => studio.picture.player.hands.drag(0.2, 0.1, false)")
        app.page.get_by_role("button", name="Keep camera").click()
        app.wait("() => !studio.editor.view.state.doc.toString().includes('(1.0, 1.5, 4.0)')")
        assert "fov_deg=40" in app.text


def test_a_click_on_the_picture_selects_the_line(tmp_path):
    with studio(tmp_path) as app:
        app.page.evaluate(SETTLED)
        box = app.page.locator(".host canvas").bounding_box()
        x, y = box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"]
        app.page.mouse.click(x, y)
        app.wait("() => document.querySelector('.work').textContent.includes('step')")
        assert app.page.locator(".work").inner_text().startswith(("Sphere", "ball"))
        assert app.page.locator(".cm-activeLine").inner_text().startswith("ball = Sphere")
        # After the camera has moved, too: the box is in the middle then.
        app.page.evaluate(
            "() => studio.picture.player.setSteering({ pan: [-0.3, 0.0], yaw: 0, pitch: 0 })"
        )
        app.page.mouse.click(x, y)
        app.wait("() => document.querySelector('.cm-activeLine').textContent.startsWith('box = ')")


def test_an_endless_loop_is_ended_and_typing_goes_on(tmp_path):
    with studio(tmp_path, limit=5.0) as app:
        app.page.evaluate("(text) => studio.editor.replace('scene.py', text)", f"{SCENE}(")
        app.wait("() => document.querySelector('.mistakes').childElementCount")
        loop = f"while True: pass\n{SCENE}"
        app.page.evaluate("(text) => studio.editor.replace('scene.py', text)", loop)
        app.wait("() => !document.querySelector('.notice').hidden")
        assert "gave no answer within 5 s" in app.page.locator(".notice").inner_text()
        assert "while True" in app.text
        assert app.mistakes == ""
        app.page.evaluate("(text) => studio.editor.replace('scene.py', text)", SCENE)
        app.wait(IDLE)
        app.wait("() => document.querySelector('.notice').hidden")


def test_a_reload_keeps_the_draft(tmp_path):
    with studio(tmp_path) as app:
        app.page.evaluate("() => studio.editor.goTo(2)")
        app.page.keyboard.type("# mine\n")
        app.idle()
        app.page.reload()
        app.wait(PLAYER)
        assert "# mine" in app.text
        assert "Unsaved changes of scene.py" in app.page.locator(".notice").inner_text()
        app.page.get_by_role("button", name="Discard them").click()
        assert app.text == SCENE


def test_two_tabs_and_another_editor(tmp_path):
    with studio(tmp_path, tabs=2) as (first, second):
        first.page.evaluate("(text) => studio.editor.replace('scene.py', text)", f"# a\n{SCENE}")
        first.saved()
        second.wait("() => studio.editor.view.state.doc.toString().startsWith('# a')")
        second.page.evaluate("(text) => studio.editor.replace('scene.py', text)", f"# b\n{SCENE}")
        first.file.write_text(f"# c\n{SCENE}")
        first.wait("() => studio.editor.view.state.doc.toString().startsWith('# c')")
        second.wait("() => document.querySelector('.state-bar')")
        assert "changed by another program" in second.page.locator(".state-bar").inner_text()
        assert second.text.startswith("# b")
        second.page.get_by_role("button", name="Take the other").click()
        assert second.text.startswith("# c")


def test_texts_of_targets_are_linked_to_lines(tmp_path):
    with studio(tmp_path) as app:
        app.page.evaluate("() => studio.editor.goTo(7)")
        app.page.get_by_role("tab", name="Emitted text").click()
        app.page.locator(".emitted .linked").first.wait_for(timeout=SLOW_MS)
        assert "sphere" in app.page.locator(".emitted .linked").first.inner_text()
        app.page.locator(".emitted .cm-line", has_text="box_").first.click()
        app.page.locator(".tab-row select").select_option("wgsl")
        app.wait("() => document.querySelector('.emitted .cm-content').textContent.includes('fn ')")


def test_exports_and_examples(tmp_path):
    with studio(tmp_path) as app:
        app.page.get_by_role("button", name="Export").click()
        with app.page.expect_download(timeout=SLOW_MS) as found:
            app.page.get_by_role("button", name=re.compile("^page")).click()
        assert found.value.suggested_filename == "scene.html"
        result = app.page.locator(".sheet-body > .result")
        assert "distal export scene.py -o scene.html" in result.inner_text()
        with app.page.expect_download(timeout=SLOW_MS) as found:
            app.page.get_by_role("button", name=re.compile("^embed")).click()
        assert found.value.suggested_filename == "scene-embed.html"
        assert "<html" not in found.value.path().read_text()
        app.wait(
            "() => document.querySelector('.sheet-body > .result').textContent.includes('--embed')"
        )
        app.page.keyboard.press("Escape")
        app.page.get_by_role("button", name="Gallery").click()
        loaded = "() => document.querySelector('.posters img').naturalWidth === 320"
        app.wait(loaded)
        app.page.get_by_label("Search the gallery").fill("no such")
        assert app.page.locator(".sheet [role=status]").inner_text() == "No example of that name."
        app.page.get_by_label("Search the gallery").fill("melt")
        app.page.get_by_role("button", name=re.compile("^melting")).click()
        app.wait("() => studio.picture.player.payload.parameters.length === 2")
        assert "sd_sphere" in app.text
        app.page.evaluate("() => studio.editor.view.focus()")
        app.page.keyboard.press("Control+z")
        assert app.text == SCENE


def test_a_phone_by_touch(tmp_path):
    with studio(tmp_path, **PHONE) as app:
        app.page.locator(".literal", has_text="0.50").first.tap()
        app.page.locator(".dial").wait_for()
        app.page.locator(".dial").get_by_role("button", name="More").tap()
        app.wait("() => studio.editor.view.state.doc.toString().includes('Box(0.51)')")
        app.page.get_by_role("button", name="Controls").tap()
        assert app.page.locator(".knobs").is_visible()
        assert not app.page.locator(".cm-editor").first.is_visible()
        wide = app.page.evaluate("() => document.documentElement.scrollWidth")
        assert wide <= PHONE["viewport"]["width"]


def test_by_keys_alone(tmp_path):
    with studio(tmp_path) as app:
        app.page.keyboard.press("F6")
        assert app.page.evaluate("() => document.activeElement.ariaLabel") == "Code"
        app.page.evaluate("() => studio.editor.goTo(8, 11)")  # in 0.50
        app.page.keyboard.press("Control+.")
        app.page.wait_for_function("() => document.activeElement.type === 'range'")
        app.page.keyboard.press("ArrowRight")
        app.wait("() => studio.editor.view.state.doc.toString().includes('Box(0.51)')")
        app.page.keyboard.press("Escape")
        assert app.page.evaluate("() => document.activeElement.ariaLabel") == "Code"
        app.page.keyboard.press("Control+s")
        app.wait("() => !studio.texts.isChanged('scene.py')")
        assert "Box(0.51)" in app.file.read_text()
        app.page.keyboard.press("Escape")
        app.page.keyboard.press("Tab")
        assert app.page.evaluate("() => document.activeElement.ariaLabel") != "Code"
        app.page.keyboard.press("F6")
        assert app.page.evaluate("() => !!document.activeElement.closest('.left, .show')")


@needs_axe
@pytest.mark.parametrize("size", [DESK, PHONE], ids=["desk", "phone"])
def test_every_screen_is_accessible_in_light_and_dark(tmp_path, size):
    with studio(tmp_path, bypass_csp=True, **size) as app:
        assert violations(app.page) == []
        for name in ("gallery", "export", "help", "commands"):
            app.page.evaluate(
                "(name) => void studio.commands.all.find(({ id }) => id === name).act()", name
            )
            assert violations(app.page) == [], name
            app.page.keyboard.press("Escape")
        app.page.evaluate("() => studio.sharing.share()")
        app.page.locator("dialog .code svg").wait_for()
        assert violations(app.page) == []
        app.page.keyboard.press("Escape")
        app.page.evaluate("() => studio.costs.toggle()")
        app.page.locator(".runs").first.wait_for()
        app.page.get_by_label("Time (measured)").check()
        app.page.get_by_role("button", name="Measure").click()
        assert violations(app.page) == []
        app.page.evaluate("() => studio.costs.toggle()")
        app.page.get_by_role("tab", name="Emitted text").click()
        assert violations(app.page) == []
        app.page.get_by_role("tab", name="scene.py").click()
        app.page.evaluate("() => studio.editor.goTo(8, 11)")
        app.page.keyboard.press("Control+.")
        app.page.locator(".dial").wait_for()
        assert violations(app.page) == []
        app.page.keyboard.press("Escape")
        app.page.evaluate("() => studio.editor.goTo(3)")
        app.page.keyboard.type("x = = 3\n")
        app.wait("() => document.querySelector('.mistakes').childElementCount")
        assert violations(app.page) == []


def test_names_are_completed_and_calls_explained(tmp_path):
    with studio(tmp_path) as app:
        app.page.evaluate("() => studio.editor.goTo(9)")
        app.page.keyboard.type("other = Tor")
        options = app.page.locator(".cm-tooltip-autocomplete li")
        options.first.wait_for()
        assert options.first.inner_text().startswith("Torus")
        app.page.keyboard.press("Tab")
        app.page.keyboard.type("(")
        tip = app.page.locator(".cm-tooltip .name-head")
        tip.wait_for()
        assert tip.inner_text().startswith("Torus(")
        app.page.keyboard.type("0.5).twi")
        options.first.wait_for()
        assert options.first.inner_text().startswith("twist")
        app.page.keyboard.press("Escape")
        place = "(at) => studio.editor.view.coordsAtPos(at)"
        at = app.page.evaluate(place, SCENE.index("Sphere(size)") + 2)
        app.page.mouse.move(at["left"], at["top"] + 5)
        app.page.locator(".name", has_text="Ball, centred at the origin.").wait_for()
        app.page.evaluate("() => studio.editor.replace('scene.py', 'for i in rang')")
        app.page.evaluate("() => studio.editor.goTo(1)")
        app.page.keyboard.press("End")
        app.page.keyboard.press("Control+Space")
        options.first.wait_for()
        assert options.all_inner_texts()[0] == "range"


def test_what_a_new_file_begins_with_is_a_picture(tmp_path):
    (tmp_path / "scene.py").write_text(STARTER)
    with studio(tmp_path) as app:
        assert app.mistakes == ""
        app.page.evaluate(SETTLED)
