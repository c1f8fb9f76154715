"""The player in a real browser: what hands, keys and accidents do to a page.

Programs here are a few lines of GLSL that paint what they are told, so that each pixel has one
right value. Scenes are the exporter's tests.
"""

from __future__ import annotations

import base64
import io
import itertools
import struct
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

from tests.browser import BrowserUnavailableError, browser, offline_page
from tests.page import player_pages as pages
from tests.page.player_pages import parameter, payload, program, uniform

SIZE = {"width": 160, "height": 200}  # the bar is at the lower edge
WIDE = {"width": 700, "height": 120}
PLAYER = "document.querySelector('[data-distal]').distal"
TINT = parameter("tint", "color", [0.0, 0.0, 0.0])
RED = parameter("red", "slider", 0.5, low=0.0, high=1.0, help="How red it is.")
RED_UNIFORM = uniform("red", "float", "parameter", 0.5, "red_2")
FLAT_RED = "void main() { fragment_color = vec4(1.0, 0.0, 0.0, 1.0); }\n"
REDDISH = "uniform float red_2;\nvoid main() { fragment_color = vec4(red_2, 0.0, 1.0, 1.0); }\n"


@pytest.fixture(autouse=True, scope="module")
def _needs_browser() -> None:
    try:
        browser()
    except BrowserUnavailableError as error:
        pytest.skip(str(error))


class Page:
    """A page with a player, asked from Python."""

    def __init__(self, watched: Any) -> None:
        self.watched = watched
        self.page = watched.page
        self.canvas = self.page.locator("canvas").first

    def ask(self, expression: str) -> Any:
        """A JavaScript expression in which ``player`` is the page's first."""
        return self.page.evaluate(f"async () => {{ const player = {PLAYER}; return {expression} }}")

    def settle(self) -> None:
        self.ask("await player.settled()")

    def color(self, x: int, y: int) -> tuple[int, ...]:
        """The color of the canvas under all else, in CSS pixels from its upper left."""
        box = self.canvas.bounding_box()
        clip = {"x": box["x"] + x, "y": box["y"] + y, "width": 1, "height": 1}
        bare = ".title, .bar, .panel { visibility: hidden !important }"
        shot = Image.open(io.BytesIO(self.page.screenshot(clip=clip, style=bare))).convert("RGB")
        return shot.getpixel((0, 0))

    def frames(self, wait_ms: int) -> int:
        """How many pictures are drawn in a while."""
        return self.ask(
            "await new Promise(resolve => { let count = 0;"
            " const end = player.on('frame', () => count++);"
            f" setTimeout(() => {{ end(); resolve(count) }}, {wait_ms}) }})"
        )


@contextmanager
def opened(tmp_path: Path, *payloads: Any, quiet: bool = True, **options: Any) -> Iterator[Page]:
    """A page with these payloads, its first picture drawn; afterwards nothing was complained of."""
    style = options.pop("style", "height:100vh")
    tail = options.pop("tail", "")
    before = options.pop("before", None)
    file = pages.write(tmp_path / "page.html", *payloads, style=style, tail=tail)
    options = {"viewport": SIZE, **options}
    if before:
        file.write_text(file.read_text().replace("<body>", f"<body><script>{before}</script>"))
    with offline_page(file, **options) as watched:
        page = Page(watched)
        if quiet:
            page.settle()
        yield page
        assert watched.requests == []
        assert watched.messages == []


def reddish(**changes: Any) -> dict[str, Any]:
    return payload(program(REDDISH, RED_UNIFORM), parameters=[RED], **changes)


def close(color: tuple[int, ...], expected: tuple[int, ...]) -> bool:
    return all(abs(a - b) <= 1 for a, b in zip(color, expected, strict=True))


# Parameters


def test_a_start_value_is_drawn_and_a_slider_changes_the_picture(tmp_path: Path) -> None:
    with opened(tmp_path, reddish(values={"red": 0.25}), viewport=WIDE) as page:
        assert close(page.color(10, 10), (64, 0, 255))
        page.ask("void (window.told = [], player.on('change', (c) => window.told.push(c)))")
        slider = page.page.get_by_role("slider", name="Red")
        slider.press("End")
        page.settle()
        assert close(page.color(10, 10), (255, 0, 255))
        assert page.ask("window.told.at(-1)") == {"name": "red", "value": 1}
        assert page.page.get_by_role("spinbutton", name="Red").input_value() == "1"
        slider.press("ArrowLeft")
        assert page.ask("player.parameters()") == {"red": 0.995}
        page.page.get_by_role("button", name="Reset Red").click()
        page.settle()
        assert close(page.color(10, 10), (128, 0, 255))
        assert page.ask("player.parameters()") == {"red": 0.5}


def test_a_program_changes_a_parameter_and_the_controls_follow_without_an_echo(
    tmp_path: Path,
) -> None:
    with opened(tmp_path, reddish(), viewport=WIDE) as page:
        page.ask("void (window.told = [], player.on('change', (c) => window.told.push(c)))")
        page.ask("player.setParameter('red', 0.75)")
        page.settle()
        assert close(page.color(10, 10), (191, 0, 255))
        assert page.page.get_by_role("spinbutton", name="Red").input_value() == "0.75"
        assert page.ask("window.told") == []
        for bad in ("'red', 'much'", "'green', 1"):
            tried = f"try {{ player.setParameter({bad}) }} catch (e) {{ return e.name }}"
            assert page.ask(f"(() => {{ {tried} }})()") == "TypeError"


def test_a_number_field_takes_what_fits_and_ends_within_the_range(tmp_path: Path) -> None:
    with opened(tmp_path, reddish(), viewport=WIDE) as page:
        field = page.page.get_by_role("spinbutton", name="Red")
        field.fill("7")
        assert page.ask("player.parameters().red") == 0.5
        field.press("Enter")
        assert page.ask("player.parameters().red") == 1
        assert field.input_value() == "1"
        field.fill("")
        field.press("Tab")
        assert field.input_value() == "1"


