"""``distal slice``: files, texts, exit codes."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
from typer.testing import CliRunner

from distal.cli.application import application

PARTS = """\
from distal import Bolt, Circle, Cone, Plane, Rectangle, Scene, Sphere
from distal.lang import slider

bolt = Bolt("M6", 10.0)
cone = Cone(1.0, 2.0)
flat = Rectangle(3.0, 2.0) - Circle(0.5)
endless = Plane()
ball = Sphere(slider("size", 1.0, low=0.5, high=2.0))
scene = Scene(cone)
"""


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "parts.py").write_text(PARTS)
    return lambda *args: CliRunner().invoke(application, args)


def test_layers_in_a_folder_lie_on_each_other(run: Any) -> None:
    done = run("slice", "parts.py:scene", "--height", "0.5", "-o", "layers", "--tolerance", "0.01")
    assert done.exit_code == 0, done.output
    first, second = done.stderr.splitlines()
    assert first.startswith("layers: 4 layers, 4 closed lines, ")
    volume = float(second.removeprefix("volume about ").partition(",")[0])
    # The sum of discs at the middles of the layers.
    assert volume == pytest.approx(sum(0.5 * math.pi * r * r for r in _RADII), rel=0.02)
    names = sorted(path.name for path in Path("layers").iterdir())
    assert names == [f"layer-000{n}.svg" for n in range(1, 5)]
    frames = {ElementTree.parse(f"layers/{name}").getroot().get("viewBox") for name in names}
    assert frames == {"0 0 2 2"}
    again = run("slice", "parts.py:cone", "--height", "1", "-o", "layers", "--tolerance", "0.01")
    assert (
        "warning: layers also holds 2 layers of an earlier run, from layer-0003.svg" in again.stderr
    )


_RADII = (0.875, 0.625, 0.375, 0.125)


def test_layers_of_a_bolt_in_one_file(run: Any) -> None:
    done = run("slice", "parts.py:bolt", "--height", "1", "-o", "bolt.svg", "--json")
    assert done.exit_code == 0, done.output
    report = json.loads(done.stdout)
    layers = report["layers"]
    assert [layer["at"] for layer in layers] == pytest.approx([n - 9.5 for n in range(14)])
    # The head of M6 is a hexagon of 10 mm across flats; its lower layers have its area.
    head = [layer["area"] for layer in layers if 0.0 < layer["at"] < 3.0]
    assert head == pytest.approx([math.sqrt(3.0) / 2.0 * 100.0] * 3, rel=1e-4)
    # A thread is the same at each height but turned.
    thread = [layer["area"] for layer in layers if -8.0 < layer["at"] < -3.0]
    assert len(thread) == 5 and max(thread) - min(thread) < 0.01
    assert all(math.pi * 2.3**2 < area < math.pi * 3.0**2 for area in thread)
    assert report["warnings"] == []
    root = ElementTree.parse("bolt.svg").getroot()
    heights = [float(group.get("data-height", "")) for group in root]
    assert heights == pytest.approx([layer["at"] for layer in layers])


def test_a_flat_shape_and_one_slice(run: Any) -> None:
    done = run("slice", "parts.py:flat", "-o", "flat.dxf", "--unit", "cm")
    assert done.exit_code == 0, done.output
    assert done.stderr.splitlines()[0].startswith("flat.dxf: 2 closed lines, ")
    assert "\n15\n" in Path("flat.dxf").read_text()  # 1.5 cm in millimeters
    done = run("slice", "parts.py:ball", "--set", "size=2", "--at", "1.2", "-o", "b.svg", "--json")
    (layer,) = json.loads(done.stdout)["layers"]
    assert layer["area"] == pytest.approx(math.pi * 1.6**2, rel=1e-3)


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        ("parts.py:endless --height 1 -o e.svg", 1, "'Plane' has no end along y, and layers end"),
        (
            "parts.py:cone --at 5 -o e.svg",
            1,
            "error: nothing to save: 'Cone' has no inside at these places",
        ),
        (
            "parts.py:cone -o e.svg",
            2,
            "error: give --height, the height of the layers, or --at, the place of one slice",
        ),
        (
            "parts.py:cone --height 1 --at 0 -o e.svg",
            2,
            "error: --height is for layers, and --at for one slice: give one of them",
        ),
        (
            "parts.py:flat --height 1 -o e.svg",
            2,
            "error: 'difference' is flat: it has one outline, without --height and --at",
        ),
        (
            "parts.py:cone --height 1 -o e.png",
            1,
            "error: an outline is not saved as '.png': use one of .svg, .dxf",
        ),
        ("parts.py:cone --height 1 -o e.svg --unit mile", 1, "error: a unit is one of "),
        ("parts.py:cone --height 1 -o e.svg --axis w", 2, "error: --axis is x, y or z, not 'w'"),
        ("parts.py:cone --height 1 -o e --format pdf", 2, "--format is svg or dxf, not 'pdf'"),
        ("parts.py:cone --height -1 -o e.svg", 2, "error: --height is a length above 0, not -1"),
        ("parts.py:cone --height 1e-9 -o e.svg", 1, "and 100,000 are the most"),
        ("parts.py:cone --height 1 -o parts.py", 2, "error: 'parts.py' is the scene itself"),
        ("parts.py:cone --height 1 -o a/b/c", 1, "error: cannot make the folder a/b/c: "),
    ],
)
def test_mistakes_have_a_message(run: Any, arguments: str, code: int, message: str) -> None:
    done = run("slice", *arguments.split())
    assert done.exit_code == code, done.output
    assert message in done.stderr
    assert not Path("e.svg").exists()
