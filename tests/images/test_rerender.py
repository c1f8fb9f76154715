"""Pictures rendered again: equal to the last bit, or refused in one line."""

import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from PIL.PngImagePlugin import PngInfo
from typer.testing import CliRunner

import distal
from distal.cli.application import application
from distal.images.picture_files import read
from distal.lang import Key, Keys
from distal.lang.render_options import RenderOptions
from distal.runtime.frame_history import LiveFrames
from distal.scene.rerender import difference, plan_rerender, rerender
from distal.scene.steering import Steering
from distal.scene.viewing.viewable import viewable

SCENE = """\
from distal import Camera, Plane, Scene, Sphere, time
from distal.lang import slider
from tones import TONE
size = slider("Size", 0.7, 0.1, 2.0)
ball = Sphere(size).paint(TONE)
scene = Scene(
    [ball.translate(time, 0.0, 0.0), Plane(y=-0.7)], camera=Camera((0, 1, 4)), name="stage"
)
"""

IMAGE = """\
from distal.lang import Frame, image, vec3

@image
def picture(frame: Frame) -> vec3:
    place = frame.coord / frame.resolution
    height = place.y + float(frame.index) * 0.01
    return vec3(height, place.x, frame.mouse.x * 0.01 + frame.time)
"""


@pytest.fixture
def run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("scene.py").write_text(SCENE)
    Path("tones.py").write_text("TONE = (0.8, 0.3, 0.1)\n")
    Path("image.py").write_text(IMAGE)
    return lambda *words: CliRunner().invoke(application, words)


def render(run, *words, scene="scene.py:scene", size="24x16"):
    result = run("render", scene, "--size", size, *words)
    assert result.exit_code == 0, result.output


def pixels(path):
    with Image.open(path) as image:
        return np.asarray(image)


@pytest.mark.parametrize(
    "words",
    [
        (),
        ("--bits", "16"),
        ("--time", "0.25", "--set", "size=0.4"),
        ("--samples", "5", "--transparent"),
        ("--slice", "y=0.125"),
        ("--view", "normal"),
        ("--exposure", "1.5", "--tone-map", "aces"),
        ("--device", "reference"),
    ],
    ids=lambda words: " ".join(words) or "plain",
)
def test_rerendered_png_is_the_same_file(run, words):
    render(run, "-o", "a.png", *words)
    result = run("rerender", "a.png")
    assert result.exit_code == 0, result.output
    assert Path("a.rerendered.png").read_bytes() == Path("a.png").read_bytes()
    render(run, "-o", "other.png")
    if words and "--bits" not in words and "reference" not in words:
        assert not np.array_equal(pixels("a.png"), pixels("other.png"))


def test_shape_on_its_stage_and_image_with_a_view(run):
    render(run, "-o", "a.png", "--set", "size=1.5", scene="scene.py:ball")
    render(run, "-o", "b.png", "--view", "local:height", "--time", "0.5", scene="image.py")
    for name in "ab":
        assert run("rerender", f"{name}.png").exit_code == 0
        assert Path(f"{name}.png").read_bytes() == Path(f"{name}.rerendered.png").read_bytes()


def test_jpeg_keeps_how_it_was_made(run):
    render(run, "-o", "a.jpg", "--time", "0.25")
    assert run("rerender", "a.jpg").exit_code == 0
    assert Path("a.jpg").read_bytes() == Path("a.rerendered.jpg").read_bytes()
    assert run("rerender", "a.jpg", "--check").stdout == "a.jpg: identical\n"
    with Image.open("a.jpg") as image:
        image.rotate(180).save("a.jpg", comment=image.info["comment"])
    assert "% of the pixels differ" in run("rerender", "a.jpg", "--check").stdout
    Path("a.jpg").write_bytes(Path("a.jpg").read_bytes()[:200])
    broken = run("rerender", "a.jpg")
    assert broken.exit_code == 1 and broken.stderr.count("\n") == 1


