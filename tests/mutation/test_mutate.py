"""The tool that mutates: what a test notices is killed, what none notices is reported."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

from tools.mutation.operators import mutations, parses
from tools.mutation.project import Index, Project
from tools.mutation.survivors import accepted, entry_text, stale
from tools.record.rows import merged

ROOT = Path(__file__).parents[2]
LIST = ROOT / "tests/mutation/survivors.toml"

SOURCE = '''\
"""Made for the test."""

from distal.lang import func


def covered(a: int, b: int) -> int:
    """Both, and 1 is not added."""
    return a + b


def run_in_vain(a: int, b: int) -> int:
    return a - b


def left_alone(a: int, b: int) -> int:
    return a * b


@func
def scene_code(x: int, y: int) -> int:
    return x | y


@func
def scene_code_in_vain(x: int, y: int) -> int:
    return x & y
'''
TESTS = """\
from small.made import covered, run_in_vain, scene_code, scene_code_in_vain


def test_covered():
    assert covered(2, 3) == 5


def test_scene_code():
    run_in_vain(2, 3)
    scene_code_in_vain(1, 2)
    assert scene_code(1, 3) == 3


def test_broken():
    assert run_in_vain(2, 3) == 7
"""
VERDICTS = {
    ("covered", "return a - b"): "killed",
    ("run_in_vain", "return a + b"): "survived",
    ("left_alone", "return a / b"): "no",
    ("scene_code", "return x & y"): "killed",
    ("scene_code_in_vain", "return x | y"): "survived",
}


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    """A project with a function that tests hold, and others that they don't."""
    root = tmp_path_factory.mktemp("mutated")
    package = root / "src/small"
    package.mkdir(parents=True)
    (root / "tests").mkdir()
    (package / "__init__.py").touch()
    (package / "made.py").write_text(SOURCE)
    (root / "tests/test_made.py").write_text(TESTS)
    (root / "pyproject.toml").write_text("[tool.pytest.ini_options]\n")
    ran = {
        "test_covered": ["covered"],
        "test_scene_code": ["run_in_vain", "scene_code_in_vain", "scene_code"],
        "test_broken": ["run_in_vain"],
    }
    rows = {
        f"tests/test_made.py::{test}": (0.1, {f"small/made.py:{name}" for name in names})
        for test, names in ran.items()
    }
    merged(rows, {}, None).save(root / "tests/record/rows.xz")
    return root


def run(root, *words):
    command = [sys.executable, ROOT / "tools/mutate.py", "--root", root, "--seed", "1", *words]
    given = ("--tests", "tests", "--preload", "numpy", "--paths", str(ROOT / "src"))
    answer = subprocess.run([*command, *given], capture_output=True, text=True, timeout=300)
    return answer.returncode, answer.stdout + answer.stderr


def made(root):
    file = "small/made.py"
    return mutations(file, Project(root, root / "src", ()).index(file))


def entry(mutation, why="equivalent"):
    text = entry_text(mutation)
    return text.replace('why = ""', f'why = "{why}"').replace('reason = ""', 'reason = "so"')


def test_what_no_test_notices_is_reported(small, tmp_path):
    lists = tmp_path / "survivors.toml"
    known = next(m for m in made(small) if m.function == "run_in_vain")
    killed = next(m for m in made(small) if m.function == "covered")
    gone = entry(known).replace("a - b", "a - c")
    lists.write_text("\n".join([entry(known), entry(killed), gone]))
    code, said = run(small, "--modules", "small", "--survivors", lists)
    verdicts = {
        (m.function, m.becomes): line.split()[1]
        for m in made(small)
        for line in said.splitlines()
        if f" {m.function}: {m.was} => {m.becomes} [" in line
    }
    assert (code, verdicts) == (1, VERDICTS), said
    assert said.count("test_broken fails without a mutation: it is left out") == 1
    reported = said.partition("small: ")[2]
    assert 'becomes = "return x | y"' in reported
    assert 'becomes = "return a / b"' in reported
    assert 'becomes = "return a + b"' not in reported.partition("stale")[0]
    assert "an accepted survivor is killed by tests/test_made.py::test_covered" in reported
    assert "a - c" in reported.partition("stale entry")[2]
    assert (small / "src/small/made.py").read_text() == SOURCE