def test_every_kind_of_control_gives_the_value_of_its_kind(tmp_path: Path) -> None:
    kinds = [
        parameter("count", "integer", 3, low=1, high=9, step=1),
        parameter("wet", "toggle", False, group="Surface"),
        parameter("finish", "choice", 0, options=["Matt", "Shiny"], group="Surface"),
        TINT,
        parameter("sun", "point", [1.0, 2.0, 3.0], group="Light"),
    ]
    told = payload(program(pages.FLAT, pages.TINT), parameters=kinds)
    with opened(tmp_path, told, viewport={"width": 700, "height": 500}) as page:
        page.page.get_by_role("slider", name="Count").press("ArrowRight")
        page.page.get_by_role("switch", name="Wet").check()
        page.page.get_by_label("Finish", exact=True).select_option("Shiny")
        page.page.get_by_label("Tint, hexadecimal").fill("#ff8000")
        page.page.get_by_role("spinbutton", name="Sun y").fill("-0.5")
        values = page.ask("player.parameters()")
        green = values["tint"].pop(1)
        assert values == {
            "count": 4,
            "wet": True,
            "finish": 1,
            "tint": [1, 0],
            "sun": [1, -0.5, 3],
        }
        assert green == pytest.approx(0.2158605, abs=1e-6)  # IEC 61966-2-1
        page.settle()
        # The scene was given linear light, and writes it as it is: half of red's green is 55.
        assert close(page.color(10, 10), (255, 55, 0))
        assert page.page.get_by_role("group", name="Surface").get_by_role("switch").count() == 1
        page.page.get_by_role("button", name="Reset all").click()
        assert page.ask("player.code()") == "params={}"


def test_texts_of_the_author_are_texts(tmp_path: Path) -> None:
    evil = "<img src=x onerror=\"document.title='broken'\">"
    told = payload(
        program(REDDISH, RED_UNIFORM),
        name=evil,
        description=evil,
        parameters=[{**RED, "label": evil, "help": evil, "group": evil}],
    )
    with opened(tmp_path, told, viewport=WIDE) as page:
        assert page.page.get_by_role("heading", name=evil).count() == 2  # scene and group
        assert page.page.locator("[data-distal] .player img").count() == 0
        assert page.page.title() == "Trial"


# Uniforms and data


def test_uniforms_of_all_types_and_the_frame_arrive(tmp_path: Path) -> None:
    checks = {
        "mat2 m": "m[1] == vec2(3.0, 4.0)",
        "mat3 n": "n[2] == vec3(7.0, 8.0, 9.0)",
        "uint seed": "seed == 4000000000u",
        "int index": "index == 90",
        "bool b": "b",
        "ivec3 i": "i == ivec3(-1, 2, 3)",
        "uvec2 u": "u == uvec2(1u, 4294967295u)",
        "bvec2 w": "w.x && !w.y",
        "vec4 v": "v == vec4(0.5, 1.0, 1.5, 2.0)",
        "vec2 resolution": "resolution == vec2(160.0, 200.0)",
        "float time_2": "time_2 == 0.25",
        "float time": "time == 1.5",
    }
    values: dict[str, Any] = {
        "m": [1, 2, 3, 4],
        "n": [[1, 2, 3], [4, 5, 6], [7, 8, 9]],
        "seed": 4000000000,
        "index": 7,
        "b": True,
        "i": [-1, 2, 3],
        "u": [1, 2**32 - 1],
        "w": [True, False],
        "v": [0.5, 1.0, 1.5, 2.0],
        "resolution": [1, 1],
        "time": 9.0,
    }
    frame = {"seed", "index", "resolution", "time"}
    uniforms = [
        uniform(name, type, "frame" if name in frame else "number", values[name])
        for type, name in (declared.split() for declared in checks)
        if name != "time_2"
    ]
    # A parameter called like one of the frame's: the same name, another origin.
    uniforms.append(uniform("time", "float", "parameter", 0.25, "time_2"))
    parts = [
        f"    if (int(gl_FragCoord.x) == {i} && !({check})) color = vec3(1.0, 0.0, 0.0);"
        for i, check in enumerate(checks.values())
    ]
    body = "".join(f"uniform {declared};\n" for declared in checks)
    body += "void main() {\n    vec3 color = vec3(0.0, 1.0, 0.0);\n" + "\n".join(parts)
    body += "\n    fragment_color = vec4(color, 1.0);\n}\n"
    told = payload(
        program(body, *uniforms),
        parameters=[parameter("time", "slider", 0.25, low=0.0, high=1.0)],
        time={"start": 1.5, "duration": None, "animated": False},
        embed=True,  # nothing covers it
    )
    with opened(tmp_path, told) as page:
        wrong = [name for i, name in enumerate(checks) if page.color(i, 20) != (0, 255, 0)]
        assert wrong == []


