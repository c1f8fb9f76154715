"""The window on a real (virtual) screen: what is seen is what the CPU says, whatever is done."""

import os
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

import distal
from distal.images.picture_files import read
from distal.lang.render_options import RenderOptions
from distal.scene.section import CutPlane
from distal.scene.steering import Steering
from distal.scene.viewing.viewable import viewable
from tests.pictures.comparison import difference
from tests.window.display import Window

SIZE = (320, 240)
MIDDLE = (160, 110)  # of the window, away from what is drawn over the picture

SCENE = """from distal import Camera, Scene
from parts import thing

scene = Scene(thing, camera=Camera(position=(0, 1, 4), target=(0, 0, 0)))
"""
PARTS = """from distal import Sphere, matte
from distal.lang import slider

radius = slider("Radius", 1.0, 0.2, 2.0)
thing = Sphere(radius).paint(matte("{color}"))
"""
MOUSE = """from distal.lang import Frame, image, vec3

@image
def pointer(frame: Frame) -> vec3:
    return vec3(frame.mouse.xy / frame.resolution, 0.25)
"""
ENDLESS_IMAGE = """from distal.lang import Frame, image, vec3

@image
def pointer(frame: Frame) -> vec3:
    x = frame.time
    while x > -1.0:
        x = x * 0.5
    return vec3(x)
"""


def told(shown: dict[str, Any]) -> Steering:
    """How the camera was moved, as the window says it was."""
    numbers = {name.removeprefix("View_"): value for name, value in shown["steering"].items()}
    return Steering(numbers["yaw"], numbers["pitch"], numbers["zoom"], tuple(numbers["pan"]))


def samples_of(device: str, view: str = "color") -> int | None:
    """Samples in a pixel of a picture at rest: adaptive on the CPU, 16 on a GPU."""
    return 1 if view != "color" else None if device == "cpu" else 16


def expected(
    path: str, shown: dict[str, Any], size: tuple[int, int], device: str
) -> NDArray[np.float32]:
    """What the CPU says should be seen."""
    scene = viewable(distal.load(path))
    options = RenderOptions(size=size, time=shown["time"], params=shown["parameters"])
    options = replace(options, samples=samples_of(device, shown["view"]))
    moved = told(shown) if shown["steering"] else None
    pixels: NDArray[np.float32] = scene.render(
        replace(options, view=shown["view"], steering=moved)
    ).array
    return pixels


@pytest.mark.parametrize("device", ["cpu", "gpu"])
def test_the_screen_shows_what_the_cpu_says(display: str, tmp_path: Path, device: str) -> None:
    name = "example:raymarcher_objects"
    arguments = [name, "--device", device, "--paused", "--time", "1", "--size", "320x240"]
    with Window(display, [*arguments, "--set", "softness=0.1"], tmp_path) as window:
        still = window.sharp()
        assert still["time"] == 1.0
        assert still["parameters"] == {"softness": 0.1}
        assert told(still) == Steering()
        window.hands("mousemove", *MIDDLE, "key", "o")
        first = window.settled()
        seen = window.screenshot(SIZE)
        assert difference(seen, expected(name, first, SIZE, device)).is_agreement
        # The author's own picture, not only what the steered program makes of it.
        parameters = {"softness": 0.1}
        author = distal.load(name).render(
            size=SIZE, time=1.0, params=parameters, samples=samples_of(device)
        )
        assert difference(seen, author.array).is_agreement

        window.drag(MIDDLE, (MIDDLE[0] + 40, MIDDLE[1] + 20))
        turned = window.settled()
        assert told(turned).yaw == pytest.approx(-40 / 240 * np.pi)
        assert told(turned).pitch == pytest.approx(20 / 240 * np.pi)
        moved = window.screenshot(SIZE)
        assert difference(moved, expected(name, turned, SIZE, device)).is_agreement
        assert difference(moved, seen).mean > 5

        window.drag(MIDDLE, (MIDDLE[0] - 30, MIDDLE[1]), hold="shift")
        window.hands("click", "5", "click", "5")
        panned = window.settled()
        assert told(panned).pan == (-0.25, 0.0)
        assert told(panned).zoom == pytest.approx(1.15**2)
        window.hands("key", "v", "key", "v", "key", "v", "key", "v")
        view = window.sharp(view="normal")
        assert told(view) == told(panned)
        assert difference(window.screenshot(SIZE), expected(name, view, SIZE, device)).is_agreement

        count = len(window.events)
        window.hands("key", "r", "key", "V", "key", "V", "key", "V", "key", "V")
        assert window.sharp(count, view="color", steering=first["steering"]) == first
        assert difference(window.screenshot(SIZE), seen).mean == 0
        # A saved picture is that on the screen.
        window.hands("key", "s")
        saved = Path(window.wait(lambda event: event["event"] == "saved")["path"])
        assert read(saved).provenance.samples == samples_of(device)
        assert difference(seen, np.asarray(Image.open(saved))).is_agreement
        assert window.end() == 130
        assert window.errors == f"saved {saved}\n"


