"""The notebook's live picture: its model from Python's side, and from that of a browser."""

from __future__ import annotations

from functools import cache

import pytest

pytest.importorskip("anywidget")

import numpy as np
from traitlets import TraitError

import distal
from distal import Camera, Scene, Sphere, Torus, time
from distal.diagnostics import CompileError
from distal.error_codes import ErrorCode
from distal.export import page_programs
from distal.export.payload import name_of
from distal.lang import Frame, choice, color, func, image, slider, vec3
from distal.lang.render_options import RenderOptions
from distal.notebook.widget import LiveView
from distal.scene.steering import Steering
from distal.scene.viewing.viewable import viewable

softness = slider("Softness", 0.05, high=0.2)
tint = color("Tint", "#ff8040")
style = choice("Style", ["plain", "striped"], 0)


@image
def drawn(frame: Frame) -> vec3:
    return tint * softness * frame.coord.x * 0.1 + float(style)


@func
def distance(p: vec3) -> float:
    return p.x


def ball():
    return Scene(
        Sphere(0.6).union(Torus(0.7, 0.2), smooth=softness), camera=Camera((2.0, 1.0, 2.0))
    )


@cache
def shown_ball():
    """For tests that change nothing: a widget compiles every view."""
    return ball().show()


def from_browser(widget, **state):
    """A message of the browser, as the widget's channel hands it on."""
    widget.set_state(state)


def test_it_begins_with_the_authors_picture():
    widget = ball().show(size=(64, 48))
    assert widget.params == {"softness": 0.05}
    assert (widget.time, widget.playing, widget.view) == (0.0, False, "color")
    assert widget.steering == {"yaw": 0.0, "pitch": 0.0, "zoom": 1.0, "pan": [0.0, 0.0]}
    assert widget.payload["format"] == 1 and widget.payload["size"] == [64, 48]
    assert [p["name"] for p in widget.payload["parameters"]] == ["softness"]


def test_images_and_shapes_are_shown_too():
    assert drawn.show().payload["steering"] is None
    assert Sphere().show().payload["steering"] is not None
    with pytest.raises(distal.LoadError, match="'distance' is a @func"):
        LiveView(distance)


def test_what_moves_plays_unless_told_otherwise():
    moving = Scene(Sphere().translate(y=0.2 * np.sin(time)))
    assert moving.show().playing
    assert not moving.show(playing=False).playing


def test_python_hears_what_a_hand_did():
    widget = drawn.show()
    heard = []
    widget.observe(lambda change: heard.append(change["new"]), "params")
    from_browser(widget, params={"softness": 0.1, "tint": [0.1, 0.2, 0.3], "style": 1})
    assert heard == [{"softness": 0.1, "tint": [0.1, 0.2, 0.3], "style": 1}]
    from_browser(widget, time=2.5, playing=True, view="coordinate")
    assert (widget.time, widget.playing, widget.view) == (2.5, True, "coordinate")


def test_the_browser_is_told_what_python_sets():
    widget = drawn.show()
    widget.set(softness=0.15)
    # A color as people write it becomes linear numbers, a choice's name its number.
    widget.params = {"tint": "#ffffff", "style": "striped"}
    state = widget.get_state()
    assert state["params"] == {"softness": 0.15, "tint": [1.0, 1.0, 1.0], "style": 1}
    widget.steering = Steering(yaw=0.5)
    assert widget.get_state()["steering"]["yaw"] == 0.5


@pytest.mark.parametrize(
    ("values", "error", "message"),
    [
        ({"softness": 3.0}, ValueError, "'Softness' lies between 0 and 0.2, not 3"),
        ({"softness": "x"}, TypeError, "'Softness'"),
        ({"soft": 0.1}, ValueError, "there is no parameter 'soft'; parameters: "),
    ],
)
def test_a_wrong_value_is_refused_and_nothing_changes(values, error, message):
    widget = drawn.show()
    before = dict(widget.params)
    with pytest.raises(error, match=message):
        widget.set(**values)
    assert widget.params == before
    with pytest.raises(error, match=message):
        drawn.show(params=values)


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("view", "norml", "there is no view 'norml'; views: color, coordinate"),
        ("steering", {"zoom": 0.0}, "a steering is yaw, pitch, zoom and pan"),
        ("steering", {"roll": 1.0}, "a steering is yaw, pitch, zoom and pan"),
        ("steering", {"pan": [1.0]}, "a steering is yaw, pitch, zoom and pan"),
        ("steering", 3, "a steering is yaw, pitch, zoom and pan"),
    ],
)
def test_a_wrong_state_is_refused(name, value, message):
    widget = shown_ball()
    with pytest.raises(TraitError, match=message):
        setattr(widget, name, value)


def test_a_time_that_no_message_can_carry_is_refused():
    widget = shown_ball()
    with pytest.raises(ValueError, match="time is finite, not nan"):
        widget.time = float("nan")
    assert widget.time == 0.0


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"widht": 3}, TypeError, "unexpected keyword argument 'widht'"),
        ({"size": 3}, TypeError, "size is .width, height. in pixels, not 3"),
        ({"size": (0, -3)}, ValueError, "each side has 1 to"),
        ({"time": "a"}, TypeError, "time is a number of seconds, not 'a'"),
    ],
)
def test_a_wrong_option_is_refused(options, error, message):
    with pytest.raises(error, match=message):
        drawn.show(**options)