def test_textures_stand_upright_and_buffers_hold_their_elements(tmp_path: Path) -> None:
    body = """
uniform highp sampler2D map;
uniform highp sampler2D points;
uniform int points_count;
uniform highp isampler2D flags;
uniform int flags_count;
void main() {
    vec2 at = gl_FragCoord.xy / vec2(160.0, 76.0);
    vec3 last = texelFetch(points, ivec2(1299 % 1024, 1299 / 1024), 0).xyz;
    bool right = points_count == 1300 && textureSize(points, 0).x == 1024
        && last == vec3(3897.0, 3898.0, 3899.0)
        && flags_count == 3 && texelFetch(flags, ivec2(2, 0), 0).x == -5;
    fragment_color = right ? vec4(texture(map, at).rgb, 1.0) : vec4(1.0, 0.0, 1.0, 1.0);
}
"""

    def packed(format: str, *numbers: float) -> str:
        return base64.b64encode(struct.pack(f"<{len(numbers)}{format}", *numbers)).decode()

    lower, upper = (255, 0, 0, 255) * 2, (0, 0, 255, 255) * 2
    told = payload(
        program(
            body,
            textures=[
                {"name": "map", "uniform": "map", "type": "Texture2D", "wrap": "clamp"},
            ],
            buffers=[
                {"name": "p", "uniform": "points", "count": "points_count", "element": "vec3"},
                {"name": "f", "uniform": "flags", "count": "flags_count", "element": "int"},
            ],
        ),
        resources={
            "map": {
                **{"type": "Texture2D", "size": [2, 2], "components": 4, "format": "rgba8"},
                "data": packed("B", *lower, *upper),
            },
            "p": {
                **{"type": "buffer", "size": [1300], "components": 3, "format": "float32"},
                "data": packed("f", *range(3900)),
            },
            "f": {
                **{"type": "buffer", "size": [3], "components": 1, "format": "int32"},
                "data": packed("i", 1, 0, -5),
            },
        },
    )
    with opened(tmp_path, told) as page:
        assert close(page.color(80, 2), (0, 0, 255))  # the upper edge
        assert close(page.color(80, 198), (255, 0, 0))


# The camera and the mouse


def steered(**changes: Any) -> dict[str, Any]:
    body = """
uniform float View_yaw; uniform float View_pitch; uniform float View_zoom; uniform vec2 View_pan;
void main() {
    fragment_color = vec4(0.5 + 0.1 * View_yaw, 0.5 + 0.1 * View_pitch, 0.25 * View_zoom, 1.0);
    if (gl_FragCoord.x < 20.0) fragment_color = vec4(0.5 + 0.25 * View_pan, 0.0, 1.0);
}
"""
    return payload(program(body, *pages.STEERING), steering={"elevation": 0.3}, **changes)


def test_drags_orbit_and_pan_the_wheel_zooms_a_double_click_resets(tmp_path: Path) -> None:
    with opened(tmp_path, steered()) as page:
        assert close(page.color(80, 30), (128, 128, 64))
        height = page.canvas.bounding_box()["height"]
        mouse = page.page.mouse
        mouse.move(80, 30)
        mouse.down()
        mouse.move(90, 35, steps=3)
        mouse.up()
        moved = page.ask("player.steering()")
        # Right: the scene follows the hand, the eye goes left. Down: the eye rises.
        assert moved["yaw"] == pytest.approx(-3.14159265 * 10 / height)
        assert moved["pitch"] == pytest.approx(3.14159265 * 5 / height)
        mouse.down(button="right")
        mouse.move(100, 15, steps=2)
        mouse.up(button="right")
        page.page.keyboard.down("Shift")
        mouse.down()
        mouse.move(110, 5)
        mouse.up()
        page.page.keyboard.up("Shift")
        pan = page.ask("player.steering().pan")
        assert pan == pytest.approx([2 * 20 / height, 2 * 30 / height])
        mouse.wheel(0, 100)
        page.page.wait_for_function(f"{PLAYER}.steering().zoom > 1.1")
        page.settle()
        now = page.ask("player.steering()")
        expected = (0.5 + 0.1 * now["yaw"], 0.5 + 0.1 * now["pitch"], 0.25 * now["zoom"])
        assert close(page.color(80, 30), tuple(round(255 * part) for part in expected))
        expected = (0.5 + 0.25 * now["pan"][0], 0.5 + 0.25 * now["pan"][1], 0)
        assert close(page.color(10, 30), tuple(round(255 * part) for part in expected))
        mouse.dblclick(80, 30)
        assert page.ask("player.steering()") == {"yaw": 0, "pitch": 0, "zoom": 1, "pan": [0, 0]}
        page.settle()
        assert close(page.color(80, 30), (128, 128, 64))


def test_the_elevation_stays_below_the_zenith(tmp_path: Path) -> None:
    with opened(tmp_path, steered()) as page:
        page.ask("player.hands.drag(0, 9, false)")
        assert page.ask("player.steering().pitch") == pytest.approx(3.14159265 / 2 - 0.02 - 0.3)
        page.ask("player.hands.drag(0, -9, false), player.setSteering({ zoom: 0.5 })")
        assert page.ask("player.steering().pitch") == pytest.approx(-3.14159265 / 2 + 0.02 - 0.3)
        said = page.ask("player.code()")
        assert said.startswith("params={}, steering=distal.Steering(pitch=-1.8508")


def test_two_fingers_move_and_zoom(tmp_path: Path) -> None:
    touch = """(points, type) => {
        const canvas = document.querySelector('[data-distal]').shadowRoot.querySelector('canvas');
        canvas.setPointerCapture = () => {};
        for (const [pointerId, clientX, clientY] of points)
            canvas.dispatchEvent(new PointerEvent(type, {
                pointerId, clientX, clientY, pointerType: 'touch', button: 0, bubbles: true }));
    }"""

    def send(page: Page, type: str, *points: tuple[int, int, int]) -> None:
        page.page.evaluate(f"([points, type]) => ({touch})(points, type)", [points, type])

    with opened(tmp_path, steered(), has_touch=True) as page:
        height = page.canvas.bounding_box()["height"]
        send(page, "pointerdown", (1, 60, 40), (2, 100, 40))
        send(page, "pointermove", (1, 40, 40), (2, 120, 40))  # twice as far apart
        moved = page.ask("player.steering()")
        assert moved["zoom"] == pytest.approx(0.5)
        assert moved["pan"] == pytest.approx([0, 0], abs=1e-9)
        assert moved["yaw"] == 0
        send(page, "pointermove", (1, 50, 40), (2, 130, 40))  # both to the right
        assert page.ask("player.steering().pan") == pytest.approx([2 * 10 / height, 0])
        send(page, "pointerup", (1, 50, 40), (2, 130, 40))
        send(page, "pointermove", (2, 140, 40))
        assert page.ask("player.steering().yaw") == 0


