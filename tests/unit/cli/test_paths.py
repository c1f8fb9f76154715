"""``distal render --mode path``: its options, previews, and going on after an interruption."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from distal.cli import preview
from distal.cli.application import application
from distal.images import exr, picture_files, png

SCENE = """
from distal import Plane, PointLight, Scene, Sphere

lamp = PointLight((2, 3, 4), intensity=9.0, radius=1.0)
scene = Scene(Sphere(0.5).translate(y=0.5) | Plane(), lights=lamp)
"""


@pytest.fixture
def run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("scene.py").write_text(SCENE)
    return lambda *words: CliRunner().invoke(
        application, ("render", "scene.py:scene", "--size", "32x24", *words)
    )


def test_options_reach_the_picture(run):
    result = run(
        "-o", "a.png", "--mode", "path", "--spp", "8", "--filter", "box", "--clamp", "5",
        "--shutter", "0.1", "--no-caustics", "--stats",
    )  # fmt: skip
    assert result.exit_code == 0, result.output
    figures = json.loads(result.stdout)
    assert figures["samples"] == 8 and figures["clamp"] == 5.0
    origin = picture_files.read(Path("a.png")).provenance
    assert origin.paths == {
        "filter": "box",
        "clamp": 5.0,
        "shutter": 0.1,
        "caustics": False,
    }
    assert not Path("a.png.film").exists()


@pytest.mark.parametrize("mode", ["direct", "path"])
def test_longest_name_of_a_file_is_possible(run, mode):
    name = "x" * 250 + ".png"
    words = ["--spp", "1"] if mode == "path" else []
    result = run("-o", name, "--mode", mode, *words)
    assert result.exit_code == 0, result.output
    assert sorted(map(str, Path().iterdir())) == ["scene.py", name]
    result = run("-o", "x" * 296 + ".png", "--mode", mode, *words)
    assert result.exit_code == 1
    assert result.stderr == f"error: cannot write {'x' * 296}.png: File name too long\n"


def test_direct_light_leaves_a_film_alone(run):
    Path("a.png.film").write_bytes(b"samples of an hour")
    assert run("-o", "a.png").exit_code == 0
    assert Path("a.png.film").read_bytes() == b"samples of an hour"


def test_a_biased_picture_is_said_to_be_so(run):
    result = run("-o", "a.png", "--mode", "path", "--spp", "8", "--clamp", "5")
    assert result.stderr.splitlines()[-1] == (
        "samples brighter than 5 were scaled to it: the picture is biased"
    )
    assert "8 samples, error 0." in result.stderr


def test_an_exr_of_paths_holds_their_samples(run):
    pytest.importorskip("OpenEXR", reason="EXR files need it: pip install 'distal[exr]'")
    assert run("-o", "a.exr", "--mode", "path", "--spp", "8").exit_code == 0
    held = exr.decode(Path("a.exr").read_bytes())
    assert (held["samples"] == 8).all() and "variance" in held and "albedo.R" in held
    assert run("-o", "b.exr").exit_code == 0
    assert "samples" not in exr.decode(Path("b.exr").read_bytes())


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--filter", "sinc"), "there is no filter 'sinc'; filters: tent, box, gaussian, "),
        (("--mode", "direct", "--filter", "box"), "filter is for mode 'path'"),
        (("--mode", "direct", "--denoise"), "denoise is for mode 'path'"),
        (("--clamp", "0"), "clamp is a number above 0, not 0.0"),
        (("--shutter", "-1"), "shutter is 0 or a number above 0, not -1.0"),
    ],
)
def test_options_that_make_no_sense(run, words, message):
    mode = () if "--mode" in words else ("--mode", "path")
    result = run("-o", "a.png", *mode, *words)
    assert result.exit_code == 2
    assert result.stderr.startswith(f"error: {message}")


def test_a_missing_denoiser_says_how_to_install_it(run, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyoidn", None)
    result = run("-o", "a.png", "--mode", "path", "--denoise")
    assert result.exit_code == 1
    assert result.stderr == "error: pyoidn is missing: pip install 'distal[denoise]'\n"


def test_a_picture_of_paths_is_rendered_again(run):
    first = run("-o", "a.png", "--mode", "path", "--noise", "0.01", "--filter", "mitchell")
    assert first.exit_code == 0, first.output
    result = CliRunner().invoke(application, ("rerender", "a.png", "--check"))
    assert (result.exit_code, result.stdout) == (0, "a.png: identical\n")


def test_ctrl_c_leaves_the_picture_so_far(run, tmp_path):
    command = [
        sys.executable, "-m", "distal.cli", "render", "scene.py:scene", "--size", "160x120",
        "--mode", "path", "-o", "a b.png", "--spp",
    ]  # fmt: skip
    process = subprocess.Popen([*command, "60000"], stderr=subprocess.PIPE, text=True)
    begin = time.monotonic()
    while not Path("a b.png").exists() and process.poll() is None:
        assert time.monotonic() - begin < 120.0
        time.sleep(0.05)
    time.sleep(0.2)
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=60)
    assert process.returncode == 130
    before, after = said.splitlines()
    assert before.startswith("a b.png: broken off after ") and "samples, error " in before
    assert after.startswith("a b.png.film keeps them; go on with: distal render scene.py:scene ")
    assert after.endswith(" --spp 60000 --continue") and "-o 'a b.png'" in after
    assert png.decode(Path("a b.png").read_bytes()).shape == (120, 160, 4)
    with np.load("a b.png.film") as found:
        samples = int(found["samples"].max())
    assert f"after {samples} samples" in before
    more = [*command, str(samples + 16), "--continue"]
    assert subprocess.run(more, capture_output=True, check=False).returncode == 0
    with np.load("a b.png.film") as found:
        assert int(found["samples"].min()) == samples + 16


def test_figures_are_described():
    assert preview.described({"samples": 1, "noise": None}) == "1 sample"
    assert preview.described({"samples": 70.51, "noise": 0.0123}) == "70.5 samples, error 0.012"
    assert preview.described({"samples": 65536, "noise": None}) == "65536 samples"
    assert preview.continued(["/bin/distal", "render", "--continue", "a b"]) == (
        "distal render 'a b' --continue"
    )
