"""Exported shaders, put into their places as they are, show what the CPU shows."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import distal
from distal.file_writer import SaveError
from tests.browser import BrowserUnavailableError
from tests.browser import browser as running_browser
from tests.export import hosts
from tests.pictures.comparison import difference

SIZE = (96, 72)
HOSTS = {"shadertoy": hosts.shadertoy, "glslcanvas": hosts.glsl_canvas, "isf": hosts.isf}
TEXTS = {"shadertoy": ".glsl", "glslcanvas": ".frag", "isf": ".fs"}

# All kinds of parameters, names that a place keeps for itself, and a text that would end a comment.
CONTROLS = '''
from distal.lang import *

softness = slider("Softness", 0.3, 0.05, 1.0)
mode = choice("Mode */ of it", ["one */ two", "\\"three\\" <b>"], 1)
count = integer("Count", 3, 1, 9)
many = integer("Many", 30, 0, 1000)
is_on = toggle("Input", True)
tint = color("Tint", "#ff8040")
place = point("Place", (0.2, 0.1, 0.3))
spot = point("RENDERSIZE", (0.2, -0.1))
clock = slider("TIME", 0.5)


@image
def picture(frame: Frame) -> vec3:
    """Rings."""
    uv = (2.0 * frame.coord - frame.resolution) / frame.resolution.y
    d = length(uv - spot - place.xy * place.z) - softness
    shown = tint * smoothstep(0.2, -0.2, d)
    for i in range(count):
        shown += 0.05 * sin(float(i) * uv.x * 9.0 + frame.time)
    if is_on and mode == 1:
        shown += vec3(0.0, 0.1, 0.2 * clock)
    return shown + 0.001 * float(many)
'''

TEXTURED = """
from distal.lang import *

dots = Texture2D("dots.png")
edge = Texture2D("dots.png", wrap="clamp")


@image
def picture(frame: Frame) -> vec3:
    uv = 1.7 * frame.coord / frame.resolution - 0.2
    return sample(dots, uv).rgb if uv.x < 0.6 else sample(edge, uv).rgb