def test_time_and_parameters_by_keys_and_a_saved_picture(display: str, tmp_path: Path) -> None:
    name = "example:raymarcher_objects"
    arguments = [name, "--device", "cpu", "--paused", "--size", "320x240"]
    with Window(display, arguments, tmp_path) as window:
        window.sharp()
        window.hands("mousemove", *MIDDLE, "key", "period")
        assert window.settled()["time"] == 0.25
        count = len(window.events)
        time.sleep(1.0)
        assert len(window.events) == count, "a still picture is drawn again"
        window.hands("key", "Tab", "key", "Right", "key", "Right")
        moved = window.settled()
        assert moved["parameters"]["softness"] != 0.05
        window.hands("key", "s", "key", "s")
        for _ in range(2):
            window.wait(lambda event: event["event"] == "saved")
        window.settled()
        saved = sorted(path.name for path in tmp_path.glob("*.png"))
        assert saved == ["raymarcher_objects-0.25s-2.png", "raymarcher_objects-0.25s.png"]
        record = read(tmp_path / saved[1])
        assert record.size == SIZE
        assert record.provenance.time == 0.25
        assert record.provenance.parameters == moved["parameters"]
        window.hands("key", "space")
        time.sleep(1.0)
        window.hands("key", "space")
        later = window.settled()["time"]
        assert 0.6 < later < 3.0
        frames = [event["time"] for event in window.events if event["event"] == "frame"]
        assert frames == sorted(frames)
        assert len(frames) > 10
        window.hands("key", "q")
        assert window.process.wait(10) == 0


def is_trouble_seen(window: Window) -> bool:
    """Whether a dark red box is on the screen."""
    seen = window.screenshot(SIZE)
    red = (abs(seen - np.array([0.18, 0.05, 0.06])) < 0.08).all(axis=2)
    return bool(red.mean() > 0.05)


def middle_color(window: Window) -> list[float]:
    """What stands in the lower middle of the picture, below a mistake's text."""
    return list(window.screenshot(SIZE)[185, 160])


