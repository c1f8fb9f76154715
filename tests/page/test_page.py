"""Exported pages in a real browser: what they show is what the CPU shows, whatever hands do."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from PIL import Image

import distal
from distal.export.page import TOO_OLD
from distal.scene.viewing.viewable import viewable
from tests.browser import BrowserUnavailableError, offline_page
from tests.browser import browser as running_browser
from tests.page.looking import looked_at
from tests.pictures.comparison import difference

IMAGE = "raymarcher"
OBJECTS = "raymarcher_objects"
SCENE = "pebble"

# No pattern of sharp edges runs to its horizon: those flip where two drivers' sines differ, and
# here it is the page that is asked whether it hands on what it should.
PEBBLE = '''
"""A sphere melts into a ring that goes around it."""

from distal import Box, Camera, Scene, Sphere, Torus, time
from distal.lang import slider

softness = slider("Softness", 0.05, high=0.2, help="How far they melt.")
ring = Torus(0.32, 0.12).translate(x=0.8).rotate(y=0.8 * time)
pebble = Sphere(0.55).union(ring, smooth=softness).paint("#d07040")
floor = Box((3.0, 0.2, 3.0)).translate(y=-0.6).paint("#88a0b0")
scene = Scene(pebble | floor, camera=Camera((2.0, 1.0, 2.0)), far=8.0, floor=False)
'''

HOSTILE = "</script><script>alert(1)</script> <!-- \"double\" 'single' & 🦄 " + "long " * 60
LABEL = '</script><img src=x onerror=alert(2)> "quoted" 🦄'

ODD = f"""
from distal.lang import *

size = slider("Size", 0.3, 0.05, 1.0, log=True, group="Form", help={LABEL!r})
mode = choice({LABEL!r}, ["one", "<b>two</b>", "three"], 1)
count = integer("Count", 3, 1, 9)
is_on = toggle("Time", True, group={LABEL!r})
tint = color("Tint", "#ff8040")
place = point("Place", (0.2, 0.1, 0.3))
spot = point("Resolution", (0.2, -0.1))


@image
def picture(frame: Frame) -> vec3:
    uv = (2.0 * frame.coord - frame.resolution) / frame.resolution.y
    d = length(uv - spot - place.xy * place.z) - size
    shown = tint * smoothstep(0.2, -0.2, d)
    for i in range(count):
        shown += 0.05 * sin(float(i) * uv.x * 9.0)
    return shown + vec3(0.0, 0.1 * float(mode), 0.2 if is_on else 0.0)
"""

DATA = """
import numpy as np
from distal.lang import *

x = np.linspace(0.0, 1.0, 8, dtype=np.float32)
light = np.stack([*np.meshgrid(x, x), np.full((8, 8), 0.37, np.float32)], axis=-1)
volume = np.random.default_rng(3).random((4, 5, 6, 3), np.float32)
sides = [np.full((4, 4, 3), 0.1 + 0.12 * i, np.float32) for i in range(6)]

stored = Texture2D("dots.png", wrap="clamp")
half = Texture2D(light)
block = Texture3D(volume)
heights = Texture3D(volume[..., 0])
around = TextureCube(sides)
numbers = Buffer([0.1 * i for i in range(1500)])
pairs = Buffer([(0.1, 0.2), (0.3, 0.4), (0.5, 0.6)])
whole = Buffer([1, -2, 3])


@image
def picture(frame: Frame) -> vec3:
    uv = frame.coord / frame.resolution
    shown = 0.4 * sample(stored, uv).rgb + 0.3 * sample(half, uv).rgb
    shown += 0.1 * sample(block, vec3(uv, 0.5)).rgb + 0.1 * sample(heights, vec3(uv, 0.3)).rgb
    shown += 0.1 * sample(around, normalize(vec3(uv - 0.5, 0.4))).rgb
    row = int(uv.y * 1499.0)
    shown += vec3(0.001 * numbers[row], pairs[2].x * 0.1, 0.01 * float(whole[1] + 3))
    return shown