def test_without_a_camera_a_drag_is_the_mouse(tmp_path: Path) -> None:
    body = "uniform vec4 mouse;\nvoid main() { fragment_color = vec4(mouse.xy / 200.0, 0.0, 1.0);"
    body += " if (gl_FragCoord.x < 20.0) fragment_color = vec4(abs(mouse.zw) / 200.0,"
    body += " mouse.z > 0.0 ? 1.0 : 0.0, 1.0); }\n"
    with opened(tmp_path, payload(program(body, pages.MOUSE), embed=True)) as page:
        height = round(page.canvas.bounding_box()["height"])
        mouse = page.page.mouse
        mouse.move(50, 20)
        mouse.down()
        mouse.move(100, 30)
        page.settle()
        # Where it is, from the lower left; where it was pressed; that it is down.
        at = (round(255 * 100 / 200), round(255 * (height - 30) / 200), 0)
        assert close(page.color(80, 40), at)
        pressed = (round(255 * 50 / 200), round(255 * (height - 20) / 200), 255)
        assert close(page.color(10, 40), pressed)
        mouse.up()
        mouse.move(10, 10)
        page.settle()
        assert close(page.color(80, 40), at)
        assert close(page.color(10, 40), (*pressed[:2], 0))


# Time


def moving(**changes: Any) -> dict[str, Any]:
    body = (
        "uniform float time;\nvoid main() { fragment_color = vec4(0.1 * time, 0.0, 0.0, 1.0); }\n"
    )
    time = {"start": 0.0, "duration": 10.0, "animated": True, **changes.pop("time", {})}
    return payload(program(body, pages.TIME), time=time, **changes)


def test_time_plays_pauses_and_is_scrubbed(tmp_path: Path) -> None:
    with opened(tmp_path, moving(), viewport={"width": 400, "height": 120}, quiet=False) as page:
        page.page.wait_for_function(f"{PLAYER}.time > 0.05")
        page.page.get_by_role("button", name="Pause").click()
        page.settle()
        still = page.ask("player.time")
        assert page.frames(300) == 0
        assert page.ask("player.time") == still
        slider = page.page.get_by_role("slider", name="Time")
        slider.evaluate("(s) => { s.value = 500; s.dispatchEvent(new Event('input')) }")
        assert page.ask("player.time") == pytest.approx(5.0)
        page.settle()
        assert close(page.color(5, 5), (128, 0, 0))
        page.ask("player.setTime(9.95)")
        page.page.get_by_role("button", name="Play").click()
        page.page.wait_for_function(f"{PLAYER}.time < 5")  # the loop began anew


def test_without_a_loop_the_time_slider_keeps_its_ends_under_the_hand(tmp_path: Path) -> None:
    scene = moving(time={"duration": None})
    calm = {"viewport": {"width": 400, "height": 120}, "reduced_motion": "reduce"}
    with opened(tmp_path, scene, **calm) as page:
        box = page.page.get_by_role("slider", name="Time").bounding_box()
        middle, right = box["y"] + box["height"] / 2, box["x"] + box["width"]
        page.page.mouse.move(box["x"] + 9, middle)
        page.page.mouse.down()
        for x in (right - 2, right + 2, right + 4, right + 6):
            page.page.mouse.move(x, middle)
        assert page.ask("player.time") == 10
        page.page.mouse.move(box["x"] - 5, middle)
        assert page.ask("player.time") == 0
        page.page.mouse.move(right + 5, middle)
        page.page.mouse.up()
        assert page.ask("player.timeRange") == [0, 10]
        page.ask("player.setTime(10.5)")
        assert page.ask("player.timeRange") == [0, 20]


def test_less_motion_means_it_starts_still(tmp_path: Path) -> None:
    with opened(tmp_path, moving(), reduced_motion="reduce") as page:
        assert page.ask("player.playing") is False
        assert page.ask("player.time") == 0
        page.ask("player.play()")
        page.page.wait_for_function(f"{PLAYER}.time > 0.05")


def test_out_of_sight_nothing_is_drawn(tmp_path: Path) -> None:
    hide = "(is) => { Object.defineProperty(document, 'hidden', { value: is, configurable: true });"
    hide += " document.dispatchEvent(new Event('visibilitychange')) }"
    tail = "<div style='height:2000px'></div>"
    with opened(tmp_path, moving(), tail=tail, quiet=False) as page:
        page.page.wait_for_function(f"{PLAYER}.time > 0.05")
        for away, back in (
            (f"({hide})(true)", f"({hide})(false)"),
            ("scrollTo(0, 1000)", "scrollTo(0, 0)"),
        ):
            page.page.evaluate(away)
            page.page.wait_for_timeout(150)
            time = page.ask("player.time")
            assert page.frames(200) == 0
            assert page.ask("player.time") == time
            page.page.evaluate(back)
            page.page.wait_for_function(f"{PLAYER}.time > {time} + 0.05")


def test_nothing_is_drawn_when_nothing_changed(tmp_path: Path) -> None:
    with opened(tmp_path, reddish()) as page:
        assert page.frames(400) == 0
        page.ask("player.setParameter('red', 0.5)")  # what it was
        assert page.frames(300) == 0
        page.ask("player.setParameter('red', 0.6)")
        page.settle()
        assert page.frames(300) == 0


# Keys