def test_a_list_that_accepts_all_passes(small, tmp_path):
    lists = tmp_path / "survivors.toml"
    rows = [m for m in made(small) if m.function == "run_in_vain"]
    lists.write_text("\n".join(map(entry, rows)))
    assert run(small, "--count", "0", "--survivors", lists) == (0, "")


def test_every_entry_has_a_reason(tmp_path):
    lists = tmp_path / "survivors.toml"
    lists.write_text(entry_text(mutations("a.py", Index("x = 1\n"))[0]))
    with pytest.raises(SystemExit, match="each survivor has"):
        accepted(lists)


def test_the_committed_list_is_of_mutations_that_there_are():
    project = Project(ROOT, ROOT / "src", ())
    assert stale(project, accepted(LIST)) == []


MUTATED = [
    ("y = a < b", {"y = a <= b"}),
    ("y = a is not b", {"y = a is b"}),
    ("y = a - b", {"y = a + b"}),
    ("y = (a) * (b)", {"y = (a) / (b)"}),
    ("y = a and b", {"y = a or b"}),
    ("y = not a", {"y = (a)"}),
    ("y = 2.0", {"y = 2.02", "y = (-2.0)"}),
    ("y = 1e-9", {"y = 1e-08", "y = (-1e-9)"}),
    ("y = 0.0", {"y = 0.01"}),
    ("y = 3", {"y = 4", "y = 2"}),
    ("y = True", {"y = False"}),
    ("y = min(a, b)", {"y = max(a, b)"}),
    ("y = m.sin(a)", {"y = m.cos(a)"}),
    ("y = abs(a)", {"y = (a)"}),
    ("y = f(a, b)", {"y = f(b, a)"}),
    ("y = f(a, 1 + a)", {"y = f(a, 2 + a)", "y = f(a, (-1) + a)", "y = f(a, 1 - a)"}),
    ("y = p.x", {"y = p.y"}),
    ("y = d['ab']", {"y = d['ab_']"}),
    ("y = {'ab': a}", {"y = {'ab_': a}"}),
    ("y = a == 'b'", {"y = a != 'b'", "y = a == 'b_'"}),
    ("f(a)", {"pass"}),
    ("y += a", {"pass", "y -= a"}),
    ("raise ValueError(f'{1}')", {"pass"}),
    ("if a < b: c()", {"if (not (a < b)): c()", "if a <= b: c()", "if a < b: pass"}),
    ("def f() -> bool: return a", {"def f() -> bool: return not (a)"}),
    ("def f() -> vec3: return a", {"def f() -> vec3: return 0.0 * (a)"}),
    ("def f() -> int | None: return a", {"def f() -> int | None: return None"}),
    ("def f(a: int = 1): pass", {"def f(a: int = 2): pass", "def f(a: int = (-1)): pass"}),
    ("def f(a): a = b", {"def f(a): pass"}),
]


@pytest.mark.parametrize(("text", "becomes"), MUTATED, ids=[text for text, _ in MUTATED])
def test_mutations_of(text, becomes):
    found = mutations("a.py", Index(text))
    assert {m.becomes for m in found} == becomes
    for mutation in found:
        assert parses(mutation.applied(text))
        assert ast.unparse(ast.parse(mutation.applied(text))) != ast.unparse(ast.parse(text))


@pytest.mark.parametrize(
    "text",
    [
        '"""A text, 1 + 1."""',
        "__all__ = ['a']",
        "x: Literal[1]",
        "def f(a: int) -> 'a[1]': ...",
        "assert a < 1, 'b'",
        "if TYPE_CHECKING:\n    x = 1",
        "y = f'{a + 1}'",
        "def __repr__(self):\n    return 1",
        "assert_never(1 + 1)",
    ],
)
def test_what_means_nothing_is_left(text):
    assert mutations("a.py", Index(text)) == []