"""


@pytest.fixture(scope="module", autouse=True)
def browser():
    try:
        return running_browser()
    except BrowserUnavailableError as error:
        pytest.skip(f"no browser: {error}")


FOLDER = TemporaryDirectory(prefix="distal-pages-")


@cache
def loaded(name):
    if name != SCENE:
        return distal.load(f"example:{name}")
    path = Path(FOLDER.name, f"{name}.py")
    path.write_text(PEBBLE, encoding="utf-8")
    return distal.load(path)


@cache
def example(name):
    return viewable(loaded(name))


@cache
def exported(name):
    path = Path(FOLDER.name, f"{name}.html")
    loaded(name).export(path)
    return path


@pytest.fixture
def page():
    return exported


@pytest.fixture
def written(tmp_path):
    """A page of a scene's text, and what the CPU renders of it."""

    def write(text, **options):
        source, path = tmp_path / "odd.py", tmp_path / "odd.html"
        source.write_text(text, encoding="utf-8")
        obj = distal.load(source)
        obj.export(path, **options)
        return path, viewable(obj)

    return write


@pytest.mark.parametrize("name", [IMAGE, OBJECTS, SCENE])
def test_the_first_frame_is_the_cpus(page, name):
    with looked_at(page(name)) as looked:
        assert looked.beside(example(name)).is_agreement
        assert looked.state()["time"] == 0.0


def test_what_is_to_be_seen_is_what_is_saved(page, tmp_path):
    bare = tmp_path / "embedded.html"
    viewable(example(SCENE)).scene.export(bare, embed=True)
    bare.write_text(f"<!doctype html><div style='height:190px'>{bare.read_text()}</div>")
    with looked_at(bare) as looked:
        # A view other than the colors keeps one sample where it rests.
        looked.page.evaluate("document.querySelector('[data-distal]').distal.setView('normal')")
        saved = looked.picture()[..., :3].astype(int)
        style = ".bar { visibility: hidden !important }"
        canvas = looked.page.locator("[data-distal] canvas")
        shot = canvas.screenshot(type="png", style=style)
        path = page(SCENE).with_suffix(".png")
        path.write_bytes(shot)
        seen = np.asarray(Image.open(path).convert("RGB")).astype(int)
        height, width = (min(a, b) for a, b in zip(saved.shape, seen.shape, strict=True) if a > 3)
        assert np.abs(saved[:height, :width] - seen[:height, :width]).max() <= 1


def test_a_slider_moves_the_picture(page):
    with looked_at(page(SCENE)) as looked:
        before = looked.picture()
        slider = looked.page.get_by_role("slider", name="Softness")
        slider.focus()
        for _ in range(30):
            slider.press("ArrowRight")
        value = looked.state()["parameters"]["softness"]
        assert value > example(SCENE).parameters[0].default
        assert looked.beside(example(SCENE)).is_agreement
        assert (looked.picture() != before).any()


def test_a_drag_goes_around_the_scene(page):
    with looked_at(page(SCENE)) as looked:
        looked.settle()
        box = looked.page.locator("[data-distal] canvas").bounding_box()
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        mouse = looked.page.mouse
        mouse.move(x, y)
        mouse.down()
        mouse.move(x - 40, y + 10, steps=4)
        mouse.up()
        mouse.wheel(0, 120)
        mouse.down(button="right")
        mouse.move(x, y, steps=3)
        mouse.up(button="right")
        looked.settle()  # the guide answers later than the hand
        moved = looked.state()["steering"]
        assert moved["yaw"] > 0.2 and moved["pitch"] > 0.05
        assert moved["zoom"] != 1.0 and moved["pan"][0] > 0.05
        assert looked.beside(example(SCENE)).is_agreement


