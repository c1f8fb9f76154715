"""A hand does the same in a window and on a page: events, sliders, colors and texts of numbers.

The player's own modules run in Node on events as a browser sends them; a window's session is
given the same as its canvas sends them.
"""

from __future__ import annotations

import importlib.util
import json
import random
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from distal import Camera, Scene, Sphere
from distal.lang import Frame, image, integer, slider, vec3
from distal.lang.number_text import shown
from distal.lang.parameters import Parameter
from distal.lang.srgb import hex_of, linear_of
from distal.scene.viewing import interaction
from distal.scene.viewing.key_bindings import BINDINGS
from distal.scene.viewing.viewable import viewable
from distal.window.dials import Dial
from distal.window.keys import action_of_character, action_of_key
from distal.window.session import Session
from tests.page.test_player_build import built

ROOT = Path(__file__).parents[2]
SIZE = (640.0, 360.0)
BUTTONS = {0: 1, 1: 3, 2: 2}  # as browsers count them -> as the window's canvas does
APART = (
    *("pause", "next_view", "last_view", "full_screen", "screenshot", "parameters", "help"),
    "mode",
    *("frame", "front", "right_side", "top", "copy_camera"),  # these ask the scene's guide
)
KEYS = [key for b in BINDINGS if b.in_page and b.action not in APART for key in b.keys]
SLIDERS = (
    slider("Linear", 1.0, 0.5, 2.0),
    slider("Odd", -0.1, -0.7, 1.3000001),
    slider("Tiny", 1.3e-7, 1e-7, 3e-7),
    slider("Wide", 12.5, -1e6, 1e6),
    slider("Log", 0.02, 0.001, 7.0, log=True),
    slider("Log in steps", 0.3, 0.1, 10.0, 0.1, log=True),
    slider("A step that does not divide", 0.3, 0.0, 1.0, 0.3),
    integer("Sevens", 7, 0, 50, 7),
)

__all__ = ["built"]


@image
def pointer(frame: Frame) -> vec3:
    return vec3(frame.mouse.xy / frame.resolution, frame.time)


def random_events(source: random.Random, count: int) -> list[dict[str, Any]]:
    """What a browser's canvas is told: drags, wheels, pinches of a touch pad, keys, clicks."""
    # First as far as it goes: nearer, farther, aside, up.
    middle = {"x": 100.0, "y": 100.0}
    press = {"type": "pointerdown", **middle, "button": 0, "shiftKey": True}
    events: list[dict[str, Any]] = [
        {"type": "wheel", **middle, "deltaY": way, "deltaMode": 0, "ctrlKey": False}
        for way in (-900.0, 900.0)
        for _ in range(8)
    ]
    for way in (1e6, -1e6):
        for shift in (True, False):
            events.append({**press, "shiftKey": shift})
            events.append({"type": "pointermove", "x": way, "y": way})
            events.append({"type": "pointerup", "x": way, "y": way})
    while len(events) < count:
        x, y = (source.uniform(-0.1, 1.1) * side for side in SIZE)
        kind = source.choice(("drag", "drag", "wheel", "key", "key", "dblclick"))
        place = {"x": x, "y": y}
        if kind == "drag":
            shift = source.random() < 0.3
            pressed = {"button": source.randrange(3), "shiftKey": shift}
            events.append({"type": "pointerdown", **place, **pressed})
            for _ in range(source.randrange(1, 6)):
                place = {"x": x + source.gauss(0, 200), "y": y + source.gauss(0, 200)}
                events.append({"type": "pointermove", **place})
            events.append({"type": "pointerup", **place})
        elif kind == "wheel":
            way = source.choice((100, -120, 3.5, source.gauss(0, 3000)))
            pinch = source.random() < 0.4
            events.append({"type": kind, **place, "deltaY": way, "deltaMode": 0, "ctrlKey": pinch})
        elif kind == "key":
            held = {"key": source.choice(KEYS), "shiftKey": source.random() < 0.3}
            events.append({"type": "keydown", **place, **held})
        elif source.random() < 0.2:
            events.append({"type": kind, **place})
    return events


def told(session: Session, event: dict[str, Any]) -> None:
    """Give a session what a window's canvas would."""
    x, y = event["x"], event["y"]
    match event["type"]:
        case "pointerdown":
            session.press(x, y, BUTTONS[event["button"]], 0.0, shift=event["shiftKey"])
        case "pointermove":
            session.drag(x, y, 0.0)
        case "pointerup":
            session.release(0.0)
        case "wheel":
            notches = interaction.notches_of(event["deltaY"], 0, event["ctrlKey"])
            session.wheel(notches, 0.0)
        case "keydown":
            action = action_of_key(event["key"]) or action_of_character(event["key"])
            assert action is not None
            session.act(action, 0.0, shift=event["shiftKey"])
        case "dblclick":
            session.double_click(x, y, 0.0)


