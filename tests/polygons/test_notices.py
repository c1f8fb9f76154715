"""What a command prints of a mesh or a volume: one line, once for each content."""

import re
import subprocess
import sys

import numpy as np
import pytest

from distal import Shape
from distal.lang import notices
from distal.mesh.files.formats import write
from tests.mesh.sample_solids import Sample, box, sphere

SCENE = """\
import numpy as np
from distal import Shape

z, y, x = np.mgrid[-1:1:8j, -1:1:8j, -1:1:8j]
ball = Shape.from_volume(np.sqrt(x * x + y * y + z * z) - 0.5, spacing=2 / 7)
part = Shape.from_mesh("a.stl", spacing=0.13)
again = Shape.from_mesh("a.stl", spacing=0.13)
scene = part | again | ball
"""


@pytest.fixture
def lines(monkeypatch):
    found = []
    monkeypatch.setattr(notices, "_hosts", [found.append])
    monkeypatch.setattr(notices, "_given", set())
    return found


def test_a_command_prints_one_line_for_each_import(tmp_path):
    write(tmp_path / "a.stl", Sample(*box()))
    (tmp_path / "scene.py").write_text(SCENE)
    code = "import sys; from distal.cli import main; sys.exit(main())"
    done = subprocess.run(
        [
            sys.executable,
            "-c",
            code,
            "compile",
            "scene.py:scene",
            "--target",
            "wgsl",
            "-o",
            "a.txt",
        ],
        capture_output=True,
        text=True,
        cwd=tmp_path,
    )
    assert done.returncode == 0 and done.stdout == ""
    # On a busy machine a warning comes in between, that the file is still running.
    first, second = (line for line in done.stderr.splitlines() if line.startswith("note:"))
    assert first == (
        "note: 'array' has 8 x 8 x 8 samples, 0.2857 x 0.2857 x 0.2857 apart: between them it is "
        "interpolated, and parts thinner than 0.2857 may be missing; more samples are finer, or "
        "spacing= if they are another distance apart"
    )
    report = Shape.from_mesh(tmp_path / "a.stl", spacing=0.13).imported[0]
    assert second == (
        f"note: 'a.stl' is sampled every 0.13: its surface is off by up to {report.largest:.2g}, "
        f"{report.mean:.2g} on average, measured at 24 places; no thin part is lost; "
        "spacing=0.065 is finer"
    )


def test_the_figures_are_measured_and_the_finer_spacing_is_finer(lines):
    Shape.from_mesh(*box(), spacing=0.13)
    (line,) = lines
    off = float(re.search(r"off by up to ([\d.e-]+)", line)[1])
    assert 0.01 < off < 0.87 * 0.13  # the corner of a box, cut by the interpolation
    finer = float(re.search(r"spacing=([\d.]+) is finer", line)[1])
    assert Shape.from_mesh(*box(), spacing=finer).imported[0].largest < off


def test_a_line_is_repeated_when_the_content_is_another_one(lines, tmp_path):
    write(tmp_path / "a.stl", Sample(*sphere(2)))
    for _ in range(3):
        Shape.from_mesh(tmp_path / "a.stl", spacing=0.2)
    assert len(lines) == 1
    write(tmp_path / "a.stl", Sample(*box((2.0, 1.0, 1.0))))
    Shape.from_mesh(tmp_path / "a.stl", spacing=0.2)
    assert len(lines) == 2 and lines[0] != lines[1]


def test_parts_that_are_lost_are_named(lines):
    body, faces = box()
    plate = box((1.0, 1.0, 0.02))[0] + np.array((0.0, 0.0, 1.1))
    both = np.concatenate([body, plate]), np.concatenate([faces, faces + 8])
    with pytest.warns(UserWarning, match="is lost; give spacing=0.1"):
        Shape.from_mesh(*both, spacing=0.2)
    assert "parts thinner than that are lost, 0.26 of its area; spacing=0.1 is finer" in lines[0]


def test_without_a_command_nothing_is_printed(capsys):
    Shape.from_mesh(*box(), spacing=0.3)
    assert capsys.readouterr() == ("", "")


def test_a_volume_with_a_level_says_that_it_is_no_distance(lines):
    z, y, x = np.mgrid[-1:1:8j, -1:1:8j, -1:1:8j]
    Shape.from_volume(1.0 - (x * x + y * y + z * z), level=0.5, spacing=(0.1, 0.2, 0.3))
    assert "0.1 x 0.2 x 0.3 apart" in lines[0] and "thinner than 0.3 may be" in lines[0]
    assert "values are no distances: rays take more steps" in lines[0]