def test_exr_keeps_its_light_its_layers_and_its_bits(run):
    pytest.importorskip("OpenEXR", reason="OpenEXR is not installed")
    render(run, "-o", "a.exr", "--bits", "32", "--layers", "depth,material")
    assert run("rerender", "a.exr").exit_code == 0
    assert read(Path("a.rerendered.exr")) == read(Path("a.exr"))
    assert read(Path("a.exr")).bits == 32
    assert read(Path("a.exr")).provenance.layers == ("depth", "material")
    assert run("rerender", "a.rerendered.exr", "--check").stdout == "a.rerendered.exr: identical\n"


def test_frame_mouse_seed_and_index_of_python_are_kept(run):
    picture = distal.load("image.py").render(
        size=(8, 6), time=0.125, mouse=(25.0, 1.0, 0.0, 0.0), index=7, seed=9
    )
    picture.save("a.png")
    origin = read(Path("a.png")).provenance
    assert (origin.index, origin.seed, origin.mouse) == (7, 9, (25.0, 1.0, 0.0, 0.0))
    again = rerender(plan_rerender(Path("a.png")))
    assert np.array_equal(again.array, picture.array)


KEPT = """\
from distal.lang import Frame, Key, buffer, image, ivec2, key_held, key_pressed, texel, vec4

@buffer
def sums(frame: Frame) -> vec4:
    held = 1.0 if key_held(Key.LEFT) else 0.0
    pressed = 0.5 if key_pressed(Key.SPACE) else 0.0
    day = frame.date.x * 0.001
    step = vec4(frame.delta, 0.1 * held + pressed, 0.05 * float(frame.buttons) + day, 1.0)
    return texel(sums, ivec2(0, 0)) + step

@image
def kept(frame: Frame) -> vec4:
    return texel(sums, ivec2(0, 0))
"""


@pytest.mark.parametrize(
    "values",
    [
        {"delta": 0.125},
        {"keys": Keys(held=frozenset({37}), pressed=frozenset({32}))},
        {"keys": [Key.LEFT]},
        {"buttons": 3},
        {"date": (20.0, 0.0, 0.0, 0.0)},
        {"delta": 0.0625, "keys": [37], "buttons": 1},
    ],
    ids=lambda values: "+".join(values),
)
def test_what_a_frame_reads_is_kept(run, values):
    Path("kept.py").write_text(KEPT)
    seen = viewable(distal.load("kept.py"))
    still = {"size": (4, 3), "index": 3, "time": 0.5}
    picture = seen.render(RenderOptions(**still, **values))
    picture.save("a.png")
    again = rerender(plan_rerender(Path("a.png")))
    assert np.array_equal(again.array, picture.array)
    assert again.provenance == picture.provenance
    # The values are seen: without them the picture is another one.
    assert not np.array_equal(seen.render(RenderOptions(**still)).array, picture.array)


def test_a_frame_of_a_video_is_made_again(run):
    Path("kept.py").write_text(KEPT)
    distal.load("kept.py").video("f_%d.png", duration=0.25, fps=12, size=(4, 3))
    assert run("rerender", "f_2.png", "--check").stdout == "f_2.png: identical\n"


def test_a_frame_that_a_window_drew_says_so(run):
    Path("kept.py").write_text(KEPT)
    seen, live = viewable(distal.load("kept.py")), LiveFrames()
    for time in (0.0, 0.5):
        picture = seen.render(RenderOptions(size=(4, 3), time=time, history=live))
    picture.save("a.png")
    result = run("rerender", "a.png")
    assert result.exit_code == 0
    assert (
        "note: a.png was drawn frame by frame by hand, of which it does not tell: its earlier "
        "frames are computed with its last keys, mouse and parameters\n"
    ) in result.stderr


def test_camera_that_was_moved_by_hand_is_kept(run):
    shown = viewable(distal.load("scene.py", "scene"))
    moved = Steering(yaw=0.3, pitch=0.1, zoom=0.75, pan=(0.1, -0.2))
    options = RenderOptions(size=(24, 16))
    picture = shown.render(replace(options, steering=moved))
    picture.save("a.png")
    again = rerender(plan_rerender(Path("a.png")))
    assert np.array_equal(again.array, picture.array)
    assert not np.array_equal(again.array, shown.render(options).array)


def test_stage_is_as_large_as_it_was_when_the_shape_was_shown(run):
    shown = viewable(distal.load("scene.py", "ball"))  # staged for the default size
    picture = shown.render(RenderOptions(size=(24, 16), params={"size": 0.3}))
    picture.save("a.png")
    again = rerender(plan_rerender(Path("a.png")))
    assert np.array_equal(again.array, picture.array)