@pytest.mark.parametrize("device", ["cpu", "gpu"])
def test_saving_shows_the_scene_anew_and_mistakes_over_the_last_good_picture(
    display: str, tmp_path: Path, device: str
) -> None:
    scene, parts = tmp_path / "scene.py", tmp_path / "parts.py"
    scene.write_text(SCENE)
    parts.write_text(PARTS.format(color="#ff0000"))
    arguments = ["scene.py", "--device", device, "--size", "320x240", "--set", "radius=1.5"]
    with Window(display, arguments, tmp_path) as window:
        window.sharp()
        window.drag(MIDDLE, (MIDDLE[0] + 40, MIDDLE[1] + 20))
        before = window.settled()
        red, _, blue = middle_color(window)
        assert red > 2 * blue
        assert not is_trouble_seen(window)

        # A module beside it.
        count = len(window.events)
        parts.write_text(PARTS.format(color="#0000ff"))
        window.wait(lambda event: event["event"] == "loaded", count)
        assert window.settled() == before
        good = middle_color(window)
        assert good[2] > 2 * good[0]

        # A mistake: the picture stays, and still turns.
        count = len(window.events)
        scene.write_text(SCENE.replace("Scene(thing,", "Scene(thing(,"))
        trouble = window.wait(lambda event: event["event"] == "trouble", count)["text"]
        assert "scene.py:4:" in trouble
        assert "^" in trouble
        window.settled()
        assert is_trouble_seen(window)
        assert middle_color(window) == good
        window.drag((160, 185), (165, 185))
        assert told(window.settled()).yaw != told(before).yaw

        # Half of a file, and none.
        count = len(window.events)
        scene.write_text(SCENE)
        parts.write_text(PARTS[:70])
        half = window.wait(lambda event: event["event"] == "trouble", count)["text"]
        assert "parts.py" in half
        count = len(window.events)
        parts.unlink()
        gone = window.wait(lambda event: event["event"] == "trouble", count)["text"]
        assert "there is no module 'parts'" in gone
        assert window.errors.count(trouble) == 1

        # Good again.
        count = len(window.events)
        parts.write_text(PARTS.format(color="#00ff00"))
        window.wait(lambda event: event["event"] == "loaded", count)
        after = window.settled()
        assert after["parameters"] == {"radius": 1.5}
        assert told(after).yaw == pytest.approx(told(before).yaw - 5 / 240 * np.pi)
        assert not is_trouble_seen(window)
        red, green, blue = middle_color(window)
        assert green > 2 * max(red, blue)
        assert window.end() == 130


@pytest.mark.parametrize("endless", ["while True: pass", "import time; time.sleep(1e6)"])
def test_a_file_that_never_ends_is_said_and_survived(
    display: str, tmp_path: Path, endless: str
) -> None:
    scene, parts = tmp_path / "scene.py", tmp_path / "parts.py"
    scene.write_text(SCENE)
    parts.write_text(PARTS.format(color="#ff0000"))
    with Window(display, ["scene.py", "--device", "cpu", "--size", "320x240"], tmp_path) as window:
        window.sharp()
        count = len(window.events)
        scene.write_text(f"{endless}\n{SCENE}")
        said = window.wait(lambda event: event["event"] == "hangs", count)["text"]
        assert said.startswith("warning: scene.py is still running after 3 s\n  --> scene.py:1:1\n")
        window.wait(lambda event: event["event"] == "drawn" and event["trouble"] == said, count)
        assert is_trouble_seen(window)
        assert window.screenshot(SIZE)[100:140, 140:180, 0].max() > 0.5  # the picture before it

        count = len(window.events)
        scene.write_text(SCENE)
        window.wait(lambda event: event["event"] == "loaded", count)
        window.wait(lambda event: event["event"] == "drawn" and not event["trouble"], count)
        assert not is_trouble_seen(window)

        count = len(window.events)
        scene.write_text(f"{endless}\n{SCENE}")
        window.wait(lambda event: event["event"] == "hangs", count)
        assert window.errors.count("still running after 3 s") == 2
        assert window.end() == 130


def test_a_picture_that_never_ends_is_given_up_when_it_is_saved(
    display: str, tmp_path: Path
) -> None:
    scene = tmp_path / "mouse.py"
    scene.write_text(ENDLESS_IMAGE)
    with Window(display, ["mouse.py", "--device", "cpu", "--size", "320x240"], tmp_path) as window:
        window.appears()
        time.sleep(2.0)  # it draws
        count = len(window.events)
        scene.write_text(MOUSE)
        window.wait(lambda event: event["event"] == "loaded", count)
        window.wait(lambda event: event["event"] == "drawn" and "shown" in event, count)
        assert window.end() == 130