def replayed(session: Session, events: list[dict[str, Any]]) -> list[list[float]]:
    states = []
    for event in events:
        told(session, event)
        shot = session.shot(0.0)
        steering = shot.steering.numbers if shot.steering else (0.0, 0.0, 1.0, 0.0, 0.0)
        width, height = SIZE
        pointed = shot.mouse.pixels((int(width), int(height)))
        session.frame_begun()
        clock = (shot.time, shot.index, session.clock.speed, *session.time_range)
        states.append([*steering, *clock, *pointed])
    return states


def run(built: Path, given: dict[str, Any]) -> dict[str, Any]:
    """What the player's modules make of it."""
    node = shutil.which("node")
    assert node is not None
    bundle = (
        "test/replay.ts",
        "--bundle",
        "--platform=node",
        "--format=esm",
        "--define:PATHS=true",
        "--define:FRAMES=false",
    )
    esbuild = built / "node_modules" / ".bin" / "esbuild"
    if not (built / "replay.mjs").exists():
        command = [esbuild, *bundle, "--outfile=replay.mjs", "--log-level=error"]
        subprocess.run(command, cwd=built, check=True)
    empty = {"elevation": None, "start": 0.0, "size": SIZE, "events": [], "sliders": []}
    text = json.dumps({**empty, "hex": [], "linear": [], "numbers": [], **given})
    done = subprocess.run(
        [node, "replay.mjs"], cwd=built, input=text, capture_output=True, text=True, timeout=60
    )
    assert done.returncode == 0, done.stderr
    result: dict[str, Any] = json.loads(done.stdout)
    return result


@pytest.mark.parametrize("start", [0.0, 12.5, -3.0])
@pytest.mark.parametrize("steers", [True, False])
def test_events_do_the_same(built: Path, steers: bool, start: float) -> None:
    scene = Scene(Sphere(1.0), camera=Camera(position=(0, 1, 4), target=(0, 0, 0)))
    seen = viewable(scene if steers else pointer)
    session = Session(seen, time=start, paused=True)
    session.animated = True  # the page's clock has one meaning for both
    session.size, session.shows_overlay = SIZE, False
    events = random_events(random.Random(f"{steers} {start}"), 400)
    given = {"elevation": seen.elevation if steers else None, "start": start, "events": events}
    page = np.array(run(built, given)["states"], np.float32)
    window = np.array(replayed(session, events), np.float32)
    different = np.flatnonzero((page != window).any(axis=1))
    assert different.size == 0, (events[different[0]], page[different[0]], window[different[0]])
    assert len(np.unique(page, axis=0)) > 100  # something happened


def plain(parameter: Parameter) -> dict[str, Any]:
    return {"default": parameter.default, **dict(parameter.interface)}


def test_sliders_have_the_same_positions_and_values(built: Path) -> None:
    source = random.Random(7)
    given = []
    expected = []
    for parameter in SLIDERS:
        low, high, step, log = parameter.low, parameter.high, parameter.step, parameter.log
        assert low is not None and high is not None
        values = [low, high, parameter.default, *(source.uniform(low, high) for _ in range(40))]
        given.append({"parameter": plain(parameter), "values": values})
        count = interaction.position_count(low, high, step)
        dial = Dial(parameter)
        rows = []
        for value in values:
            at = interaction.whole(interaction.position_of(value, low, high, step, log))
            by_keys = [dial.moved(value, steps) for steps in (-1, 0, 1)]
            rows.append([at, *by_keys, dial.placed(value, count // 3 / count)])
        expected.append(rows)
    assert run(built, {"sliders": given})["sliders"] == expected


def test_colors_and_texts_are_the_same(built: Path) -> None:
    source = random.Random(11)
    hex_texts = [f"#{code:02x}{255 - code:02x}{code * 7 % 256:02x}" for code in range(256)]
    linear = [[source.random() ** 3 for _ in range(3)] for _ in range(500)] + [[-1.0, 0.5, 2.0]]
    numbers = [0.0, -0.0, 1.0, 0.3, 1e-7, 1e21, 999999.5, 1e-5, 123456.5, 2.5]
    numbers += [source.gauss(0, 1) * 10.0 ** source.randrange(-12, 25) for _ in range(500)]
    page = run(built, {"hex": hex_texts, "linear": linear, "numbers": numbers})
    assert np.allclose(page["colors"], [linear_of(text) for text in hex_texts], rtol=1e-14)
    assert page["texts"] == [hex_of(light) for light in linear]
    assert page["numbers"] == [shown(number) for number in numbers]


def test_what_python_defines_is_generated() -> None:
    path = ROOT / "tools" / "gen_player.py"
    spec = importlib.util.spec_from_file_location("gen_player", path)
    assert spec is not None and spec.loader is not None
    made = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(made)
    stale = [
        name
        for name, text in made.FILES.items()
        if (made.FOLDER / name).read_text(encoding="utf-8") != text()
    ]
    assert stale == [], "run tools/gen_player.py, then build the player"