@pytest.mark.parametrize("name", [IMAGE, SCENE])
def test_time_runs_stops_and_is_scrubbed(page, name):
    with looked_at(page(name), reduced_motion="no-preference") as looked:
        looked.page.wait_for_function(
            "() => document.querySelector('[data-distal]').distal.time > 0.1"
        )
        looked.page.get_by_role("button", name="Pause").click()
        state = looked.state()
        assert not state["playing"] and state["time"] > 0.1
        assert looked.beside(example(name)).is_agreement
        slider = looked.page.get_by_role("slider", name="Time")
        slider.fill("700")
        scrubbed = looked.state()
        assert scrubbed["time"] > 1.0 and scrubbed["time"] != state["time"]
        assert looked.beside(example(name)).is_agreement


@pytest.mark.parametrize("name", [IMAGE, SCENE])
def test_every_view_is_the_cpus(page, name):
    seen = example(name)
    found = {}
    with looked_at(page(name)) as looked:
        menu = looked.page.get_by_label("View")
        for view in seen.views:
            menu.select_option(view)
            assert looked.state()["view"] == view
            looked.page.wait_for_function(
                "() => document.querySelector('[data-distal]').shadowRoot"
                ".querySelector('.player').dataset.state === 'ready'"
            )
            found[view] = looked.beside(seen)
    # A ray that ends a step sooner has another color: few do, which the mean tells better.
    steps = found.pop("steps", None)
    assert steps is None or steps.mean < 0.1
    assert {view: one for view, one in found.items() if not one.is_agreement} == {}


def test_a_lost_context_comes_back(page):
    with looked_at(page(SCENE)) as looked:
        before = looked.picture()
        looked.page.evaluate(
            """() => {
              const root = document.querySelector("[data-distal]").shadowRoot;
              const gl = root.querySelector("canvas").getContext("webgl2");
              window.losing = gl.getExtension("WEBGL_lose_context");
              window.losing.loseContext();
            }"""
        )
        looked.page.get_by_text("let go of the picture").first.wait_for()
        assert looked.page.locator("[data-distal] > img").is_visible()
        looked.page.evaluate("() => window.losing.restoreContext()")
        looked.page.wait_for_function(
            "() => document.querySelector('[data-distal]').shadowRoot"
            ".querySelector('.player').dataset.state === 'ready'"
        )
        assert (looked.picture() == before).all()


def test_an_old_browser_shows_the_poster_and_a_sentence(tmp_path):
    # Everything that needs WebGL 2 and a style sheet of 2024 has what unpacks the player too.
    path = exported(SCENE)
    with offline_page(path) as watched:
        watched.page.add_init_script("delete window.DecompressionStream")
        watched.page.reload()
        watched.page.get_by_text(TOO_OLD).wait_for()
        assert watched.page.locator("img").is_visible()
        assert watched.complaints == []


def test_the_policy_lets_the_pages_own_scripts_run_and_no_other(tmp_path):
    text = exported(SCENE).read_text(encoding="utf-8")
    foreign = tmp_path / "foreign.html"
    injected = "<body><script>document.title = 'taken over'</script>"
    foreign.write_text(text.replace("<body>", injected), encoding="utf-8")
    with offline_page(foreign) as watched:
        watched.page.locator("canvas").wait_for()
        assert watched.page.title() == SCENE


def test_without_webgl_stand_the_poster_and_a_sentence(page):
    with offline_page(page(SCENE), flags=["--disable-3d-apis"], viewport=None) as watched:
        sentence = watched.page.get_by_text("WebGL 2").first
        sentence.wait_for()
        poster = watched.page.locator("[data-distal] > img")
        assert poster.is_visible()
        assert poster.evaluate("(img) => img.naturalWidth") == 480
        assert "sphere" in poster.get_attribute("alt")
        watched.settle()
        assert watched.requests == []
        assert [line for line in watched.messages if line.startswith("error:")] == []


