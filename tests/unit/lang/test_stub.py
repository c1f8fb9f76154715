"""The stub that editors read: fresh, complete, and content with ordinary scene code."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import distal.lang
from distal.frontend import lower
from distal.ir.nodes import EntryKind
from distal.loading import load

ROOT = Path(__file__).parents[3]
STUB = ROOT / "src/distal/lang/__init__.pyi"


def test_it_is_fresh() -> None:
    command = [sys.executable, ROOT / "tools/gen_lang_stub.py", "--check"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr


def test_every_name_is_in_it() -> None:
    defined: set[str] = set()
    for node in ast.parse(STUB.read_text()).body:
        match node:
            case ast.FunctionDef(name) | ast.ClassDef(name):
                defined.add(name)
            case ast.Assign([ast.Name(name)]) | ast.AnnAssign(ast.Name(name)):
                defined.add(name)
            case ast.ImportFrom(_, names):
                defined |= {n.asname or n.name for n in names}
    assert set(distal.lang.__all__) <= defined


def test_well_typed_scene_code_compiles() -> None:
    # tests/meta/test_stubs.py asks the type checker; of what does not compile, that says nothing.
    image = load(Path(__file__).parent / "well_typed_scene.py")
    assert lower(image).kind is EntryKind.IMAGE
