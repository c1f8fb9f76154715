"""The repository keeps its own promises."""

import subprocess
from pathlib import Path

import pytest

import distal

ROOT = Path(__file__).parents[2]
VAGUE = {"utils", "util", "helpers", "helper", "common", "misc"}


def test_rooms_have_names_that_say_something():
    rooms = {path.stem for path in (ROOT / "src").rglob("*.py")}
    assert not rooms & VAGUE


def test_readme_names_the_two_commands_and_shows_a_picture():
    readme = (ROOT / "README.md").read_text()
    assert "make picture" in readme
    assert "make test" in readme
    assert ".png)" in readme


def test_ci_runs_the_test_command_and_nothing_else():
    lines = (ROOT / ".ci" / "run").read_text().splitlines()
    commands = [line for line in lines if line and not line.startswith(("#", "set ", "cd "))]
    assert commands == ["exec make test"]


def test_the_package_is_typed_and_licensed():
    assert (Path(distal.__file__).parent / "py.typed").exists()
    assert (ROOT / "LICENSE").read_text().startswith("MIT License")


@pytest.mark.parametrize("goal", ["picture", "test", "bench", "sweep"])
def test_make_knows_what_to_do(goal):
    answer = subprocess.run(
        ["make", "-n", "-C", str(ROOT), goal], capture_output=True, text=True, timeout=600
    )
    assert answer.returncode == 0, answer.stderr