def test_a_view_that_webgl_cannot_show_is_none(monkeypatch):
    compiled = page_programs.compiled

    def refusing(image):
        if "depth" in image.name:
            raise CompileError.at(ErrorCode.TARGET, "it cannot be said", None)
        return compiled(image)

    scene = ball()
    monkeypatch.setattr(page_programs, "compiled", refusing)
    widget = scene.show()
    widget.view = "normal"
    with pytest.raises(TraitError, match="there is no view 'depth'"):
        widget.view = "depth"


def test_the_picture_as_it_stands_is_computed_by_python():
    scene = ball()
    widget = scene.show(size=(48, 36))
    from_browser(
        widget,
        params={"softness": 0.2},
        steering={"yaw": 0.7, "pitch": 0.2, "zoom": 0.8, "pan": [0.1, 0.0]},
    )
    found = widget.render()
    wanted = distal.scene.viewing.viewable.viewable(scene).render(
        RenderOptions(
            size=(48, 36),
            params={"softness": 0.2},
            steering=Steering(0.7, 0.2, 0.8, (0.1, 0.0)),
        )
    )
    assert (found.array == wanted.array).all()
    assert not np.allclose(found.array, scene.render(size=(48, 36)).array, atol=0.05)


def test_a_notebook_is_given_a_widget():
    bundle = shown_ball()._repr_mimebundle_()
    data = bundle[0] if isinstance(bundle, tuple) else bundle
    assert "application/vnd.jupyter.widget-view+json" in data


@pytest.fixture
def shell(monkeypatch):
    """IPython, as a kernel makes it: cells have file names that no file has."""
    module = pytest.importorskip("IPython.core.interactiveshell")
    made = module.InteractiveShell()
    made.kernel = object()
    monkeypatch.setattr("IPython.get_ipython", lambda: made)
    monkeypatch.setattr(
        made.compile, "get_code_name", lambda *_: "/tmp/ipykernel_4711/1234567890.py"
    )
    return made


def cell(shell, text):
    """What a cell shows for its last line."""
    result = shell.run_cell(text, store_history=True)
    result.raise_error()
    return shell.display_formatter.format(result.result)[0]


WIDGET = "application/vnd.jupyter.widget-view+json"


@pytest.mark.parametrize("last", ["egg", "Sphere()", "Circle()", "grey"])
def test_the_last_line_of_a_cell_is_live(shell, last):
    text = "from distal import *\nfrom distal.lang import Frame, image, vec3\n"
    text += "@image\ndef grey(frame: Frame) -> vec3:\n    return vec3(0.5)\n"
    assert WIDGET in cell(shell, f"{text}egg = Scene(Sphere(0.5))\n{last}\n")


def test_a_cell_has_the_title_and_the_code_of_its_variable(shell):
    cell(shell, "from distal import *\nblue_egg = Scene(Sphere(0.5))\nscene = Scene(Box())\n1")
    named, plain = (LiveView(shell.user_ns[name]).payload for name in ("blue_egg", "scene"))
    assert named["name"] == "blue egg"
    assert named["code"] == ("import distal; blue_egg.render(", ")")
    assert plain["name"] == "scene"
    assert plain["code"] == ("import distal; scene.render(", ")")
    # A scene without a variable: no number of the kernel's temporary file.
    lone = cell(shell, "Scene(Sphere(0.25))")
    assert WIDGET in lone
    assert name_of(viewable(shell.user_ns["_"])) == "scene"


def test_a_mistake_is_the_text_of_the_cell(shell):
    text = "from distal import *\nfrom distal.lang import func, vec3\n"
    text += "@func\ndef wrong(p: vec3) -> float:\n    return p\nShape.from_function(wrong)\n"
    shown = cell(shell, text)
    assert set(shown) == {"text/plain"}
    assert "error: " in shown["text/plain"]
    assert "^" in shown["text/plain"]


def test_a_terminal_compiles_nothing(shell, monkeypatch):
    del shell.kernel
    monkeypatch.setattr("distal.notebook.widget.LiveView", None)
    assert set(cell(shell, "from distal import *\nScene(Sphere())")) == {"text/plain"}


def test_without_the_extra_a_cell_shows_a_still_picture(shell, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "anywidget", None)
    monkeypatch.delitem(__import__("sys").modules, "distal.notebook.widget", raising=False)
    shown = cell(shell, "from distal import *\nSphere()")
    assert "image/png" in shown
    assert "pip install 'distal[notebook]'" in shown["text/plain"]


def test_without_the_extra_the_mend_is_named(monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "anywidget", None)
    monkeypatch.delitem(__import__("sys").modules, "distal.notebook.widget", raising=False)
    with pytest.raises(ImportError) as caught:
        ball().show()
    assert str(caught.value) == "anywidget is missing: pip install 'distal[notebook]'"


def test_a_scene_by_paths_has_the_player_of_paths_and_renders_so():
    widget = ball().show(size=(24, 16), mode="path")
    assert "Film_offset" in widget._esm
    assert "Film_offset" not in shown_ball()._esm
    views = {view["name"]: view for view in widget.payload["views"]}
    assert views["color"]["film"]["name"] == "Film"
    assert "film" not in views["normal"]
    picture = widget.render(samples=3)
    assert (picture.provenance.mode, picture.stats["samples"]) == ("path", 3)
    assert widget.render(time_limit=1e-6, size=(8, 8)).stats["samples"] == 1
    widget.view = "normal"
    assert widget.render().provenance.mode == "direct"
    with pytest.raises(ValueError, match="there is no mode 'rays'; modes: direct, path"):
        ball().show(mode="rays")