@pytest.mark.parametrize("style", ["", "img{max-width:100%;height:auto}", "img{all:unset}"])
def test_the_poster_is_as_large_as_the_picture_will_be(page, tmp_path, style):
    # A narrow picture keeps the author's width: so must the poster.
    narrow = tmp_path / "narrow.html"
    text = page(SCENE).read_text(encoding="utf-8")
    narrow.write_text(text.replace("</head>", f"<style>{style}</style></head>"), encoding="utf-8")
    size = {"width": 240, "height": 600}
    with offline_page(narrow, flags=["--disable-3d-apis"], viewport=size) as watched:
        watched.page.get_by_text("WebGL 2").first.wait_for()
        box = watched.page.locator("[data-distal] > img").bounding_box()
        stage = watched.page.locator(".stage").bounding_box()
        bar = watched.page.locator(".bar").bounding_box()
        assert box["width"] == pytest.approx(stage["width"], abs=2)
        assert box["height"] == pytest.approx(stage["width"] * 3 / 4, abs=2)
        assert box["x"] + box["width"] / 2 == pytest.approx(120, abs=1)
        assert box["y"] + box["height"] / 2 == pytest.approx(bar["y"] / 2, abs=2)


def test_without_script_stand_the_poster_and_a_sentence(page):
    with offline_page(page(SCENE), java_script_enabled=False) as watched:
        assert watched.page.locator("[data-distal] > img").is_visible()
        assert watched.page.locator("noscript").is_visible()
        assert "JavaScript" in watched.page.locator("noscript").inner_text()


def test_hostile_names_are_shown_and_never_run(written):
    path, seen = written(ODD, title=HOSTILE)
    with looked_at(path) as looked:
        dialogs = []
        looked.page.on("dialog", lambda dialog: (dialogs.append(dialog.message), dialog.dismiss()))
        assert looked.beside(seen).is_agreement
        assert looked.page.title() == " ".join(HOSTILE.split())
        assert looked.page.get_by_text(LABEL).first.is_visible()
        assert looked.page.locator("[data-distal] img").count() == 1  # the poster
        assert dialogs == []


def test_every_kind_of_control(written):
    path, seen = written(ODD)
    with looked_at(path, viewport={"width": 660, "height": 700}) as looked:
        looked.settle()
        page = looked.page
        page.get_by_role("slider", name="Size").fill("900")
        page.get_by_label(LABEL, exact=True).first.select_option(label="three")
        count = page.get_by_role("spinbutton", name="Count")
        count.fill("7")
        count.press("Enter")
        page.get_by_role("switch").click()
        tint = page.get_by_label("Tint, hexadecimal")
        tint.fill("#20c0ff")
        tint.press("Enter")
        page.get_by_role("spinbutton", name="Place y").fill("-0.5")
        page.get_by_role("spinbutton", name="Resolution x").fill("-0.25")
        values = looked.state()["parameters"]
        names = {p.label: p.name for p in seen.parameters}
        assert values["size"] > 0.5
        assert values[names[LABEL]] == 2
        assert values["count"] == 7
        assert values["time"] is False
        assert values["tint"] == pytest.approx(distal.lang.color("x", "#20c0ff").default, abs=1e-6)
        assert values["place"] == pytest.approx([0.2, -0.5, 0.3])
        assert values["resolution"] == pytest.approx([-0.25, -0.1])
        assert looked.beside(seen).is_agreement


def test_values_view_and_time_at_the_start(tmp_path):
    path = tmp_path / "page.html"
    start = {"params": {"softness": 0.2}, "view": "normal", "time": 2.5}
    loaded(SCENE).export(path, views=["color"], **start)
    with looked_at(path) as looked:
        state = looked.state()
        assert state["parameters"]["softness"] == pytest.approx(0.2)
        assert (state["view"], state["time"]) == ("normal", 2.5)
        assert looked.beside(example(SCENE)).is_agreement


def test_textures_and_buffers(written, tmp_path):
    texels = np.random.default_rng(1).integers(0, 256, (8, 8, 3), np.uint8)
    Image.fromarray(texels).save(tmp_path / "dots.png")
    path, seen = written(DATA)
    with looked_at(path) as looked:
        assert looked.beside(seen).is_agreement


