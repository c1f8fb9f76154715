"""Hands on the camera of a real window: never inside a solid, never black; keys show the scene."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import distal
from distal.scene.steering import Steering
from distal.scene.viewing.guide import Guide, Moment
from tests.window.display import Window

SIZE = (320, 240)
MIDDLE = (160, 120)
FAR = 100
# Half of them close to a floor, a wall or in a room: where a free camera ends inside.
SCENES = """from distal import *

floor = Plane()
ball = Scene(Sphere().translate(y=1) | floor, camera=Camera((2, 0.6, 3), (0, 1, 0)))
room = Scene(
    Box((6, 3, 6)).shell(0.1, where="center").translate(y=1.5) | Box(1).translate(1, 0.5, -1),
    lights=PointLight((0, 2.5, 0), 4),
    camera=Camera((0, 1.6, 2.5), (0, 1.2, 0)),
)
"""


def told(shown: dict[str, Any]) -> Steering:
    """How the camera was moved, as the window says it was."""
    numbers = {name.removeprefix("View_"): value for name, value in shown["steering"].items()}
    return Steering(numbers["yaw"], numbers["pitch"], numbers["zoom"], tuple(numbers["pan"]))


@pytest.mark.parametrize("name", ["ball", "room"])
def test_drags_in_eight_directions_and_the_wheel_end_outside(
    display: str, tmp_path: Path, name: str
) -> None:
    (tmp_path / "scene.py").write_text(SCENES)
    scene = distal.load(str(tmp_path / "scene.py"), name)
    guide, moment = Guide(scene), Moment(SIZE)
    arguments = [f"scene.py:{name}", "--device", "cpu", "--size", "320x240", "--paused"]
    with Window(display, arguments, tmp_path) as window:
        window.sharp()
        window.hands("mousemove", *MIDDLE, "key", "o")
        stops = 0
        for k in range(8):
            window.hands("key", "r")
            angle = k * math.pi / 4
            end = (
                MIDDLE[0] + round(FAR * math.cos(angle)),
                MIDDLE[1] + round(FAR * math.sin(angle)),
            )
            window.drag(MIDDLE, end)
            window.hands("mousemove", *MIDDLE, *(["click", "4"] * 3))
            seen = window.settled()
            place = guide.place(told(seen), moment)
            assert float(scene.shape(np.asarray(place.position))) > 0.0, (k, seen)
            assert window.screenshot(SIZE).mean() > 0.03, (k, "black")
            free = Steering(
                -(end[0] - MIDDLE[0]) / SIZE[1] * math.pi, (end[1] - MIDDLE[1]) / SIZE[1] * math.pi
            )
            stops += not math.isclose(told(seen).pitch, free.pitch, abs_tol=0.02)
        assert stops > 0, "nothing was in the way"


def test_keys_show_the_scene_and_copy_the_camera(display: str, tmp_path: Path) -> None:
    (tmp_path / "scene.py").write_text(SCENES)
    scene = distal.load(str(tmp_path / "scene.py"), "ball")
    guide, moment = Guide(scene), Moment(SIZE)
    arguments = ["scene.py:ball", "--device", "cpu", "--size", "320x240", "--paused"]
    with Window(display, arguments, tmp_path) as window:
        window.sharp()
        window.hands("mousemove", *MIDDLE)
        for keys, wanted in [
            ("1", (0, 0, 1)),
            ("3", (1, 0, 0)),
            ("7", (0, 1, 0)),
            ("shift+1", (0, 0, -1)),
            ("ctrl+3", (-1, 0, 0)),
        ]:
            window.hands("key", keys)
            place = guide.place(told(window.settled()), moment)
            away = np.array(place.position) - np.array(place.target)
            assert away @ np.array(wanted) > 0.95 * np.linalg.norm(away), keys
        count = len(window.events)
        window.hands("key", "r", "key", "c")
        copied = window.wait(lambda event: event["event"] == "copied", count)["text"]
        assert copied.startswith("Camera((2, 0.6, 3), (0, 1, 0), fov_deg=40")