def test_keys_do_what_the_list_of_keys_says(tmp_path: Path) -> None:
    two = payload(
        program(REDDISH, RED_UNIFORM),
        program("void main() { fragment_color = vec4(0.0, 1.0, 0.0, 1.0); }\n"),
        parameters=[RED],
        steering={"elevation": 0.0},
        time={"start": 0.0, "duration": None, "animated": True},
    )
    with opened(tmp_path, two, viewport=WIDE, reduced_motion="reduce") as page:
        keys = page.page.keyboard
        keys.press("ArrowRight")
        keys.press("ArrowUp")
        moved = page.ask("player.steering()")
        assert moved["yaw"] > 0 and moved["pitch"] > 0  # the eye goes where the arrow points
        keys.press("+")
        assert page.ask("player.steering().zoom") < 1
        keys.press("r")
        assert page.ask("player.camera.moved") is False
        keys.press("v")
        page.settle()
        assert page.ask("player.view") == "normal"
        assert close(page.color(10, 10), (0, 255, 0))
        keys.press("V")
        assert page.ask("player.view") == "color"
        keys.press(".")
        keys.press(">")
        assert page.ask("player.time") == pytest.approx(0.25 + 1 / 60)
        keys.press("Home")
        assert page.ask("player.time") == 0
        keys.press("]")
        assert page.page.get_by_role("combobox", name="Speed").input_value() == "2"
        keys.press(" ")
        assert page.ask("player.playing") is True
        keys.press(" ")
        assert page.ask("player.playing") is False
        panel = page.page.get_by_role("region", name="Settings")
        assert panel.is_visible()
        keys.press("p")
        assert not panel.is_visible()
        keys.press("h")
        assert page.page.get_by_role("dialog").is_visible()
        keys.press("Escape")
        assert not page.page.get_by_role("dialog").is_visible()


def test_the_list_of_keys_tells_of_the_mouse_that_a_picture_reads(tmp_path: Path) -> None:
    body = "uniform vec4 mouse;\nvoid main() { fragment_color = vec4(mouse.xy, 0.0, 1.0); }\n"
    reading = payload(program(body, pages.MOUSE))
    for scene, said in (
        (reading, "The mouse that"),
        (steered(), "Right or shift drag"),
        (reddish(), ""),
    ):
        with opened(tmp_path, scene, viewport=WIDE) as page:
            page.page.keyboard.press("?")
            words = page.page.get_by_role("dialog").inner_text()
            assert said in words
            assert ("Drag" in words) == bool(said)
            page.page.keyboard.press("Escape")
            assert page.page.get_by_role("dialog").count() == 0
            page.page.keyboard.press("?")
            page.page.get_by_role("dialog").wait_for()


def test_keys_in_a_field_are_the_fields(tmp_path: Path) -> None:
    with opened(
        tmp_path, steered(parameters=[TINT]), viewport={"width": 700, "height": 300}
    ) as page:
        field = page.page.get_by_label("Tint, hexadecimal")
        field.focus()
        for key in ("v", "r", "h", "ArrowRight", "-", " "):
            page.page.keyboard.press(key)
        assert page.ask("player.camera.moved") is False
        assert page.page.get_by_role("region", name="Settings").is_visible()


def test_everything_is_reached_with_the_tab_key_and_has_a_name(tmp_path: Path) -> None:
    told = steered(parameters=[RED, TINT], time={"start": 0, "duration": None, "animated": True})
    with opened(
        tmp_path, told, viewport={"width": 700, "height": 400}, reduced_motion="reduce"
    ) as page:
        seen = []
        for _ in range(30):
            page.page.keyboard.press("Tab")
            element = page.page.evaluate(
                "() => { let e = document.activeElement; while (e?.shadowRoot?.activeElement)"
                " e = e.shadowRoot.activeElement; return [e.tagName, e.getAttribute('aria-label')"
                " || e.labels?.[0]?.textContent || e.textContent || ''] }"
            )
            if element[0] == "BODY":
                break
            seen.append(element)
        assert all(name for _, name in seen), seen
        names = [name for _, name in seen]
        assert names[0].startswith("A trial.")
        for expected in ("Play (space)", "Time", "Red", "Tint", "Resolution", "Copy as code"):
            assert expected in names


# What is taken along


def test_a_screenshot_is_the_picture_as_a_file(tmp_path: Path) -> None:
    with opened(tmp_path, reddish(name="my <scene>")) as page:
        with page.page.expect_download() as download:
            page.page.keyboard.press("s")
        assert download.value.suggested_filename == "my-scene.png"
        picture = Image.open(download.value.path()).convert("RGB")
        box = page.canvas.bounding_box()
        assert picture.size == (round(box["width"]), round(box["height"]))
        assert close(picture.getpixel((80, 30)), (128, 0, 255))


def test_code_is_copied(tmp_path: Path) -> None:
    with opened(tmp_path, reddish(values={"red": 0.25}), viewport=WIDE) as page:
        page.page.context.grant_permissions(["clipboard-read", "clipboard-write"])
        page.page.get_by_role("button", name="Copy as code").click()
        page.page.get_by_text("Copied").first.wait_for()
        assert page.page.evaluate("navigator.clipboard.readText()") == 'params={"red": 0.25}'


def test_the_code_says_what_render_would_not_do_by_itself(tmp_path: Path) -> None:
    time = {"start": 2.0, "duration": None, "animated": True}
    two = [program(FLAT_RED), program(FLAT_RED)]
    scene = payload(*two, time=time, steering={"elevation": 0.0})
    with opened(tmp_path, scene, reduced_motion="reduce") as page:
        assert page.ask("player.code()") == "params={}, time=2"
        page.ask("player.setTime(0)")
        page.ask("player.setView('normal')")
        assert page.ask("player.code()") == 'params={}, view="normal"'


# Accidents


def test_while_the_driver_compiles_the_page_says_so_and_lives(tmp_path: Path) -> None:
    # A driver that is done when the test says so, whether or not this one has the extension.
    before = (
        "window.done = false; const gl = WebGL2RenderingContext.prototype;"
        "const { getProgramParameter, getExtension } = gl;"
        "gl.getExtension = function (name) { return name === 'KHR_parallel_shader_compile'"
        " ? { COMPLETION_STATUS_KHR: 0x91b1 } : getExtension.call(this, name) };"
        "gl.getProgramParameter = function (program, what) { return what === 0x91b1"
        " ? window.done : getProgramParameter.call(this, program, what) }"
    )
    with opened(tmp_path, reddish(), quiet=False, before=before, viewport=WIDE) as page:
        page.page.get_by_text("Compiling Color …").first.wait_for()
        assert page.page.get_by_role("status").inner_text() == "Compiling Color …"
        assert page.page.locator("[data-distal] img").is_visible()
        page.page.get_by_role("slider", name="Red").press("End")  # nothing is held up
        assert page.ask("await player.screenshot()") is None
        page.page.evaluate("window.done = true")
        page.settle()
        assert page.page.get_by_text("Compiling").count() == 0
        assert close(page.color(10, 10), (255, 0, 255))


