"""The live picture in a real browser, its model in the browser and that of Python held together."""

from __future__ import annotations

import base64
import json
from contextlib import contextmanager

import pytest

pytest.importorskip("anywidget")

from distal import Box, Camera, Plane, Scene, Sphere, time
from distal.lang import slider
from distal.notebook.widget import LiveView
from distal.scene.steering import Steering
from distal.scene.viewing.guide import Guide, Moment
from distal.scene.viewing.viewable import viewable
from tests.browser import BrowserUnavailableError, browser
from tests.page.looking import looked_at

softness = slider("Softness", 0.05, high=0.2)
scene = Scene(
    Sphere(0.5).union(Box(0.6).translate(x=0.5).rotate(y=time), smooth=softness).paint("#d07040"),
    camera=Camera((2.0, 1.0, 2.0)),
    far=8.0,
)

# What anywidget hands to ``render``: an object with a notebook's two-way state.
PAGE = """<!doctype html><meta charset="utf-8"><body><script type="module">
const widget = await import("data:text/javascript;base64,@player@");
const state = @state@, listeners = {};
window.sent = [];
window.model = {
  get: (name) => state[name],
  set(name, value) { state[name] = value; this.changed = [...(this.changed ?? []), name]; },
  save_changes() {
    const names = [...new Set(this.changed)];
    this.changed = [];
    sent.push(Object.fromEntries(names.map((name) => [name, structuredClone(state[name])])));
  },
  on: (event, act) => (listeners[event] ??= new Set()).add(act),
  off: (event, act) => listeners[event].delete(act),
};
window.fromPython = (changes) => {
  Object.assign(state, changes);
  for (const name in changes) for (const act of listeners[`change:${name}`] ?? []) act();
};
window.end = widget.default.render({ model, el: document.body });
window.listening = () => Object.values(listeners).reduce((sum, set) => sum + set.size, 0);
</script></body>"""


@pytest.fixture(scope="module", autouse=True)
def running():
    try:
        return browser()
    except BrowserUnavailableError as error:
        pytest.skip(f"no browser: {error}")


@contextmanager
def cell(tmp_path, widget):
    """The widget in a page; its state is what Python would send."""
    names = ("payload", "params", "time", "playing", "view", "steering", "error")
    state = {name: getattr(widget, name) for name in names}
    player = base64.b64encode(str(LiveView._esm).encode()).decode()
    text = json.dumps(state).replace("<", "\\u003c")
    path = tmp_path / "cell.html"
    path.write_text(PAGE.replace("@player@", player).replace("@state@", text))
    with looked_at(path, viewport={"width": 700, "height": 240}) as looked:
        yield looked


def received(looked, widget, *, any_at_all=True):
    """What the browser said, told to Python; all of it at once.

    Args:
        looked: The page.
        widget: Python's side.
        any_at_all: Wait until it said something, however slow it is.
    """
    if any_at_all:
        looked.page.wait_for_function("sent.length > 0")
    looked.page.wait_for_timeout(250)
    said = {}
    for message in looked.page.evaluate("sent.splice(0)"):
        said |= message
    widget.set_state(said)
    return said


def live(**options):
    return LiveView(scene, size=(96, 72), playing=False, **options)


def test_a_slider_reaches_python_and_python_the_slider(tmp_path):
    widget = live()
    with cell(tmp_path, widget) as looked:
        handle = looked.page.get_by_role("slider", name="Softness")
        handle.focus()
        looked.page.keyboard.press("End")
        assert received(looked, widget) == {"params": {"softness": 0.2}}
        assert widget.params == {"softness": 0.2}
        assert looked.beside(viewable(scene)).is_agreement
        widget.set(softness=0.1)
        looked.page.evaluate("(params) => fromPython({ params })", widget.params)
        assert looked.state()["parameters"] == {"softness": 0.1}
        assert handle.input_value() == "100"
        assert looked.beside(viewable(scene)).is_agreement
        # What Python said is not said back to it.
        assert received(looked, widget, any_at_all=False) == {}


