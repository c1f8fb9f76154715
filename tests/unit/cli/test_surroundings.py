"""The command in unusual surroundings: folders, terminals, names, encodings, Python's options."""

import inspect
import json
import os
import subprocess
import sys

import distal
import distal.lang

SCENE = "from distal import Scene, Sphere\nscene = Scene(Sphere(0.8))\n"
SMALL = ("--size", "16x12")
ENVIRONMENT = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
SIGNATURES = """
import inspect, json, sys, distal, distal.lang

def text(value):
    try:
        return str(inspect.signature(value))
    except (TypeError, ValueError) as error:
        return type(error).__name__

named = {f"{m.__name__}.{n}": getattr(m, n) for m in (distal, distal.lang) for n in m.__all__}
print(json.dumps({name: text(value) for name, value in named.items()}))
"""


def run(folder, *words, python=(), env=None, **options):
    """Run the command in a folder; words may be bytes."""
    return subprocess.run(
        [sys.executable, *python, "-m", "distal", *words],
        cwd=folder,
        env={**ENVIRONMENT, **(env or {})},
        capture_output=True,
        timeout=120,
        **options,
    )


def one_line(done, code):
    """Return the only line on stderr of a command that ended with a code."""
    lines = done.stderr.decode("utf-8", "surrogateescape").splitlines()
    assert done.returncode == code, lines
    assert len(lines) == 1, lines
    return lines[0]


# Python without docstrings


def test_without_docstrings_every_public_name_takes_the_same_arguments():
    plain, stripped = (
        subprocess.run(
            [sys.executable, *flags, "-c", SIGNATURES], env=ENVIRONMENT, capture_output=True
        )
        for flags in ((), ("-OO",))
    )
    assert plain.returncode == stripped.returncode == 0, stripped.stderr
    named = json.loads(plain.stdout)
    assert len(named) > 300
    assert named["distal.Sphere"] == str(inspect.signature(distal.Sphere))
    assert json.loads(stripped.stdout) == named


def test_without_docstrings_commands_do_the_same(tmp_path):
    (tmp_path / "s.py").write_text(SCENE)
    for words in (
        ("render", "s.py", "-o", "a.png", *SMALL),
        ("check", "s.py"),
        ("compile", "s.py", "--target", "wgsl"),
    ):
        done = run(tmp_path, *words, python=("-OO",))
        assert done.returncode == 0, done.stderr
    assert (tmp_path / "a.png").exists()