def test_an_image_gets_the_mouse_and_follows_the_size(display: str, tmp_path: Path) -> None:
    (tmp_path / "mouse.py").write_text(MOUSE)
    with Window(display, ["mouse.py", "--device", "cpu", "--size", "320x240"], tmp_path) as window:
        window.sharp()
        window.hands("search", "--name", "distal", "windowsize", 480, 360)
        larger = window.sharp(pixels=[480, 360])
        assert larger["steering"] is None
        window.drag((100, 100), (360, 90))
        shown = window.settled()
        assert shown["mouse"] == pytest.approx([360, 270, -100, -260])
        seen = window.screenshot((480, 360))[200, 240]
        assert seen == pytest.approx([0.75, 0.75, 0.25], abs=1 / 255)
        window.hands("key", "Escape")
        assert window.process.wait(10) == 0


def test_ctrl_c_ends_it_while_a_slow_scene_compiles(display: str, tmp_path: Path) -> None:
    arguments = ["example:city", "--device", "cpu"]
    with Window(display, arguments, tmp_path, XDG_CACHE_HOME=str(tmp_path / "cache")) as window:
        end = time.monotonic() + 20
        search = ["xdotool", "search", "--name", "city - distal"]
        while time.monotonic() < end:
            found = subprocess.run(search, env=window._environment, capture_output=True)
            if found.returncode == 0:
                break
            time.sleep(0.1)
        time.sleep(0.5)
        assert window.process.poll() is None
        assert not window.events, "it was compiled already: this proves nothing"
        begin = time.monotonic()
        assert window.end() == 130
        assert time.monotonic() - begin < 6
        assert window.errors == ""


@pytest.mark.parametrize(
    ("name", "reason"),
    [("", "no display (DISPLAY is not set)"), (":7654", "X11: Failed to open display :7654")],
)
def test_without_a_display_one_line_says_so(name: str, reason: str) -> None:
    if not sys.platform.startswith("linux"):
        pytest.skip("displays have names on X11 only")
    environment = {k: v for k, v in os.environ.items() if k != "WAYLAND_DISPLAY"}
    environment["DISPLAY"] = name
    ended = subprocess.run(
        [sys.executable, "-m", "distal.cli", "view", "example:raymarcher"],
        env=environment,
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert ended.returncode == 1
    assert ended.stderr == f"error: no window can be opened here: {reason}\n"


@pytest.mark.parametrize("device", ["cpu", "gpu"])
def test_keys_cut_a_scene_open(display: str, tmp_path: Path, device: str) -> None:
    (tmp_path / "parts.py").write_text(PARTS.format(color="#c04020"))
    (tmp_path / "scene.py").write_text(SCENE)
    path = str(tmp_path / "scene.py")
    with Window(display, [path, "--device", device, "--size", "320x240"], tmp_path) as window:
        whole = window.sharp()
        assert whole["section"] is None

        def cut(normal: list[float], offset: float) -> dict[str, Any]:
            """What is on the screen once it is sharp and cut by this plane."""

            def holds(event: dict[str, Any]) -> bool:
                found = event.get("shown", {}).get("section")
                is_sharp = event["event"] == "drawn" and event["shown"]["is_final"]
                return (
                    is_sharp
                    and found is not None
                    and found["Section_normal"] == normal
                    and found["Section_offset"] == pytest.approx(offset, abs=1e-6)
                )

            shown: dict[str, Any] = window.wait(holds)["shown"]
            return shown

        window.hands("mousemove", *MIDDLE, "key", "o", "key", "x", "key", "x", "key", "Prior")
        shown = cut([0.0, 1.0, 0.0], 0.05)  # a fortieth of 2 above the middle
        section = shown["section"]
        plane = CutPlane((0.0, 1.0, 0.0), section["Section_offset"], section["Section_hatch"])
        options = RenderOptions(size=SIZE, samples=samples_of(device))
        seen = viewable(distal.load(path))
        asked = seen.render(replace(options, steering=told(shown), section=plane)).array
        screen = window.screenshot(SIZE)
        assert difference(screen, asked).is_agreement
        assert difference(screen, seen.render(options).array).mean > 5
        window.hands("key", "X")
        cut([0.0, -1.0, 0.0], -0.05)
        count = len(window.events)
        window.hands("key", "x", "key", "x")
        window.sharp(count, section=None)