def test_two_fragments_in_another_page(tmp_path):
    fragments = []
    for name in (IMAGE, SCENE):
        path = tmp_path / f"{name}.html"
        loaded(name).export(path, embed=True)
        fragments.append(path.read_text(encoding="utf-8"))
    assert "<html" not in fragments[0]
    box = '<div class="box" style="width:160px;height:120px">'
    around = f"""<!doctype html><meta charset="utf-8"><title>A blog</title>
<style>canvas {{ display: none }} button {{ color: red }} * {{ box-sizing: content-box }}</style>
<h1 id="c1">A blog</h1>{box}{fragments[0]}</div><p>between</p>{box}{fragments[1]}</div>
<div id="wide" style="width:200px">{fragments[0]}</div>"""
    host = tmp_path / "blog.html"
    host.write_text(around, encoding="utf-8")
    with looked_at(host, viewport={"width": 660, "height": 700}) as looked:
        for looked.number, name in enumerate((IMAGE, SCENE, IMAGE)):
            assert looked.beside(example(name)).is_agreement
            shape = looked.picture().shape[:2]
            assert shape == ((150, 200) if looked.number == 2 else (120, 160))
        assert looked.page.get_by_text("between").is_visible()
        heading = looked.page.locator("h1").evaluate("(h) => getComputedStyle(h).color")
        assert heading == "rgb(0, 0, 0)"


def test_a_page_without_any_rules_shows_no_script(tmp_path):
    path = tmp_path / "pebble.html"
    loaded(SCENE).export(path, embed=True)
    host = tmp_path / "bare.html"
    style = "<!doctype html><title>Bare</title><style>body * {all: unset}</style>"
    host.write_text(f"{style}<p>before</p>{path.read_text(encoding='utf-8')}", encoding="utf-8")
    with looked_at(host, viewport={"width": 160, "height": 300}) as looked:
        assert looked.picture().shape[:2] == (108, 144)
        assert looked.page.evaluate("document.body.innerText").strip() == "before"


def test_the_code_gives_the_same_picture(page, monkeypatch):
    with looked_at(page(SCENE), viewport={"width": 660, "height": 360}) as looked:
        looked.settle()  # from now on keys mean something
        slider = looked.page.get_by_role("slider", name="Softness")
        slider.focus()
        slider.press("PageUp")
        looked.page.locator("canvas").focus()
        for key in ("ArrowLeft", "ArrowUp", "+"):
            looked.page.keyboard.press(key)
        looked.settle()  # the guide answers later than the hand
        looked.page.get_by_role("combobox", name="View").select_option("normal")
        looked.page.evaluate("document.querySelector('[data-distal]').distal.setTime(1.25)")
        line = looked.page.evaluate("document.querySelector('[data-distal]').distal.code()")
        shown = looked.picture()
        words = ("softness", "time=1.25", 'view="normal"', "yaw=", "pitch=", "zoom=")
        assert [word for word in words if word not in line] == []
        # It runs beside the scene's file.
        before, after = 'import distal; distal.load("pebble.py").render(', ').save("pebble.png")'
        assert line.startswith(f"{before}params=")
        assert line.endswith(after)
        arguments = line.removeprefix(before).removesuffix(after)
        given = f"distal.load('pebble.py').render({shown.shape[1::-1]}, samples=1, {arguments})"
        monkeypatch.chdir(FOLDER.name)
        assert difference(eval(given, {"distal": distal}).array, shown).is_agreement
        exec(line, {})
        assert Image.open("pebble.png").size == (640, 480)


def test_a_page_can_ask_for_nothing_even_if_it_wants_to(page):
    with offline_page(page(IMAGE)) as watched:
        asked = """() => fetch("https://distal.invalid/").then(() => "sent", (e) => String(e))"""
        assert "TypeError" in watched.page.evaluate(asked)
        watched.settle()
        assert watched.requests == []
        assert any("Content Security Policy" in line for line in watched.messages)