def test_a_lost_context_is_told_and_mended(tmp_path: Path) -> None:
    with opened(tmp_path, reddish()) as page:
        page.page.evaluate(
            "() => { const c = document.querySelector('[data-distal]').shadowRoot"
            ".querySelector('canvas'); window.lose = c.getContext('webgl2')"
            ".getExtension('WEBGL_lose_context'); window.lose.loseContext() }"
        )
        notice = page.page.get_by_role("alert")
        notice.wait_for()
        assert "let go of the picture" in notice.inner_text()
        assert page.page.locator("[data-distal] img").is_visible()
        page.ask("player.setParameter('red', 1)")
        page.page.evaluate("window.lose.restoreContext()")
        notice.wait_for(state="detached")
        page.settle()
        assert close(page.color(10, 10), (255, 0, 255))


def test_words_that_pass_leave_what_is_wrong(tmp_path: Path) -> None:
    with opened(tmp_path, reddish(), viewport=WIDE) as page:
        page.page.evaluate(
            "document.querySelector('[data-distal]').shadowRoot.querySelector('canvas')"
            ".getContext('webgl2').getExtension('WEBGL_lose_context').loseContext()"
        )
        notice = page.page.get_by_role("alert")
        notice.wait_for()
        page.page.get_by_role("button", name="Copy as code").click()
        word = page.page.locator(".chip").get_by_text("params={}")
        word.wait_for()
        page.page.get_by_role("button", name="Copy as code").click()
        word.wait_for()
        word.wait_for(state="detached")
        assert "let go of the picture" in notice.inner_text()
        assert notice.get_by_role("button", name="Try again").is_visible()


def test_disposed_of_at_any_moment_it_keeps_no_context(tmp_path: Path) -> None:
    with opened(tmp_path, reddish()) as page:
        living = page.page.evaluate(
            """async () => {
  const host = document.querySelector("[data-distal]");
  const payload = host.distal.payload;
  const { constructor } = host.distal;
  host.distal.dispose();
  const made = [];
  const get = HTMLCanvasElement.prototype.getContext;
  HTMLCanvasElement.prototype.getContext = function (...words) {
    return made[made.push(get.apply(this, words)) - 1];
  };
  const wait = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
  for (const ms of [0, 1, 2, 4, 8, 15, 30, 60]) {
    const another = document.createElement("div");
    host.after(another);
    const player = new constructor(another, payload);
    await wait(ms);
    player.dispose();
  }
  // In the middle of unpacking, whatever this machine's pace.
  const another = document.createElement("div");
  host.after(another);
  let unpacked;
  const programs = { encoding: "plain", get data() { unpacked(); return payload.programs.data; } };
  const player = new constructor(another, { ...payload, programs });
  await new Promise((resolve) => (unpacked = resolve));
  player.dispose();
  await wait(300);
  return made.filter((gl) => !gl.isContextLost()).length;
}"""
        )
        assert living == 0


def test_an_old_browser_keeps_the_poster(tmp_path: Path) -> None:
    before = "CSSStyleSheet = function () { throw new TypeError('no constructor') }"
    with opened(tmp_path, reddish(), before=before, quiet=False) as page:
        page.watched.settle(300)
        assert page.page.locator("[data-distal] img").is_visible()
        assert page.watched.messages == ["error: no constructor"]
        page.watched.messages.clear()


def test_one_payload_too_new_does_not_stop_the_others(tmp_path: Path) -> None:
    with opened(tmp_path, reddish(format=2), reddish(), style="height:60px", quiet=False) as page:
        page.page.wait_for_function(
            "document.querySelectorAll('[data-distal]')[1].shadowRoot?.querySelector('.live')"
        )
        assert page.watched.messages == ["error: a payload of format 2 is too new"]
        page.watched.messages.clear()


def test_a_shader_that_fails_names_the_authors_line_and_the_poster_stays(tmp_path: Path) -> None:
    bad = program(
        "void main() { fragment_color = vec4(nothing); }\n", lines=[[6, 6, 0, 42], [5, 5, 0, 1]]
    )
    bad["fragment"] = bad["fragment"].replace("void main", "\nvoid main")
    good = program("void main() { fragment_color = vec4(0.0, 1.0, 0.0, 1.0); }\n")
    big = {"width": 700, "height": 400}
    with opened(tmp_path, payload(bad, good), quiet=False, viewport=big) as page:
        notice = page.page.get_by_role("alert")
        notice.wait_for()
        assert "scene.py:42" in notice.locator("p").inner_text()
        assert page.page.locator("[data-distal] img").is_visible()
        notice.get_by_text("Details").click()
        assert "'nothing' : undeclared identifier" in notice.inner_text()
        page.ask("player.setView('normal')")
        page.settle()
        assert close(page.color(10, 10), (0, 255, 0))
        assert notice.count() == 0
        # The old picture stays while another view fails.
        page.ask("player.setView('color')")
        notice.wait_for()
        assert close(page.color(10, 10), (0, 255, 0))
        notice.get_by_role("button", name="Try again").click()
        page.page.get_by_role("alert").wait_for()


