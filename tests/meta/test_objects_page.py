"""The page of lights, backgrounds, cameras, materials and patterns: fresh and complete."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

from distal import public_names

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs/reference/objects.md"


def test_it_is_fresh():
    command = [sys.executable, ROOT / "tools/gen_objects_page.py", "--check"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr


def test_every_declared_object_is_in_it():
    text = PAGE.read_text(encoding="utf-8")
    headings = set(re.findall(r"^### `([\w.]+)\(", text, re.MULTILINE))
    headings |= set(re.findall(r"^- `(\w+)`: ", text.partition("\n## Looks\n")[2], re.MULTILINE))
    modules = public_names.DECLARED_NAMES.items()
    declared = {n for m, names in modules if not m.endswith(".shapes") for n in names.split()}
    assert declared | {"Material", "glass", "Environment", "Camera.yaw_pitch_roll"} <= headings
    assert "reference/objects.md" in (ROOT / "docs/README.md").read_text(encoding="utf-8")
