"""Hands on the camera of a page: never inside a solid, never black, and as the CPU's guide says."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import expect

from distal import Box, Camera, Plane, PointLight, Scene, Sphere
from distal.export.page_options import PageOptions
from distal.export.payload import payload
from distal.scene.steering import STILL, Steering
from distal.scene.viewing.guide import CameraPlace, Guide, Moment, point_text
from distal.scene.viewing.viewable import viewable
from tests.browser import ACTION_MS, BrowserUnavailableError, browser
from tests.page import player_pages
from tests.page.looking import Looked, looked_at

FAR = 100
ROOM = Box((6, 3, 6)).shell(0.1, where="center").translate(y=1.5) | Box(1).translate(1, 0.5, -1)
SCENES = {
    "ball": Scene(Sphere().translate(y=1) | Plane(), camera=Camera((2, 0.6, 3), (0, 1, 0))),
    "room": Scene(
        ROOM, lights=PointLight((0, 2.5, 0), 4), camera=Camera((0, 1.6, 2.5), (0, 1.2, 0))
    ),
}
ASK = """async ([action, now, goal]) => {
  const { camera } = document.querySelector("[data-distal]").distal;
  return camera.ask(action, now, goal);
}"""


@pytest.fixture(autouse=True, scope="module")
def _needs_browser() -> None:
    try:
        browser()
    except BrowserUnavailableError as error:
        pytest.skip(str(error))


def page_of(folder: Path, scene: Scene, *, panel: bool = False) -> Path:
    """A page of the scene, 160x120."""
    data = payload(viewable(scene), PageOptions(size=(160, 120), panel=panel, views=("color",)))
    return player_pages.write(folder / "page.html", data)


def numbers_of(steering: Steering) -> dict[str, Any]:
    """A steering as the player has it."""
    yaw, pitch, zoom, x, y = steering.numbers
    return {"yaw": yaw, "pitch": pitch, "zoom": zoom, "pan": [x, y]}


def steered(looked: Looked) -> Steering:
    """How the page's camera was moved."""
    moved = looked.state()["steering"]
    return Steering(moved["yaw"], moved["pitch"], moved["zoom"], tuple(moved["pan"]))


@pytest.mark.parametrize("name", SCENES)
def test_drags_in_eight_directions_and_the_wheel_end_outside(tmp_path: Path, name: str) -> None:
    scene = SCENES[name]
    guide, moment = Guide(scene), Moment((160, 120))
    with looked_at(page_of(tmp_path, scene), viewport={"width": 160, "height": 164}) as looked:
        looked.settle()
        mouse = looked.page.mouse
        stops = 0
        for k in range(8):
            looked.page.keyboard.press("r")
            way = (math.cos(k * math.pi / 4) * FAR, math.sin(k * math.pi / 4) * FAR)
            mouse.move(80, 60)
            mouse.down()
            for step in range(1, 6):
                mouse.move(80 + way[0] * step / 5, 60 + way[1] * step / 5)
            mouse.up()
            mouse.wheel(0, -300)
            looked.settle()
            place = guide.place(steered(looked), moment)
            assert float(scene.shape(np.asarray(place.position))) > 0.0, (k, steered(looked))
            assert looked.picture()[..., :3].mean() > 8, (k, "black")
            stops += steered(looked).zoom > 0.7 or place.clearance < 0.2
        assert stops > 0, "nothing was in the way"


def test_the_pages_guide_is_the_windows(tmp_path: Path) -> None:
    scene = SCENES["ball"]
    guide = Guide(scene)
    with looked_at(page_of(tmp_path, scene), viewport={"width": 160, "height": 164}) as looked:
        looked.settle()
        size = looked.page.evaluate("document.querySelector('[data-distal]').distal.frameSize")
        moment = Moment(tuple(size))
        source = np.random.default_rng(5)
        for _ in range(12):
            yaw, pitch = source.normal(0, 1.2), source.uniform(-1.2, 1.2)
            pan = tuple(source.normal(0, 0.4, 2))
            goal = Steering(yaw, pitch, math.exp(source.uniform(-2.5, 0.7)), pan)
            found = looked.page.evaluate(ASK, ["go", numbers_of(STILL), numbers_of(goal)])
            place = guide.place(guide.go(STILL, goal, moment), moment)
            eye = [found["eyeX"], found["eyeY"], found["eyeZ"]]
            # The last of a hundred steps along a wall may end one step apart: a fiftieth of 3.6.
            assert eye == pytest.approx(place.position, abs=0.08)
        for action in ("frame", "front", "right", "top", "bottom"):
            now = Steering(0.3, 0.1)
            found = looked.page.evaluate(ASK, [action, numbers_of(now), numbers_of(now)])
            expected = guide.show(action, now, moment)
            names = ("yaw", "pitch", "zoom", "panX", "panY")
            assert [found[n] for n in names] == pytest.approx(expected.numbers, abs=1e-4)