def test_without_webgl_2_the_poster_and_a_sentence_stay(tmp_path: Path) -> None:
    before = (
        "const real = HTMLCanvasElement.prototype.getContext; window.deny = true;"
        "HTMLCanvasElement.prototype.getContext = function (...given) {"
        " return window.deny ? null : real.apply(this, given) }"
    )
    with opened(tmp_path, reddish(), quiet=False, before=before, viewport=WIDE) as page:
        notice = page.page.get_by_role("alert")
        notice.wait_for()
        assert "no WebGL 2" in notice.inner_text()
        assert page.page.locator("[data-distal] img").is_visible()
        page.page.evaluate("window.deny = false")
        notice.get_by_role("button", name="Try again").click()
        page.settle()
        assert close(page.color(10, 10), (128, 0, 255))


def test_a_dear_still_is_drawn_in_bands_and_is_whole(tmp_path: Path) -> None:
    # Some ten milliseconds a column in software; each pixel says where it is.
    body = """
uniform vec2 resolution;
void main() {
    float sum = 0.0;
    for (int i = 0; i < 20000; i++) sum += sin(float(i) + gl_FragCoord.x);
    fragment_color = vec4(gl_FragCoord.xy / resolution, sum > 1e9 ? 1.0 : 0.0, 1.0);
}
"""
    before = (
        "window.bands = []; const real = WebGL2RenderingContext.prototype.scissor;"
        "WebGL2RenderingContext.prototype.scissor = function (...box) {"
        " window.bands.push(box); real.apply(this, box) }"
    )
    told = payload(program(body, pages.RESOLUTION), embed=True)
    with opened(tmp_path, told, before=before) as page:
        width, height = page.ask(
            "[...document.querySelectorAll('[data-distal]')].map((h) => {"
            " const c = h.shadowRoot.querySelector('canvas');"
            " return [c.width, c.height] })[0]"
        )
        bands = [band for band in page.page.evaluate("window.bands") if band[3] == height]
        # The still's bands follow one another from the left edge to the right.
        still = bands[max(i for i, band in enumerate(bands) if band[0] == 0) :]
        assert len(still) > 1
        assert [band[0] for band in still] == [
            sum(b[2] for b in still[:i]) for i in range(len(still))
        ]
        assert sum(band[2] for band in still) == width
        for x, y in ((5, 5), (150, 40), (80, height - 2)):
            expected = ((x + 0.5) / width, (height - y - 0.5) / height, 0)
            assert close(page.color(x, y), tuple(round(255 * part) for part in expected))


# Embedded


def test_an_embedded_player_is_bare_and_leaves_the_page_its_wheel(tmp_path: Path) -> None:
    tail = "<div style='height:2000px'></div>"
    style = "height:100px"
    with opened(tmp_path, steered(embed=True), style=style, tail=tail) as page:
        assert page.page.get_by_role("region", name="Settings").count() == 0
        assert page.canvas.bounding_box()["height"] == 100
        assert page.canvas.evaluate("(c) => getComputedStyle(c).touchAction") == "pan-y"
        page.page.mouse.move(80, 50)
        page.page.mouse.wheel(0, 100)
        page.page.wait_for_function("scrollY > 0")
        assert page.ask("player.steering().zoom") == 1
        page.page.evaluate("scrollTo(0, 0)")
        page.page.mouse.click(80, 50)  # picked up: now it is the camera's
        page.page.mouse.wheel(0, 100)
        page.page.wait_for_function(f"{PLAYER}.steering().zoom > 1")
        assert page.page.evaluate("scrollY") == 0


def test_a_pages_way_of_writing_stays_outside_what_is_hidden_stays_hidden(tmp_path: Path) -> None:
    tail = "<style>body{direction:rtl;text-transform:uppercase;letter-spacing:9px}</style>"
    told = "['direction', 'textTransform', 'letterSpacing', 'visibility', 'pointerEvents']"
    with opened(tmp_path, moving(), tail=tail, viewport=WIDE, reduced_motion="reduce") as page:
        style = f"(e) => {{ const s = getComputedStyle(e); return {told}.map((n) => s[n]) }}"
        label = page.page.get_by_text("Resolution")
        assert label.evaluate(style) == ["ltr", "none", "normal", "visible", "auto"]
        page.page.evaluate("document.body.style = 'visibility:hidden;pointer-events:none'")
        assert label.evaluate(style)[3:] == ["hidden", "none"]


def test_several_scenes_on_a_page_do_not_disturb_each_other_nor_the_page(tmp_path: Path) -> None:
    tail = "<p id=c1 class=panel>text</p><style>canvas{display:none}.panel{color:red}</style>"
    with opened(
        tmp_path,
        reddish(values={"red": 0.0}),
        reddish(values={"red": 1.0}),
        style="height:60px",
        tail=tail,
    ) as page:
        page.page.wait_for_function(
            "[...document.querySelectorAll('[data-distal]')].every((h) => "
            "h.shadowRoot.querySelector('.live'))"
        )
        hosts = page.page.evaluate(
            "Promise.all([...document.querySelectorAll('[data-distal]')].map(async (h) => {"
            " await h.distal.settled(); return h.distal.parameters().red }))"
        )
        assert hosts == [0, 1]
        assert page.page.evaluate("getComputedStyle(c1).display") == "block"
        page.ask("player.dispose()")
        assert page.page.evaluate("[...document.querySelectorAll('[data-distal]')][1].distal.view")


# Sharper pictures, ranges of values, the frame


SAMPLED = """
uniform int Samples;
void main() { fragment_color = vec4(float(Samples) / 32.0, 0.5, 0.0, 1.0); }
"""


def sampled(**changes: Any) -> dict[str, Any]:
    number = uniform("Samples", "int", "number", 1)
    return payload(program(SAMPLED, number), **changes)


def test_a_picture_that_rests_gets_more_samples(tmp_path: Path) -> None:
    with opened(tmp_path, sampled(embed=True)) as page:
        page.page.evaluate(
            "() => { window.seen = [];"
            f" {PLAYER}.on('frame', (frame) => window.seen.push(frame.samples)) }}"
        )
        page.ask("player.resetAll(), player.setResolution(1), player.hands.changed()")
        page.page.wait_for_function("window.seen.includes(16)")
        taken = page.page.evaluate("window.seen")
        assert [s for s in taken if s > 1] == [4, 16]
        assert close(page.color(80, 20), (round(255 * 0.5), 128, 0))
        assert page.frames(200) == 0  # and then nothing is drawn any more