def test_frames_of_a_sequence(run):
    result = run(
        *("video", "scene.py:scene", "-o", "frames/%03d.png", "--duration", "0.3"),
        *("--fps", "10", "--size", "24x16"),
    )
    assert result.exit_code == 0, result.output
    frames = sorted(Path("frames").glob("*.png"))
    assert len(frames) == 3
    result = run("rerender", str(frames[2]), "--check")
    assert (result.exit_code, result.stdout) == (0, f"{frames[2]}: identical\n")
    assert read(frames[2]).provenance.index == 2


def test_other_size_and_samples(run):
    render(run, "-o", "a.png")
    result = run("rerender", "a.png", "--size", "48x32", "--samples", "4", "-o", "b.png")
    assert result.exit_code == 0, result.output
    render(run, "-o", "c.png", "--samples", "4", size="48x32")
    assert Path("b.png").read_bytes() == Path("c.png").read_bytes()
    assert run("rerender", "a.png", "--samples", "2", "--check").exit_code == 2


def test_check_writes_nothing_and_measures_the_difference(run):
    render(run, "-o", "a.png")
    before = set(Path().iterdir())
    result = run("rerender", "a.png", "--check")
    assert (result.exit_code, result.stdout) == (0, "a.png: identical\n")
    assert set(Path().iterdir()) == before
    with Image.open("a.png") as image:
        texts, changed = image.info, np.array(image)
    changed[0, 0, 1] ^= 51  # a fifth of the range, in one of 384 pixels
    information = PngInfo()
    for key, text in texts.items():
        if isinstance(text, str):
            information.add_text(key, text)
    Image.fromarray(changed).save("b.png", pnginfo=information)
    level = int(changed[0, 0, 1])
    largest = abs((level ^ 51) - level) / 255.0
    result = run("rerender", "b.png", "--check")
    assert result.exit_code == 1
    assert result.stdout == f"b.png: 0.26 % of the pixels differ, by up to {largest:.3g}\n"
    found = difference(plan_rerender(Path("b.png")), rerender(plan_rerender(Path("b.png"))))
    assert (found.largest, found.share) == (pytest.approx(largest), 1 / 384)


@pytest.mark.parametrize("file", ["scene.py", "tones.py"])
def test_source_that_has_changed_is_refused_before_it_runs(run, file):
    render(run, "-o", "a.png")
    Path(file).write_text(Path(file).read_text() + "open('ran', 'w')\n")
    result = run("rerender", "a.png")
    assert result.exit_code == 1
    assert result.stderr == (
        "error: scene.py:scene or what it imports (tones.py) is not what a.png was rendered of: "
        "it has changed since; --force renders it as it is now\n"
    )
    assert not Path("ran").exists()
    result = run("rerender", "a.png", "--force")
    assert result.exit_code == 0
    assert "note: scene.py:scene or what it imports (tones.py) is not what a.png" in result.stderr
    assert Path("ran").exists()
    again, then = (read(Path(f"a{mark}.png")).provenance for mark in (".rerendered", ""))
    assert again.source_hash != then.source_hash


def test_line_ends_of_another_system_are_no_change(run):
    render(run, "-o", "a.png")
    for name in ("scene.py", "tones.py"):
        Path(name).write_bytes(Path(name).read_bytes().replace(b"\n", b"\r\n"))
    assert run("rerender", "a.png", "--check").exit_code == 0


def test_source_is_found_beside_the_picture_and_here(run):
    render(run, "-o", "a.png")
    elsewhere = Path("elsewhere")
    elsewhere.mkdir()
    os.replace("a.png", elsewhere / "a.png")
    assert run("rerender", "elsewhere/a.png", "--check").exit_code == 0
    # A file of that name beside the picture that is another one does not get in the way.
    (elsewhere / "scene.py").write_text("scene = 1\n")
    assert run("rerender", "elsewhere/a.png", "--check").exit_code == 0
    os.replace("scene.py", elsewhere / "scene.py")
    os.replace("tones.py", elsewhere / "tones.py")
    assert run("rerender", "elsewhere/a.png", "--check").exit_code == 0
    os.replace(elsewhere / "scene.py", elsewhere / "moved.py")
    result = run("rerender", "elsewhere/a.png")
    assert result.exit_code == 1
    assert result.stderr == (
        "error: cannot rebuild elsewhere/a.png: there is no scene.py:scene, neither beside it nor "
        "here; name it: --source FILE[:NAME]\n"
    )
    result = run("rerender", "elsewhere/a.png", "--source", "elsewhere/moved.py:scene")
    assert result.exit_code == 0, result.output
    assert read(elsewhere / "a.rerendered.png").provenance.source == "elsewhere/moved.py:scene"


