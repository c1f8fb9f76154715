"""What is written of devices is what the code takes: docstrings, the guide, the command line."""

import ast
import re
from pathlib import Path

import pytest

import distal
from distal.cli.base import Device
from distal.lang.options import rows
from distal.lang.render_options import RenderOptions
from distal.runtime.device_names import AUTO, DEVICE_NAMES
from distal.runtime.kernels import DEVICES

SOURCE = Path(distal.__file__).parent
ROOT = Path(__file__).parents[2]
# Several lines: an entry ends where another begins, or the list does.
ENTRY = re.compile(r"^( +)device: (.*(?:\n\1 +.*)*)", re.MULTILINE)
AS_ELSEWHERE = re.compile(r"[`\.]render``")


def functions():
    """Every function with a device's name among its arguments, and its place."""
    for path in sorted(SOURCE.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.FunctionDef):
                arguments = [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]
                for argument in arguments:
                    if argument.arg == "device" and ast.unparse(argument.annotation) == "str":
                        yield f"{path.relative_to(SOURCE)}:{node.name}", node


def entries():
    for path in sorted(SOURCE.rglob("*.py")):
        for found in ENTRY.finditer(path.read_text("utf-8")):
            if not found[2].startswith(("str", "Any", "Device", "Annotated")):
                yield f"{path.relative_to(SOURCE)}: {found[2][:40]}", found[2]


def test_one_declaration_serves_the_executor_and_the_command_line():
    assert [device.value for device in Device] == list(DEVICE_NAMES)
    assert [AUTO, *DEVICES] == list(DEVICE_NAMES)


@pytest.mark.parametrize(("place", "text"), list(entries()), ids=lambda value: value[:50])
def test_an_entry_of_a_docstring_names_every_device_or_none(place, text):
    named = re.findall(r'"([a-z-]+)"', text)
    if not AS_ELSEWHERE.search(text):
        assert named in ([], list(DEVICE_NAMES)), place


@pytest.mark.parametrize(
    "place",
    [
        *("lang/option_methods.py:render", "lang/option_methods.py:video"),
        "lang/option_methods.py:sweep",
    ],
)
def test_what_authors_call_names_every_device(place):
    found = dict(functions())[place]
    entry = ENTRY.search(ast.get_docstring(found, clean=False) or "")
    assert entry is not None
    assert re.findall(r'"([a-z-]+)"', entry[2]) == list(DEVICE_NAMES)


def test_the_declaration_of_the_options_names_every_device():
    row = next(row for row in rows(RenderOptions) if row.name == "device")
    assert re.findall(r'"([a-z-]+)"', row.doc_of("scene")) == list(DEVICE_NAMES)


@pytest.mark.parametrize("page", ["command-line.md", "window.md"])
def test_the_guide_names_every_device(page):
    rows = [
        r for r in (ROOT / "docs/guide" / page).read_text("utf-8").splitlines() if "--device" in r
    ]
    assert rows
    assert any(all(re.search(rf"\b{name}\b", row) for name in DEVICE_NAMES) for row in rows)