def test_a_picture_that_moves_has_one_sample(tmp_path: Path) -> None:
    told = sampled(time={"start": 0.0, "duration": 10.0, "animated": True})
    with opened(tmp_path, told, quiet=False) as page:
        page.page.evaluate(
            "() => { window.seen = [];"
            f" {PLAYER}.on('frame', (frame) => window.seen.push(frame.samples)) }}"
        )
        page.page.wait_for_function("window.seen.length > 5")
        assert set(page.page.evaluate("window.seen")) == {1}


RANGED = """
uniform float View_low; uniform float View_middle; uniform float View_high;
uniform vec2 resolution;
void main() {
    // Values from 10 to 20, packed as in render.ranges; then the numbers of the range.
    float value = 10.0 + 10.0 * gl_FragCoord.x / resolution.x;
    float code = floor(8388608.0 + log2(1.0 + value * 65536.0) / 48.0 * 8388607.0 + 0.5);
    float high = floor(code / 65536.0);
    float middle = floor((code - 65536.0 * high) / 256.0);
    vec3 bytes = vec3(high, middle, code - 65536.0 * high - 256.0 * middle) / 255.0;
    vec3 told = vec3(View_low, View_middle, View_high) / 25.0;
    fragment_color = vec4(View_low > View_high ? bytes : told, 1.0);
}
"""


def test_a_view_is_told_the_range_of_its_values(tmp_path: Path) -> None:
    names = ("View_low", "View_middle", "View_high")
    numbers = [uniform(name, "float", "number", 0.0) for name in names]
    told = payload(program(RANGED, pages.RESOLUTION, *numbers), embed=True)
    with opened(tmp_path, told) as page:
        # 64 columns: the second, the middle, the last but one.
        expected = [10.0 + 10.0 * (i + 0.5) / 64.0 for i in (1, 31.5, 62)]
        found = page.color(80, 20)
        assert found == pytest.approx([255 * value / 25.0 for value in expected], abs=2)


FRAMED = """
uniform vec2 resolution; uniform vec2 Frame_offset;
void main() {
    vec2 at = (gl_FragCoord.xy - Frame_offset) / resolution;
    bool inside = all(greaterThan(at, vec2(0.0))) && all(lessThan(at, vec2(1.0)));
    fragment_color = vec4(inside ? 1.0 : 0.0, 0.0, 1.0, 1.0);
}
"""
OFFSET = uniform("Frame_offset", "vec2", "number", [0.0, 0.0])


def framed(**changes: Any) -> dict[str, Any]:
    return payload(program(FRAMED, pages.RESOLUTION, OFFSET), size=[400, 300], **changes)


def test_the_frame_lies_beside_the_panel_and_above_the_bar(tmp_path: Path) -> None:
    size = {"width": 900, "height": 400}
    with opened(tmp_path, framed(), viewport=size) as page:
        panel = page.page.get_by_role("region", name="Settings").bounding_box()
        bar = page.page.locator(".bar").bounding_box()
        inside, outside = (255, 0, 255), (0, 0, 255)
        assert close(page.color(2, 2), inside)
        assert close(page.color(int(panel["x"]) - 3, int(bar["y"]) - 3), inside)
        assert close(page.color(int(panel["x"]) + 3, 20), outside)
        assert close(page.color(20, int(bar["y"]) + 3), outside)
        page.page.keyboard.press("p")
        page.settle()
        assert close(page.color(int(panel["x"]) + 3, 20), inside)


def test_a_portrait_screen_keeps_the_authors_width(tmp_path: Path) -> None:
    size = {"width": 390, "height": 844}
    with opened(tmp_path, framed(), viewport=size) as page:
        bar = page.page.locator(".bar").bounding_box()
        middle, half = bar["y"] / 2, 390 * 3 / 4 / 2
        inside, outside = (255, 0, 255), (0, 0, 255)
        for x in (1, 388):
            assert close(page.color(x, int(middle - half) + 3), inside)
            assert close(page.color(x, int(middle + half) - 3), inside)
            assert close(page.color(x, int(middle - half) - 3), outside)
            assert close(page.color(x, int(middle + half) + 3), outside)


@pytest.mark.parametrize("size", [(1280, 800), (390, 844), (844, 390), (320, 568)])
def test_controls_lie_on_the_page_and_not_on_one_another(tmp_path: Path, size: Any) -> None:
    told = moving(parameters=[RED], steering={"elevation": 0.0})
    told["views"].append({"name": "normal", "label": "Normal", "program": 0})
    width, height = size
    still = {"viewport": {"width": width, "height": height}, "reduced_motion": "reduce"}
    with opened(tmp_path, told, **still) as page:
        for is_open in (False, True):
            if page.page.get_by_role("region", name="Settings").is_visible() != is_open:
                page.ask("player.togglePanel()")
            boxes = {
                name: page.page.locator(name).bounding_box()
                for name in (".bar", ".panel", ".title")
                if page.page.locator(name).is_visible()
            }
            assert (".panel" in boxes) == is_open
            for box in boxes.values():
                assert box["x"] >= 0 and box["x"] + box["width"] <= width
                assert box["y"] >= 0 and box["y"] + box["height"] <= height
            for a, b in itertools.combinations(boxes.values(), 2):
                beside = a["x"] + a["width"] <= b["x"] or b["x"] + b["width"] <= a["x"]
                above = a["y"] + a["height"] <= b["y"] or b["y"] + b["height"] <= a["y"]
                assert beside or above, boxes
            menu = page.page.get_by_role("combobox", name="View")
            assert menu.is_visible()
            menu.select_option("Normal")
            assert page.ask("player.view") == "normal"
            menu.select_option("Color")