def test_path_is_stored_as_it_was_given(run, tmp_path):
    render(run, "-o", "a.png")
    assert read(Path("a.png")).provenance.source == "scene.py:scene"
    assert str(tmp_path).encode() not in Path("a.png").read_bytes()
    assert run("rerender", "a.png").exit_code == 0
    assert str(tmp_path).encode() not in Path("a.rerendered.png").read_bytes()


def test_example_is_found_by_its_name(run):
    render(run, "-o", "a.png", scene="example:raymarcher")
    assert run("rerender", "a.png", "--check").stdout == "a.png: identical\n"


def test_picture_of_python_names_no_file(run):
    distal.Scene(distal.Sphere(1.0)).render(size=(8, 6)).save("a.png")
    result = run("rerender", "a.png")
    assert result.stderr == (
        "error: cannot rebuild a.png: it names no .py file, only 'scene'; name it: "
        "--source FILE[:NAME]\n"
    )


def test_parameter_that_is_gone_is_named(run):
    render(run, "-o", "a.png", "--set", "size=0.5")
    text = Path("scene.py").read_text().replace('slider("Size", 0.7, 0.1, 2.0)', "0.7")
    Path("scene.py").write_text(text)
    result = run("rerender", "a.png", "--force")
    assert result.exit_code == 1
    last = result.stderr.splitlines()[-1]
    assert last == ("error: cannot rebuild a.png: there is no parameter 'size'; parameters: none")


def with_texts(path, **changes):
    """A picture's file with other texts: ``None`` leaves one out."""
    with Image.open(path) as image:
        texts = {k: v for k, v in image.info.items() if isinstance(v, str)}
        for key, value in changes.items():
            texts[f"distal:{key.replace('_', '-')}"] = value
        information = PngInfo()
        for key, value in texts.items():
            if value is not None:
                information.add_text(key, value)
        image.save(path, pnginfo=information)


@pytest.mark.parametrize(
    "changes",
    [
        {"parameters": "{"},
        {"parameters": "[1]"},
        {"time": "soon"},
        {"time": "nan"},
        {"mouse": "[1, 2]"},
        {"mouse": "[1, 2, 3, Infinity]"},
        {"plane": "7"},
        {"steering": '"up"'},
        {"size": "-1x4"},
        {"stage": "[]"},
        {"samples": "1e3"},
        {"keys": "[[1]]"},
        {"keys": "[[300], [], []]"},
        {"keys": '[["a"], [], []]'},
        {"delta": "nan"},
        {"buttons": "left"},
        {"date": "[1]"},
        {"parameters": "[" * 100000},
    ],
    ids=lambda changes: f"{changes}"[:40],
)
def test_garbled_texts_are_told_in_one_line(run, changes):
    render(run, "-o", "a.png", size="4x4")
    with_texts("a.png", **changes)
    result = run("rerender", "a.png")
    assert result.exit_code == 1
    told = "error: cannot rebuild a.png: what it says about itself is garbled\n"
    assert result.stderr == told


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"size": "0x4"}, "each side has 1 to 16384 pixels, not 0x4"),
        ({"delta": "-1.0"}, "delta is the seconds between two frames, more than 0, not -1"),
        ({"size": "99999x4"}, "each side has 1 to 16384 pixels"),
        ({"samples": "0"}, "a pixel has 1 to 65536 samples, not 0"),
        ({"view": "moon"}, "there is no view 'moon'"),
        ({"layers": "smell"}, "there is no layer 'smell'"),
        ({"device": "abacus"}, "there is no device 'abacus'"),
        ({"tone_map": "sepia"}, "there is no tone map 'sepia'"),
        ({"parameters": json.dumps({"size": 99.0})}, "'Size'"),
        ({"steering": "[0, 0, 0, 0, 0]"}, "zoom is a factor above 0"),
        ({"source": "\0"}, "it names no .py file, only '\\x00'"),
        ({"source": "nowhere/" * 2000 + "a.py"}, "there is no"),
        ({"neighbors": '["/dev/zero", "../../x"]'}, "it has changed since"),
    ],
    ids=lambda value: f"{value}"[:40],
)
def test_texts_out_of_reach_are_told_without_a_traceback(run, changes, words):
    render(run, "-o", "a.png", size="4x4")
    with_texts("a.png", **changes)
    result = run("rerender", "a.png")
    assert result.exit_code == 1, result.output
    assert not result.exception or isinstance(result.exception, SystemExit)
    assert words in result.stderr


