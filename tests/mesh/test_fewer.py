"""Meshes with fewer triangles and fewer colors."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from distal import Box, Cylinder, Sphere, linear_gradient
from distal.cli.application import application
from distal.mesh.palette import nearest, palette_of
from distal.scene.tree.errors import SceneValueError

PART = (
    Box(2.0, 1.0, 1.0).paint("#ff0000") | Sphere(0.7).translate(y=0.6).paint("#0000ff")
) - Cylinder(0.2, 4.0)


def test_points_that_are_spared_leave_the_tolerance_and_borders_of_colors() -> None:
    made = PART.mesh(0.02, check=True)
    report = made.report
    assert report["triangles"] == len(made.triangles) < 0.5 * report["triangles_before"]
    assert report["check"] == {"open_edges": 0, "pinched_points": 0, "intersections": 0}
    assert report["error"]["largest"] <= 0.02
    # Other points than those that were measured: at least |value| / slope from the surface.
    rng = np.random.default_rng(3)
    rows = made.triangles[rng.integers(0, len(made.triangles), 4000)]
    points = np.einsum("ij,ijk->ik", rng.dirichlet((1.0, 1.0, 1.0), 4000), made.points[rows])
    assert np.abs(PART(points)).max() <= 1.1 * 0.02
    assert len(np.unique(made.points, axis=0)) == len(made.points)
    finer = PART.mesh(0.005)
    assert made.triangle_colors is not None and finer.triangle_colors is not None
    blue = [
        float(areas(mesh.points, mesh.triangles)[mesh.triangle_colors[:, 2] > 0.5].sum())
        for mesh in (finer, made)
    ]
    assert blue[1] == pytest.approx(blue[0], rel=0.02)


def areas(points: Any, triangles: Any) -> Any:
    a, b, c = np.moveaxis(points[triangles], 1, 0)
    return 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)


def test_colors_are_reduced_to_means_of_their_groups() -> None:
    colors = np.array([[1.0, 0, 0]] * 3 + [[0.9, 0, 0]] + [[0, 0, 1.0]] * 4)
    found = nearest(palette_of(colors, 2), colors)
    assert np.allclose(found[:4], (0.975, 0.0, 0.0)) and np.allclose(found[4:], (0.0, 0.0, 1.0))
    assert (nearest(palette_of(colors, 3), colors) == colors).all()


@pytest.mark.parametrize("count", [1, 3, 16])
def test_a_pattern_becomes_at_most_so_many_colors(count: int) -> None:
    ball = Sphere(1.0).paint(linear_gradient("#ff0000", "#0000ff", start=(0, -1, 0), end=(0, 1, 0)))
    made = ball.mesh(0.05, colors=count)
    assert made.triangle_colors is not None
    assert 0 < len(np.unique(made.triangle_colors, axis=0)) <= count


def test_invalid_numbers_of_colors() -> None:
    with pytest.raises(SceneValueError) as caught:
        PART.mesh(0.1, colors=300)
    expected = "colors is True, False, or a number from 1 to 256, not 300"
    assert caught.value.diagnostics[0].message == expected


FILE = "from distal import Box\npart = Box(2.0, 1.0, 1.0).paint('#ff0000')\n"


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "part.py").write_text(FILE)
    return lambda *args: CliRunner().invoke(application, args)


def test_the_command_counts_colors(run: Any) -> None:
    options = ("--colors", "2", "--tolerance", "0.01", "--check")
    done = run("mesh", "part.py", "-o", "p.3mf", *options)
    assert done.exit_code == 0, done.stderr
    first = done.stderr.splitlines()[0]
    assert first == "p.3mf: 12 triangles, 2 x 1 x 1 mm, 2 cubic mm"
    done = run("mesh", "part.py", "-o", "p.3mf", "--colors", "0")
    assert (done.exit_code, done.stderr) == (
        2,
        "error: --colors is a number from 1 to 256, not 0\n",
    )


SLOW = """
import time
from distal.mesh import spacing
from distal.cli import main
def slow(*given):
    print("meshing", flush=True)
    while True:
        time.sleep(0.01)
from distal.mesh import meshing
meshing.meshed = slow
main()
"""


def test_ctrl_c_leaves_no_file(tmp_path: Path) -> None:
    (tmp_path / "part.py").write_text(FILE)
    process = subprocess.Popen(
        [sys.executable, "-c", SLOW, "mesh", "part.py", "-o", "p.stl"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        assert process.stdout is not None and process.stdout.readline() == "meshing\n"
        time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=20)
    finally:
        process.kill()
    assert process.returncode == 130
    assert "Traceback" not in errors
    assert [path.name for path in tmp_path.iterdir() if path.suffix == ".stl"] == []