def test_keys_show_the_scene_and_say_where_the_camera_is(tmp_path: Path) -> None:
    scene = SCENES["ball"]
    guide, moment = Guide(scene), Moment((160, 120))
    with looked_at(page_of(tmp_path, scene), viewport={"width": 160, "height": 164}) as looked:
        looked.settle()
        text = "() => document.querySelector('[data-distal]').distal.cameraText()"
        assert looked.page.evaluate(text) == guide.text(guide.place(STILL, moment))
        for key, wanted in [
            ("Digit1", (0, 0, 1)),
            ("Digit3", (1, 0, 0)),
            ("Digit7", (0, 1, 0)),
            ("Shift+Digit1", (0, 0, -1)),
            ("Shift+Digit3", (-1, 0, 0)),
        ]:
            before = looked.state()["steering"]
            looked.page.keyboard.press(key)
            looked.page.wait_for_function(
                "(was) => JSON.stringify(document.querySelector('[data-distal]').distal"
                ".steering()) !== was",
                arg=looked.page.evaluate("(steering) => JSON.stringify(steering)", before),
            )
            place = guide.place(steered(looked), moment)
            away = np.array(place.position) - np.array(place.target)
            assert away @ np.array(wanted) > 0.95 * np.linalg.norm(away), key


def test_the_panel_shows_where_the_camera_is_and_copies_it(tmp_path: Path) -> None:
    scene = SCENES["ball"]
    guide = Guide(scene)
    with looked_at(page_of(tmp_path, scene, panel=True)) as looked:
        page = looked.page
        page.context.grant_permissions(["clipboard-read", "clipboard-write"])
        position = expect(page.locator(".position"))

        def place() -> CameraPlace:
            looked.settle()
            size = page.evaluate("document.querySelector('[data-distal]').distal.frameSize")
            return guide.place(steered(looked), Moment(tuple(size)))

        def window_text() -> str:
            return point_text(place().position, place())

        page.get_by_label("Resolution").select_option("¼")
        # The guide is compiled first.
        position.to_have_text("(2, 0.6, 3)", timeout=ACTION_MS)
        page.mouse.move(100, 60)
        page.mouse.down()
        page.mouse.move(150, 40, steps=3)
        # While the button is held.
        position.not_to_have_text("(2, 0.6, 3)")
        page.mouse.up()
        position.to_have_text(window_text())
        page.mouse.wheel(0, 200)
        position.to_have_text(window_text())

        page.locator(".position").click(click_count=3)
        page.keyboard.press("Control+c")
        assert page.evaluate("navigator.clipboard.readText()").strip() == window_text()

        page.get_by_role("button", name="Copy the camera as Python").click()
        page.get_by_text("Copied").first.wait_for()
        # That this text is a camera at the same place, tests/scene/test_guide.py checks.
        assert page.evaluate("navigator.clipboard.readText()") == guide.text(place())


def test_there_is_no_position_without_a_guide(tmp_path: Path) -> None:
    flat = player_pages.program(player_pages.FLAT, player_pages.TINT)
    broken = player_pages.program("void main() { nothing }")
    view = {"views": [{"name": "color", "label": "Color", "program": 0}]}
    for steering in (None, {"elevation": 0.0, "guide": -1}, {"elevation": 0.0, "guide": 1}):
        data = player_pages.payload(flat, broken, steering=steering, **view)
        path = player_pages.write(tmp_path / "page.html", data)
        with looked_at(path) as looked:
            looked.settle()
            expect(looked.page.get_by_label("Resolution")).to_be_visible()
            expect(looked.page.get_by_title("Copy the camera")).to_be_hidden()


def test_a_camera_without_a_guide_moves_freely(tmp_path: Path) -> None:
    data = payload(viewable(SCENES["ball"]), PageOptions(size=(160, 120), views=("color",)))
    data["steering"]["guide"] = -1
    path = player_pages.write(tmp_path / "page.html", data)
    with looked_at(path, viewport={"width": 160, "height": 164}) as looked:
        looked.settle()
        looked.page.mouse.move(80, 60)
        looked.page.mouse.down()
        looked.page.mouse.move(80, 20)
        looked.page.mouse.up()
        height = looked.page.locator("canvas").bounding_box()["height"]
        assert steered(looked).pitch == pytest.approx(-40 / height * math.pi)