def test_stripped_and_foreign_files(run):
    render(run, "-o", "a.png")
    with Image.open("a.png") as image:
        image.save("b.png")
        image.save("c.jpg")
    Path("d.png").write_text("no picture")
    Path("e.png").write_bytes(b"")
    stripped = "does not say how it was made: not a picture of distal's, or its metadata was strip"
    for name, words in {
        "b.png": stripped,
        "c.jpg": stripped,
        "d.png": "d.png is no PNG, JPEG or EXR",
        "e.png": "e.png is no PNG, JPEG or EXR",
        "f.png": "cannot read f.png: No such file",
        ".": "cannot read .: Is a directory",
    }.items():
        result = run("rerender", name)
        assert result.exit_code == 1
        assert words in result.stderr
        assert result.stderr.count("\n") == 1


def test_picture_that_was_scaled_since_is_rebuilt_at_its_own_size(run):
    render(run, "-o", "a.png")
    with Image.open("a.png") as image:
        information = PngInfo()
        for key, value in image.info.items():
            if isinstance(value, str):
                information.add_text(key, value)
        image.resize((12, 8)).save("b.png", pnginfo=information)
    result = run("rerender", "b.png", "--check")
    assert result.exit_code == 1
    assert result.stderr == "error: cannot compare b.png: it is 12x8, the picture 24x16\n"
    assert run("rerender", "b.png").exit_code == 0
    assert np.array_equal(pixels("b.rerendered.png"), pixels("a.png"))


def test_another_version_is_said(run):
    render(run, "-o", "a.png")
    with_texts("a.png", version="0.0.1")
    result = run("rerender", "a.png", "--check")
    assert result.exit_code == 0
    assert f"note: a.png was made by distal 0.0.1, this is {distal.__version__}" in result.stderr


def test_layers_go_into_an_exr_only(run):
    result = run("render", "scene.py:scene", "-o", "a.png", "--layers", "depth")
    assert result.exit_code == 2
    assert result.stderr == "error: layers are for an .exr, not for a .png\n"
    pytest.importorskip("OpenEXR", reason="OpenEXR is not installed")
    result = run("render", "image.py", "-o", "a.exr", "--layers", "depth")
    assert result.stderr == "error: --layers is for scenes and shapes; 'picture' is an @image\n"
    result = run("render", "scene.py:scene", "-o", "a.exr", "--layers", "dept")
    assert result.stderr == (
        "error: there is no layer 'dept'; layers: depth, normal, albedo, material, samples, "
        "variance\n"
    )
    for words, layers in {
        ("scene.py:scene",): ("depth", "normal", "albedo", "material"),
        ("scene.py:scene", "--layers", "none"): (),
        ("scene.py:scene", "--view", "depth"): (),
        ("image.py",): (),
    }.items():
        render(run, "-o", "a.exr", *words[1:], scene=words[0], size="4x4")
        assert read(Path("a.exr")).provenance.layers == layers


def test_everything_is_the_same_in_another_process(run, tmp_path):
    render(run, "-o", "a.png", "--samples", "3")
    made = subprocess.run(
        [*(sys.executable, "-m", "distal.cli"), "rerender", "a.png", "-o", "b.png"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
    )
    assert made.returncode == 0, made.stderr
    assert Path("a.png").read_bytes() == Path("b.png").read_bytes()