def test_a_hand_on_the_picture_moves_pythons_camera(tmp_path):
    widget = live()
    with cell(tmp_path, widget) as looked:
        looked.settle()
        box = looked.page.locator("canvas").bounding_box()
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        looked.page.mouse.move(x, y)
        looked.page.mouse.down()
        looked.page.mouse.move(x - 40, y + 20, steps=4)
        looked.page.mouse.up()
        said = received(looked, widget)["steering"]
        assert said["yaw"] > 0.1 and said["pitch"] > 0.05
        assert widget.steering["yaw"] == said["yaw"]
        shown = looked.picture()
        computed = widget.render(size=shown.shape[1::-1])
        assert looked.beside(viewable(scene)).is_agreement
        assert abs(computed.array * 255.0 - shown).mean() < 1.0


def test_time_and_view_go_both_ways(tmp_path):
    widget = live(time=0.5)
    with cell(tmp_path, widget) as looked:
        looked.page.evaluate("fromPython({ time: 2.0, view: 'normal' })")
        state = looked.state()
        assert (state["time"], state["view"]) == (2.0, "normal")
        assert looked.beside(viewable(scene)).is_agreement
        looked.page.evaluate("fromPython({ playing: true })")
        looked.page.wait_for_function("sent.length >= 1", timeout=60_000)
        looked.page.evaluate("fromPython({ playing: false })")
        said = received(looked, widget)
        # That it runs and stands again came from Python, and is not told back.
        assert said.keys() == {"time"} and said["time"] > 2.0
        assert widget.time == looked.state()["time"]


def test_running_time_is_told_now_and_then(tmp_path):
    with cell(tmp_path, live()) as looked:
        looked.settle()  # The time starts with the first picture.
        begin = looked.page.evaluate("fromPython({ playing: true }), performance.now()")
        # However slow the machine is, the time is told again and again, but not at each frame.
        looked.page.wait_for_function("sent.length >= 4", timeout=60_000)
        looked.page.evaluate("fromPython({ playing: false })")
        messages, end = looked.page.evaluate("[sent.length, performance.now()]")
        assert messages <= 4 + (end - begin) / 100


def test_a_closed_cell_listens_no_more(tmp_path):
    with cell(tmp_path, live()) as looked:
        assert looked.page.evaluate("listening()") > 0
        looked.page.evaluate("end()")
        assert looked.page.evaluate("listening()") == 0
        looked.page.evaluate(
            "document.querySelector('[data-distal]').distal.settled = async () => {}"
        )


def test_keys_in_the_player_are_not_the_notebooks(tmp_path):
    with cell(tmp_path, live()) as looked:
        looked.settle()
        looked.page.evaluate(
            "window.keys = []; document.addEventListener('keydown', (e) => keys.push(e.key))"
        )
        looked.page.locator("canvas").focus()
        looked.page.keyboard.press("v")
        assert looked.state()["view"] == "coordinate"
        assert looked.page.evaluate("keys") == []


def test_a_camera_in_a_cell_stays_above_the_floor_and_has_the_keys(tmp_path):
    ground = Scene(Sphere(0.5).translate(y=0.5) | Plane(), camera=Camera((1, 0.4, 2), (0, 0.5, 0)))
    guide, moment = Guide(ground), Moment((96, 72))
    widget = LiveView(ground, size=(96, 72), playing=False)

    def place():
        moved = {**widget.steering, "pan": tuple(widget.steering["pan"])}
        return guide.place(Steering(**moved), moment)

    with cell(tmp_path, widget) as looked:
        looked.settle()
        box = looked.page.locator("canvas").bounding_box()
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        for way in ((0, -60), (50, -40), (-50, -40)):
            looked.page.mouse.move(x, y)
            looked.page.mouse.down()
            looked.page.mouse.move(x + way[0], y + way[1], steps=4)
            looked.page.mouse.up()
            looked.settle()
            assert received(looked, widget)["steering"] == widget.steering
            assert place().position[1] > 0.0
        looked.page.locator("canvas").focus()
        looked.page.keyboard.press("Digit7")
        looked.page.wait_for_timeout(300)
        assert received(looked, widget)["steering"]["pitch"] > 1.0
        assert place().position[1] > 1.0