"""


@pytest.fixture(scope="module", autouse=True)
def browser():
    try:
        return running_browser()
    except BrowserUnavailableError as error:
        pytest.skip(f"no browser: {error}")


@pytest.fixture
def scene(tmp_path):
    def load(text: str, name: str = "rings.py"):
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        return distal.load(path)

    return load


def exported(obj, tmp_path: Path, target: str, **options) -> str:
    path = tmp_path / f"out{TEXTS[target]}"
    obj.export(path, target=target, **options)
    return path.read_text(encoding="utf-8")


@pytest.mark.parametrize("target", HOSTS)
@pytest.mark.parametrize("name", ["raymarcher", "raymarcher_objects", "melting"])
def test_it_shows_what_the_cpu_shows(tmp_path, target, name):
    obj = distal.load(f"example:{name}")
    text = exported(obj, tmp_path, target)
    shown = HOSTS[target](text, SIZE, 1.25)
    expected = obj.render(SIZE, time=1.25, samples=1)
    assert difference(expected.array, shown).is_agreement


@pytest.mark.parametrize("target", HOSTS)
def test_parameters_of_every_kind(scene, tmp_path, target):
    picture = scene(CONTROLS)
    shown = HOSTS[target](exported(picture, tmp_path, target), SIZE, 0.5)
    assert difference(picture.render(SIZE, samples=1, time=0.5).array, shown).is_agreement
    values = {"softness": 0.6, "tint": "#20c0ff", "spot": (-0.3, 0.2), "count": 7}
    values = {"rendersize" if name == "spot" else name: v for name, v in values.items()}
    shown = HOSTS[target](exported(picture, tmp_path, target, params=values), SIZE, 0.5)
    assert difference(
        picture.render(SIZE, samples=1, time=0.5, params=values).array, shown
    ).is_agreement


def test_isf_has_an_input_of_the_right_type_for_each_parameter(scene, tmp_path):
    picture = scene(CONTROLS)
    text = exported(picture, tmp_path, "isf")
    told = hosts.isf_header(text)
    assert told["ISFVSN"] == "2"
    assert told["CREDIT"] == "rings.py"
    inputs = {one["LABEL"]: one for one in told["INPUTS"]}
    types = {label: one["TYPE"] for label, one in inputs.items()}
    assert types == {
        "Softness": "float",
        "Mode */ of it": "long",
        "Count": "long",
        "Many": "long",
        "Input": "bool",
        "Tint (linear)": "color",
        "Place x": "float",
        "Place y": "float",
        "Place z": "float",
        "RENDERSIZE": "point2D",
        "TIME": "float",
    }
    softness, mode, count = inputs["Softness"], inputs["Mode */ of it"], inputs["Count"]
    assert [softness[key] for key in ("DEFAULT", "MIN", "MAX")] == [0.3, 0.05, 1.0]
    assert (mode["VALUES"], mode["DEFAULT"]) == ([0, 1], 1)
    assert mode["LABELS"] == ["one */ two", '"three" <b>']
    assert count["VALUES"] == list(range(1, 10)) and "VALUES" not in inputs["Many"]
    moved = {
        softness["NAME"]: 0.6,
        mode["NAME"]: 0,
        count["NAME"]: 5,
        inputs["Tint (linear)"]["NAME"]: (0.1, 0.5, 0.9, 1.0),
        inputs["Place y"]["NAME"]: -0.8,
        inputs["RENDERSIZE"]["NAME"]: (-0.4, 0.3),
        inputs["TIME"]["NAME"]: 0.9,
    }
    params = {
        "softness": 0.6,
        "mode_of_it": 0,
        "count": 5,
        "tint": (0.1, 0.5, 0.9),
        "place": (0.2, -0.8, 0.3),
        "rendersize": (-0.4, 0.3),
        "time": 0.9,
    }
    shown = hosts.isf(text, SIZE, 0.5, moved)
    assert difference(
        picture.render(SIZE, samples=1, time=0.5, params=params).array, shown
    ).is_agreement


@pytest.mark.parametrize("target", HOSTS)
def test_textures(scene, tmp_path, target):
    x, y = np.meshgrid(*2 * [np.arange(64) / 64.0 * 2.0 * np.pi])
    waves = [0.5 + 0.4 * np.sin(x), 0.5 + 0.4 * np.sin(x + 2.0 * y), 0.2 + 0.02 * y, 1.0 + 0.0 * x]
    texels = np.ascontiguousarray(255.0 * np.stack(waves, axis=-1), dtype=np.uint8)
    Image.fromarray(texels).save(tmp_path / "dots.png")
    # One wrap for all there: a place knows none of each texture's own.
    text = TEXTURED if target == "isf" else TEXTURED.replace('wrap="clamp"', 'wrap="repeat"')
    picture = scene(text, "dots.py")
    written = exported(picture, tmp_path, target)
    # What the host is given is what was written beside the text.
    beside = {p.name: np.asarray(Image.open(p).convert("RGBA")) for p in tmp_path.glob("out.*.png")}
    assert len(beside) == 2 and all((p == texels).all() for p in beside.values())
    assert all(name in written for name in beside)
    bottom_first = np.ascontiguousarray(texels[::-1])
    names = {"shadertoy": "iChannel{}", "glslcanvas": "u_tex{}"}
    bound = {names[target].format(i): bottom_first for i in range(2)} if target in names else {}
    if target == "isf":
        imported = hosts.isf_header(written)["IMPORTED"]
        assert [one["PATH"] for one in imported.values()] == ["out.dots.png", "out.edge.png"]
        bound = dict.fromkeys(imported, bottom_first)
    shown = HOSTS[target](written, SIZE, textures=bound)
    found = difference(picture.render(SIZE, samples=1).array, shown)
    # An ISF host wraps nothing: our text does, and at the seam nothing is blended for half a texel.
    seam = 2.0 * 1.7 / 64.0 if target == "isf" else 0.0
    assert found.mean <= 1.0
    assert found.far_off <= seam + 0.002


@pytest.mark.parametrize(
    "target", ["shadertoy", "glslcanvas", "isf", "glsl-es300", "glsl-330", "wgsl", "wgsl-compute"]
)
def test_the_head_says_how_to_use_it_and_no_path(scene, tmp_path, target):
    picture = scene(CONTROLS)
    path = tmp_path / "out.txt"
    made = picture.export(path, target=target)
    text = path.read_text(encoding="utf-8")
    head = "".join(re.findall(r"/\*.*?\*/", text, re.DOTALL))
    assert "rings.py, written by distal" in head
    assert "softness" in head
    assert all(str(tmp_path) not in p.read_text(encoding="utf-8") for p in (path, *made.beside))
    vertices = {"glsl-es300", "glsl-330"}
    assert (path.with_suffix(".vert") in made.beside) == (target in vertices)


def test_a_file_called_to_end_the_comment(scene, tmp_path):
    picture = scene(CONTROLS, "end*.py")
    text = exported(picture, tmp_path, "shadertoy")
    assert difference(
        picture.render(SIZE, samples=1).array, hosts.shadertoy(text, SIZE)
    ).is_agreement


@pytest.mark.parametrize(
    ("name", "target", "whose"),
    [
        ("a.vert", "glsl-330", "vertex stage"),
        ("a.json", "wgsl", "interface"),
        ("a.json", "glsl-es300", "interface"),
    ],
)
def test_the_text_never_takes_the_place_of_what_stands_beside_it(
    scene, tmp_path, name, target, whose
):
    picture = scene(CONTROLS)
    known = sorted(tmp_path.iterdir())
    with pytest.raises(SaveError, match=f"its {whose} goes there; give it another suffix"):
        picture.export(tmp_path / name, target=target)
    assert sorted(tmp_path.iterdir()) == known


@pytest.mark.parametrize("target", ["shadertoy", "isf"])
def test_another_view(tmp_path, target):
    obj = distal.load("example:raymarcher_objects")
    text = exported(obj, tmp_path, target, view="normal")
    shown = HOSTS[target](text, SIZE)
    assert difference(obj.render(SIZE, view="normal").array, shown).is_agreement
